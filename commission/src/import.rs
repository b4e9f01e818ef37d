//! Files of measurements: which of the two forms a text has, and what both share.

use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::measurement::{Direction, Measurement};
use crate::ren::Table;
use crate::{csv, ren};

/// Readings that are taken at most.
pub(crate) const MOST_READINGS: usize = 20_000;
/// The farthest position, mm.
const FARTHEST_MM: f64 = 9999.999;
/// The largest value, µm: beyond it the unit is wrong.
const LARGEST_UM: f64 = 10_000.0;

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Imported {
    /// Values for the pitch error table.
    Table(Table),
    /// Readings to be fitted.
    Measured(Measurement),
}

impl Imported {
    /// The axis that the file names, if it does.
    pub const fn axis(&self) -> Option<Axis> {
        match self {
            Self::Table(table) => table.axis,
            Self::Measured(measured) => measured.axis,
        }
    }
}

/// What is wrong with a line of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileFault {
    /// The line, from 1.
    pub line: u32,
    /// What is wrong with it.
    pub rule: Message,
}

impl FileFault {
    pub(crate) const fn new(line: u32, rule: Message) -> Self {
        Self { line, rule }
    }

    /// Line and rule.
    pub fn message(&self) -> Message {
        say::pitch_file_line(self.line, self.rule.clone())
    }
}

/// Reads a text: CSV where its first line with content is a heading with columns, the text
/// of a calibration (REN) otherwise.
///
/// # Errors
/// The first line that cannot be.
pub fn read(text: &str) -> Result<Imported, FileFault> {
    let text = text.trim_start_matches('\u{feff}');
    if csv::is_csv(text) {
        csv::read(text).map(Imported::Measured)
    } else {
        ren::read(text)
    }
}

/// Lines with content, from 1, without remarks.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (u32, &str)> {
    (1..)
        .zip(text.lines())
        .map(|(number, line)| (number, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '!']))
}

/// A number as it stands in a field.
pub(crate) fn number(line: u32, field: &str) -> Result<f64, FileFault> {
    let number: Option<f64> = field.trim().parse().ok();
    let finite = number.filter(|number| number.is_finite());
    finite.ok_or_else(|| FileFault::new(line, say::pitch_not_a_number(field)))
}

/// A position, mm.
pub(crate) fn position(line: u32, field: &str) -> Result<f64, FileFault> {
    let value = number(line, field)?;
    if value.abs() > FARTHEST_MM {
        let rule = say::pitch_position_too_far(value, FARTHEST_MM);
        return Err(FileFault::new(line, rule));
    }
    Ok(value)
}

/// A deviation or a value, µm.
pub(crate) fn microns(line: u32, value: f64) -> Result<f64, FileFault> {
    if value.abs() > LARGEST_UM {
        let rule = say::pitch_value_too_large(value, LARGEST_UM);
        return Err(FileFault::new(line, rule));
    }
    Ok(value)
}

/// The word of a direction.
pub(crate) fn direction(line: u32, field: &str) -> Result<Direction, FileFault> {
    match field.trim().to_ascii_lowercase().as_str() {
        "+" | "+1" | "1" | "plus" | "forward" | "fwd" | "up" | "正" | "正向" => {
            Ok(Direction::Plus)
        }
        "-" | "-1" | "2" | "minus" | "reverse" | "rev" | "backward" | "负" | "负向" | "反向" => {
            Ok(Direction::Minus)
        }
        _ => Err(FileFault::new(line, say::pitch_not_a_direction(field))),
    }
}

/// The word of an axis.
pub(crate) fn axis(line: u32, field: &str) -> Result<Axis, FileFault> {
    match field.trim() {
        "X" | "x" => Ok(Axis::X),
        "Z" | "z" => Ok(Axis::Z),
        other => Err(FileFault::new(line, say::pitch_not_an_axis(other))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::Travel;
    use crate::plan::{PlanWish, add_table, plan};
    use gsk_core::memory::{Parameters, PitchTable};

    /// Texts put together from pieces of both forms at random: whatever is read is fitted,
    /// planned or refused, and what is planned the control takes.
    #[test]
    fn no_text_stops_the_program() {
        const HEADS: [&str; 4] = [
            "run,direction,target,deviation\n",
            "target,deviation\n",
            "axis: Z\nspacing: 10\n",
            "",
        ];
        const LINES: [&str; 16] = [
            "1,+,-300,2\n",
            "1,-,-300,8\n",
            "2,-,-10.5,8\n",
            "1,+,0,-9000\n",
            "-10,3\n",
            "-20 4\n",
            "-0.001,0\n",
            "9999.999,1\n",
            "run: 1 -\n",
            "run: 2 +\n",
            "255 -10 1\n",
            "backlash=7\n",
            "-2540 -255\n",
            "nan,inf\n",
            "1e300 1\n",
            "偏差,;\n",
        ];
        let mut seed = 7_u64;
        let mut throw = |below: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize % below
        };
        let (mut tables, mut plans) = (0, 0);
        for _ in 0..20_000 {
            let lines = (0..throw(7)).map(|_| LINES[throw(LINES.len())]);
            let lines: String = lines.collect();
            let text = format!("{}{lines}", HEADS[throw(HEADS.len())]);
            let own = (Parameters::default(), PitchTable::default());
            let changes = match read(&text) {
                Ok(Imported::Table(table)) => add_table(Axis::Z, &table, &own.0, &own.1, false),
                Ok(Imported::Measured(measured)) => {
                    let interval = [None, Some(Travel(0.001)), Some(Travel(7.5))][throw(3)];
                    let wish = PlanWish {
                        interval,
                        clear: throw(2) == 0,
                    };
                    crate::fit(&measured, Direction::Minus)
                        .and_then(|fit| plan(Axis::X, &fit, &own.0, &own.1, wish))
                        .inspect(|_| plans += 1)
                        .map(|plan| plan.proposal)
                }
                Err(_) => continue,
            };
            let Ok(proposal) = changes else {
                continue;
            };
            tables += 1;
            let (mut parameters, mut pitch) = own;
            for change in proposal.changes {
                change.apply(&mut parameters, &mut pitch).unwrap();
            }
        }
        assert!(tables > 100 && plans > 20, "{tables} {plans}");
    }
}
