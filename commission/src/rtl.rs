//! The file of a linear measurement that Renishaw's laser software saves (`.rtl`): targets
//! once, then a reading a line (decision COMMISSION-6).
//!
//! ```text
//!   TARGET DATA::
//!   Target-count: 3
//!   Targets :
//!   0.0000  -50.0000  -100.0000
//!   Flags: 0 0 2 0
//!   DEVIATIONS::
//!   Run Target Data:
//!   1   1      0.00
//! ```
//!
//! Targets are in mm, deviations in µm. Within a run the targets are met one after the
//! other, which says from where each was approached.

use gsk_core::units::Axis;
use gsk_messages::say;

use crate::line::{self as line_of, FileFault, MOST_READINGS, lines};
use crate::measurement::{Deviation, Direction, Measurement, Reading, Travel};

/// What the lines after a heading are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Other,
    Targets,
    Readings,
}

/// A row of `DEVIATIONS::`.
#[derive(Clone, Copy, Debug)]
struct Row {
    run: u16,
    target: Travel,
    deviation: Deviation,
}

/// Whether a text is such a file.
pub(crate) fn is_rtl(text: &str) -> bool {
    let mut lines = lines(text).take(20);
    lines.any(|(_, line)| line.eq_ignore_ascii_case("TARGET DATA::"))
}

/// Reads a text.
///
/// # Errors
/// The first line that cannot be.
pub(crate) fn read(text: &str) -> Result<Measurement, FileFault> {
    let mut part = Part::Other;
    let mut measured = Measurement::default();
    let mut targets: Vec<f64> = Vec::new();
    let mut count = None;
    let mut one_way = false;
    let mut rows: Vec<Row> = Vec::new();
    let mut last = 1;
    for (line, text) in lines(text) {
        last = line;
        if let Some((key, value)) = text.split_once(':') {
            let key = key.trim().to_ascii_lowercase();
            let value = value.trim();
            part = match key.as_str() {
                "targets" => Part::Targets,
                "run target data" => Part::Readings,
                _ => Part::Other,
            };
            match key.as_str() {
                "target-count" => count = Some((line, line_of::number(line, value)?)),
                "flags" => one_way = value.split_whitespace().nth(1) == Some("1"),
                // What its operator wrote: often the letter alone.
                "axis" => measured.axis = axis_of(value),
                "eof" => break,
                _ => {}
            }
            if part != Part::Targets || value.is_empty() {
                continue;
            }
        }
        let numbers = text.split_once(':').map_or(text, |(_, value)| value);
        match part {
            Part::Other => {}
            Part::Targets => {
                for field in numbers.split_whitespace() {
                    enough(line, targets.len())?;
                    targets.push(line_of::position(line, field)?);
                }
            }
            Part::Readings => {
                enough(line, rows.len())?;
                rows.push(row(line, numbers, &targets)?);
            }
        }
    }
    if let Some((line, said)) = count
        && said != targets.len() as f64
    {
        return Err(FileFault::new(
            line,
            say::pitch_rtl_targets(said, targets.len()),
        ));
    }
    if rows.is_empty() {
        return Err(FileFault::new(last, say::pitch_rtl_row(targets.len())));
    }
    let first = targets.first().zip(targets.last());
    let forwards = first.is_none_or(|(first, last)| last >= first);
    for run in rows.chunk_by(|one, other| one.run == other.run) {
        let zero = run.iter().all(|it| it.deviation.0 == 0.0);
        if one_way && zero && run.iter().all(|it| it.run % 2 == 0) {
            // The way back of a measurement in one direction: nothing was read on it.
            continue;
        }
        let direction = direction(run, forwards);
        measured.readings.extend(run.iter().map(|it| Reading {
            run: it.run,
            target: it.target,
            direction,
            deviation: it.deviation,
        }));
    }
    Ok(measured)
}

fn enough(line: u32, count: usize) -> Result<(), FileFault> {
    if count >= MOST_READINGS {
        let rule = say::pitch_too_many_readings(MOST_READINGS);
        return Err(FileFault::new(line, rule));
    }
    Ok(())
}

/// Run, target from 1, deviation.
fn row(line: u32, text: &str, targets: &[f64]) -> Result<Row, FileFault> {
    let wrong = || FileFault::new(line, say::pitch_rtl_row(targets.len()));
    let fields: Vec<&str> = text.split_whitespace().collect();
    let [run, target, deviation] = fields[..] else {
        return Err(wrong());
    };
    let run = run.parse().ok().filter(|run| *run > 0);
    let index = target
        .parse::<usize>()
        .ok()
        .and_then(|it| it.checked_sub(1));
    let target = index.and_then(|it| targets.get(it)).copied();
    let deviation = line_of::microns(line, line_of::number(line, deviation)?)?;
    Ok(Row {
        run: run.ok_or_else(wrong)?,
        target: Travel(target.ok_or_else(wrong)?),
        deviation: Deviation(deviation),
    })
}

/// Which way a run went; of one with a single target odd ones go as the targets stand,
/// even ones back. `forwards`: the targets go towards plus.
fn direction(run: &[Row], forwards: bool) -> Direction {
    let (Some(first), Some(last)) = (run.first(), run.last()) else {
        return Direction::Plus;
    };
    let plus = match last.target.partial_cmp(&first.target) {
        Some(core::cmp::Ordering::Greater) => true,
        Some(core::cmp::Ordering::Less) => false,
        _ => forwards != (first.run % 2 == 0),
    };
    if plus {
        Direction::Plus
    } else {
        Direction::Minus
    }
}

/// The axis where its operator wrote that of a lathe.
fn axis_of(value: &str) -> Option<Axis> {
    match value {
        "X" | "x" => Some(Axis::X),
        "Z" | "z" => Some(Axis::Z),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "HEADER::\nFile type  : rtl\nOwner      : Linear\nVersion no : V20.02.02\n\n\
        TARGET DATA::\nFiletype  : ISO\nTarget-count: 6\nTargets :\n\
        0.0000  -50.0000  -100.0000  -150.0000  -200.0000 \n-250.0000 \nFlags: 0 0 2 0\n\n\
        USER-TEXT::\nMachine:                \nSerial No:              \n\
        Date:2019-06-13 10:12:13\nBy:\nAxis:Z\nLocation:\nTITLE:Repeatability\n\n\
        RUNS::\nRun-count:2\n\nDEVIATIONS::\nRun Target Data:\n\
        1   1      0\n1   2      -1.2\n1   3      -2.5\n1   4      -3\n1   5      -4.5\n\
        1   6      -6\n2   6      2\n2   5      3.1\n2   4      4.8\n2   3      5.5\n\
        2   2      6.9\n2   1      8\n\nENVIRONMENT::\nAir temp   : 20.1\n\nEOF::\n\n";

    #[test]
    fn runs_go_there_and_back() {
        assert!(is_rtl(FILE));
        let measured = read(FILE).unwrap();
        assert_eq!((measured.axis, measured.runs()), (Some(Axis::Z), 2));
        assert_eq!(measured.readings.len(), 12);
        let of = |at: usize| {
            let reading = measured.readings[at];
            (reading.target.0, reading.direction, reading.deviation.0)
        };
        assert_eq!(of(5), (-250.0, Direction::Minus, -6.0));
        assert_eq!(of(6), (-250.0, Direction::Plus, 2.0));
        assert_eq!(of(11), (0.0, Direction::Plus, 8.0));
    }

    #[test]
    fn the_way_back_of_one_direction_is_none() {
        let zeros = FILE
            .replace("Flags: 0 0", "Flags: 0 1")
            .replace("6      2", "6      0")
            .replace("3.1", "0")
            .replace("4.8", "0")
            .replace("5.5", "0")
            .replace("6.9", "0")
            .replace("1      8", "1      0");
        let measured = read(&zeros).unwrap();
        assert_eq!((measured.runs(), measured.readings.len()), (1, 6));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (from, to, line) in [
            ("Target-count: 6", "Target-count: 7", 8),
            ("-150.0000", "-150.0x", 10),
            ("1   6      -6", "1   7      -6", 33),
            ("1   6      -6", "0   6      -6", 33),
            ("1   6      -6", "1   6", 33),
            ("1   6      -6", "1   6      -60000", 33),
        ] {
            let text = FILE.replace(from, to);
            assert_ne!(text, FILE);
            assert_eq!(read(&text).unwrap_err().line, line, "{to}");
        }
        let (head, _) = FILE.split_once("1   1      0\n").unwrap();
        assert!(read(head).is_err());
    }
}
