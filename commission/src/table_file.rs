//! Adds the values of a pitch error table file to the table of the control (manual III-10).

use std::ops::RangeInclusive;

use gsk_core::memory::{ControlParameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::correction::{MAX_BACKLASH, MAX_POINT_VALUE, units_per_mm};
use crate::parameter_change::{ParameterChange, Proposal, axis_letter, select_by_axis};
use crate::renishaw_ren::{PitchTableFile, PitchTableRow};

/// Proposes to add the values of a file to the pitch error table of an axis (manual III-10;
/// decision COMMISSION-1). `clear` empties the column first and takes the interval from the
/// file.
///
/// # Errors
/// The line in the file, and the rule: an interval or point that does not fit the parameters,
/// or a sum beyond ±255.
pub fn propose_table_values(
    axis: Axis,
    table: &PitchTableFile,
    parameters: &ControlParameters,
    pitch: &PitchTable,
    clear: bool,
) -> Result<Proposal, Message> {
    let units = units_per_mm(parameters);
    let mut changes = Vec::new();
    let mut changed_parameters = parameters.clone();
    if let Some(change) = change_interval(axis, table, parameters, clear)? {
        changes.push(change);
        change.apply(&mut changed_parameters, &mut PitchTable::default())?;
    }
    let interval = changed_parameters.pitch_interval(axis);
    if interval == 0 {
        return Err(say::pitch_no_interval(interval_number(axis)));
    }
    let mut column = PitchColumn {
        values: (0..=u8::MAX)
            .map(|point| {
                if clear {
                    0
                } else {
                    pitch.value(axis, point).into()
                }
            })
            .collect(),
        units,
        interval: interval as f64,
        factor: f64::from(parameters.pitch_factor()),
        origin: i64::from(parameters.pitch_origin(axis)),
        counts: parameters.pitch_points(axis),
    };
    for row in &table.rows {
        column
            .add_row(row)
            .map_err(|rule| say::pitch_file_line(row.line, rule))?;
    }
    let points = (0..=u8::MAX).zip(column.values);
    changes.extend(points.map(|(point, value)| ParameterChange::Pitch {
        axis,
        point,
        value: value as i16,
    }));
    if let Some((line, backlash)) = table.backlash {
        let value = (backlash.0 * units / 1000.0).round();
        if !(0.0..=MAX_BACKLASH).contains(&value) {
            let rule = say::pitch_backlash_beyond(value, MAX_BACKLASH);
            return Err(say::pitch_file_line(line, rule));
        }
        changes.push(ParameterChange::Value {
            number: select_by_axis(axis, parameter::X_BACKLASH, parameter::Z_BACKLASH),
            value: value as i32,
        });
    }
    let mut notes = vec![say::pitch_zero_return_needed()];
    if !parameters.is_pitch_compensated() {
        notes.insert(0, say::pitch_switched_off(axis_letter(axis)));
    }
    Proposal::from_changes(changes, notes, parameters, pitch)
}

/// Returns the number of the parameter with the point interval of an axis.
const fn interval_number(axis: Axis) -> u16 {
    select_by_axis(
        axis,
        parameter::X_PITCH_INTERVAL,
        parameter::Z_PITCH_INTERVAL,
    )
}

/// Returns the change of the interval to the spacing of a file; `None` if the parameter has
/// it.
///
/// # Errors
/// Returns a message for a spacing outside the range of the parameter, or another interval
/// without `clear`.
fn change_interval(
    axis: Axis,
    table: &PitchTableFile,
    parameters: &ControlParameters,
    clear: bool,
) -> Result<Option<ParameterChange>, Message> {
    let Some((line, spacing)) = table.spacing else {
        return Ok(None);
    };
    let units = units_per_mm(parameters);
    let interval_units = (spacing.0 * units).round();
    let number = interval_number(axis);
    if !(1.0..=999_999.0).contains(&interval_units) {
        let rule = say::pitch_interval_wrong(spacing.0);
        return Err(say::pitch_file_line(line, rule));
    }
    if interval_units as i64 == parameters.pitch_interval(axis) {
        return Ok(None);
    }
    if !clear {
        let current = parameters.pitch_interval(axis) as f64 / units;
        let rule = say::pitch_ren_spacing(spacing.0, number, current);
        return Err(say::pitch_file_line(line, rule));
    }
    Ok(Some(ParameterChange::Value {
        number,
        value: interval_units as i32,
    }))
}

/// The column of an axis in the pitch error table, and the parameters of its points.
struct PitchColumn {
    /// Value of each point, in table units before multiplication by `factor`.
    values: Vec<i64>,
    /// Number of table units in a millimetre.
    units: f64,
    /// Interval between two points, table units.
    interval: f64,
    /// Factor of parameter 013, by which the control multiplies each value.
    factor: f64,
    /// Number of the point at the machine zero.
    origin: i64,
    /// Numbers of the points that have an effect.
    counts: RangeInclusive<usize>,
}

impl PitchColumn {
    /// Adds the value of a file's row to its point.
    ///
    /// # Errors
    /// Returns the message about the rule that the row breaks.
    fn add_row(&mut self, row: &PitchTableRow) -> Result<(), Message> {
        let steps = row.end.0 * self.units / self.interval;
        let whole = steps.round();
        if (steps - whole).abs() > 1e-3 {
            return Err(say::pitch_ren_off_grid(row.end.0));
        }
        let units_value = row.value.0 * self.units / 1000.0 / self.factor;
        if (units_value - units_value.round()).abs() > 1e-6 {
            return Err(say::pitch_ren_fraction(row.value.0, self.factor));
        }
        // No interval ends at the machine zero.
        let whole = whole as i64;
        let point = match whole {
            0 if row.point.is_none() && units_value == 0.0 => return Ok(()),
            0 if row.point.is_none() => return Err(say::pitch_ren_at_zero()),
            1.. => self.origin + whole,
            _ => self.origin + whole + 1,
        };
        if let Some(stated) = row.point
            && whole != 0
            && i64::from(stated) != point
        {
            return Err(say::pitch_ren_other_point(stated, point));
        }
        let point = row.point.map_or(point, i64::from);
        let entry = usize::try_from(point)
            .ok()
            .filter(|it| self.counts.contains(it));
        let entry = entry
            .filter(|it| *it > 0)
            .and_then(|it| self.values.get_mut(it));
        let Some(entry) = entry else {
            let (low, high) = (self.counts.start().max(&1), self.counts.end());
            return Err(say::pitch_ren_no_point(point, low, high));
        };
        *entry += units_value.round() as i64;
        if entry.abs() > MAX_POINT_VALUE {
            return Err(say::pitch_ren_sum(point, *entry, MAX_POINT_VALUE));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::read_measurement_file;
    use crate::renishaw_ren::ImportedFile;

    fn table_of(text: &str) -> PitchTableFile {
        match read_measurement_file(text).unwrap() {
            ImportedFile::Table(table) => table,
            ImportedFile::Measured(_) => panic!("a table"),
        }
    }

    /// The second example of the sibling manual, as a file for this control.
    #[test]
    fn file_values_are_added_to_table_points() {
        let mut parameters = ControlParameters::default();
        parameters.set(parameter::Z_PITCH_ORIGIN, 60).unwrap();
        let table = table_of("spacing 10\nbacklash 5\n-20 -7\n59 -20 0\n-10 6\n10 4\n0 0\n");
        let pitch = PitchTable::default();
        let proposal = propose_table_values(Axis::Z, &table, &parameters, &pitch, false).unwrap();
        let (mut parameters, mut pitch) = (parameters, pitch);
        for change in &proposal.changes {
            change.apply(&mut parameters, &mut pitch).unwrap();
        }
        let values: Vec<i16> = (58..=61).map(|point| pitch.value(Axis::Z, point)).collect();
        assert_eq!(values, [0, -7, 6, 4]);
        assert_eq!(parameters.value(parameter::Z_BACKLASH), 5);
        let twice = propose_table_values(Axis::Z, &table, &parameters, &pitch, false).unwrap();
        let point = ParameterChange::Pitch {
            axis: Axis::Z,
            point: 60,
            value: 12,
        };
        assert!(twice.changes.contains(&point));
        let cleared = propose_table_values(Axis::Z, &table, &parameters, &pitch, true).unwrap();
        assert_eq!(cleared.changes, []);
        for (text, line) in [
            ("spacing 20\n20 1\n", "1"),
            ("\n15 1\n", "2"),
            ("10 1\n0 1\n", "2"),
            ("62 10 1\n", "1"),
            ("-700 1\n", "1"),
            ("10 300\n", "1"),
            ("10 0.5\n", "1"),
            ("backlash -3\n10 1\n", "1"),
        ] {
            let result = propose_table_values(Axis::Z, &table_of(text), &parameters, &pitch, false);
            let message = result.unwrap_err();
            assert_eq!(message.plain_value("line"), Some(line), "{text}");
        }
    }
}
