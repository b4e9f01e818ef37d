//! The coordinate frame of a command: work zero, tool offset and zero offset.

use serde::{Deserialize, Serialize};

use crate::units::{Axis, Point, round};

/// The coordinate frame in force: `machine = program + zero + offset`, all in mm, X as a
/// radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Machine coordinates of the work zero, mm.
    pub zero: Point,
    /// Tool offset in force, added to programmed coordinates.
    pub offset: Point,
    /// The part of `zero` that comes from zero offsets (G55 to G57 of the Huaxing lathes).
    #[serde(default, skip_serializing_if = "ZeroOffset::is_none")]
    pub zero_offset: ZeroOffset,
}

/// A zero offset in half micrometres, X as a radius. The type is small because each command
/// carries a copy of its frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ZeroOffset {
    x: i32,
    z: i32,
}

impl ZeroOffset {
    /// Number of half micrometres in a millimetre.
    const UNITS_PER_MM: f64 = 2000.0;

    /// Rounds a point in mm to the nearest zero offset.
    pub fn from_point(point: Point) -> Self {
        let to_units = |mm: f64| round(mm * Self::UNITS_PER_MM) as i32;
        Self {
            x: to_units(point.x),
            z: to_units(point.z),
        }
    }

    /// Converts the offset to a point in mm, X as a radius.
    pub fn to_point(self) -> Point {
        Point::new(
            f64::from(self.x) / Self::UNITS_PER_MM,
            f64::from(self.z) / Self::UNITS_PER_MM,
        )
    }

    /// Sets the offset of one axis to zero.
    pub(crate) const fn clear_axis(&mut self, axis: Axis) {
        match axis {
            Axis::X => self.x = 0,
            Axis::Z => self.z = 0,
        }
    }

    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

impl Frame {
    /// Converts programmed to machine coordinates, mm.
    pub fn to_machine(&self, program: Point) -> Point {
        program + self.zero + self.offset
    }

    /// Converts machine coordinates to programmed (absolute) coordinates.
    pub fn to_program(&self, machine: Point) -> Point {
        machine - self.zero - self.offset
    }
}
