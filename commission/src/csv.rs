//! Parses measurements in CSV: a heading, then one reading per line.
//!
//! ```text
//!   run,direction,target,deviation
//!   1,+,-300,-4.1
//! ```
//!
//! `target` is in mm, `deviation` in µm. The column `measured` in mm can replace `deviation`.
//! Without the column `direction`, the move from the previous target gives the direction.

use gsk_messages::say;

use crate::file_line::{self, FileFault, MAX_READINGS, lines};
use crate::measurement::{ApproachDirection, AxisDeviation, AxisReading, Measurement, SlideTravel};
use crate::screw_fit::DeviationCurve;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Run,
    Direction,
    Target,
    Deviation,
    Measured,
    Other,
}

fn parse_column(name: &str) -> Column {
    let name = name.trim().trim_matches('"').to_lowercase();
    // A unit may follow in brackets.
    let name = name
        .split(['(', '[', '（'])
        .next()
        .unwrap_or_default()
        .trim();
    match name {
        "run" | "次" | "次数" | "循环" => Column::Run,
        "direction" | "dir" | "方向" => Column::Direction,
        "target" | "position" | "目标" | "目标位置" | "位置" => Column::Target,
        "deviation" | "error" | "偏差" | "误差" => Column::Deviation,
        "measured" | "actual" | "实测" | "实测位置" | "实际位置" => Column::Measured,
        _ => Column::Other,
    }
}

/// Returns the character that separates the fields of the heading; `None` if it has only one
/// field.
fn find_separator(heading: &str) -> Option<char> {
    [';', '\t', ',']
        .into_iter()
        .find(|it| heading.contains(*it))
}

/// Returns whether the first line with content is a heading with at least two known columns.
pub(crate) fn is_csv(text: &str) -> bool {
    let Some((_, heading)) = lines(text).next() else {
        return false;
    };
    let has_columns = |separator| {
        let columns = heading.split(separator).map(parse_column);
        columns.filter(|it| *it != Column::Other).count() >= 2
    };
    find_separator(heading).is_some_and(has_columns)
}

/// Parses a CSV file to its readings.
///
/// # Errors
/// Returns the first line that is malformed, with the rule.
pub(crate) fn read(text: &str) -> Result<Measurement, FileFault> {
    let mut rows = lines(text);
    let (first, heading) = rows.next().unwrap_or((1, ""));
    let separator = find_separator(heading).unwrap_or(',');
    let columns: Vec<Column> = heading.split(separator).map(parse_column).collect();
    let has = |column| columns.contains(&column);
    if !has(Column::Target) || has(Column::Deviation) == has(Column::Measured) {
        return Err(FileFault::new(first, say::pitch_csv_columns()));
    }
    let mut readings: Vec<AxisReading> = Vec::new();
    let mut before: Option<(u16, f64)> = None;
    // First readings of a run: the next move gives their direction.
    let mut undirected = Vec::new();
    for (line, row) in rows {
        if readings.len() == MAX_READINGS {
            return Err(FileFault::new(
                line,
                say::pitch_too_many_readings(MAX_READINGS),
            ));
        }
        let fields: Vec<String> = row
            .split(separator)
            .map(|field| {
                let field = field.trim().trim_matches('"');
                match separator {
                    ',' => field.to_owned(),
                    // Decimal comma.
                    _ => field.replace(',', "."),
                }
            })
            .collect();
        let field = |column| {
            let at = columns.iter().position(|it| *it == column)?;
            fields.get(at).map(String::as_str)
        };
        let required = |column| field(column).filter(|it| !it.is_empty());
        let missing = || FileFault::new(line, say::pitch_csv_field_missing(columns.len()));
        let target =
            file_line::parse_position(line, required(Column::Target).ok_or_else(missing)?)?;
        let deviation = match required(Column::Measured) {
            Some(measured) => (file_line::parse_position(line, measured)? - target) * 1000.0,
            None => {
                file_line::parse_number(line, required(Column::Deviation).ok_or_else(missing)?)?
            }
        };
        let deviation = file_line::check_microns(line, deviation)?;
        let run = match field(Column::Run) {
            Some(run) => {
                let run = run.parse().ok().filter(|run| *run > 0);
                run.ok_or_else(|| FileFault::new(line, say::pitch_run_wrong()))?
            }
            None => 1,
        };
        let moved_mm = before
            .filter(|(last, _)| *last == run)
            .map(|(_, last)| target - last);
        let direction = match (field(Column::Direction), moved_mm) {
            (Some(word), _) => file_line::parse_direction(line, word)?,
            (None, Some(moved)) if moved > 0.0 => ApproachDirection::Plus,
            (None, Some(moved)) if moved < 0.0 => ApproachDirection::Minus,
            // The same target twice: the slide has reversed and comes from the other side.
            (None, Some(_)) => readings
                .last()
                .map_or(ApproachDirection::Plus, |last| last.direction.other()),
            (None, None) => {
                undirected.push(readings.len());
                ApproachDirection::Plus
            }
        };
        before = Some((run, target));
        readings.push(AxisReading {
            run,
            target: SlideTravel(target),
            direction,
            deviation: AxisDeviation(deviation),
        });
    }
    for at in undirected {
        let next = readings.get(at + 1).copied();
        if let (Some(next), Some(reading)) = (next, readings.get_mut(at))
            && next.run == reading.run
        {
            reading.direction = next.direction;
        }
    }
    if readings.is_empty() {
        return Err(FileFault::new(first, say::pitch_no_readings()));
    }
    Ok(Measurement {
        axis: None,
        readings,
    })
}

/// Returns a correction curve as CSV text: position in mm, correction in µm.
pub fn write(curve: &DeviationCurve) -> String {
    let rows = curve.points().iter();
    let rows = rows.map(|(at, value)| format!("{:.3},{:.3}\n", at.0, value.0));
    format!("position,correction\n{}", rows.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_ok(text: &str) -> Vec<(u16, char, f64, f64)> {
        assert!(is_csv(text), "{text}");
        let readings = read(text).unwrap().readings.into_iter();
        readings
            .map(|it| (it.run, it.direction.sign(), it.target.0, it.deviation.0))
            .collect()
    }

    #[test]
    fn columns_in_any_order_and_language() {
        let expected = [(1, '+', -10.0, 2.5), (1, '-', -20.0, -1.0)];
        for text in [
            "run,direction,target,deviation\n1,+,-10,2.5\n1,-,-20,-1\n",
            "# laser\nDeviation (um);Target (mm);Dir\n2,5;-10;plus\n-1;-20;minus\n",
            "目标位置\t方向\t误差\n-10\t正\t2.5\n-20\t负\t-1\n",
        ] {
            assert_eq!(read_ok(text), expected, "{text}");
        }
        let measured = read_ok("target,measured\n10,10.0025\n20,19.999\n10,10.001\n");
        let directions: String = measured.iter().map(|it| it.1).collect();
        assert_eq!(directions, "++-");
        assert!((measured[0].3 - 2.5).abs() < 1e-9 && (measured[1].3 + 1.0).abs() < 1e-9);
    }

    #[test]
    fn errors_name_their_line() {
        for (text, line) in [
            ("target,deviation\n1,x\n", 2),
            ("target,deviation\n1,2\n\n3\n", 4),
            ("target,deviation,direction\n1,2,left\n", 2),
            ("target,deviation,measured\n1,2,3\n", 1),
            ("target,run\n1,2\n", 1),
            ("target,deviation\n1e9,2\n", 2),
            ("target,deviation\n1,20000\n", 2),
            ("target,deviation,run\n1,2,0\n", 2),
            ("target,deviation\n", 1),
        ] {
            assert_eq!(read(text).unwrap_err().line, line, "{text}");
        }
    }
}
