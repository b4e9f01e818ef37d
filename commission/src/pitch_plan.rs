//! Plans the pitch error table of a measured screw and its parameters (003.5, 013, 090 to 103;
//! manual III-10).

use gsk_core::axis::PitchCurve;
use gsk_core::memory::{ControlParameters, PitchTable, parameter};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::correction::{LAST_POINT, MAX_BACKLASH, MAX_POINT_VALUE, units_per_mm};
use crate::measurement::{AxisDeviation, SlideTravel};
use crate::parameter_change::{ParameterChange, Proposal, select_by_axis};
use crate::screw_fit::ScrewFit;
use crate::table_interval::{CorrectionTask, IntervalCorrections, find_interval};

/// Shortest time that an interval may take at the rapid rate, s (decision COMMISSION-3).
const MIN_INTERVAL_TIME_S: f64 = 0.008;

/// Options for planning a pitch error table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PitchPlanOptions {
    /// Slide travel between two points, mm; `None` chooses the largest that is accurate
    /// enough.
    pub interval: Option<SlideTravel>,
    /// Whether the measurement was made without the current table, so that the plan ignores
    /// it.
    pub clear: bool,
}

/// A planned pitch error table with its expected result.
#[derive(Clone, Debug, PartialEq)]
pub struct PitchPlan {
    /// The changes of table and parameters to write.
    pub proposal: Proposal,
    /// Slide travel between two points of the table, mm.
    pub interval: SlideTravel,
    /// Largest measured deviation relative to the machine zero, µm.
    pub before: AxisDeviation,
    /// Largest expected deviation with the new table, µm.
    pub after: AxisDeviation,
}

/// Plans the pitch error table, its parameters and the backlash for a fitted screw.
///
/// # Errors
/// Returns a message for an interval out of range, too many points for the table, or a value
/// beyond ±255.
pub fn plan_pitch_table(
    axis: Axis,
    fit: &ScrewFit,
    parameters: &ControlParameters,
    pitch: &PitchTable,
    options: PitchPlanOptions,
) -> Result<PitchPlan, Message> {
    let empty = PitchTable::default();
    let current = if options.clear { &empty } else { pitch };
    let units = units_per_mm(parameters);
    let (first, last) = fit.curve.range();
    let task = CorrectionTask {
        axis,
        fit,
        current: PitchCurve::new(axis, parameters, current, 1),
        units_per_mm: units,
        factor: parameters.pitch_factor().into(),
        range_units: (first.0 * units, last.0 * units),
        zero_deviation_um: fit.curve.at(SlideTravel(0.0)).0,
    };
    let corrections = match options.interval {
        Some(interval) => {
            let interval = (interval.0 * units).round();
            if !(1.0..=999_999.0).contains(&interval) {
                return Err(say::pitch_interval_wrong(interval / units));
            }
            let points = task.point_count(interval);
            if points > LAST_POINT {
                return Err(say::pitch_too_many_points(points, LAST_POINT));
            }
            let corrections = task.corrections(interval as i64);
            if !task.fits(&corrections) {
                return Err(say::pitch_step_too_large(MAX_POINT_VALUE * task.factor));
            }
            corrections
        }
        None => find_interval(&task)
            .ok_or_else(|| say::pitch_step_too_large(MAX_POINT_VALUE * task.factor))?,
    };
    let mut changes = table_changes(&task, &corrections, parameters);
    let mut notes = Vec::new();
    if let Some(measured) = fit.backlash {
        let number = select_by_axis(axis, parameter::X_BACKLASH, parameter::Z_BACKLASH);
        let sum = f64::from(parameters.value(number)) + measured.0 * units / 1000.0;
        let value = sum.round().clamp(0.0, MAX_BACKLASH);
        if (sum - value).abs() > 1.0 {
            notes.push(say::pitch_backlash_beyond(sum, MAX_BACKLASH));
        }
        let value = value as i32;
        changes.push(ParameterChange::Value { number, value });
    }
    let rapid_mm_per_s = parameters.rapid_rate(axis) / 60.0;
    let interval = SlideTravel(corrections.interval as f64 / units);
    if interval.0 < rapid_mm_per_s * MIN_INTERVAL_TIME_S {
        notes.push(say::pitch_interval_short(
            interval.0,
            rapid_mm_per_s * MIN_INTERVAL_TIME_S,
        ));
    }
    if fit.slope_um_per_m.abs() > 100.0 {
        notes.push(say::pitch_slope_large(fit.slope_um_per_m));
    }
    notes.push(say::pitch_zero_return_needed());
    let knots = fit.curve.points().iter();
    let before = knots.map(|(at, _)| task.deviation_um(at.0 * units).abs());
    Ok(PitchPlan {
        proposal: Proposal::from_changes(changes, notes, parameters, pitch)?,
        interval,
        before: AxisDeviation(before.fold(0.0, f64::max)),
        after: AxisDeviation(corrections.max_residual_um),
    })
}

/// Returns the changes of the axis's table column and of its parameters.
fn table_changes(
    task: &CorrectionTask<'_>,
    corrections: &IntervalCorrections,
    parameters: &ControlParameters,
) -> Vec<ParameterChange> {
    let axis = task.axis;
    let mut column = [0_i16; LAST_POINT as usize + 1];
    for (point, value) in task.point_values(corrections) {
        if let Some(entry) = usize::try_from(point)
            .ok()
            .and_then(|it| column.get_mut(it))
        {
            *entry = value as i16;
        }
    }
    let origin = CorrectionTask::origin_point(corrections) as i32;
    let interval = corrections.interval as i32;
    let mut changes = vec![
        ParameterChange::Bit {
            number: 3,
            bit: 5,
            on: true,
        },
        ParameterChange::Value {
            number: select_by_axis(axis, parameter::X_PITCH_ORIGIN, parameter::Z_PITCH_ORIGIN),
            value: origin,
        },
        ParameterChange::Value {
            number: select_by_axis(
                axis,
                parameter::X_PITCH_INTERVAL,
                parameter::Z_PITCH_INTERVAL,
            ),
            value: interval,
        },
    ];
    let counts = parameters.pitch_points(axis);
    if counts != (0..=LAST_POINT as usize) {
        // All points are valid if the highest is not above the lowest.
        for number in [
            select_by_axis(axis, parameter::X_PITCH_LOWEST, parameter::Z_PITCH_LOWEST),
            select_by_axis(axis, parameter::X_PITCH_HIGHEST, parameter::Z_PITCH_HIGHEST),
        ] {
            changes.push(ParameterChange::Value { number, value: 0 });
        }
    }
    let points = (0..=u8::MAX).zip(column);
    changes.extend(points.map(|(point, value)| ParameterChange::Pitch { axis, point, value }));
    changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::compute_correction;
    use crate::measurement::{ApproachDirection, AxisReading, Measurement};
    use crate::table_interval::MAX_RESIDUAL_UM;

    fn fit_of(curve: impl Fn(f64) -> f64, from: i32, to: i32) -> ScrewFit {
        let readings = (from..=to).map(|at| {
            let at = f64::from(at) * 10.0;
            AxisReading {
                run: 1,
                target: SlideTravel(at),
                direction: ApproachDirection::Plus,
                deviation: AxisDeviation(curve(at)),
            }
        });
        let measured = Measurement {
            axis: None,
            readings: readings.collect(),
        };
        crate::fit_screw(&measured, ApproachDirection::Plus).unwrap()
    }

    fn written(changes: &[ParameterChange]) -> (ControlParameters, PitchTable) {
        let (mut parameters, mut pitch) = (ControlParameters::default(), PitchTable::default());
        for change in changes {
            change.apply(&mut parameters, &mut pitch).unwrap();
        }
        (parameters, pitch)
    }

    /// The correction of the control is the negative curve, on both sides of the zero and with an
    /// earlier table.
    #[test]
    fn planned_table_cancels_deviation() {
        let curve = |at: f64| 0.04 * at + 6.0 * libm_sin(at / 60.0) + 3.0;
        for (from, to) in [(-30, 0), (0, 30), (-20, 11), (-1, 2)] {
            let fit = fit_of(curve, from, to);
            let none = (ControlParameters::default(), PitchTable::default());
            let plan =
                plan_pitch_table(Axis::Z, &fit, &none.0, &none.1, PitchPlanOptions::default())
                    .unwrap();
            let (parameters, pitch) = written(&plan.proposal.changes);
            let positions =
                (from * 100..=to * 100).map(|tenth| SlideTravel(f64::from(tenth) / 10.0));
            let made = compute_correction(Axis::Z, &parameters, &pitch, positions);
            for (at, value) in made.points() {
                let left = fit.curve.at(*at).0 - fit.curve.at(SlideTravel(0.0)).0 + value.0;
                assert!(
                    left.abs() <= plan.after.0 + 0.01,
                    "{at:?}: {left} {}",
                    plan.after.0
                );
            }
            assert!(
                plan.after.0 <= MAX_RESIDUAL_UM || plan.interval.0 <= 1.0,
                "{}",
                plan.after.0
            );
            // Measured again: the residual is less than a step of the table.
            let again = fit_of(|_| 0.0, from, to);
            let options = PitchPlanOptions {
                interval: Some(plan.interval),
                clear: false,
            };
            let same = plan_pitch_table(Axis::Z, &again, &parameters, &pitch, options).unwrap();
            assert_eq!(same.proposal.changes, []);
        }
    }

    fn libm_sin(angle: f64) -> f64 {
        angle.sin()
    }

    #[test]
    fn curve_beyond_table_limits_is_refused() {
        let none = (ControlParameters::default(), PitchTable::default());
        let steep = fit_of(|at| at * 40.0, -20, 0);
        let options = |interval| PitchPlanOptions {
            interval: Some(SlideTravel(interval)),
            clear: false,
        };
        let planned =
            |fit: &ScrewFit, options| plan_pitch_table(Axis::Z, fit, &none.0, &none.1, options);
        assert!(planned(&steep, options(10.0)).is_err());
        assert!(planned(&steep, options(0.1)).is_err());
        assert!(planned(&steep, options(0.0)).is_err());
        assert!(planned(&steep, options(0.001)).is_err());
        assert!(planned(&steep, options(4.0)).is_ok());
    }
}
