//! Writes the part of a program at evenly spaced moments, as the half section that is cut and
//! as the triangles that are drawn: `part_moments JOB COUNT PROGRAM [SUBPROGRAM]…`.
//! `tests/oracles/part_silhouette.py` compares both.
//!
//! Each moment is a line of JSON: `time`, s; `section`, polygons of (Z, radius), mm; `triangles`,
//! their number. After the line come nine little-endian `f32` for each triangle: three corners
//! of (along the axis, up, towards the operator), mm.

use std::error::Error;
use std::io::{BufWriter, Write};

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::preview::preview_with_progress;
use gsk_core::setup::Setup;
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_scene::part::outline::PartOutline;
use gsk_scene::software::part_triangles;
use gsk_tests::setup::build_memory;
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::job::Job;
use serde_json::json;

/// Flat sides of the revolved part, as in a picture file.
const SIDES: u32 = 192;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [job, count, programs @ ..] = &arguments[..] else {
        return Err("part_moments JOB COUNT PROGRAM [SUBPROGRAM]…".into());
    };
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let job: Job = options.from_str(&std::fs::read_to_string(job)?)?;
    let texts: Result<Vec<String>, _> = programs.iter().map(std::fs::read_to_string).collect();
    let mut setup = Setup::default().with_chuck();
    setup.memory.programs = build_memory(&texts?)?;
    if let Some(zero) = job.zero {
        setup.absolute = Some(setup.start.unwrap_or_default() - zero.point());
    }
    write_moments(&setup, job, count.parse()?)
}

fn write_moments(setup: &Setup, job: Job, count: u32) -> Result<(), Box<dyn Error>> {
    let rates = RapidRates::from_memory(&setup.memory);
    let mut moves: Vec<ExecutedMove> = Vec::new();
    let preview = preview_with_progress(
        setup,
        &setup.memory.programs,
        &mut |executed| moves.push(*executed),
        &mut |_| true,
    );
    if let Some(alarm) = preview.alarm {
        return Err(format!("{alarm:?}").into());
    }
    let moments = (1..=count).map(|at| preview.time_s * f64::from(at) / f64::from(count));
    let mut output = BufWriter::new(std::io::stdout().lock());
    let mut machining = Machining::new(job);
    let mut rest = moves.into_iter();
    let mut current = rest.next();
    for moment_s in moments {
        while let Some(executed) = current {
            if executed.start_s + executed.duration_s > moment_s {
                break;
            }
            machining.execute_move(&executed, rates);
            current = rest.next();
        }
        current = current.map(|executed| split_move(&mut machining, executed, moment_s, rates));
        write_moment(&mut output, &machining, moment_s)?;
    }
    Ok(output.flush()?)
}

/// Executes a straight cut up to a moment, s. Returns the rest of it; any other move remains
/// whole.
fn split_move(
    machining: &mut Machining,
    executed: ExecutedMove,
    moment_s: f64,
    rates: RapidRates,
) -> ExecutedMove {
    let passed_s = moment_s - executed.start_s;
    if executed.kind != MoveKind::Feed || passed_s <= 0.0 {
        return executed;
    }
    let (mut done, mut rest) = (executed, executed);
    done.to = executed.from + (executed.to - executed.from) * (passed_s / executed.duration_s);
    done.duration_s = passed_s;
    rest.from = done.to;
    rest.start_s = moment_s;
    rest.duration_s = executed.duration_s - passed_s;
    machining.execute_move(&done, rates);
    rest
}

fn write_moment(
    output: &mut impl Write,
    machining: &Machining,
    moment_s: f64,
) -> Result<(), Box<dyn Error>> {
    let section = machining.scene().part().section();
    let polygons: Vec<Vec<[f64; 2]>> = section
        .contours()
        .iter()
        .map(|contour| {
            let points = contour.iter().map(|point| from_grid(*point));
            points.map(|it| [it.z, it.x]).collect()
        })
        .collect();
    let drawn: Vec<Vec<[f32; 2]>> = polygons
        .iter()
        .map(|polygon| polygon.iter().map(|it| it.map(|it| it as f32)).collect())
        .collect();
    let radius = machining.job().stock.radius() as f32;
    let triangles = part_triangles(&PartOutline::from_polygons(&drawn, radius), SIDES);
    let line = json!({ "time": moment_s, "section": polygons, "triangles": triangles.len() });
    writeln!(output, "{line}")?;
    for number in triangles.iter().flatten().flatten() {
        output.write_all(&number.to_le_bytes())?;
    }
    Ok(())
}
