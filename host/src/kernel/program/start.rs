//! Compares the position at which a program would start with that of its last start.
//!
//! A program that begins with G50 (on the Huaxing G92) takes the current position as its start point. After RESET in
//! the cut it would move through the part. A program that was reset in the middle continues
//! there, without what its first blocks set.

use gsk_core::cnc::{Cnc, Event};
use gsk_core::command::{ProgramId, SequenceNumber, SourcePosition};
use gsk_core::model::ModelRecord;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::program::Program;
use gsk_core::units::{Axis, Diameter, Point};

/// Greatest distance from the last start that is not reported, mm; for X the difference of the
/// diameters.
const TOLERANCE_MM: f64 = 0.1;
/// Number of lines at the beginning of a program that are searched for a G50 or G92.
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
pub(in crate::kernel) struct StartWatch {
    /// Program and slide position of the last start, machine coordinates, mm; `None` before the
    /// first one.
    last_start: Option<(ProgramId, Point)>,
    /// Whether the last run came to its end: the next start may be at any position.
    is_complete: bool,
    run_state: Option<RunState>,
    /// The work zero at the last tick, machine coordinates, mm.
    work_zero: Option<Point>,
    /// The program that was reset before its end; `None` after its end.
    interrupted: Option<ProgramId>,
}

impl StartWatch {
    /// Records the starts and ends of program runs; call it after every tick.
    pub(in crate::kernel) fn update(&mut self, cnc: &Cnc) {
        let now = cnc.run_state();
        let before = self.run_state.replace(now);
        let ended = |event: &Event| matches!(event, Event::ProgramEnded { .. });
        if cnc.events().iter().any(ended) {
            self.is_complete = true;
            self.interrupted = None;
        }
        // The operator has set another zero, for example by G50 after a trial cut: the start
        // point of before means nothing there.
        let zero = cnc.frame().zero;
        let is_other_zero = self
            .work_zero
            .replace(zero)
            .is_some_and(|last| last != zero);
        if is_other_zero && (cnc.mode() != OperatingMode::Auto || now == RunState::Reset) {
            self.last_start = None;
        }
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
        self.interrupted = Some(program);
        self.is_complete = false;
    }

    /// Returns the distance of the slides from the last start, while the selected program waits for
    /// its start and begins with G50 or G92; `None` otherwise, or if the slides are close to that
    /// start.
    /// `is_internal`: the tool works in a bore.
    pub(in crate::kernel) fn distance(
        &self,
        cnc: &Cnc,
        is_internal: bool,
    ) -> Option<StartDistance> {
        let (program, last) = self.last_start?;
        let waits = cnc.run_state() == RunState::Reset && !cnc.is_position_unknown();
        let is_selected = cnc.programs().selected() == Some(program);
        if !waits || !is_selected {
            return None;
        }
        let distance = last - cnc.position_machine();
        let is_far = distance.x.abs() * 2.0 > TOLERANCE_MM || distance.z.abs() > TOLERANCE_MM;
        let text = cnc.programs().get(program);
        let record = cnc.model().record();
        let sets_coordinates = || text.is_some_and(|text| coordinate_words(text, record).is_some());
        (is_far && sets_coordinates()).then_some(StartDistance {
            program,
            distance,
            first_axis: if is_internal { Axis::Z } else { Axis::X },
        })
    }

    /// Returns the block at which the selected program, which was reset in the middle, waits in
    /// automatic mode to continue; `None` at its head.
    pub(in crate::kernel) fn resumes_at(&self, cnc: &Cnc) -> Option<SourcePosition> {
        let waits = cnc.run_state() == RunState::Reset && cnc.mode() == OperatingMode::Auto;
        let program = cnc.programs().selected().filter(|_| waits)?;
        if self.interrupted != Some(program) {
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

/// Whether the selected program waits in automatic mode with the cursor after its last block, where
/// a start only returns to the head.
pub(in crate::kernel) fn waits_at_end(cnc: &Cnc) -> bool {
    if cnc.run_state() != RunState::Reset || cnc.mode() != OperatingMode::Auto {
        return false;
    }
    let programs = cnc.programs();
    let Some(program) = programs.selected().and_then(|id| programs.get(id)) else {
        return false;
    };
    let next = program.block_from_line(cnc.cursor().line);
    let is_empty = |block: u32| matches!(program.block(block).trim(), "" | "%");
    next > 0 && (next..program.block_count()).all(is_empty)
}

/// The coordinates that one of the first blocks of a program sets with G50, on the Huaxing with
/// G92, as text; `None` without one.
fn coordinate_words<'a>(program: &'a Program, record: &ModelRecord) -> Option<&'a str> {
    let code = format!("G{}", record.coordinate_code()?);
    let mut lines = program.text().lines().take(FIRST_LINES);
    lines.find_map(|line| {
        let block = line.split(['(', ';']).next().unwrap_or_default();
        let (_, words) = block.split_once(&code)?;
        let is_whole = !words.starts_with(|it: char| it.is_ascii_digit());
        let has_axes = words.contains(['X', 'Z', 'U', 'W']);
        (is_whole && has_axes).then_some(words)
    })
}

/// The point that a program takes as its start with G50 or G92, work coordinates, mm, X as a
/// radius; `None` if it sets not both axes.
pub(in crate::kernel) fn programmed_start(
    program: &Program,
    record: &ModelRecord,
) -> Option<Point> {
    let words = coordinate_words(program, record)?;
    let value = |axis: char| {
        let (_, text) = words.split_once(axis)?;
        let end = text.find(|it: char| !matches!(it, '0'..='9' | '.' | '-' | '+'));
        text.get(..end.unwrap_or(text.len()))?.parse().ok()
    };
    Some(Point::from_diameter(Diameter(value('X')?), value('Z')?))
}

#[cfg(test)]
mod tests {
    use gsk_core::cnc::ControlRequest;
    use gsk_core::model::ModelId;
    use gsk_core::setup::Setup;
    use gsk_panel::emulator::Emulator;
    use gsk_panel::keys::Key;

    use super::*;

    #[test]
    fn only_a_code_with_coordinates_sets_them() {
        let lathe = ModelId::Gsk980td.record();
        for (text, expected) in [
            ("O1\nG50 X100 Z100\nM30\n", true),
            ("O1\nN10G50Z5\nM30\n", true),
            ("O1\nG50 S2000\nM30\n", false),
            ("O1 (G50 X1)\nG00 X1\nM30\n", false),
        ] {
            let program = Program::new(text);
            let found = coordinate_words(&program, lathe);
            assert_eq!(found.is_some(), expected, "{text}");
        }
        let start = |text| programmed_start(&Program::new(text), lathe);
        let expected = Point::from_diameter(Diameter(120.5), -3.0);
        assert_eq!(start("O1\nN10 G50 X120.5Z-3 (X1)\n"), Some(expected));
        assert_eq!(start("O1\nN10 G50 X120\n"), None);
        // G92 is a thread there, and sets the coordinates on the Huaxing.
        let program = Program::new("%P21\nN10 G92 X100 Z50\nG50 X1 Z1\n");
        assert_eq!(
            programmed_start(&program, ModelId::Hx31.record()),
            Some(Point::from_diameter(Diameter(100.0), 50.0))
        );
        assert_eq!(start("O1\nG92 X10 Z-20 F1\n"), None);
    }

    #[test]
    fn a_program_waits_at_its_end_after_it_was_keyed_in() {
        let mut emulator = Emulator::new(Setup::default());
        emulator.run(200);
        let mut waits = |line: u32, mode: Key| {
            let text = "O0001;\nG00 X10;\nM30;\n";
            let stored = ControlRequest::StoreProgram(text.to_owned());
            assert_eq!(emulator.request(stored), Ok(()));
            emulator.press(mode);
            assert_eq!(emulator.request(ControlRequest::CursorTo(line)), Ok(()));
            emulator.run(100);
            waits_at_end(emulator.cnc())
        };
        assert!(waits(4, Key::Auto));
        assert!(!waits(3, Key::Auto));
        assert!(!waits(1, Key::Auto));
        assert!(!waits(4, Key::Edit));
    }
}
