//! The extents of a program, for the graphic page.

use gsk_core::command::{ExecutedMove, MoveKind, ProgramId};
use gsk_core::preview::{End, Progress, preview_while};
use gsk_core::program::ProgramMemory;
use gsk_core::setup::Setup;
use gsk_core::units::Point;

use crate::kernel::Opened;

/// Room around the cuts, mm.
const MARGIN: f64 = 5.0;

/// The least and the greatest point that the cuts of a program reach (X as a
/// radius), with some room around; `None` for a program without cuts, and for one
/// that `go_on` gives up.
pub fn of(opened: &Opened, go_on: &mut dyn FnMut(&Progress) -> bool) -> Option<(Point, Point)> {
    let mut programs = ProgramMemory::default();
    for program in &opened.subprograms {
        // What does not fit the memory is missing here as in the control.
        let _ = programs.store(program.text());
    }
    programs.open_external(opened.program.clone());
    programs.select(ProgramId::External);

    let mut extents: Option<(Point, Point)> = None;
    let mut take = |point: Point| {
        let (least, greatest) = extents.get_or_insert((point, point));
        *least = Point::new(least.x.min(point.x), least.z.min(point.z));
        *greatest = Point::new(greatest.x.max(point.x), greatest.z.max(point.z));
    };
    let preview = preview_while(
        &Setup::default(),
        &programs,
        &mut |executed: &ExecutedMove| {
            if !matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell) {
                take(executed.from);
                take(executed.to);
            }
        },
        go_on,
    );
    if preview.end == End::Limit {
        return None;
    }
    let margin = Point::new(MARGIN, MARGIN);
    extents.map(|(least, greatest)| (least - margin, greatest + margin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::program::Program;

    fn extents(text: &str) -> Option<(Point, Point)> {
        let opened = Opened {
            name: "part.CNC".to_owned(),
            path: None,
            storing: crate::kernel::Storing::Ask,
            program: Program::new(text),
            subprograms: Vec::new(),
        };
        of(&opened, &mut |progress| progress.moves < 10_000)
    }

    #[test]
    fn rapids_do_not_count() {
        let (least, greatest) =
            extents("G00 X40 Z2\nG01 Z-30 F100\nG01 X60\nG00 X200 Z200\nM30\n").unwrap();
        assert_eq!((least.x, least.z), (15.0, -35.0));
        assert_eq!((greatest.x, greatest.z), (35.0, 7.0));
    }

    #[test]
    fn a_loop_without_end_is_given_up() {
        let text = "N1 G01 U0.001 F6000\nG01 U-0.001\nG65 H80 P1\n";
        assert_eq!(extents(text), None);
    }

    #[test]
    fn a_program_without_cuts_has_none() {
        assert_eq!(extents("G00 X10\nM30\n"), None);
    }
}
