//! What a program asks for that a board cannot do, found before anything moves.

use std::collections::BTreeSet;

use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::{ProgramId, Source};
use crate::program::Program;

/// What one block of text asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Asks {
    /// The board cannot do it.
    refused: Option<&'static str>,
    /// The program it calls.
    calls: Option<u16>,
}

impl Cnc {
    /// Looks through a program and what it calls; the first block that the board
    /// cannot carry out. A thread of the dry run is only feed.
    pub(super) fn scan_for_board(&self, main: ProgramId) -> Option<Alarm> {
        let threads = self.from_plc.dry_run || self.board.is_some_and(|board| board.threads);
        let mut seen = BTreeSet::new();
        let mut next = vec![main];
        while let Some(id) = next.pop() {
            let Some(program) = self.programs.get(id) else {
                continue;
            };
            for index in 0..program.block_count() {
                let asks = asks(program.block(index), threads, self.from_plc.dry_run);
                if let Some(what) = asks.refused {
                    return Some(alarm(id, program, index, what));
                }
                if let Some(number) = asks.calls
                    && seen.insert(number)
                {
                    next.push(ProgramId::Stored(number));
                }
            }
        }
        None
    }
}

fn alarm(id: ProgramId, program: &Program, index: u32, what: &str) -> Alarm {
    Alarm::new(604)
        .because(format!(
            "the board cannot do {what}; nothing of the program was begun"
        ))
        .at(Source {
            program: id,
            line: program.block_line(index),
            sequence: program.sequence(index),
        })
}

/// Reads the words of a block as far as they matter here.
fn asks(block: &str, threads: bool, dry_run: bool) -> Asks {
    let mut asks = Asks::default();
    let (mut call, mut place) = (false, None);
    let mut comment = false;
    for (at, letter) in block.char_indices() {
        match letter {
            '(' => comment = true,
            ')' => comment = false,
            _ if comment => {}
            'G' | 'g' | 'M' | 'm' | 'P' | 'p' => {
                let number = number(&block[at + 1..]);
                match (letter.to_ascii_uppercase(), number) {
                    ('G', Some(32 | 34 | 76 | 92)) if !threads => {
                        asks.refused = Some("a thread (G32, G34, G76, G92)");
                    }
                    ('G', Some(33)) if !dry_run => asks.refused = Some("tapping (G33)"),
                    ('G', Some(96)) if !dry_run => {
                        asks.refused = Some("constant surface speed (G96)");
                    }
                    ('G', Some(99)) if !dry_run => {
                        asks.refused = Some("feed per revolution (G99)");
                    }
                    ('M', Some(98)) => call = true,
                    ('P', number) => place = number,
                    _ => {}
                }
            }
            _ => {}
        }
        if asks.refused.is_some() {
            return asks;
        }
    }
    if call {
        asks.calls = place.map(|number| (number % 10_000) as u16);
    }
    asks
}

/// The whole number at the start of a text, blanks before it skipped.
fn number(text: &str) -> Option<u32> {
    let text = text.trim_start_matches([' ', '\t']);
    let end = text
        .find(|digit: char| !digit.is_ascii_digit())
        .unwrap_or(text.len());
    text[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_found_however_they_are_written() {
        for block in [
            "N10 G92 X20 Z-30 F2",
            "g32z-5f1",
            "G 076 P010060 Q50",
            "G97 G34 Z-1",
        ] {
            assert!(asks(block, false, false).refused.is_some(), "{block}");
            assert_eq!(asks(block, true, false).refused, None, "{block}");
        }
        for block in ["G96 S120", "G99", "X1 G33 Z-5 F1"] {
            assert!(asks(block, true, false).refused.is_some(), "{block}");
        }
        for block in ["(G92) G01 X1", "G98", "G9", "G920", "G0 X32", "N92 G01"] {
            assert_eq!(asks(block, false, false), Asks::default(), "{block}");
        }
    }

    #[test]
    fn calls_name_their_program() {
        assert_eq!(asks("N130 M98 P41031", false, false).calls, Some(1031));
        assert_eq!(asks("M98P7", false, false).calls, Some(7));
        assert_eq!(asks("G65 H01 P#100", false, false).calls, None);
    }
}
