//! The pitch error table: 256 points per axis (manual III-10).

use core::fmt;
use std::collections::BTreeMap;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::units::{Axis, PerAxis};

/// Greatest absolute value of a point of the table, in 0.001 mm.
const LARGEST_ERROR: i16 = 255;

/// Errors of the lead screws at up to 256 points per axis, in 0.001 mm, before multiplication
/// by the factor 013. A missing point is 0. No interval belongs to point 0.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    try_from = "PerAxis<BTreeMap<u8, i16>>",
    into = "PerAxis<BTreeMap<u8, i16>>"
)]
pub struct PitchTable {
    points: PerAxis<BTreeMap<u8, i16>>,
}

/// The error of writing a value beyond ±255 to the pitch error table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PitchError {
    /// Number of the point in the pitch error table.
    pub point: u8,
    /// The value that was refused.
    pub value: i16,
}

impl PitchError {
    /// The message that explains to the operator why the value was not written.
    pub fn message(&self) -> Message {
        say::pitch_error_out_of_range(self.point, self.value, LARGEST_ERROR)
    }
}

impl fmt::Display for PitchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl core::error::Error for PitchError {}

impl From<PitchError> for crate::alarm::Alarm {
    fn from(error: PitchError) -> Self {
        Self::new(43).with_detail(error.message())
    }
}

impl PitchTable {
    /// The value of a point of an axis, in 0.001 mm, before multiplication by the factor 013.
    pub fn value(&self, axis: Axis, point: u8) -> i16 {
        self.points.get(axis).get(&point).copied().unwrap_or(0)
    }

    /// Writes the value of a point of an axis, in 0.001 mm, before multiplication by the
    /// factor 013.
    ///
    /// # Errors
    /// A value beyond ±255 (alarm 043).
    pub fn set(&mut self, axis: Axis, point: u8, value: i16) -> Result<(), PitchError> {
        check_value(point, value)?;
        let points = self.points.get_mut(axis);
        if value == 0 {
            points.remove(&point);
        } else {
            points.insert(point, value);
        }
        Ok(())
    }

    /// Whether no value of an axis has an effect.
    pub(crate) fn is_flat(&self, axis: Axis) -> bool {
        self.points.get(axis).range(1..).next().is_none()
    }
}

const fn check_value(point: u8, value: i16) -> Result<(), PitchError> {
    if value < -LARGEST_ERROR || value > LARGEST_ERROR {
        return Err(PitchError { point, value });
    }
    Ok(())
}

impl TryFrom<PerAxis<BTreeMap<u8, i16>>> for PitchTable {
    type Error = PitchError;

    fn try_from(points: PerAxis<BTreeMap<u8, i16>>) -> Result<Self, PitchError> {
        let mut table = Self::default();
        for (axis, values) in [(Axis::X, points.x), (Axis::Z, points.z)] {
            for (point, value) in values {
                table.set(axis, point, value)?;
            }
        }
        Ok(table)
    }
}

impl From<PitchTable> for PerAxis<BTreeMap<u8, i16>> {
    fn from(table: PitchTable) -> Self {
        table.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_checked_and_survive_storage() {
        let mut table = PitchTable::default();
        table.set(Axis::X, 1, -255).unwrap();
        table.set(Axis::Z, 255, 7).unwrap();
        table.set(Axis::Z, 0, 5).unwrap();
        let error = table.set(Axis::Z, 3, 256).unwrap_err();
        assert_eq!(
            error.to_string(),
            "pitch error point 003: 256 is outside -255..255"
        );
        let text = ron::to_string(&table).unwrap();
        assert_eq!(ron::from_str::<PitchTable>(&text).unwrap(), table);
        assert!(ron::from_str::<PitchTable>("(x:{1:300},z:{})").is_err());
        table.set(Axis::Z, 255, 0).unwrap();
        assert!(table.is_flat(Axis::Z) && !table.is_flat(Axis::X));
    }
}
