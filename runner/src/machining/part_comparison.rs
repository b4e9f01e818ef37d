//! Compares the intended part with the machined one: the part that sharp tools cut along the
//! programmed path, and the parts that the real tools cut with and without nose radius
//! compensation.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::preview::{PreviewProgress, preview_with_progress};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{Insert, InsertLetter, Tool};

use super::Machining;
use crate::curves::{RapidRates, arc_points};

/// Greatest distance of the chords that replace an arc from that arc, mm.
const MAX_SAGITTA_MM: f64 = 0.002;
/// Greatest number of pieces of a path that are stored; the rest is dropped.
const MAX_PATH_PIECES: usize = 200_000;

/// A straight piece of a path, in part coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPiece {
    /// Start and end of the piece, mm; X is a radius.
    pub ends: [Point; 2],
    /// Nose radius of the tool, mm; 0 for a sharp tool.
    pub nose_radius_mm: f64,
}

/// The part that one program makes of the same stock in three ways, with the tool paths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartComparison {
    /// Half section of the part that the programmer intends, cut by sharp tools that are set
    /// correctly.
    pub intended: Region,
    /// Half section of the part as machined, with nose radius compensation as programmed.
    pub finished: Region,
    /// Half section of the part without nose radius compensation.
    pub uncompensated: Region,
    /// The programmed path of the cuts.
    pub programmed_path: Vec<PathPiece>,
    /// The path of the imaginary tip with compensation.
    pub tip_path: Vec<PathPiece>,
    /// The path of the nose centre with compensation.
    pub nose_center_path: Vec<PathPiece>,
}

/// Machines the part in the three ways of a [`PartComparison`]. `rates` are the rapid rates.
/// `can_continue` receives the progress and returns false to cancel; the result is then `None`.
pub fn compare_parts(
    setup: &Setup,
    job: &Job,
    rates: RapidRates,
    can_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Option<PartComparison> {
    let mut compared = PartComparison::default();
    let mut stopped = false;
    let mut carry_out = |setup: &Setup, machined: &mut dyn FnMut(&ExecutedMove)| {
        preview_with_progress(setup, &setup.memory.programs, machined, &mut |progress| {
            stopped |= !can_continue(progress);
            !stopped
        });
    };
    let mut real = Machining::new(job.clone());
    carry_out(setup, &mut |executed| {
        real.execute_move(executed, rates);
        let tool = job.tools.get(&executed.conditions.tool);
        add_cut(&mut compared.tip_path, executed, &real, None);
        add_cut(&mut compared.nose_center_path, executed, &real, tool);
    });
    let mut sharp = Setup::clone(setup);
    sharp.memory.offsets.clear_noses();
    let mut without = Machining::new(job.clone());
    let mut wanted = Machining::new(as_programmed(job));
    carry_out(&sharp, &mut |executed| {
        without.execute_move(executed, rates);
        wanted.execute_move(executed, rates);
        add_cut(&mut compared.programmed_path, executed, &wanted, None);
    });
    let section = |machining: &Machining| machining.scene().part().section();
    compared.finished = section(&real);
    compared.uncompensated = section(&without);
    compared.intended = section(&wanted);
    (!stopped).then_some(compared)
}

/// Adds a cut to `path`, a path of the nose centre of the tool `nose_of`; with `None` a path of the
/// tip. A rapid or a dwell is not added.
fn add_cut(
    path: &mut Vec<PathPiece>,
    executed: &ExecutedMove,
    machining: &Machining,
    nose_of: Option<&Tool>,
) {
    if matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell) || path.len() > MAX_PATH_PIECES {
        return;
    }
    let conditions = &executed.conditions;
    let zero = machining
        .mounting()
        .slide_at_part_zero(conditions.tool, &conditions.frame);
    let shift = conditions.frame.to_machine(Point::default()) - zero
        + nose_of.map_or(Point::default(), Tool::center);
    let nose = nose_of.map_or(0.0, Tool::nose);
    let (from, to) = (executed.from + shift, executed.to + shift);
    match (executed.kind, executed.center) {
        (MoveKind::Clockwise | MoveKind::CounterClockwise, Some(center)) => {
            let clockwise = executed.kind == MoveKind::Clockwise;
            let mut from = from;
            for point in arc_points(from, to, center + shift, clockwise, MAX_SAGITTA_MM * 2.0) {
                let ends = [core::mem::replace(&mut from, point), point];
                path.push(PathPiece {
                    ends,
                    nose_radius_mm: nose,
                });
            }
        }
        _ => path.push(PathPiece {
            ends: [from, to],
            nose_radius_mm: nose,
        }),
    }
}

/// Returns the job as the programmer assumes it: inserts without nose radius, and each tip where
/// the program has it, so that a wrong offset or work zero shows as a deviation.
fn as_programmed(job: &Job) -> Job {
    let mut job = job.clone();
    job.zero = None;
    job.lengths.clear();
    for tool in job.tools.values_mut() {
        tool.insert = without_nose(tool.insert);
    }
    job
}

/// Returns the insert without its nose radius. Threading inserts and drills are unchanged. A round
/// insert becomes a narrow one.
const fn without_nose(insert: Insert) -> Insert {
    match insert {
        Insert::Turning {
            letter,
            entering,
            size,
            ..
        } => {
            let (letter, entering) = match letter {
                InsertLetter::R => (InsertLetter::V, 90.0),
                letter => (letter, entering),
            };
            Insert::Turning {
                letter,
                entering,
                size,
                nose: 0.0,
            }
        }
        Insert::Grooving { width, reach, .. } => Insert::Grooving {
            width,
            nose: 0.0,
            reach,
        },
        same @ (Insert::Threading { .. } | Insert::Drill { .. }) => same,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use gsk_core::command::ProgramId;
    use gsk_core::memory::ToolOffset;
    use gsk_core::program::Program;
    use gsk_workpiece::compare::deviations;
    use gsk_workpiece::job::DiameterPoint;
    use gsk_workpiece::stock::Stock;

    const NOSE: f64 = 0.8;

    /// Compares the parts of a program that turns a cone of 45° between two cylinders, with the G
    /// code `compensation` (G40, G41 or G42).
    fn cone(compensation: &str) -> PartComparison {
        let mut job = Job::new(Stock::bar(42.0, 0.0, 60.0));
        job.tools.insert(1, Tool::turning());
        compare_cone(compensation, &job)
    }

    fn compare_cone(compensation: &str, job: &Job) -> PartComparison {
        let mut setup = Setup::default();
        let text = format!(
            "T0101 M03 S500\nG00 X30 Z3\n{compensation} G01 X20 Z2 F100\nZ-10\nX40 Z-20\n\
             Z-30\nG40 X60\nM30\n"
        );
        let programs = &mut setup.memory.programs;
        programs.open_external(Program::new(&*text));
        programs.select(ProgramId::External);
        let offset = ToolOffset {
            r: NOSE,
            t: 3,
            ..ToolOffset::default()
        };
        setup.memory.offsets.set(1, offset).unwrap();
        setup.memory.parameters.set_bit(2, 1, true).unwrap();
        let rates = RapidRates::from_memory(&setup.memory);
        compare_parts(&setup, job, rates, &mut |_| true).unwrap()
    }

    /// Returns the least and the greatest deviation, mm, of a part from the wanted one at Z above
    /// -25.
    fn deviation_range(part: &Region, wanted: &Region) -> (f64, f64) {
        let found = deviations(part, wanted, -25.0);
        let each = found.iter().flatten().map(|it| it.distance);
        each.fold((0.0, 0.0), |(low, high): (f64, f64), off| {
            (low.min(off), high.max(off))
        })
    }

    #[test]
    fn a_nose_without_compensation_leaves_what_geometry_says() {
        // Distance from a cone of angle a: r (sin a + cos a − 1).
        let expected = NOSE * (2_f64.sqrt() - 1.0);
        let compared = cone("");
        let (low, high) = deviation_range(&compared.uncompensated, &compared.intended);
        assert!(
            (high - expected).abs() < 1e-3 && low > -1e-3,
            "{low} {high}"
        );
        assert_eq!(compared.finished, compared.uncompensated);
    }

    #[test]
    fn with_compensation_only_the_inner_corner_keeps_the_round_of_the_nose() {
        let compared = cone("G42");
        let (low, high) = deviation_range(&compared.finished, &compared.intended);
        // The nose ends r (1 / cos 22.5° − 1) before the corner, which lies that much
        // times cos 22.5° off both sides.
        let corner = NOSE * (1.0 - libm::cos(PI / 8.0));
        assert!(low > -1e-3, "{low}");
        assert!((high - corner).abs() < 1e-3, "{high} {corner}");
        assert_eq!(compared.uncompensated, cone("").uncompensated);
        assert!(!compared.nose_center_path.is_empty() && compared.programmed_path.len() >= 4);
    }

    #[test]
    fn an_offset_that_is_wrong_shows_as_a_deviation() {
        let mut job = Job::new(Stock::bar(42.0, 0.0, 60.0));
        job.tools.insert(1, Tool::turning());
        // The control has offset 0; the tip is 0.4 mm further out than that.
        let length = DiameterPoint::from(Point::new(-0.2, 0.0));
        job.lengths.insert(1, length);
        let compared = compare_cone("G42", &job);
        assert_eq!(compared.intended, cone("G42").intended);
        let found = deviations(&compared.finished, &compared.intended, -9.0);
        let cylinder = found.iter().flatten().map(|it| it.distance);
        let greatest = cylinder.fold(0.0, f64::max);
        assert!((greatest - 0.2).abs() < 1e-3, "{greatest}");
    }

    #[test]
    fn what_must_not_go_on_ends() {
        let mut setup = Setup::default();
        let text = "G01 X20 F100\nX21\n".repeat(10_000);
        setup.memory.programs.open_external(Program::new(&*text));
        setup.memory.programs.select(ProgramId::External);
        let job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        let rates = RapidRates::from_memory(&setup.memory);
        assert_eq!(compare_parts(&setup, &job, rates, &mut |_| false), None);
    }
}
