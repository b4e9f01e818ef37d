//! Parses linear measurements of Renishaw laser software (`.rtl`): targets once, then one reading
//! per line (decision COMMISSION-6).
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
//! Targets are in mm, deviations in µm. The order of targets within a run gives the direction
//! of the approach.

use gsk_core::units::Axis;
use gsk_messages::say;

use crate::file_line::{self, FileFault, MAX_READINGS, lines};
use crate::measurement::{ApproachDirection, AxisDeviation, AxisReading, Measurement, SlideTravel};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RtlBlock {
    Other,
    Targets,
    Readings,
}

/// A reading in a row after `DEVIATIONS::`.
#[derive(Clone, Copy, Debug)]
struct RtlRow {
    run: u16,
    target: SlideTravel,
    deviation: AxisDeviation,
}

/// Returns whether one of the first 20 lines with content is the heading of an RTL file.
pub(crate) fn is_rtl(text: &str) -> bool {
    let mut lines = lines(text).take(20);
    lines.any(|(_, line)| line.eq_ignore_ascii_case("TARGET DATA::"))
}

/// Parses an RTL file to its readings.
///
/// # Errors
/// Returns the first line that is malformed, with the rule.
pub(crate) fn read(text: &str) -> Result<Measurement, FileFault> {
    let mut block = RtlBlock::Other;
    let mut measured = Measurement::default();
    let mut targets: Vec<f64> = Vec::new();
    let mut count = None;
    let mut is_one_way = false;
    let mut rows: Vec<RtlRow> = Vec::new();
    let mut last = 1;
    for (line, text) in lines(text) {
        last = line;
        if let Some((key, value)) = text.split_once(':') {
            let key = key.trim().to_ascii_lowercase();
            let value = value.trim();
            block = match key.as_str() {
                "targets" => RtlBlock::Targets,
                "run target data" => RtlBlock::Readings,
                _ => RtlBlock::Other,
            };
            match key.as_str() {
                "target-count" => count = Some((line, file_line::parse_number(line, value)?)),
                "flags" => is_one_way = value.split_whitespace().nth(1) == Some("1"),
                // The operator types this field freely, often as the letter alone.
                "axis" => measured.axis = parse_axis(value),
                "eof" => break,
                _ => {}
            }
            if block != RtlBlock::Targets || value.is_empty() {
                continue;
            }
        }
        let numbers = text.split_once(':').map_or(text, |(_, value)| value);
        match block {
            RtlBlock::Other => {}
            RtlBlock::Targets => {
                for field in numbers.split_whitespace() {
                    check_reading_count(line, targets.len())?;
                    targets.push(file_line::parse_position(line, field)?);
                }
            }
            RtlBlock::Readings => {
                check_reading_count(line, rows.len())?;
                rows.push(parse_row(line, numbers, &targets)?);
            }
        }
    }
    if let Some((line, stated)) = count
        && stated != targets.len() as f64
    {
        return Err(FileFault::new(
            line,
            say::pitch_rtl_targets(stated, targets.len()),
        ));
    }
    if rows.is_empty() {
        return Err(FileFault::new(last, say::pitch_rtl_row(targets.len())));
    }
    let first = targets.first().zip(targets.last());
    let targets_rise = first.is_none_or(|(first, last)| last >= first);
    for run in rows.chunk_by(|one, other| one.run == other.run) {
        let is_all_zero = run.iter().all(|it| it.deviation.0 == 0.0);
        if is_one_way && is_all_zero && run.iter().all(|it| it.run % 2 == 0) {
            // The return run of a measurement in one direction has no readings.
            continue;
        }
        let direction = run_direction(run, targets_rise);
        measured.readings.extend(run.iter().map(|it| AxisReading {
            run: it.run,
            target: it.target,
            direction,
            deviation: it.deviation,
        }));
    }
    Ok(measured)
}

fn check_reading_count(line: u32, count: usize) -> Result<(), FileFault> {
    if count >= MAX_READINGS {
        let rule = say::pitch_too_many_readings(MAX_READINGS);
        return Err(FileFault::new(line, rule));
    }
    Ok(())
}

/// Parses a reading: run, number of the target (from 1) and deviation, µm.
fn parse_row(line: u32, text: &str, targets: &[f64]) -> Result<RtlRow, FileFault> {
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
    let deviation = file_line::check_microns(line, file_line::parse_number(line, deviation)?)?;
    Ok(RtlRow {
        run: run.ok_or_else(wrong)?,
        target: SlideTravel(target.ok_or_else(wrong)?),
        deviation: AxisDeviation(deviation),
    })
}

/// Returns the direction in which a run approached its targets. In a run with a single target,
/// odd runs follow the order of the targets and even runs reverse it. `targets_rise`: that
/// order is towards plus.
fn run_direction(run: &[RtlRow], targets_rise: bool) -> ApproachDirection {
    let (Some(first), Some(last)) = (run.first(), run.last()) else {
        return ApproachDirection::Plus;
    };
    let plus = match last.target.partial_cmp(&first.target) {
        Some(core::cmp::Ordering::Greater) => true,
        Some(core::cmp::Ordering::Less) => false,
        _ => targets_rise != (first.run % 2 == 0),
    };
    if plus {
        ApproachDirection::Plus
    } else {
        ApproachDirection::Minus
    }
}

fn parse_axis(value: &str) -> Option<Axis> {
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
    fn runs_alternate_direction() {
        assert!(is_rtl(FILE));
        let measured = read(FILE).unwrap();
        assert_eq!((measured.axis, measured.runs()), (Some(Axis::Z), 2));
        assert_eq!(measured.readings.len(), 12);
        let of = |at: usize| {
            let reading = measured.readings[at];
            (reading.target.0, reading.direction, reading.deviation.0)
        };
        assert_eq!(of(5), (-250.0, ApproachDirection::Minus, -6.0));
        assert_eq!(of(6), (-250.0, ApproachDirection::Plus, 2.0));
        assert_eq!(of(11), (0.0, ApproachDirection::Plus, 8.0));
    }

    #[test]
    fn return_run_of_one_way_measurement_is_skipped() {
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
    fn errors_name_their_line() {
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
