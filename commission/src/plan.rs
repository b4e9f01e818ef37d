//! The pitch error table and its parameters for a curve (003.5, 013, 090–103; manual III-10).

use gsk_core::axis::PitchCurve;
use gsk_core::memory::{Parameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::change::{Change, Proposal, of};
use crate::correction::{LARGEST, LARGEST_BACKLASH, LAST, units_a_mm};
use crate::fit::Fit;
use crate::intervals::{Steps, Task, finest};
use crate::measurement::{Deviation, Travel};

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
        let number = of(axis, parameter::X_BACKLASH, parameter::Z_BACKLASH);
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
            number: of(axis, parameter::X_PITCH_ORIGIN, parameter::Z_PITCH_ORIGIN),
            value: origin,
        },
        Change::Value {
            number: of(
                axis,
                parameter::X_PITCH_INTERVAL,
                parameter::Z_PITCH_INTERVAL,
            ),
            value: interval,
        },
    ];
    let counts = parameters.pitch_points(axis);
    if counts != (0..=LAST as usize) {
        // All points count while the highest is not above the lowest.
        for number in [
            of(axis, parameter::X_PITCH_LOWEST, parameter::Z_PITCH_LOWEST),
            of(axis, parameter::X_PITCH_HIGHEST, parameter::Z_PITCH_HIGHEST),
        ] {
            changes.push(Change::Value { number, value: 0 });
        }
    }
    let points = (0..=u8::MAX).zip(column);
    changes.extend(points.map(|(point, value)| Change::Pitch { axis, point, value }));
    changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::correction;
    use crate::intervals::FINE_UM;
    use crate::measurement::{Direction, Measurement, Reading};

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
}
