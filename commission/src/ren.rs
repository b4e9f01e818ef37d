//! The text of a calibration (REN): lines of a key and a value, then rows (decision
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

use crate::line::{self as line_of, FileFault, MOST_READINGS, lines};
use crate::measurement::{Deviation, Direction, Measurement, Reading, Travel};

/// A row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The line of the file.
    pub line: u32,
    /// The point, where the file has it.
    pub point: Option<u16>,
    /// The far end of its interval, seen from the machine zero, mm.
    pub end: Travel,
    /// What is to be added to the value of the point, µm.
    pub value: Deviation,
}

/// Values for the pitch error table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The letter of the axis that the file names, if it does.
    pub axis: Option<char>,
    /// Slide travel from point to point, with its line.
    pub spacing: Option<(u32, Travel)>,
    /// The backlash, µm, with its line.
    pub backlash: Option<(u32, Deviation)>,
    /// The rows.
    pub rows: Vec<Row>,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Imported {
    /// Values for the pitch error table.
    Table(Table),
    /// Readings to be fitted.
    Measured(Measurement),
}

impl Imported {
    /// The axis of the lathe that the file names, if it does.
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

/// What was read so far.
struct Reader<'a> {
    /// The axes of the machine.
    axes: &'a [char],
    table: Table,
    start: Option<f64>,
    end: Option<f64>,
    points: Option<(u32, usize)>,
    run: Option<(u16, Direction)>,
    readings: Vec<Reading>,
}

/// A line that begins with a word: the word in small letters, and what follows it.
fn key_of(line: &str) -> Option<(String, &str)> {
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

impl<'a> Reader<'a> {
    fn new(axes: &'a [char]) -> Self {
        Self {
            axes,
            table: Table::default(),
            start: None,
            end: None,
            points: None,
            run: None,
            readings: Vec::new(),
        }
    }

    fn key(&mut self, line: u32, key: &str, value: &str) -> Result<(), FileFault> {
        match key {
            "axis" => self.table.axis = Some(line_of::axis(line, value, self.axes)?),
            "type" if value.eq_ignore_ascii_case("rotary") => {
                return Err(FileFault::new(line, say::pitch_ren_rotary()));
            }
            "start" => self.start = Some(line_of::position(line, value)?),
            "end" => self.end = Some(line_of::position(line, value)?),
            "spacing" => {
                let spacing = line_of::position(line, value)?.abs();
                self.table.spacing = Some((line, Travel(spacing)));
            }
            "points" => {
                let points = value.parse().ok();
                let points =
                    points.ok_or_else(|| FileFault::new(line, say::pitch_not_a_number(value)))?;
                self.points = Some((line, points));
            }
            "backlash" => {
                let backlash = line_of::microns(line, line_of::number(line, value)?)?;
                self.table.backlash = Some((line, Deviation(backlash)));
            }
            "run" => {
                let mut words = value.split_whitespace();
                let run = words.next().and_then(|word| word.parse().ok());
                let run = run.filter(|run| *run > 0);
                let run = run.ok_or_else(|| FileFault::new(line, say::pitch_run_wrong()))?;
                let direction = line_of::direction(line, words.next().unwrap_or_default())?;
                self.run = Some((run, direction));
            }
            // Whatever else a calibration says of itself.
            _ => {}
        }
        Ok(())
    }

    fn row(&mut self, line: u32, row: &str) -> Result<(), FileFault> {
        if self.table.rows.len() + self.readings.len() == MOST_READINGS {
            let rule = say::pitch_too_many_readings(MOST_READINGS);
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
        let position = line_of::position(line, position)?;
        let value = line_of::microns(line, line_of::number(line, value)?)?;
        match self.run {
            Some((run, direction)) => self.readings.push(Reading {
                run,
                direction,
                target: Travel(position),
                deviation: Deviation(value),
            }),
            None => {
                let known = |point: &str| point.parse::<u16>();
                let point = point.map(known).transpose();
                let point = point.map_err(|_| FileFault::new(line, say::pitch_ren_point()))?;
                self.table.rows.push(Row {
                    line,
                    point,
                    end: Travel(position),
                    value: Deviation(value),
                });
            }
        }
        Ok(())
    }

    fn finish(self, last: u32) -> Result<Imported, FileFault> {
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
        let places = table.rows.iter().map(|row| (row.line, row.end.0));
        let (start, end) = (self.start.unwrap_or(-1e9), self.end.unwrap_or(1e9));
        let (low, high) = (start.min(end), start.max(end));
        for (line, place) in places {
            if place < low - 1e-6 || place > high + 1e-6 {
                let rule = say::pitch_ren_outside(place, low, high);
                return Err(FileFault::new(line, rule));
            }
        }
        if let Some((line, points)) = self.points.filter(|_| readings.is_empty())
            && points != rows
        {
            return Err(FileFault::new(line, say::pitch_ren_points(points, rows)));
        }
        let table = Imported::Table(table);
        Ok(if readings.is_empty() {
            table
        } else {
            let axis = table.axis();
            Imported::Measured(Measurement { axis, readings })
        })
    }
}

/// Reads a text about an axis of a machine that has these.
///
/// # Errors
/// The first line that cannot be.
pub(crate) fn read(text: &str, axes: &[char]) -> Result<Imported, FileFault> {
    let mut reader = Reader::new(axes);
    let mut last = 1;
    for (line, content) in lines(text) {
        last = line;
        match key_of(content) {
            Some((key, value)) => reader.key(line, &key, value)?,
            None => reader.row(line, content)?,
        }
    }
    reader.finish(last)
}

/// Writes a table as such a text.
pub fn write(
    axis: Axis,
    spacing: Travel,
    backlash: Deviation,
    rows: &[(u8, Travel, Deviation)],
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

    fn read(text: &str) -> Result<Imported, FileFault> {
        super::read(text, &['X', 'Z'])
    }

    #[test]
    fn axes_are_those_of_the_machine() {
        let five = ['X', 'Y', 'Z', 'A', 'C'];
        let axis = |text: &str| match super::read(text, &five) {
            Ok(Imported::Table(table)) => Ok(table.axis),
            Ok(Imported::Measured(measured)) => panic!("{measured:?}"),
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
    fn keys_end_with_a_colon_an_equals_sign_or_a_blank() {
        let text = "Renishaw 10\n AXIS = z\nStart: -20\nEND 20\nspacing:10\nPoints=4\nbacklash 8\n\
                    Date: 1.2.2008\n124 -20 -7\n-10 6\n10, 4\n20;-1\n";
        let Imported::Table(table) = read(text).unwrap() else {
            panic!("a table");
        };
        assert_eq!(table.axis, Some('Z'));
        assert_eq!(table.spacing, Some((5, Travel(10.0))));
        assert_eq!(table.backlash, Some((7, Deviation(8.0))));
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
    fn runs_are_readings() {
        let text = "axis X\nrun: 1 +\n-10 1.5\n0 0\nrun: 1 -\n1 -10 4\n";
        let Imported::Measured(measured) = read(text).unwrap() else {
            panic!("readings");
        };
        assert_eq!(measured.axis, Some(Axis::X));
        let last = measured.readings[2];
        assert_eq!(
            (last.direction, last.target.0, last.deviation.0),
            (Direction::Minus, -10.0, 4.0)
        );
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
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
    fn what_is_written_is_read_again() {
        let rows: [(u8, _, _); 2] = [
            (255, Travel(-10.0), Deviation(2.0)),
            (254, Travel(-20.0), Deviation(-7.0)),
        ];
        let text = write(Axis::Z, Travel(10.0), Deviation(12.0), &rows);
        let Imported::Table(table) = read(&text).unwrap() else {
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
