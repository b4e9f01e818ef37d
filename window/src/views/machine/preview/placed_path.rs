//! The drawn path of a program: where it lies beside the part, and the position it begins at.

use gsk_core::command::{ExecutedMove, Frame, ProgramId};
use gsk_core::preview::{WorkBudget, preview_with_progress};
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_host::preview::work_limit::WorkLimit;
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;

use super::super::path::{DrawnPath, PathBuilder};
use super::super::xray;

/// Limit of the work of one execution of a program.
pub const WORK_BUDGET: WorkBudget = WorkBudget::interactive(5_000_000);

/// Builds the path of a program with the profile cycles removed, for a profile that breaks a
/// rule.
pub fn build_profile_path(
    setup: &Setup,
    program: ProgramId,
    place: PathPlace<'_>,
    rates: RapidRates,
) -> DrawnPath {
    let mut setup = setup.clone();
    let programs = &mut setup.memory.programs;
    if let Some(text) = programs.get(program).map(xray::remove_profile_cycles) {
        replace_program_text(programs, program, &text);
    }
    build_path(&setup, place, rates)
}

/// Builds the path of a program once more, drawn at `place`.
pub fn build_path(setup: &Setup, place: PathPlace<'_>, rates: RapidRates) -> DrawnPath {
    let limit = WorkLimit::new(WORK_BUDGET);
    let mut builder = PathBuilder::default();
    preview_with_progress(
        setup,
        &setup.memory.programs,
        &mut |executed| builder.add_move(executed, place.shift_of(executed), rates),
        &mut |progress| limit.allows(progress),
    );
    builder.build(&setup.memory.programs, false)
}

/// Replaces the text of the program `id` in the memory if that program is selected.
pub fn replace_program_text(programs: &mut ProgramMemory, id: ProgramId, text: &Program) {
    if programs.selected() != Some(id) {
        return;
    }
    match id {
        ProgramId::Stored(number) => {
            let before = programs.clone();
            // A text with another number would be stored as another program.
            if programs.store(text.text()).ok() != Some(number) {
                *programs = before;
            }
        }
        ProgramId::External => programs.open_external(text.clone()),
        ProgramId::Mdi | ProgramId::Dnc => {}
    }
    programs.select(id);
}

/// Machine coordinates of the work zero, µm: X as a radius, and Z.
pub fn work_zero(setup: &Setup) -> [i64; 2] {
    micrometres(setup.start.unwrap_or_default() - setup.absolute.unwrap_or_default())
}

/// Rounds a position to micrometres: X as a radius, and Z.
pub fn micrometres(point: Point) -> [i64; 2] {
    [point.x, point.z].map(|mm| (mm * 1000.0).round() as i64)
}

/// What places the path of a program beside its part.
#[derive(Clone, Copy, Debug)]
pub struct PathPlace<'a> {
    /// The part with its mounting; `None`: program and part have the same zero.
    pub machining: Option<&'a Machining>,
    /// Distance from the machine coordinates of the control to the position of the slides, mm.
    pub slide_shift: Point,
}

impl PathPlace<'_> {
    /// The shift from program to part coordinates of a move, mm. It is zero without a job that
    /// defines the position of the part.
    pub fn shift_of(self, executed: &ExecutedMove) -> Point {
        let Some(machining) = self.machining else {
            return Point::default();
        };
        let conditions = &executed.conditions;
        let frame = Frame {
            zero: conditions.frame.zero + self.slide_shift,
            ..conditions.frame
        };
        let zero = machining
            .mounting()
            .slide_at_part_zero(conditions.tool, &frame);
        frame.to_machine(Point::default()) - zero
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;
    use gsk_runner::machining::guess::empty_chuck_job;

    use super::*;

    #[test]
    fn a_path_with_a_placed_part_lies_where_the_slides_are() {
        let mut setup = Setup::default();
        let programs = &mut setup.memory.programs;
        programs.open_external(Program::new("G50 X100 Z100\nG00 X80 Z50\nM30\n"));
        programs.select(ProgramId::External);
        let rates = RapidRates::from_memory(&setup.memory);
        let bounds = |machining, slide_shift| {
            let place = PathPlace {
                machining,
                slide_shift,
            };
            build_path(&setup, place, rates).bounds.unwrap()
        };
        let lathe = Machining::new(empty_chuck_job(&setup.lathe));
        let none = Point::default();
        let by = Point::new(3.0, 7.0);
        let placed = bounds(Some(&lathe), none);
        assert_eq!(
            bounds(Some(&lathe), by).min - placed.min,
            vec2(by.z as f32, by.x as f32)
        );
        // Without a place the part goes with the work zero.
        assert_eq!(bounds(None, by), bounds(None, none));
    }
}
