//! The pitch error table and its parameters for a curve (003.5, 013, 090–103; manual III-10).
//!
//! ```text
//!            ┌──── S(2) = v[R+1] + v[R+2]         the control's correction is level between
//!       ┌────┘     S(1) = v[R+1]                  two points; it is made right in the middle
//!   ────┘          S(0) = 0                       of each interval
//! ```

use gsk_core::axis::PitchCurve;
use gsk_core::memory::{Parameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::change::{Change, Proposal, name, of};
use crate::fit::{Curve, Fit};
use crate::measurement::{Deviation, Travel};
use crate::ren::Table;

/// The last point of the table.
const LAST: i64 = 255;
/// The largest value of a point.
const LARGEST: i64 = 255;
/// The largest backlash, 034 and 035.
const LARGEST_BACKLASH: f64 = 2000.0;
/// Intervals that are tried, thousandths of a millimetre, the coarsest first.
const INTERVALS: [i64; 8] = [20_000, 10_000, 5_000, 4_000, 2_500, 2_000, 1_500, 1_000];
/// The deviation that is left may be so much, µm, before a finer interval is taken.
const FINE_UM: f64 = 0.8;
/// An interval is to last so long at the rapid rate, s (decision COMMISSION-3).
const LEAST_TIME_S: f64 = 0.008;

/// How a plan is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanWish {
    /// Slide travel from point to point; none: the coarsest that is fine enough.
    pub interval: Option<Travel>,
    /// The values that stand in the table are none: it was measured without them.
    pub clear: bool,
}

/// A table for a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What is to be written.
    pub proposal: Proposal,
    /// The interval, mm.
    pub interval: Travel,
    /// The largest deviation that was measured, from the machine zero.
    pub before: Deviation,
    /// The largest that is to be left.
    pub after: Deviation,
}

/// Units of the table in a millimetre: 0.001 mm, or 0.0001 inch.
fn units_a_mm(parameters: &Parameters) -> f64 {
    1.0 / parameters.least_increment()
}

/// The interval of an axis as it stands; none: there is no compensation.
pub fn interval_of(axis: Axis, parameters: &Parameters) -> Option<Travel> {
    let interval = parameters.pitch_interval(axis);
    (interval > 0).then(|| Travel(interval as f64 / units_a_mm(parameters)))
}

/// The correction that is in force, at each of these positions.
pub fn correction(
    axis: Axis,
    parameters: &Parameters,
    pitch: &PitchTable,
    positions: impl IntoIterator<Item = Travel>,
) -> Curve {
    let curve = PitchCurve::new(axis, parameters, pitch, 1);
    let units = units_a_mm(parameters);
    let points = positions.into_iter().map(|at| {
        let value = curve.at((at.0 * units).round() as i64) as f64;
        (at, Deviation(value * 1000.0 / units))
    });
    Curve::new(points.collect())
}

/// What a table has to do.
struct Task<'a> {
    axis: Axis,
    fit: &'a Fit,
    old: PitchCurve,
    /// Units in a millimetre.
    units: f64,
    factor: i64,
    /// First and last position, units.
    range: (f64, f64),
    /// Deviation at the machine zero, µm.
    zero: f64,
}

/// Corrections for an interval, in units of the table.
struct Steps {
    interval: i64,
    /// S(1), S(2) … towards plus, and towards minus.
    plus: Vec<i64>,
    minus: Vec<i64>,
    /// The largest deviation that is left, µm.
    left: f64,
}

impl Task<'_> {
    /// The deviation from the machine zero, µm; `at` in units.
    fn deviation(&self, at: f64) -> f64 {
        self.fit.curve.at(Travel(at / self.units)).0 - self.zero
    }

    /// The correction that stands there, units.
    fn old(&self, at: f64) -> f64 {
        self.old.at(at.round() as i64) as f64
    }

    /// The correction that the slide needs, units.
    fn wanted(&self, at: f64) -> f64 {
        self.old(at) - self.deviation(at) * self.units / 1000.0
    }

    /// How many points a table of this interval has.
    fn points(&self, interval: f64) -> i64 {
        let side = |end: f64| (end.max(0.0) / interval + 1e-9).floor() as i64;
        side(self.range.1) + side(-self.range.0)
    }

    /// Corrections of the intervals of one side; `sign`: which one.
    fn side(&self, interval: i64, sign: f64) -> Vec<i64> {
        let end = match sign > 0.0 {
            true => self.range.1,
            false => -self.range.0,
        };
        let count = (end.max(0.0) / interval as f64 + 1e-9).floor() as i64;
        (1..=count)
            .map(|index| {
                let from = (index * interval) as f64;
                let to = (from + interval as f64).min(end.max(from));
                let wanted = self.wanted(sign * (from + to) / 2.0);
                let factor = self.factor as f64;
                (wanted / factor).round() as i64 * self.factor
            })
            .collect()
    }

    fn steps(&self, interval: i64) -> Steps {
        let mut steps = Steps {
            interval,
            plus: self.side(interval, 1.0),
            minus: self.side(interval, -1.0),
            left: 0.0,
        };
        let knots = self
            .fit
            .curve
            .points()
            .iter()
            .map(|(at, _)| at.0 * self.units);
        let [plus, minus] = [&steps.plus, &steps.minus].map(|side| side.len() as i64);
        // At and before each step the deviation is largest.
        let edges = (-minus..=plus).flat_map(|index| {
            let edge = (index * interval) as f64;
            [edge, edge - 1.0, edge + 1.0]
        });
        let within = |at: &f64| (self.range.0..=self.range.1).contains(at);
        let left = knots
            .chain(edges)
            .filter(within)
            .map(|at| self.left(&steps, at).abs());
        steps.left = left.fold(0.0, f64::max);
        steps
    }

    /// What is left at a position, µm.
    fn left(&self, steps: &Steps, at: f64) -> f64 {
        let passed = (at.abs() / steps.interval as f64 + 1e-9).floor() as usize;
        let side = if at < 0.0 { &steps.minus } else { &steps.plus };
        let last = passed.min(side.len());
        let made = last.checked_sub(1).and_then(|it| side.get(it));
        let made = made.copied().unwrap_or(0) as f64;
        self.deviation(at) + (made - self.old(at)) * 1000.0 / self.units
    }

    /// Whether the table has room for so many points, and each value is small enough.
    fn fits(&self, steps: &Steps) -> bool {
        steps.plus.len() + steps.minus.len() <= LAST as usize
            && self
                .values(steps)
                .iter()
                .all(|(_, value)| value.abs() <= LARGEST)
    }

    /// The point of the machine zero.
    fn origin(steps: &Steps) -> i64 {
        let (plus, minus) = (steps.plus.len() as i64, steps.minus.len() as i64);
        match (plus, minus) {
            (_, 0) => 0,
            (0, _) => LAST,
            _ => minus + (LAST - plus - minus) / 2,
        }
    }

    /// Point and value.
    fn values(&self, steps: &Steps) -> Vec<(i64, i64)> {
        let origin = Self::origin(steps);
        let mut values = Vec::new();
        let mut before = 0;
        for (sum, index) in steps.plus.iter().zip(1..) {
            values.push((origin + index, (sum - before) / self.factor));
            before = *sum;
        }
        before = 0;
        for (sum, index) in steps.minus.iter().zip(1..) {
            values.push((origin - index + 1, (before - sum) / self.factor));
            before = *sum;
        }
        values
    }
}

/// A table for a curve, with its parameters and the backlash.
///
/// # Errors
/// An interval that cannot be, a curve that the table cannot hold.
pub fn plan(
    axis: Axis,
    fit: &Fit,
    parameters: &Parameters,
    pitch: &PitchTable,
    wish: PlanWish,
) -> Result<Plan, Message> {
    let none = PitchTable::default();
    let standing = if wish.clear { &none } else { pitch };
    let units = units_a_mm(parameters);
    let (first, last) = fit.curve.range();
    let task = Task {
        axis,
        fit,
        old: PitchCurve::new(axis, parameters, standing, 1),
        units,
        factor: parameters.pitch_factor().into(),
        range: (first.0 * units, last.0 * units),
        zero: fit.curve.at(Travel(0.0)).0,
    };
    let steps = match wish.interval {
        Some(interval) => {
            let interval = (interval.0 * units).round();
            if !(1.0..=999_999.0).contains(&interval) {
                return Err(say::pitch_interval_wrong(interval / units));
            }
            let points = task.points(interval);
            if points > LAST {
                return Err(say::pitch_too_many_points(points, LAST));
            }
            let steps = task.steps(interval as i64);
            if !task.fits(&steps) {
                return Err(say::pitch_step_too_large(LARGEST * task.factor));
            }
            steps
        }
        None => finest(&task).ok_or_else(|| say::pitch_step_too_large(LARGEST * task.factor))?,
    };
    let mut changes = table_changes(&task, &steps, parameters);
    let mut notes = Vec::new();
    if let Some(measured) = fit.backlash {
        let number = of(axis, 34, 35);
        let sum = f64::from(parameters.value(number)) + measured.0 * units / 1000.0;
        let value = sum.round().clamp(0.0, LARGEST_BACKLASH);
        if (sum - value).abs() > 1.0 {
            notes.push(say::pitch_backlash_beyond(sum, LARGEST_BACKLASH));
        }
        let value = value as i32;
        changes.push(Change::Value { number, value });
    }
    let rapid = parameters.rapid_rate(axis) / 60.0;
    let interval = Travel(steps.interval as f64 / units);
    if interval.0 < rapid * LEAST_TIME_S {
        notes.push(say::pitch_interval_short(interval.0, rapid * LEAST_TIME_S));
    }
    if fit.slope.abs() > 100.0 {
        notes.push(say::pitch_slope_large(fit.slope));
    }
    notes.push(say::pitch_zero_return_needed());
    let knots = fit.curve.points().iter();
    let before = knots.map(|(at, _)| task.deviation(at.0 * units).abs());
    Ok(Plan {
        proposal: Proposal::of(changes, notes, parameters, pitch)?,
        interval,
        before: Deviation(before.fold(0.0, f64::max)),
        after: Deviation(steps.left),
    })
}

/// The coarsest interval that is fine enough, else the best there is.
fn finest(task: &Task<'_>) -> Option<Steps> {
    let mut best: Option<Steps> = None;
    for interval in INTERVALS {
        if task.points(interval as f64) > LAST {
            continue;
        }
        let steps = task.steps(interval);
        if !task.fits(&steps) {
            continue;
        }
        if steps.left <= FINE_UM {
            return Some(steps);
        }
        if best.as_ref().is_none_or(|it| steps.left < it.left) {
            best = Some(steps);
        }
    }
    best
}

/// The column of the axis and the parameters that belong to it.
fn table_changes(task: &Task<'_>, steps: &Steps, parameters: &Parameters) -> Vec<Change> {
    let axis = task.axis;
    let mut column = [0_i16; LAST as usize + 1];
    for (point, value) in task.values(steps) {
        if let Some(place) = usize::try_from(point)
            .ok()
            .and_then(|it| column.get_mut(it))
        {
            *place = value as i16;
        }
    }
    let origin = Task::origin(steps) as i32;
    let interval = steps.interval as i32;
    let mut changes = vec![
        Change::Bit {
            number: 3,
            bit: 5,
            on: true,
        },
        Change::Value {
            number: of(axis, 98, 99),
            value: origin,
        },
        Change::Value {
            number: of(axis, 102, 103),
            value: interval,
        },
    ];
    let counts = parameters.pitch_points(axis);
    if counts != (0..=LAST as usize) {
        // All points count while the highest is not above the lowest.
        for number in [of(axis, 90, 91), of(axis, 94, 95)] {
            changes.push(Change::Value { number, value: 0 });
        }
    }
    let points = (0..=u8::MAX).zip(column);
    changes.extend(points.map(|(point, value)| Change::Pitch { axis, point, value }));
    changes
}

/// Adds the values of a file to the table (manual III-10; decision COMMISSION-1). With
/// `clear` the column is emptied first, and takes the spacing of the file.
///
/// # Errors
/// A spacing or a point that does not fit the parameters, a value beyond ±255: with the line
/// of the file.
pub fn add_table(
    axis: Axis,
    table: &Table,
    parameters: &Parameters,
    pitch: &PitchTable,
    clear: bool,
) -> Result<Proposal, Message> {
    let units = units_a_mm(parameters);
    let at_line = |line: u32, rule: Message| say::pitch_file_line(line, rule);
    let mut changes = Vec::new();
    let mut parameters_then = parameters.clone();
    if let Some((line, spacing)) = table.spacing {
        let wanted = (spacing.0 * units).round();
        let number = of(axis, 102, 103);
        if !(1.0..=999_999.0).contains(&wanted) {
            return Err(at_line(line, say::pitch_interval_wrong(spacing.0)));
        }
        if wanted as i64 != parameters.pitch_interval(axis) {
            if !clear {
                let stands = parameters.pitch_interval(axis) as f64 / units;
                let rule = say::pitch_ren_spacing(spacing.0, number, stands);
                return Err(at_line(line, rule));
            }
            let change = Change::Value {
                number,
                value: wanted as i32,
            };
            changes.push(change);
            let mut none = PitchTable::default();
            change.apply(&mut parameters_then, &mut none)?;
        }
    }
    let interval = parameters_then.pitch_interval(axis);
    if interval == 0 {
        return Err(say::pitch_no_interval(of(axis, 102, 103)));
    }
    let origin = i64::from(parameters.pitch_origin(axis));
    let counts = parameters.pitch_points(axis);
    let mut column: Vec<i64> = (0..=u8::MAX)
        .map(|point| {
            if clear {
                0
            } else {
                pitch.value(axis, point).into()
            }
        })
        .collect();
    let factor = f64::from(parameters.pitch_factor());
    for row in &table.rows {
        let steps = row.end.0 * units / interval as f64;
        let whole = steps.round();
        if (steps - whole).abs() > 1e-3 {
            return Err(at_line(row.line, say::pitch_ren_off_grid(row.end.0)));
        }
        let said = row.value.0 * units / 1000.0 / factor;
        if (said - said.round()).abs() > 1e-6 {
            return Err(at_line(
                row.line,
                say::pitch_ren_fraction(row.value.0, factor),
            ));
        }
        // No interval ends at the machine zero.
        let whole = whole as i64;
        let point = match whole {
            0 if row.point.is_none() && said == 0.0 => continue,
            0 if row.point.is_none() => {
                return Err(at_line(row.line, say::pitch_ren_at_zero()));
            }
            1.. => origin + whole,
            _ => origin + whole + 1,
        };
        if let Some(named) = row.point
            && whole != 0
            && i64::from(named) != point
        {
            return Err(at_line(row.line, say::pitch_ren_other_point(named, point)));
        }
        let point = row.point.map_or(point, i64::from);
        let place = usize::try_from(point).ok().filter(|it| counts.contains(it));
        let place = place.filter(|it| *it > 0).and_then(|it| column.get_mut(it));
        let Some(place) = place else {
            let (low, high) = (counts.start().max(&1), counts.end());
            return Err(at_line(row.line, say::pitch_ren_no_point(point, low, high)));
        };
        *place += said.round() as i64;
        if place.abs() > LARGEST {
            let rule = say::pitch_ren_sum(point, *place, LARGEST);
            return Err(at_line(row.line, rule));
        }
    }
    let points = (0..=u8::MAX).zip(column);
    changes.extend(points.map(|(point, value)| Change::Pitch {
        axis,
        point,
        value: value as i16,
    }));
    if let Some((line, backlash)) = table.backlash {
        let value = (backlash.0 * units / 1000.0).round();
        if !(0.0..=LARGEST_BACKLASH).contains(&value) {
            let rule = say::pitch_backlash_beyond(value, LARGEST_BACKLASH);
            return Err(at_line(line, rule));
        }
        changes.push(Change::Value {
            number: of(axis, 34, 35),
            value: value as i32,
        });
    }
    let mut notes = vec![say::pitch_zero_return_needed()];
    if !parameters.pitch_compensated() {
        notes.insert(0, say::pitch_switched_off(name(axis)));
    }
    Proposal::of(changes, notes, parameters, pitch)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::read;
    use crate::measurement::{Direction, Measurement, Reading};
    use crate::ren::Imported;

    fn table_of(text: &str) -> Table {
        match read(text).unwrap() {
            Imported::Table(table) => table,
            Imported::Measured(_) => panic!("a table"),
        }
    }

    fn fit_of(curve: impl Fn(f64) -> f64, from: i32, to: i32) -> Fit {
        let readings = (from..=to).map(|at| {
            let at = f64::from(at) * 10.0;
            Reading {
                run: 1,
                target: Travel(at),
                direction: Direction::Plus,
                deviation: Deviation(curve(at)),
            }
        });
        let measured = Measurement {
            axis: None,
            readings: readings.collect(),
        };
        crate::fit(&measured, Direction::Plus).unwrap()
    }

    fn written(changes: &[Change]) -> (Parameters, PitchTable) {
        let (mut parameters, mut pitch) = (Parameters::default(), PitchTable::default());
        for change in changes {
            change.apply(&mut parameters, &mut pitch).unwrap();
        }
        (parameters, pitch)
    }

    /// What the control makes of the table is the curve turned round, whichever side of the
    /// zero it lies on, and with what stood there before.
    #[test]
    fn the_control_takes_the_deviation_away() {
        let curve = |at: f64| 0.04 * at + 6.0 * libm_sin(at / 60.0) + 3.0;
        for (from, to) in [(-30, 0), (0, 30), (-20, 11), (-1, 2)] {
            let fit = fit_of(curve, from, to);
            let none = (Parameters::default(), PitchTable::default());
            let plan = plan(Axis::Z, &fit, &none.0, &none.1, PlanWish::default()).unwrap();
            let (parameters, pitch) = written(&plan.proposal.changes);
            let positions = (from * 100..=to * 100).map(|tenth| Travel(f64::from(tenth) / 10.0));
            let made = correction(Axis::Z, &parameters, &pitch, positions);
            for (at, value) in made.points() {
                let left = fit.curve.at(*at).0 - fit.curve.at(Travel(0.0)).0 + value.0;
                assert!(
                    left.abs() <= plan.after.0 + 0.01,
                    "{at:?}: {left} {}",
                    plan.after.0
                );
            }
            assert!(
                plan.after.0 <= FINE_UM || plan.interval.0 <= 1.0,
                "{}",
                plan.after.0
            );
            // Measured again, what is left is less than a step of the table.
            let again = fit_of(|_| 0.0, from, to);
            let wish = PlanWish {
                interval: Some(plan.interval),
                clear: false,
            };
            let same = super::plan(Axis::Z, &again, &parameters, &pitch, wish).unwrap();
            assert_eq!(same.proposal.changes, []);
        }
    }

    fn libm_sin(angle: f64) -> f64 {
        angle.sin()
    }

    #[test]
    fn what_the_table_cannot_hold_is_refused() {
        let none = (Parameters::default(), PitchTable::default());
        let steep = fit_of(|at| at * 40.0, -20, 0);
        let wish = |interval| PlanWish {
            interval: Some(Travel(interval)),
            clear: false,
        };
        let planned = |fit: &Fit, wish| plan(Axis::Z, fit, &none.0, &none.1, wish);
        assert!(planned(&steep, wish(10.0)).is_err());
        assert!(planned(&steep, wish(0.1)).is_err());
        assert!(planned(&steep, wish(0.0)).is_err());
        assert!(planned(&steep, wish(0.001)).is_err());
        assert!(planned(&steep, wish(4.0)).is_ok());
    }

    /// The second example of the siblings' manual, as a file for this control.
    #[test]
    fn values_of_a_file_are_added_to_their_points() {
        let mut parameters = Parameters::default();
        parameters.set(99, 60).unwrap();
        let table = table_of("spacing 10\nbacklash 5\n-20 -7\n59 -20 0\n-10 6\n10 4\n0 0\n");
        let pitch = PitchTable::default();
        let proposal = add_table(Axis::Z, &table, &parameters, &pitch, false).unwrap();
        let (mut parameters, mut pitch) = (parameters, pitch);
        for change in &proposal.changes {
            change.apply(&mut parameters, &mut pitch).unwrap();
        }
        let values: Vec<i16> = (58..=61).map(|point| pitch.value(Axis::Z, point)).collect();
        assert_eq!(values, [0, -7, 6, 4]);
        assert_eq!(parameters.value(35), 5);
        let twice = add_table(Axis::Z, &table, &parameters, &pitch, false).unwrap();
        let point = Change::Pitch {
            axis: Axis::Z,
            point: 60,
            value: 12,
        };
        assert!(twice.changes.contains(&point));
        let cleared = add_table(Axis::Z, &table, &parameters, &pitch, true).unwrap();
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
            let refused = add_table(Axis::Z, &table_of(text), &parameters, &pitch, false);
            let said = refused.unwrap_err();
            assert_eq!(said.plain_value("line"), Some(line), "{text}");
        }
    }
}
