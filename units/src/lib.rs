//! Defines the physical quantities that all crates exchange: axes, points, diameters, feeds
//! and pulses.
//!
//! Each quantity has a type, so that a diameter is never taken for a radius, a pulse count
//! for millimetres, or a feed per revolution for a feed per minute. The module [`alarm`]
//! names the alarm numbers.

use core::fmt;
use core::ops::{Add, Mul, Neg, Sub};

use glam::DVec2;
use serde::{Deserialize, Serialize};

pub mod alarm;
mod finite;

pub use finite::{NonFinite, find_non_finite, parse_finite};

/// The two controlled axes of the lathe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Axis {
    /// Cross slide, perpendicular to the spindle.
    X,
    /// Carriage, parallel to the spindle.
    Z,
}

impl Axis {
    /// Returns Z for X and X for Z.
    pub const fn other(self) -> Self {
        match self {
            Self::X => Self::Z,
            Self::Z => Self::X,
        }
    }
}

/// One value for each of the axes X and Z.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PerAxis<T> {
    /// Value of the X axis.
    pub x: T,
    /// Value of the Z axis.
    pub z: T,
}

impl<T> PerAxis<T> {
    /// Creates a pair from the X value and the Z value.
    pub const fn new(x: T, z: T) -> Self {
        Self { x, z }
    }

    /// Returns the value of `axis`.
    pub const fn get(&self, axis: Axis) -> &T {
        match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
        }
    }

    /// Returns a mutable reference to the value of `axis`.
    pub const fn get_mut(&mut self, axis: Axis) -> &mut T {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "X",
            Self::Z => "Z",
        })
    }
}

/// A point or a displacement in the ZX plane of the lathe, mm.
///
/// `x` is always a *radius*. Diameters exist only in program words and on displays
/// ([`Diameter`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Distance from the spindle axis (radius), mm.
    pub x: f64,
    /// Position along the spindle axis, mm.
    pub z: f64,
}

impl Point {
    /// Creates a point from a radius and a Z coordinate, mm.
    pub const fn new(x: f64, z: f64) -> Self {
        Self { x, z }
    }

    /// Creates a point from an X diameter and a Z coordinate, mm.
    pub const fn from_diameter(x: Diameter, z: f64) -> Self {
        Self { x: x.0 / 2.0, z }
    }

    /// Returns the X coordinate as a diameter.
    pub const fn diameter(self) -> Diameter {
        Diameter(self.x * 2.0)
    }

    /// Converts a point to a vector with Z as its first and X as its second component, mm:
    ///
    /// ```text
    ///  X (radius)
    ///  ^   left(t)        cross(t, left(t)) > 0: counter-clockwise
    ///  |     |
    ///  |     +----> t
    ///  +-----------------> Z
    /// ```
    pub const fn to_vector(self) -> DVec2 {
        DVec2::new(self.z, self.x)
    }

    /// Converts a vector with Z as its first and X as its second component to a point.
    pub(crate) const fn from_vector(vector: DVec2) -> Self {
        Self::new(vector.y, vector.x)
    }

    /// Returns the length of the displacement, mm. For a point this is the distance from the
    /// origin.
    pub fn length(self) -> f64 {
        self.to_vector().length()
    }

    /// Returns the scalar product of two displacements, mm².
    pub fn dot(self, other: Self) -> f64 {
        self.to_vector().dot(other.to_vector())
    }

    /// Returns the cross product of two displacements, mm². The product is positive if `other`
    /// points counter-clockwise of `self`, with Z to the right and X up.
    pub fn cross(self, other: Self) -> f64 {
        self.to_vector().perp_dot(other.to_vector())
    }

    /// Returns the displacement turned by 90° counter-clockwise, with Z to the right and X
    /// up.
    #[must_use]
    pub fn left(self) -> Self {
        Self::from_vector(self.to_vector().perp())
    }

    /// Returns the direction as a vector of length 1, or `None` if the length is 0.
    pub fn unit(self) -> Option<Self> {
        self.to_vector().try_normalize().map(Self::from_vector)
    }

    /// Returns the coordinate of `axis`, mm; X as a radius.
    pub const fn get(self, axis: Axis) -> f64 {
        match axis {
            Axis::X => self.x,
            Axis::Z => self.z,
        }
    }

    /// Returns a mutable reference to the coordinate of `axis`, mm; X as a radius.
    pub const fn get_mut(&mut self, axis: Axis) -> &mut f64 {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }
}

impl Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.z + other.z)
    }
}

impl Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.z - other.z)
    }
}

impl Mul<f64> for Point {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.z * factor)
    }
}

impl Neg for Point {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.z)
    }
}

/// Returns the direction from the centre of a tool nose to its imaginary tip, as signs of X
/// and Z.
///
/// `number` is the tip number of the offset table, 0 to 9:
///
/// ```text
///  X ^    2   6   1        The number gives the direction of the imaginary tip,
///    |      \\ | /          seen from the centre of the nose.
///    |    7 - o - 5        0 and 9: the tip is at the centre.
///    |      / | \\
///    |    3   8   4        tip = centre + |R| * direction
///    +--------------> Z
/// ```
pub const fn tip_direction(number: u8) -> Point {
    let (z, x) = match number {
        1 => (1.0, 1.0),
        2 => (-1.0, 1.0),
        3 => (-1.0, -1.0),
        4 => (1.0, -1.0),
        5 => (1.0, 0.0),
        6 => (0.0, 1.0),
        7 => (-1.0, 0.0),
        8 => (0.0, -1.0),
        _ => (0.0, 0.0),
    };
    Point::new(x, z)
}

/// An X coordinate as programs and displays give it: a diameter, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Diameter(pub f64);

impl Diameter {
    /// Returns half the diameter, mm.
    pub const fn radius(self) -> f64 {
        self.0 / 2.0
    }
}

/// A commanded feed, as distance per minute or per revolution.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Feed {
    /// Feed per minute (G98), mm/min.
    PerMinute(f64),
    /// Feed per revolution (G99), mm/r.
    PerRevolution(f64),
}

/// A number of drive pulses of one axis, counted from the machine zero.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct Pulses(pub i64);

/// Duration of one interpolation tick, ms of machine time.
pub const TICK_MS: u32 = 1;

/// Duration of one interpolation tick, s of machine time.
pub const TICK_S: f64 = 0.001;

/// Table of the factors of the percentages 0 to 255 %: entry 150 is 1.5.
static PERCENT_FACTORS: [f64; 256] = {
    let mut factors = [0.0; 256];
    let mut percent = 0;
    while percent < factors.len() {
        factors[percent] = percent as f64 / 100.0;
        percent += 1;
    }
    factors
};

/// Converts a percentage to a factor: 150 % to 1.5.
///
/// A table replaces the division, which takes as long as ten additions, because each tick
/// converts the overrides.
#[inline]
pub fn percent_to_factor(percent: u8) -> f64 {
    PERCENT_FACTORS[usize::from(percent)]
}

/// Returns the smaller of two numbers. Neither may be NaN.
///
/// This function compiles to one instruction; `f64::min` needs more because it also handles
/// NaN.
#[inline]
pub const fn min_not_nan(one: f64, other: f64) -> f64 {
    if one < other { one } else { other }
}

/// Returns the larger of two numbers. Neither may be NaN.
#[inline]
pub const fn max_not_nan(one: f64, other: f64) -> f64 {
    if one > other { one } else { other }
}

/// 1.5 · 2^52. A number below [`MAX_SHIFTABLE`] plus this constant has no bits left for a
/// fraction: the addition rounds it to a whole number, half to even, in its lowest bits.
const ROUNDING_SHIFT: f64 = 6_755_399_441_055_744.0;

/// 2^51: [`ROUNDING_SHIFT`] rounds only numbers whose absolute value is smaller.
const MAX_SHIFTABLE: f64 = 2_251_799_813_685_248.0;

/// Rounds a number below [`MAX_SHIFTABLE`] half to even and returns the result as `i64` and as
/// `f64`.
///
/// The addition replaces the conversion with `as`, which also checks the range of `i64`.
#[inline]
const fn round_half_to_even(value: f64) -> (i64, f64) {
    let shifted = value + ROUNDING_SHIFT;
    let whole = shifted.to_bits() as i64 - ROUNDING_SHIFT.to_bits() as i64;
    (whole, shifted - ROUNDING_SHIFT)
}

/// Rounds to the nearest whole number, half away from zero, like `value.round() as i64`.
/// Numbers outside `i64` saturate; NaN gives 0.
///
/// This function needs no library call on processors that have no rounding instruction.
///
/// ```
/// for value in [0.0, 0.5, 1.5, 2.5, 0.49999999999999994, 2.4, 2.6, 4503599627370494.5, 1e300] {
///     assert_eq!(gsk_units::round_to_i64(value), value.round() as i64);
///     assert_eq!(gsk_units::round_to_i64(-value), (-value).round() as i64);
/// }
/// assert_eq!(gsk_units::round_to_i64(f64::NAN), 0);
/// ```
#[inline]
pub fn round_to_i64(value: f64) -> i64 {
    if value.abs() < MAX_SHIFTABLE {
        let (whole, even) = round_half_to_even(value);
        if (value - even).abs() < 0.5 {
            return whole;
        }
    }
    // The value is half-way between two whole numbers or not below the limit. The
    // subtraction below is exact.
    let whole = value as i64;
    let rest = value - whole as f64;
    whole.saturating_add((rest + 0.5_f64.copysign(value)) as i64)
}

/// Rounds down to a whole number, like `value.floor() as i64`. Numbers outside `i64`
/// saturate; NaN gives 0.
///
/// This function needs no library call.
///
/// ```
/// for value in [0.0, -0.0, 0.5, -0.5, 3.0, -3.0, 1e300, -1e300, f64::NAN] {
///     assert_eq!(gsk_units::floor_to_i64(value), value.floor() as i64);
/// }
/// ```
#[inline]
pub fn floor_to_i64(value: f64) -> i64 {
    if value.abs() < MAX_SHIFTABLE {
        let (whole, even) = round_half_to_even(value);
        return whole - i64::from(value < even);
    }
    let whole = value as i64;
    whole.saturating_sub(i64::from(value < whole as f64))
}

/// Rounds to the nearest whole number, half away from zero, like `value.round()`, and keeps
/// the sign of zero. This function needs no library call.
#[inline]
pub fn round(value: f64) -> f64 {
    // The largest number below 0.5. A value just below a half plus this number stays below
    // 1; a half plus this number rounds to 1.
    const BELOW_HALF: f64 = 0.499_999_999_999_999_94;
    // From 2^52 on, every `f64` is a whole number.
    const ALL_WHOLE: f64 = 4_503_599_627_370_496.0;
    if value.abs() < ALL_WHOLE {
        let whole = (value + BELOW_HALF.copysign(value)) as i64;
        (whole as f64).copysign(value)
    } else {
        value
    }
}
