//! What a program asks for that a board cannot do, found before anything moves.

mod passes;

use std::collections::BTreeSet;

use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::command::{BeyondPass, BlockNumber, ProgramId, Source};
use crate::program::Program;
use gsk_link::{MissingForThreads, ThreadCapability};
use gsk_messages::{Message, say};
use passes::Threads;

/// What one block of text asks for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Asks {
    /// The board cannot do it.
    refused: Option<Refused>,
    /// It has the spindle speed follow X (G96).
    surface: bool,
    /// The program it calls.
    calls: Option<u16>,
}

/// What the board cannot do.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Refused {
    /// A thread, for what it lacks.
    Thread(MissingForThreads),
    /// A thread that is no straight pass.
    Beyond(BeyondPass),
    /// Something that no board of its kind does.
    Never(Message),
}

impl Cnc {
    /// Looks through a program and what it calls; the first block that the board
    /// cannot carry out. A thread of the dry run is only feed.
    pub(crate) fn scan_for_board(&self, main: ProgramId) -> Option<Alarm> {
        let rights = self
            .drives
            .board
            .map_or_else(Default::default, |board| board.threads);
        let mut threads = Threads::new(self.memory.parameters.run_out_tenths());
        let passes = rights == ThreadCapability::Passes && !self.plc.signals.dry_run;
        let without_surface = self
            .drives
            .board
            .filter(|board| !board.surface)
            .map(|board| super::without_surface(board.timed));
        let mut seen = BTreeSet::new();
        let mut next = vec![main];
        while let Some(id) = next.pop() {
            let Some(program) = self.memory.programs.get(id) else {
                continue;
            };
            for index in 0..program.block_count() {
                let asks = asks(program.block(index), rights, self.plc.signals.dry_run);
                let beyond = || threads.look(program.block(index)).map(Refused::Beyond);
                let beyond = passes.then(beyond).flatten();
                let surface = without_surface.clone().filter(|_| asks.surface);
                let surface = surface.map(Refused::Never);
                if let Some(refused) = asks.refused.or(surface).or(beyond) {
                    return Some(alarm(id, program, index, refused));
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

fn alarm(id: ProgramId, program: &Program, index: u32, refused: Refused) -> Alarm {
    let what = match refused {
        Refused::Thread(lacks) => say::cannot_thread(lacks.text()),
        Refused::Beyond(beyond) => say::cannot_beyond_passes(beyond.text()),
        Refused::Never(what) => what,
    };
    Alarm::new(number::BOARD_CANNOT)
        .because(say::board_cannot_do(what))
        .at(Source {
            program: id,
            line: program.block_line(index),
            sequence: program.sequence(index).map(BlockNumber::from),
        })
}

/// Reads the words of a block as far as they matter here.
fn asks(block: &str, threads: ThreadCapability, dry_run: bool) -> Asks {
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
                    // In the dry run everything is feed.
                    ('G', Some(96)) if !dry_run => asks.surface = true,
                    ('G', Some(number)) if !dry_run => asks.refused = refused(number, threads),
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

/// What of a G code the board cannot do.
fn refused(code: u32, threads: ThreadCapability) -> Option<Refused> {
    let never = match (code, threads) {
        (32 | 34 | 76 | 92, ThreadCapability::None(lacks)) => return Some(Refused::Thread(lacks)),
        (33, ThreadCapability::Followed) => say::cannot_tap_by_index(),
        (33, _) => say::cannot_tap(),
        (99, ThreadCapability::Followed) => return None,
        (99, ThreadCapability::None(MissingForThreads { index: true, .. })) => {
            say::cannot_feed_per_revolution_unwired()
        }
        (99, _) => say::cannot_feed_per_revolution(),
        _ => return None,
    };
    Some(Refused::Never(never))
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

    const NONE: ThreadCapability = ThreadCapability::None(MissingForThreads {
        sync: true,
        proof: true,
        encoder: false,
        gains: false,
        offset: false,
        index: false,
    });

    #[test]
    fn codes_are_found_however_they_are_written() {
        for block in [
            "N10 G92 X20 Z-30 F2",
            "g32z-5f1",
            "G 076 P010060 Q50",
            "G97 G34 Z-1",
        ] {
            assert!(asks(block, NONE, false).refused.is_some(), "{block}");
            assert_eq!(
                asks(block, ThreadCapability::Followed, false).refused,
                None,
                "{block}"
            );
        }
        assert!(asks("G96 S120", NONE, false).surface && !asks("G96 S120", NONE, true).surface);
        assert!(asks("G99", NONE, false).refused.is_some());
        assert_eq!(asks("G99", ThreadCapability::Followed, false).refused, None);
        let tap = asks("X1 G33 Z-5 F1", ThreadCapability::Followed, false);
        assert!(tap.refused.is_some());
        for block in ["(G92) G01 X1", "G98", "G9", "G920", "G0 X32", "N92 G01"] {
            assert_eq!(asks(block, NONE, false), Asks::default(), "{block}");
        }
    }

    #[test]
    fn what_is_lacking_is_named() {
        let Some(Refused::Thread(lacks)) = asks("G92 X1 Z1 F1", NONE, false).refused else {
            panic!("not refused");
        };
        let text = lacks.text().to_string();
        assert!(
            text.contains("SS") && text.contains("line.thread_proved"),
            "{text}"
        );
        assert_eq!(asks("G92 X1 Z1 F1", NONE, true).refused, None, "dry run");
    }

    #[test]
    fn calls_name_their_program() {
        assert_eq!(asks("N130 M98 P41031", NONE, false).calls, Some(1031));
        assert_eq!(asks("M98P7", NONE, false).calls, Some(7));
        assert_eq!(asks("G65 H01 P#100", NONE, false).calls, None);
    }
}
