//! Compares the position at which a program would start with that of its last start.
//!
//! A program that begins with G50 takes the current position as its start point. After RESET in
//! the cut it would move through the part. A program that was reset in the middle continues
//! there, without what its first blocks set.

use gsk_core::cnc::{Cnc, Event};
use gsk_core::command::{ProgramId, SequenceNumber, SourcePosition};
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::program::Program;
use gsk_core::units::{Axis, Point};

/// Greatest distance from the last start that is not reported, mm; for X the difference of the
/// diameters.
const TOLERANCE_MM: f64 = 0.1;
/// Number of lines at the beginning of a program that are searched for a G50.
const FIRST_LINES: usize = 12;

/// The distance of the slides from the last start of the selected program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartDistance {
    pub program: ProgramId,
    /// Position of the last start minus current position, mm, X as a radius.
    pub distance: Point,
    /// The axis that leads out of the part and goes first.
    pub first_axis: Axis,
}

/// The last start of a program.
#[derive(Debug, Default)]
pub(super) struct StartWatch {
    /// Program and slide position of the last start, machine coordinates, mm; `None` before the
    /// first one.
    last_start: Option<(ProgramId, Point)>,
    /// Whether the last run came to its end: the next start may be at any position.
    is_complete: bool,
    run_state: Option<RunState>,
}

impl StartWatch {
    /// Records the starts and ends of program runs; call it after every tick.
    pub(super) fn update(&mut self, cnc: &Cnc) {
        let now = cnc.run_state();
        let before = self.run_state.replace(now);
        let ended = |event: &Event| matches!(event, Event::ProgramEnded { .. });
        self.is_complete |= cnc.events().iter().any(ended);
        let starts = before == Some(RunState::Reset) && now == RunState::Run;
        if !starts || cnc.mode() != OperatingMode::Auto {
            return;
        }
        let Some(program) = cnc.programs().selected() else {
            return;
        };
        let is_same = self.last_start.is_some_and(|(last, _)| last == program);
        if self.is_complete || !is_same {
            self.last_start = Some((program, cnc.position_machine()));
        }
        self.is_complete = false;
    }

    /// Returns the distance of the slides from the last start, while the selected program waits for
    /// its start in automatic mode and begins with G50; `None` otherwise, or if the slides are
    /// close to that start.
    /// `is_internal`: the tool works in a bore.
    pub(super) fn report(&self, cnc: &Cnc, is_internal: bool) -> Option<StartDistance> {
        let (program, last) = self.last_start?;
        let waits = cnc.run_state() == RunState::Reset && !cnc.is_position_unknown();
        let is_selected = cnc.programs().selected() == Some(program);
        if !waits || !is_selected || cnc.mode() != OperatingMode::Auto {
            return None;
        }
        let distance = last - cnc.position_machine();
        let is_far = distance.x.abs() * 2.0 > TOLERANCE_MM || distance.z.abs() > TOLERANCE_MM;
        let sets_coordinates = || cnc.programs().get(program).is_some_and(begins_with_g50);
        (is_far && sets_coordinates()).then_some(StartDistance {
            program,
            distance,
            first_axis: if is_internal { Axis::Z } else { Axis::X },
        })
    }

    /// Returns the block at which the selected program, which was reset in the middle, waits in
    /// automatic mode to continue; `None` at its head.
    pub(super) fn resumes_at(&self, cnc: &Cnc) -> Option<SourcePosition> {
        let waits = cnc.run_state() == RunState::Reset && cnc.mode() == OperatingMode::Auto;
        let program = cnc.programs().selected().filter(|_| waits)?;
        let is_interrupted = self.last_start.is_some_and(|(last, _)| last == program);
        if !is_interrupted || self.is_complete {
            return None;
        }
        let (text, line) = (cnc.programs().get(program)?, cnc.cursor().line);
        let block = text.block_from_line(line);
        let sequence = text.sequence(block);
        (block > 0).then_some(SourcePosition {
            program,
            line,
            sequence: sequence.map(SequenceNumber::from),
        })
    }
}

/// Whether one of the first blocks of a program is G50 with coordinates.
fn begins_with_g50(program: &Program) -> bool {
    program.text().lines().take(FIRST_LINES).any(|line| {
        let code = line.split(['(', ';']).next().unwrap_or_default();
        let Some((_, words)) = code.split_once("G50") else {
            return false;
        };
        words.contains(['X', 'Z', 'U', 'W'])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_g50_with_coordinates_sets_them() {
        for (text, expected) in [
            ("O1\nG50 X100 Z100\nM30\n", true),
            ("O1\nN10G50Z5\nM30\n", true),
            ("O1\nG50 S2000\nM30\n", false),
            ("O1 (G50 X1)\nG00 X1\nM30\n", false),
        ] {
            assert_eq!(begins_with_g50(&Program::new(text)), expected, "{text}");
        }
    }
}
