//! Searches a program, before any motion, for functions that the board cannot execute.

mod passes;

use std::collections::BTreeSet;

use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::command::{ProgramId, SequenceNumber, SourcePosition, ThreadPassFeature};
use crate::model::{GCode, ModelRecord};
use crate::program::Program;
use gsk_link::{MissingForThreads, TapCapability, ThreadCapability};
use gsk_messages::{Message, say};
use passes::ThreadScan;

/// The functions and pulse rates that one block requires from the board.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct BlockNeeds {
    /// Function that the board cannot execute; `None` without one.
    refused_function: Option<RefusedFunction>,
    /// Whether the block programs constant surface speed (G96).
    surface_speed: bool,
    /// O number of the program that the block calls (M98); `None` without a call.
    called_program: Option<u16>,
}

/// A function of a program that the board cannot execute.
#[derive(Clone, Debug, PartialEq, Eq)]
enum RefusedFunction {
    /// A thread, with the equipment that the board lacks.
    ThreadLacks(MissingForThreads),
    /// A thread that is not a single straight pass.
    BeyondPass(ThreadPassFeature),
    /// A function that no board of this kind has.
    Unsupported(Message),
}

impl Cnc {
    /// Scans a program and the programs it calls. Returns the alarm for the first block
    /// that the board cannot execute; `None` without one. In dry run a thread is an
    /// ordinary cut.
    pub(crate) fn scan_program_for_board(&self, main: ProgramId) -> Option<Alarm> {
        let thread_capability = self
            .drives
            .board
            .map_or_else(Default::default, |board| board.threads);
        let taps = self
            .drives
            .board
            .map_or_else(Default::default, |board| board.taps);
        let mut threads = ThreadScan::new(self.memory.parameters.run_out_tenths());
        let record = self.memory.model.record();
        // The search for more than one pass reads the thread codes of the GSK980TD.
        let has_thread_cycle = record.g_code(92) == Some(GCode::ThreadCycle);
        let passes = thread_capability == ThreadCapability::Passes
            && !self.plc.signals.dry_run
            && has_thread_cycle;
        let without_surface = self
            .drives
            .board
            .filter(|board| !board.speed_follows_motion)
            .map(|board| super::surface_speed_refusal(board.has_timed_outputs));
        let mut scanned = BTreeSet::new();
        let mut next = vec![main];
        while let Some(id) = next.pop() {
            let Some(program) = self.memory.programs.get(id) else {
                continue;
            };
            for index in 0..program.block_count() {
                let needs = block_needs(
                    program.block(index),
                    record,
                    (thread_capability, taps),
                    self.plc.signals.dry_run,
                );
                let pass_refusal = || {
                    threads
                        .read_block(program.block(index))
                        .map(RefusedFunction::BeyondPass)
                };
                let pass_refusal = passes.then(pass_refusal).flatten();
                let surface = without_surface.clone().filter(|_| needs.surface_speed);
                let surface = surface.map(RefusedFunction::Unsupported);
                if let Some(refused) = needs.refused_function.or(surface).or(pass_refusal) {
                    return Some(refusal_alarm(id, program, index, refused));
                }
                if let Some(number) = needs.called_program
                    && scanned.insert(number)
                {
                    next.push(ProgramId::Stored(number));
                }
            }
        }
        None
    }
}

fn refusal_alarm(id: ProgramId, program: &Program, index: u32, refused: RefusedFunction) -> Alarm {
    let function = match refused {
        RefusedFunction::ThreadLacks(lacks) => say::cannot_thread(lacks.text()),
        RefusedFunction::BeyondPass(beyond) => say::cannot_beyond_passes(beyond.to_message()),
        RefusedFunction::Unsupported(what) => what,
    };
    Alarm::new(number::BOARD_CANNOT)
        .with_detail(say::board_cannot_do(function))
        .with_source(SourcePosition {
            program: id,
            line: program.block_line(index),
            sequence: program.sequence(index).map(SequenceNumber::from),
        })
}

/// Determines which functions a block requires from the board. `record` gives the meanings of its
/// codes, `capabilities` the threads and taps that the board can cut; in `dry_run` a thread is an
/// ordinary cut.
fn block_needs(
    block: &str,
    record: &ModelRecord,
    capabilities: (ThreadCapability, TapCapability),
    dry_run: bool,
) -> BlockNeeds {
    let mut needs = BlockNeeds::default();
    let (mut call, mut called) = (false, None);
    let mut comment = false;
    for (at, letter) in block.char_indices() {
        match letter {
            '(' => comment = true,
            ')' => comment = false,
            _ if comment => {}
            'G' | 'g' | 'M' | 'm' | 'P' | 'p' => {
                let number = parse_number(&block[at + 1..]);
                match (letter.to_ascii_uppercase(), number) {
                    // In dry run all motion is feed.
                    ('G', Some(number)) if !dry_run => match record.g_code(number.into()) {
                        Some(GCode::SurfaceSpeed) => needs.surface_speed = true,
                        Some(code) => needs.refused_function = g_code_refusal(code, capabilities),
                        None => {}
                    },
                    ('M', Some(98)) => call = true,
                    ('P', number) => called = number,
                    _ => {}
                }
            }
            _ => {}
        }
        if needs.refused_function.is_some() {
            return needs;
        }
    }
    if call {
        needs.called_program = called.map(|number| (number % 10_000) as u16);
    }
    needs
}

/// Returns the function of the G code `code` that the board cannot execute; `None` if the board can
/// execute the code.
fn g_code_refusal(
    code: GCode,
    (threads, taps): (ThreadCapability, TapCapability),
) -> Option<RefusedFunction> {
    let reason = match (code, threads) {
        (
            GCode::Thread
            | GCode::VariableThread
            | GCode::CompoundThread
            | GCode::ThreadCycle
            | GCode::MetricThreadPass
            | GCode::InchThreadPass
            | GCode::MetricThreadCycle
            | GCode::InchThreadCycle,
            ThreadCapability::None(lacks),
        ) => return Some(RefusedFunction::ThreadLacks(lacks)),
        (GCode::Tapping | GCode::MetricRigidTapping | GCode::InchRigidTapping, _) => {
            match (taps, threads) {
                (TapCapability::Followed, _) => return None,
                (TapCapability::OldFirmware, _) => say::cannot_tap_by_firmware(),
                (TapCapability::NoEncoder, ThreadCapability::Followed) => {
                    say::cannot_tap_by_index()
                }
                (TapCapability::NoEncoder, _) => say::cannot_tap(),
            }
        }
        (GCode::FeedPerRevolution, ThreadCapability::Followed) => return None,
        (
            GCode::FeedPerRevolution,
            ThreadCapability::None(MissingForThreads { index: true, .. }),
        ) => say::cannot_feed_per_revolution_unwired(),
        (GCode::FeedPerRevolution, _) => say::cannot_feed_per_revolution(),
        _ => return None,
    };
    Some(RefusedFunction::Unsupported(reason))
}

/// Parses the integer at the start of a text, after blanks; `None` without one.
fn parse_number(text: &str) -> Option<u32> {
    let text = text.trim_start_matches([' ', '\t']);
    let end = text
        .find(|digit: char| !digit.is_ascii_digit())
        .unwrap_or(text.len());
    text[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::ModelId;

    const NONE: ThreadCapability = ThreadCapability::None(MissingForThreads {
        sync: true,
        proof: true,
        encoder: false,
        gains: false,
        offset: false,
        index: false,
    });

    fn needs_of(block: &str, threads: ThreadCapability, dry_run: bool) -> BlockNeeds {
        let capabilities = (threads, TapCapability::NoEncoder);
        block_needs(block, ModelId::Gsk980td.record(), capabilities, dry_run)
    }

    #[test]
    fn codes_have_the_meaning_of_the_model() {
        let record = ModelId::Hx31.record();
        let refuses = |block: &str| {
            let needs = block_needs(block, record, (NONE, TapCapability::NoEncoder), false);
            needs.refused_function.is_some()
        };
        for block in ["G92 X100 Z100", "G76", "G74 X0", "G91 G01 X2"] {
            assert!(!refuses(block), "{block}");
        }
        for block in [
            "G33 Z-20 K2",
            "G34 Z-20 K8",
            "G86 Z-20 K2",
            "G87 Z-20 K8",
            "G84 Z-5 K1",
        ] {
            assert!(refuses(block), "{block}");
        }
    }

    #[test]
    fn codes_are_found_in_any_notation() {
        for block in [
            "N10 G92 X20 Z-30 F2",
            "g32z-5f1",
            "G 076 P010060 Q50",
            "G97 G34 Z-1",
        ] {
            assert!(
                needs_of(block, NONE, false).refused_function.is_some(),
                "{block}"
            );
            assert_eq!(
                needs_of(block, ThreadCapability::Followed, false).refused_function,
                None,
                "{block}"
            );
        }
        assert!(
            needs_of("G96 S120", NONE, false).surface_speed
                && !needs_of("G96 S120", NONE, true).surface_speed
        );
        assert!(needs_of("G99", NONE, false).refused_function.is_some());
        assert_eq!(
            needs_of("G99", ThreadCapability::Followed, false).refused_function,
            None
        );
        let tap = needs_of("X1 G33 Z-5 F1", ThreadCapability::Followed, false);
        assert!(tap.refused_function.is_some());
        for (taps, is_refused) in [
            (TapCapability::OldFirmware, true),
            (TapCapability::Followed, false),
        ] {
            let record = ModelId::Gsk980td.record();
            let capabilities = (ThreadCapability::Followed, taps);
            let needs = block_needs("G33 Z-5 F1", record, capabilities, false);
            assert_eq!(needs.refused_function.is_some(), is_refused, "{taps:?}");
        }
        for block in ["(G92) G01 X1", "G98", "G9", "G920", "G0 X32", "N92 G01"] {
            assert_eq!(
                needs_of(block, NONE, false),
                BlockNeeds::default(),
                "{block}"
            );
        }
    }

    #[test]
    fn lacking_equipment_is_named() {
        let Some(RefusedFunction::ThreadLacks(lacks)) =
            needs_of("G92 X1 Z1 F1", NONE, false).refused_function
        else {
            panic!("not refused");
        };
        let text = lacks.text().to_string();
        assert!(
            text.contains("SS") && text.contains("line.thread_proved"),
            "{text}"
        );
        assert_eq!(
            needs_of("G92 X1 Z1 F1", NONE, true).refused_function,
            None,
            "dry run"
        );
    }

    #[test]
    fn calls_name_their_program() {
        assert_eq!(
            needs_of("N130 M98 P41031", NONE, false).called_program,
            Some(1031)
        );
        assert_eq!(needs_of("M98P7", NONE, false).called_program, Some(7));
        assert_eq!(needs_of("G65 H01 P#100", NONE, false).called_program, None);
    }
}
