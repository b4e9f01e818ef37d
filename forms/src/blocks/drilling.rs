//! Holes on the spindle axis: G74, and a feed with a dwell.

use super::{BlockText, FRONT_MM, micrometres};
use crate::thousandths::Thousandths;
use crate::values::FormValues;

/// Retract after a peck, mm.
const PECK_RETRACT_MM: f64 = 1.0;

/// Z of the point of the drill at the end, mm.
pub(crate) fn end_z(values: &FormValues) -> f64 {
    let point = values.value("D") * cone_length_factor(values.value("POINT"));
    // A form without a length cuts the cone alone.
    -(values.value("L") + point)
}

/// A hole whose full diameter reaches the length.
pub(super) fn drill(text: &mut BlockText, values: &FormValues) {
    approach(text);
    text.add(format!(
        "G74 R{}",
        Thousandths::round(PECK_RETRACT_MM).with_point()
    ));
    text.add(format!(
        "G74 Z{} Q{} F{}",
        Thousandths::round(end_z(values)).with_point(),
        micrometres(values.number("PECK")),
        values.number("F").with_point(),
    ));
}

/// A cone with a diameter at the face.
pub(super) fn center(text: &mut BlockText, values: &FormValues) {
    approach(text);
    let end = Thousandths::round(end_z(values)).with_point();
    text.add(format!("G01 Z{end} F{}", values.number("F").with_point()));
    if values.number("DWELL").0 > 0 {
        text.add(format!("G04 X{}", values.number("DWELL").with_point()));
    }
    text.rapid(None, Some(Thousandths::round(FRONT_MM)));
}

fn approach(text: &mut BlockText) {
    text.rapid(Some(Thousandths(0)), Some(Thousandths::round(FRONT_MM)));
}

/// Half the cotangent of half an angle, degrees: length of a cone for each mm of its diameter.
fn cone_length_factor(angle: f64) -> f64 {
    0.5 / libm::tan((angle / 2.0).to_radians())
}
