//! What a program means, beside what comes of it: the part that sharp tools would cut on
//! the path as it is programmed, and the part that the real ones cut with and without
//! nose radius compensation.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::preview::{Progress, preview_while};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{Insert, InsertLetter, Tool};

use super::Machining;
use crate::curves::{RapidRates, arc_points};

/// How far the chord of an arc may lie beside it, mm.
const SAGITTA: f64 = 0.002;
/// Pieces of a path that are kept.
const MOST_PIECES: usize = 200_000;

/// A piece of a path, part coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its ends.
    pub ends: [Point; 2],
    /// The nose radius of the tool that goes there, mm; 0 of one that has none.
    pub nose: f64,
}

/// The same program on the same stock, three times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compared {
    /// The part that is meant.
    pub wanted: Region,
    /// The part that comes of it.
    pub finished: Region,
    /// The part that would come of it without nose radius compensation.
    pub uncompensated: Region,
    /// The cuts as they are programmed.
    pub programmed: Vec<Piece>,
    /// The way of the imaginary tip with compensation.
    pub tips: Vec<Piece>,
    /// The way of the centre of the nose with compensation.
    pub centers: Vec<Piece>,
}

/// Cuts them; `None` when it was not to go on.
pub fn compare(
    setup: &Setup,
    job: &Job,
    rates: RapidRates,
    go_on: &mut dyn FnMut(&Progress) -> bool,
) -> Option<Compared> {
    let mut compared = Compared::default();
    let mut stopped = false;
    let mut carry_out = |setup: &Setup, machined: &mut dyn FnMut(&ExecutedMove)| {
        preview_while(setup, &setup.memory.programs, machined, &mut |progress| {
            stopped |= !go_on(progress);
            !stopped
        });
    };
    let mut real = Machining::new(job.clone());
    carry_out(setup, &mut |executed| {
        real.moved(executed, rates);
        let tool = job.tools.get(&executed.conditions.tool);
        add(&mut compared.tips, executed, &real, None);
        add(&mut compared.centers, executed, &real, tool);
    });
    let mut sharp = Setup::clone(setup);
    sharp.memory.offsets.clear_noses();
    let mut without = Machining::new(job.clone());
    let mut wanted = Machining::new(sharpened(job));
    carry_out(&sharp, &mut |executed| {
        without.moved(executed, rates);
        wanted.moved(executed, rates);
        add(&mut compared.programmed, executed, &wanted, None);
    });
    let section = |machining: &Machining| machining.scene().part().section();
    compared.finished = section(&real);
    compared.uncompensated = section(&without);
    compared.wanted = section(&wanted);
    (!stopped).then_some(compared)
}

/// Adds a cut to the path of the tip, or of the centre of a tool's nose.
fn add(
    path: &mut Vec<Piece>,
    executed: &ExecutedMove,
    machining: &Machining,
    nose_of: Option<&Tool>,
) {
    if matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell) || path.len() > MOST_PIECES {
        return;
    }
    let conditions = &executed.conditions;
    let zero = machining
        .mounting()
        .zero_of(conditions.tool, &conditions.frame);
    let shift = conditions.frame.machine(Point::default()) - zero
        + nose_of.map_or(Point::default(), Tool::center);
    let nose = nose_of.map_or(0.0, Tool::nose);
    let (from, to) = (executed.from + shift, executed.to + shift);
    match (executed.kind, executed.center) {
        (MoveKind::Clockwise | MoveKind::CounterClockwise, Some(center)) => {
            let clockwise = executed.kind == MoveKind::Clockwise;
            let mut from = from;
            for point in arc_points(from, to, center + shift, clockwise, SAGITTA * 2.0) {
                let ends = [core::mem::replace(&mut from, point), point];
                path.push(Piece { ends, nose });
            }
        }
        _ => path.push(Piece {
            ends: [from, to],
            nose,
        }),
    }
}

/// The same tools, as sharp as the programmer thinks of them.
fn sharpened(job: &Job) -> Job {
    let mut job = job.clone();
    for tool in job.tools.values_mut() {
        tool.insert = sharp(tool.insert);
    }
    job
}

/// Without its nose. A thread is meant with the point of its insert, and a round insert
/// becomes a narrow one.
const fn sharp(insert: Insert) -> Insert {
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
    use gsk_workpiece::stock::Stock;

    const NOSE: f64 = 0.8;

    /// A cone of 45° between two cylinders.
    fn cone(compensation: &str) -> Compared {
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
        let mut job = Job::new(Stock::bar(42.0, 0.0, 60.0));
        job.tools.insert(1, Tool::turning());
        let rates = RapidRates::of(&setup.memory);
        compare(&setup, &job, rates, &mut |_| true).unwrap()
    }

    /// Least and greatest deviation in front of a Z, mm.
    fn range(part: &Region, wanted: &Region) -> (f64, f64) {
        let found = deviations(part, wanted, -25.0);
        let each = found.iter().flatten().map(|it| it.distance);
        each.fold((0.0, 0.0), |(low, high): (f64, f64), off| {
            (low.min(off), high.max(off))
        })
    }

    #[test]
    fn a_nose_without_compensation_leaves_what_geometry_says() {
        // Off a cone of the angle a: r (sin a + cos a − 1).
        let expected = NOSE * (2_f64.sqrt() - 1.0);
        let compared = cone("");
        let (low, high) = range(&compared.uncompensated, &compared.wanted);
        assert!(
            (high - expected).abs() < 1e-3 && low > -1e-3,
            "{low} {high}"
        );
        assert_eq!(compared.finished, compared.uncompensated);
    }

    #[test]
    fn with_compensation_only_the_inner_corner_keeps_the_round_of_the_nose() {
        let compared = cone("G42");
        let (low, high) = range(&compared.finished, &compared.wanted);
        // The nose ends r (1 / cos 22.5° − 1) before the corner, which lies that much
        // times cos 22.5° off both sides.
        let corner = NOSE * (1.0 - libm::cos(PI / 8.0));
        assert!(low > -1e-3, "{low}");
        assert!((high - corner).abs() < 1e-3, "{high} {corner}");
        assert_eq!(compared.uncompensated, cone("").uncompensated);
        assert!(!compared.centers.is_empty() && compared.programmed.len() >= 4);
    }

    #[test]
    fn what_must_not_go_on_ends() {
        let mut setup = Setup::default();
        let text = "G01 X20 F100\nX21\n".repeat(10_000);
        setup.memory.programs.open_external(Program::new(&*text));
        setup.memory.programs.select(ProgramId::External);
        let job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        let rates = RapidRates::of(&setup.memory);
        assert_eq!(compare(&setup, &job, rates, &mut |_| false), None);
    }
}
