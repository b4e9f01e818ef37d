//! Grooves and parting off with G75. The programmed point of the blade is its left corner.

use gsk_messages::say;

use super::{BlockText, CLEARANCE_MM, FRONT_MM, RETRACT_MM, micrometres, side};
use crate::error::FormError;
use crate::thousandths::Thousandths;
use crate::tool_path::CutSide;
use crate::values::FormValues;

/// Overlap of neighbouring plunges, mm.
const OVERLAP_MM: f64 = 0.2;

/// Distance beyond the axis at which parting off ends, mm.
const BEYOND_AXIS_MM: f64 = 0.2;

/// Equal grooves, one after the other towards the chuck.
pub(super) fn grooves(text: &mut BlockText, values: &FormValues) -> Result<(), FormError> {
    let (surface, bottom) = (values.number("D"), values.number("DB"));
    let (width, blade) = (values.number("W"), values.number("TW"));
    if blade.0 > width.0 {
        return Err(FormError::new("TW", say::form_blade_too_wide(width)));
    }
    let side = side(values);
    let clearance = Thousandths::round(2.0 * CLEARANCE_MM);
    let start = match side {
        CutSide::Outside if bottom.0 >= surface.0 => {
            return Err(FormError::new(
                "DB",
                say::form_groove_bottom_outside(surface),
            ));
        }
        CutSide::Inside if bottom.0 <= surface.0 => {
            return Err(FormError::new(
                "DB",
                say::form_groove_bottom_inside(surface),
            ));
        }
        CutSide::Outside => surface + clearance,
        CutSide::Inside => surface - clearance,
    };
    let (count, step) = (values.number("COUNT").0 / 1000, values.number("STEP"));
    if count > 1 && step.0 <= width.0 {
        return Err(FormError::new("STEP", say::form_step_too_small(width)));
    }
    let first = Thousandths(-values.number("POS").0 - blade.0);
    let shift = Thousandths(width.0 - blade.0);
    let column = Thousandths::round((blade.value() - OVERLAP_MM).max(blade.value() / 2.0));
    match side {
        CutSide::Outside => {
            text.rapid(None, Some(first));
            text.rapid(Some(start), None);
        }
        CutSide::Inside => {
            text.rapid(Some(start), Some(Thousandths::round(FRONT_MM)));
            text.rapid(None, Some(first));
        }
    }
    text.add(format!(
        "G75 R{}",
        Thousandths::round(RETRACT_MM).with_point()
    ));
    for index in 0..count {
        let z = Thousandths(first.0 - index * step.0);
        if index > 0 {
            text.rapid(None, Some(z));
        }
        let (end, peck) = (z - shift, 2 * micrometres(values.number("PECK")));
        let feed = values.number("F").with_point();
        text.add(match shift.0 {
            0 => format!("G75 X{} P{peck} F{feed}", bottom.with_point()),
            _ => format!(
                "G75 X{} Z{} P{peck} Q{} R0. F{feed}",
                bottom.with_point(),
                end.with_point(),
                micrometres(column),
            ),
        });
    }
    if side == CutSide::Inside {
        text.rapid(None, Some(Thousandths::round(FRONT_MM)));
    }
    Ok(())
}

/// The end of the part: to the axis, or into the bore.
pub(super) fn part_off(text: &mut BlockText, values: &FormValues) -> Result<(), FormError> {
    let (surface, core) = (values.number("D"), values.number("BORE"));
    if core.0 >= surface.0 {
        return Err(FormError::new("BORE", say::form_below_stock(surface)));
    }
    let bottom = match core.0 {
        // A blade with rounded corners leaves a stub on the axis.
        0 => Thousandths::round(-2.0 * BEYOND_AXIS_MM),
        _ => Thousandths((core.0 - 1_000).max(0)),
    };
    let z = Thousandths(-values.number("L").0 - values.number("TW").0);
    text.rapid(None, Some(z));
    text.rapid(Some(surface + Thousandths::round(2.0 * CLEARANCE_MM)), None);
    text.add(format!(
        "G75 R{}",
        Thousandths::round(RETRACT_MM).with_point()
    ));
    text.add(format!(
        "G75 X{} P{} F{}",
        bottom.with_point(),
        2 * micrometres(values.number("PECK")),
        values.number("F").with_point(),
    ));
    Ok(())
}
