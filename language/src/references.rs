//! Finds the target of a reference, and all references to a target.

use std::collections::BTreeSet;

use crate::reference_target::ReferenceTarget;
use crate::structure::{MacroLoop, NumberedBlock, ProgramPart, Structure, WordReference};
use crate::text::{Position, TextRange};

/// The item at the cursor that refers to a block or program, or to which words can refer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CursorTarget<'a> {
    /// The cursor is on the sequence number of a block.
    Block(&'a NumberedBlock),
    /// The cursor is on a word that refers to a block or program.
    Reference(&'a WordReference),
    /// The cursor is on the name (O word) of a program.
    Program(&'a ProgramPart),
    /// The cursor is on the beginning or end of a macro loop.
    Loop(&'a MacroLoop),
}

/// The positions in the text to which a word refers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Definition {
    /// Ranges in the text: sequence numbers of blocks, the name of a program, or an end of a
    /// loop.
    pub blocks: Vec<TextRange>,
    /// The number of the program if the text does not contain it; otherwise `None`.
    pub program: Option<u16>,
}

/// Returns the item at a position that refers to a block or program, or to which words can refer;
/// otherwise `None`.
pub fn target_at(structure: &Structure, at: Position) -> Option<CursorTarget<'_>> {
    let block = structure.blocks.iter().find(|it| it.word.touches(at));
    let reference = || structure.references.iter().find(|it| it.word.touches(at));
    let named = |part: &&ProgramPart| {
        let name = part.name.as_ref().filter(|name| name.line == at.line);
        // The position may also be on the letter or on blanks before the digits.
        name.is_some_and(|name| at.byte <= name.to)
    };
    let program = || structure.parts.iter().find(named);
    let ends = |it: &&MacroLoop| it.begin.touches(at) || it.end.touches(at);
    let looped = || structure.loops.iter().find(ends);
    (block.map(CursorTarget::Block))
        .or_else(|| reference().map(CursorTarget::Reference))
        .or_else(|| program().map(CursorTarget::Program))
        .or_else(|| looped().map(CursorTarget::Loop))
}

/// Returns where the targets of the word at a position are; empty if it refers to nothing.
pub fn definition(structure: &Structure, at: Position) -> Definition {
    let mut definition = Definition::default();
    match target_at(structure, at) {
        Some(CursorTarget::Block(block)) => definition.blocks.push(block.digits.clone()),
        Some(CursorTarget::Program(part)) => definition.blocks.extend(part.name.clone()),
        Some(CursorTarget::Loop(it)) => {
            let other = if it.begin.touches(at) {
                &it.end
            } else {
                &it.begin
            };
            definition.blocks.push(other.clone());
        }
        Some(CursorTarget::Reference(reference)) => {
            if let ReferenceTarget::Program(number) = reference.target {
                let mut parts = structure.parts.iter();
                let part = parts.find(|part| part.number == Some(number));
                match part.and_then(|part| part.name.clone()) {
                    Some(name) => definition.blocks.push(name),
                    None => definition.program = Some(number),
                }
            } else {
                let found = structure.referenced_blocks(reference).into_iter();
                definition
                    .blocks
                    .extend(found.map(|block| block.digits.clone()));
            }
        }
        None => {}
    }
    definition
}

/// Returns all references to the block or program at a position, or to the target of the word
/// there. Also returns the number if the target is a program, because other files may call it.
/// `include_declaration` includes the sequence number of the block or the name of the program.
pub fn references(
    structure: &Structure,
    at: Position,
    include_declaration: bool,
) -> (Vec<TextRange>, Option<u16>) {
    let mut ranges = Vec::new();
    let mut program = None;
    match target_at(structure, at) {
        Some(CursorTarget::Loop(it)) => ranges.extend([it.begin.clone(), it.end.clone()]),
        Some(CursorTarget::Program(part)) => program = part.number,
        Some(CursorTarget::Block(block)) => {
            ranges
                .extend(references_to(structure, block).map(|reference| reference.digits.clone()));
            ranges.extend(include_declaration.then(|| block.digits.clone()));
        }
        Some(CursorTarget::Reference(reference)) => match reference.target {
            ReferenceTarget::Program(number) => program = Some(number),
            _ => {
                for block in structure.referenced_blocks(reference) {
                    ranges.extend(references_to(structure, block).map(|it| it.digits.clone()));
                    ranges.extend(include_declaration.then(|| block.digits.clone()));
                }
            }
        },
        None => {}
    }
    if let Some(number) = program {
        let calls = structure.references.iter();
        let calls = calls.filter(|reference| reference.target == ReferenceTarget::Program(number));
        ranges.extend(calls.map(|reference| reference.digits.clone()));
        let named = structure
            .parts
            .iter()
            .filter(|part| part.number == Some(number));
        let names = named.filter_map(|part| part.name.clone());
        ranges.extend(names.filter(|_| include_declaration));
    }
    ranges.sort();
    ranges.dedup();
    (ranges, program)
}

/// Returns the words of the text that refer to a block.
pub(crate) fn references_to<'a>(
    structure: &'a Structure,
    block: &'a NumberedBlock,
) -> impl Iterator<Item = &'a WordReference> {
    let references = structure.references.iter();
    references.filter(move |reference| structure.referenced_blocks(reference).contains(&block))
}

/// Returns the numbers of the programs that a text calls.
pub fn programs_called(structure: &Structure) -> BTreeSet<u16> {
    let references = structure.references.iter();
    let programs = references.filter_map(|reference| match reference.target {
        ReferenceTarget::Program(number) => Some(number),
        _ => None,
    });
    programs.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TextDocument;

    const TEXT: &str = "O0001\nG71 P10 Q20\nN10 G00 X20\nN20 G01 Z-30\nG70 P10 Q20\nM98 P2\n\
                        WHILE [#1 LT 3] DO 1\nEND 1\nG65 H80 P20\nM98 P30003\nO0002\nN20 M99\n";

    fn at(line: u32, byte: u32) -> Position {
        Position { line, byte }
    }

    fn lines(ranges: &[TextRange]) -> Vec<u32> {
        ranges.iter().map(|range| range.line).collect()
    }

    #[test]
    fn words_lead_to_blocks_programs_and_loops() {
        let structure = Structure::read(&TextDocument::new(TEXT));
        let definition = |line, byte| {
            let definition = definition(&structure, at(line, byte));
            (lines(&definition.blocks), definition.program)
        };
        assert_eq!(definition(1, 4), (vec![2], None));
        assert_eq!(definition(1, 11), (vec![3], None), "at the end of the word");
        assert_eq!(definition(5, 5), (vec![10], None));
        assert_eq!(definition(9, 7), (vec![], Some(3)));
        assert_eq!(definition(6, 3), (vec![7], None));
        assert_eq!(definition(7, 1), (vec![6], None));
        assert_eq!(definition(3, 5), (vec![], None));
    }

    #[test]
    fn references_are_those_of_the_same_program() {
        let structure = Structure::read(&TextDocument::new(TEXT));
        let refer = |line, byte, include_declaration| {
            let (ranges, program) = references(&structure, at(line, byte), include_declaration);
            (lines(&ranges), program)
        };
        assert_eq!(refer(3, 1, true), (vec![1, 3, 4, 8], None));
        assert_eq!(refer(1, 9, false), (vec![1, 4, 8], None));
        assert_eq!(refer(11, 1, false), (vec![], None));
        assert_eq!(refer(10, 2, true), (vec![5, 10], Some(2)));
        assert_eq!(programs_called(&structure), BTreeSet::from([2, 3]));
    }
}
