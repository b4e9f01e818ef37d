//! `check`: programs interpreted without running the machine.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use gsk_core::preview::{End, Preview, Turning, preview};
use gsk_core::setup::Setup;

use super::{ALARM, FINE, USAGE, output};
use crate::cli::CheckArgs;
use crate::report::{self, AlarmReport, Bounds, Final, PathReport, Report};
use crate::{loading, moves};

/// Checks programs.
pub fn check(args: &CheckArgs) -> Result<u8, String> {
    if args.moves.is_some() && args.files.len() > 1 {
        return Err("--moves takes one program".to_owned());
    }
    let setup = loading::setup(&args.setup)?;
    if let (Some(path), [file]) = (&args.moves, &args.files[..]) {
        let mut out = output::open(path)?;
        let mut failed = None;
        let report = check_file(&setup, file, &mut |executed| {
            if failed.is_none() {
                failed = moves::write_move(&mut *out, executed).err();
            }
        })?;
        let flushed = out.flush().err();
        if let Some(error) = failed.or(flushed) {
            return Err(format!("{} cannot be written: {error}", path.display()));
        }
        drop(out);
        return print(&[Ok(report)], args.json);
    }
    print(&all(&setup, &args.files), args.json)
}

/// Checks files on all cores; the results keep the order of the files.
fn all(setup: &Setup, files: &[PathBuf]) -> Vec<Result<Report, String>> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<Report, String>>>> =
        files.iter().map(|_| Mutex::new(None)).collect();
    let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    thread::scope(|scope| {
        for _ in 0..cores.min(files.len()) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(file) = files.get(index) else { break };
                    let result = check_file(setup, file, &mut |_| {});
                    if let Ok(mut place) = results[index].lock() {
                        *place = Some(result);
                    }
                }
            });
        }
    });
    let missing = || Err("this file was not checked".to_owned());
    results
        .into_iter()
        .map(|result| result.into_inner().ok().flatten().unwrap_or_else(missing))
        .collect()
}

fn check_file(
    setup: &Setup,
    file: &Path,
    on_move: &mut dyn FnMut(&gsk_core::command::ExecutedMove),
) -> Result<Report, String> {
    let mut setup = setup.clone();
    loading::open(&mut setup, &[file.to_owned()])?.print();
    let preview = preview(&setup, &setup.programs, on_move);
    Ok(report(&file.display().to_string(), &setup, &preview))
}

fn print(results: &[Result<Report, String>], json: bool) -> Result<u8, String> {
    let mut code = FINE;
    for result in results {
        match result {
            Ok(report) => {
                if matches!(report.end, "alarm" | "limit") {
                    code = code.max(ALARM);
                }
                if json {
                    let line = serde_json::to_string(report).map_err(|error| error.to_string())?;
                    output::print(&format!("{line}\n"))?;
                } else {
                    output::print(&report.words())?;
                }
            }
            Err(said) => {
                code = code.max(USAGE);
                eprintln!("gsk980td: {said}");
            }
        }
    }
    Ok(code)
}

fn report(name: &str, setup: &Setup, preview: &Preview) -> Report {
    Report {
        file: name.to_owned(),
        end: match preview.end {
            End::M30 => "M30",
            End::M99 => "M99",
            End::Text => "EOF",
            End::Alarm => "alarm",
            End::Limit => "limit",
        },
        alarm: preview
            .alarm
            .as_ref()
            .map(|alarm| AlarmReport::new(alarm, &setup.programs)),
        time_s: moves::rounded(preview.time_s),
        cutting_s: moves::rounded(preview.cutting_s),
        blocks: preview.blocks,
        moves: preview.moves,
        parts: preview.parts,
        stops: preview.stops,
        position: Final::new(preview.absolute, preview.machine, preview.relative),
        modal: report::modal_codes(&preview.modal),
        f: preview.modal.feed,
        s: preview.modal.spindle,
        t: report::tool_word((preview.modal.tool, preview.modal.offset)),
        spindle: match preview.spindle {
            Turning::Clockwise => "cw",
            Turning::CounterClockwise => "ccw",
            Turning::Stopped => "stop",
        },
        coolant: preview.coolant,
        parameters_changed: report::changed(&setup.parameters, &preview.parameters),
        path: Some(path(preview)),
    }
}

fn path(preview: &Preview) -> PathReport {
    let lengths = &preview.lengths;
    PathReport {
        lengths: BTreeMap::from([
            ("rapid", moves::rounded(lengths.rapid)),
            ("feed", moves::rounded(lengths.feed)),
            ("cw", moves::rounded(lengths.clockwise)),
            ("ccw", moves::rounded(lengths.counter_clockwise)),
            ("thread", moves::rounded(lengths.thread)),
        ]),
        tools: preview
            .tools
            .iter()
            .map(|tool| report::tool_word(*tool))
            .collect(),
        bounds: preview.bounds.map(|bounds| {
            let (low, high) = (
                moves::diameter_z(bounds.least),
                moves::diameter_z(bounds.greatest),
            );
            Bounds {
                x: (low.0, high.0),
                z: (low.1, high.1),
            }
        }),
    }
}
