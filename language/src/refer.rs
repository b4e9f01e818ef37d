//! Finds the target of a reference, and all references to a target.

use std::collections::BTreeSet;

use crate::leads::Aim;
use crate::structure::{Lead, Loop, Numbered, Part, Structure};
use crate::text::{Place, Position};

/// The symbol under the cursor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Under<'a> {
    /// The number of a block.
    Block(&'a Numbered),
    /// A word that refers to a block or program.
    Lead(&'a Lead),
    /// The name of a program.
    Program(&'a Part),
    /// The begin or end of a loop.
    Loop(&'a Loop),
}

/// The targets of a reference.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Led {
    /// Ranges in the text: numbers of blocks, the name of a program, an end of a loop.
    pub blocks: Vec<Place>,
    /// The number of a program that the text does not contain.
    pub program: Option<u16>,
}

/// Returns the symbol at a position, if it refers to something or can be referred to.
pub fn under(structure: &Structure, at: Position) -> Option<Under<'_>> {
    let block = structure.blocks.iter().find(|it| it.word.touches(at));
    let lead = || structure.leads.iter().find(|it| it.word.touches(at));
    let named = |part: &&Part| {
        let name = part.name.as_ref().filter(|name| name.line == at.line);
        // The position may also be on the letter or on blanks before the digits.
        name.is_some_and(|name| at.byte <= name.to)
    };
    let program = || structure.parts.iter().find(named);
    let ends = |it: &&Loop| it.begin.touches(at) || it.end.touches(at);
    let looped = || structure.loops.iter().find(ends);
    (block.map(Under::Block))
        .or_else(|| lead().map(Under::Lead))
        .or_else(|| program().map(Under::Program))
        .or_else(|| looped().map(Under::Loop))
}

/// Returns the targets of the word at a position.
pub fn definition(structure: &Structure, at: Position) -> Led {
    let mut led = Led::default();
    match under(structure, at) {
        Some(Under::Block(block)) => led.blocks.push(block.digits.clone()),
        Some(Under::Program(part)) => led.blocks.extend(part.name.clone()),
        Some(Under::Loop(it)) => {
            let other = if it.begin.touches(at) {
                &it.end
            } else {
                &it.begin
            };
            led.blocks.push(other.clone());
        }
        Some(Under::Lead(lead)) => {
            if let Aim::Program(number) = lead.aim {
                let mut parts = structure.parts.iter();
                let part = parts.find(|part| part.number == Some(number));
                match part.and_then(|part| part.name.clone()) {
                    Some(name) => led.blocks.push(name),
                    None => led.program = Some(number),
                }
            } else {
                let found = structure.aimed_at(lead).into_iter();
                led.blocks.extend(found.map(|block| block.digits.clone()));
            }
        }
        None => {}
    }
    led
}

/// Returns all references to the symbol at a position, or to its target. Also returns the
/// number if the target is a program, because other files may call it. `itself` includes the
/// block number or program name.
pub fn references(structure: &Structure, at: Position, itself: bool) -> (Vec<Place>, Option<u16>) {
    let mut places = Vec::new();
    let mut program = None;
    match under(structure, at) {
        Some(Under::Loop(it)) => places.extend([it.begin.clone(), it.end.clone()]),
        Some(Under::Program(part)) => program = part.number,
        Some(Under::Block(block)) => {
            places.extend(leading_to(structure, block).map(|lead| lead.digits.clone()));
            places.extend(itself.then(|| block.digits.clone()));
        }
        Some(Under::Lead(lead)) => match lead.aim {
            Aim::Program(number) => program = Some(number),
            _ => {
                for block in structure.aimed_at(lead) {
                    places.extend(leading_to(structure, block).map(|it| it.digits.clone()));
                    places.extend(itself.then(|| block.digits.clone()));
                }
            }
        },
        None => {}
    }
    if let Some(number) = program {
        let calls = structure.leads.iter();
        let calls = calls.filter(|lead| lead.aim == Aim::Program(number));
        places.extend(calls.map(|lead| lead.digits.clone()));
        let named = structure
            .parts
            .iter()
            .filter(|part| part.number == Some(number));
        let names = named.filter_map(|part| part.name.clone());
        places.extend(names.filter(|_| itself));
    }
    places.sort();
    places.dedup();
    (places, program)
}

/// Returns the references to a block.
pub(crate) fn leading_to<'a>(
    structure: &'a Structure,
    block: &'a Numbered,
) -> impl Iterator<Item = &'a Lead> {
    let leads = structure.leads.iter();
    leads.filter(move |lead| structure.aimed_at(lead).contains(&block))
}

/// Returns the numbers of the programs that a text calls.
pub fn programs_called(structure: &Structure) -> BTreeSet<u16> {
    let leads = structure.leads.iter();
    let programs = leads.filter_map(|lead| match lead.aim {
        Aim::Program(number) => Some(number),
        _ => None,
    });
    programs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Text;

    const TEXT: &str = "O0001\nG71 P10 Q20\nN10 G00 X20\nN20 G01 Z-30\nG70 P10 Q20\nM98 P2\n\
                        WHILE [#1 LT 3] DO 1\nEND 1\nG65 H80 P20\nM98 P30003\nO0002\nN20 M99\n";

    fn at(line: u32, byte: u32) -> Position {
        Position { line, byte }
    }

    fn lines(places: &[Place]) -> Vec<u32> {
        places.iter().map(|place| place.line).collect()
    }

    #[test]
    fn words_lead_to_blocks_programs_and_loops() {
        let structure = Structure::read(&Text::new(TEXT));
        let led = |line, byte| {
            let led = definition(&structure, at(line, byte));
            (lines(&led.blocks), led.program)
        };
        assert_eq!(led(1, 4), (vec![2], None));
        assert_eq!(led(1, 11), (vec![3], None), "at the end of the word");
        assert_eq!(led(5, 5), (vec![10], None));
        assert_eq!(led(9, 7), (vec![], Some(3)));
        assert_eq!(led(6, 3), (vec![7], None));
        assert_eq!(led(7, 1), (vec![6], None));
        assert_eq!(led(3, 5), (vec![], None));
    }

    #[test]
    fn references_are_those_of_the_same_program() {
        let structure = Structure::read(&Text::new(TEXT));
        let refer = |line, byte, itself| {
            let (places, program) = references(&structure, at(line, byte), itself);
            (lines(&places), program)
        };
        assert_eq!(refer(3, 1, true), (vec![1, 3, 4, 8], None));
        assert_eq!(refer(1, 9, false), (vec![1, 4, 8], None));
        assert_eq!(refer(11, 1, false), (vec![], None));
        assert_eq!(refer(10, 2, true), (vec![5, 10], Some(2)));
        assert_eq!(programs_called(&structure), BTreeSet::from([2, 3]));
    }
}
