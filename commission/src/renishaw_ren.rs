//! Parses and writes calibration files (REN): lines with a key and a value, then rows (decision
//! COMMISSION-1).
//!
//! ```text
//!   axis: Z
//!   spacing: 10
//!   backlash: 12
//!   247 -80 -3          point, far end of its interval (mm), value (µm)
//!   -80 -3              the same without the point
//!   run: 1 +            from here on rows are readings: target (mm), deviation (µm)
//! ```

use gsk_core::units::Axis;
use gsk_messages::say;

use crate::file_line::{self, FileFault, MAX_READINGS, lines};
use crate::measurement::{ApproachDirection, AxisDeviation, AxisReading, Measurement, SlideTravel};

/// A row of a pitch error table file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PitchTableRow {
    /// Line of the row in the file, from 1.
    pub line: u32,
    /// Number of the table's point; `None` if the row has only two fields.
    pub point: Option<u16>,
    /// End of the interval that is farther from the machine zero, mm.
    pub end: SlideTravel,
    /// Value to add to the point, µm.
    pub value: AxisDeviation,
}

/// Values for the pitch error table of an axis, read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PitchTableFile {
    /// Letter of the axis that the file names; `None` if it names none.
    pub axis: Option<char>,
    /// Number of the line, and slide travel between two points (mm); `None` if the file has no
    /// such line.
    pub spacing: Option<(u32, SlideTravel)>,
    /// Number of the line, and backlash (µm); `None` if the file has no such line.
    pub backlash: Option<(u32, AxisDeviation)>,
    /// The rows with values, in the order of the file.
    pub rows: Vec<PitchTableRow>,
}

/// The content of a measurement file.
#[derive(Clone, Debug, PartialEq)]
pub enum ImportedFile {
    /// Values to add to the pitch error table.
    Table(PitchTableFile),
    /// Readings, from which a table has to be planned.
    Measured(Measurement),
}

impl ImportedFile {
    /// Returns the axis that the file names; `None` for no axis or one that a lathe does not have.
    pub const fn axis(&self) -> Option<Axis> {
        match self {
            Self::Table(table) => match table.axis {
                Some('X') => Some(Axis::X),
                Some('Z') => Some(Axis::Z),
                _ => None,
            },
            Self::Measured(measured) => measured.axis,
        }
    }
}

struct RenReader<'a> {
    /// Letters of the machine's axes.
    axes: &'a [char],
    table: PitchTableFile,
    start: Option<f64>,
    end: Option<f64>,
    points: Option<(u32, usize)>,
    run: Option<(u16, ApproachDirection)>,
    readings: Vec<AxisReading>,
}

/// Splits a line that begins with a word into the word, in lower case, and the rest. Returns
/// `None` for a line that begins otherwise.
fn split_key(line: &str) -> Option<(String, &str)> {
    if !line.starts_with(char::is_alphabetic) {
        return None;
    }
    let end = line
        .find([':', '='])
        .or_else(|| line.find(char::is_whitespace));
    let (key, value) = line.split_at(end.unwrap_or(line.len()));
    let value = value.trim_start_matches([':', '=', ' ', '\t']).trim();
    Some((key.trim().to_lowercase(), value))
}

impl<'a> RenReader<'a> {
    fn new(axes: &'a [char]) -> Self {
        Self {
            axes,
            table: PitchTableFile::default(),
            start: None,
            end: None,
            points: None,
            run: None,
            readings: Vec::new(),
        }
    }

    fn read_key(&mut self, line: u32, key: &str, value: &str) -> Result<(), FileFault> {
        match key {
            "axis" => self.table.axis = Some(file_line::parse_axis(line, value, self.axes)?),
            "type" if value.eq_ignore_ascii_case("rotary") => {
                return Err(FileFault::new(line, say::pitch_ren_rotary()));
            }
            "start" => self.start = Some(file_line::parse_position(line, value)?),
            "end" => self.end = Some(file_line::parse_position(line, value)?),
            "spacing" => {
                let spacing = file_line::parse_position(line, value)?.abs();
                self.table.spacing = Some((line, SlideTravel(spacing)));
            }
            "points" => {
                let points = value.parse().ok();
                let points =
                    points.ok_or_else(|| FileFault::new(line, say::pitch_not_a_number(value)))?;
                self.points = Some((line, points));
            }
            "backlash" => {
                let backlash =
                    file_line::check_microns(line, file_line::parse_number(line, value)?)?;
                self.table.backlash = Some((line, AxisDeviation(backlash)));
            }
            "run" => {
                let mut words = value.split_whitespace();
                let run = words.next().and_then(|word| word.parse().ok());
                let run = run.filter(|run| *run > 0);
                let run = run.ok_or_else(|| FileFault::new(line, say::pitch_run_wrong()))?;
                let direction = file_line::parse_direction(line, words.next().unwrap_or_default())?;
                self.run = Some((run, direction));
            }
            // Calibration files have other keys, which carry no values for the control.
            _ => {}
        }
        Ok(())
    }

    fn read_row(&mut self, line: u32, row: &str) -> Result<(), FileFault> {
        if self.table.rows.len() + self.readings.len() == MAX_READINGS {
            let rule = say::pitch_too_many_readings(MAX_READINGS);
            return Err(FileFault::new(line, rule));
        }
        let fields: Vec<&str> = row
            .split(|letter: char| letter.is_whitespace() || letter == ',' || letter == ';')
            .filter(|field| !field.is_empty())
            .collect();
        let (point, position, value) = match fields[..] {
            [point, position, value] => (Some(point), position, value),
            [position, value] => (None, position, value),
            _ => return Err(FileFault::new(line, say::pitch_ren_row())),
        };
        let position = file_line::parse_position(line, position)?;
        let value = file_line::check_microns(line, file_line::parse_number(line, value)?)?;
        match self.run {
            Some((run, direction)) => self.readings.push(AxisReading {
                run,
                direction,
                target: SlideTravel(position),
                deviation: AxisDeviation(value),
            }),
            None => {
                let parse_point = |point: &str| point.parse::<u16>();
                let point = point.map(parse_point).transpose();
                let point = point.map_err(|_| FileFault::new(line, say::pitch_ren_point()))?;
                self.table.rows.push(PitchTableRow {
                    line,
                    point,
                    end: SlideTravel(position),
                    value: AxisDeviation(value),
                });
            }
        }
        Ok(())
    }

    fn finish(self, last: u32) -> Result<ImportedFile, FileFault> {
        let Self {
            table, readings, ..
        } = self;
        let rows = table.rows.len() + readings.len();
        if rows == 0 {
            return Err(FileFault::new(last, say::pitch_no_readings()));
        }
        if !table.rows.is_empty() && !readings.is_empty() {
            return Err(FileFault::new(last, say::pitch_ren_both()));
        }
        let row_ends = table.rows.iter().map(|row| (row.line, row.end.0));
        let (start, end) = (self.start.unwrap_or(-1e9), self.end.unwrap_or(1e9));
        let (low, high) = (start.min(end), start.max(end));
        for (line, row_end) in row_ends {
            if row_end < low - 1e-6 || row_end > high + 1e-6 {
                let rule = say::pitch_ren_outside(row_end, low, high);
                return Err(FileFault::new(line, rule));
            }
        }
        if let Some((line, points)) = self.points.filter(|_| readings.is_empty())
            && points != rows
        {
            return Err(FileFault::new(line, say::pitch_ren_points(points, rows)));
        }
        let table = ImportedFile::Table(table);
        Ok(if readings.is_empty() {
            table
        } else {
            let axis = table.axis();
            ImportedFile::Measured(Measurement { axis, readings })
        })
    }
}

/// Parses a REN file for a machine whose axes have these letters.
///
/// # Errors
/// Returns the first line that is malformed or contradicts the others, with the rule.
pub(crate) fn read(text: &str, axes: &[char]) -> Result<ImportedFile, FileFault> {
    let mut reader = RenReader::new(axes);
    let mut last = 1;
    for (line, content) in lines(text) {
        last = line;
        match split_key(content) {
            Some((key, value)) => reader.read_key(line, &key, value)?,
            None => reader.read_row(line, content)?,
        }
    }
    reader.finish(last)
}

/// Returns a pitch error table as the text of a REN file. `rows` are point, far end of the
/// interval (mm) and value (µm).
pub fn write(
    axis: Axis,
    spacing: SlideTravel,
    backlash: AxisDeviation,
    rows: &[(u8, SlideTravel, AxisDeviation)],
) -> String {
    let name = match axis {
        Axis::X => 'X',
        Axis::Z => 'Z',
    };
    let ends = || rows.iter().map(|(_, end, _)| end.0);
    let start = ends().fold(0.0, f64::min);
    let end = ends().fold(0.0, f64::max);
    let head = format!(
        "axis: {name}\nstart: {start:.3}\nend: {end:.3}\nspacing: {:.3}\npoints: {}\nbacklash: {}\n",
        spacing.0,
        rows.len(),
        backlash.0
    );
    let rows = rows
        .iter()
        .map(|(point, end, value)| format!("{point} {:.3} {}\n", end.0, value.0));
    head + &rows.collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ImportedFile, FileFault> {
        super::read(text, &['X', 'Z'])
    }

    #[test]
    fn axis_must_exist_on_machine() {
        let five = ['X', 'Y', 'Z', 'A', 'C'];
        let axis = |text: &str| match super::read(text, &five) {
            Ok(ImportedFile::Table(table)) => Ok(table.axis),
            Ok(ImportedFile::Measured(measured)) => panic!("{measured:?}"),
            Err(fault) => Err(fault.line),
        };
        assert_eq!(axis("Axis: y\n10 2\n"), Ok(Some('Y')));
        assert_eq!(axis("axis=C\n10 2\n"), Ok(Some('C')));
        assert_eq!(axis("10 2\n"), Ok(None));
        assert_eq!(axis("Renishaw\naxis: B\n10 2\n"), Err(2));
        assert_eq!(axis("axis: XY\n10 2\n"), Err(1));
        assert_eq!(axis("axis:\n10 2\n"), Err(1));
    }

    #[test]
    fn key_ends_with_colon_equals_sign_or_blank() {
        let text = "Renishaw 10\n AXIS = z\nStart: -20\nEND 20\nspacing:10\nPoints=4\nbacklash 8\n\
                    Date: 1.2.2008\n124 -20 -7\n-10 6\n10, 4\n20;-1\n";
        let ImportedFile::Table(table) = read(text).unwrap() else {
            panic!("a table");
        };
        assert_eq!(table.axis, Some('Z'));
        assert_eq!(table.spacing, Some((5, SlideTravel(10.0))));
        assert_eq!(table.backlash, Some((7, AxisDeviation(8.0))));
        let rows: Vec<_> = table
            .rows
            .iter()
            .map(|it| (it.point, it.end.0, it.value.0))
            .collect();
        let expected = [
            (Some(124), -20.0, -7.0),
            (None, -10.0, 6.0),
            (None, 10.0, 4.0),
            (None, 20.0, -1.0),
        ];
        assert_eq!(rows, expected);
    }

    #[test]
    fn rows_after_run_are_readings() {
        let text = "axis X\nrun: 1 +\n-10 1.5\n0 0\nrun: 1 -\n1 -10 4\n";
        let ImportedFile::Measured(measured) = read(text).unwrap() else {
            panic!("readings");
        };
        assert_eq!(measured.axis, Some(Axis::X));
        let last = measured.readings[2];
        assert_eq!(
            (last.direction, last.target.0, last.deviation.0),
            (ApproachDirection::Minus, -10.0, 4.0)
        );
    }

    #[test]
    fn errors_name_their_line() {
        for (text, line) in [
            ("axis: Y\n", 1),
            ("type: rotary\n", 1),
            ("10 x\n", 1),
            ("10\n", 1),
            ("70000 10 2\n", 1),
            ("points: 3\n10 2\n", 1),
            ("start: 0\nend: 5\n10 2\n", 3),
            ("run: 0 +\n", 1),
            ("run: 1 up and away\nrun: 1 sideways\n", 2),
            ("10 2\nrun: 1 +\n10 2\n", 3),
            ("axis: X\n", 1),
            ("", 1),
        ] {
            assert_eq!(read(text).unwrap_err().line, line, "{text}");
        }
    }

    #[test]
    fn written_file_parses_to_same_rows() {
        let rows: [(u8, _, _); 2] = [
            (255, SlideTravel(-10.0), AxisDeviation(2.0)),
            (254, SlideTravel(-20.0), AxisDeviation(-7.0)),
        ];
        let text = write(Axis::Z, SlideTravel(10.0), AxisDeviation(12.0), &rows);
        let ImportedFile::Table(table) = read(&text).unwrap() else {
            panic!("a table");
        };
        let again: Vec<_> = table
            .rows
            .iter()
            .map(|it| (it.point.unwrap(), it.end, it.value))
            .collect();
        assert_eq!(
            again,
            rows.map(|(point, end, value)| (u16::from(point), end, value))
        );
    }
}
