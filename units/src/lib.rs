//! Units that cross a boundary: diameter and radius, millimetres and pulses,
//! feed per minute and feed per revolution never share a bare number. The numbers of
//! the alarms cross it too, by name.

use core::fmt;
use core::ops::{Add, Mul, Neg, Sub};

use glam::DVec2;
use serde::{Deserialize, Serialize};

mod finite;

pub use finite::{NonFinite, find_non_finite, parse_finite};

/// Numbers of the alarms that the sources name, from the `id` column of
/// `assets/tables/alarms.tsv`.
pub mod alarm {
    include!(concat!(env!("OUT_DIR"), "/alarm_numbers.rs"));
}

/// The two controlled axes of the lathe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Axis {
    /// Cross slide, perpendicular to the spindle.
    X,
    /// Carriage, parallel to the spindle.
    Z,
}

impl Axis {
    /// The one that this is not.
    pub const fn other(self) -> Self {
        match self {
            Self::X => Self::Z,
            Self::Z => Self::X,
        }
    }
}

/// One value for each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PerAxis<T> {
    /// The X value.
    pub x: T,
    /// The Z value.
    pub z: T,
}

impl<T> PerAxis<T> {
    /// Both values.
    pub const fn new(x: T, z: T) -> Self {
        Self { x, z }
    }

    /// The value of one axis.
    pub const fn get(&self, axis: Axis) -> &T {
        match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
        }
    }

    /// The value of one axis, to be changed.
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

/// A point or displacement in the working plane.
///
/// `x` is a *radius* in mm, always; diameters exist in program words and on
/// displays only ([`Diameter`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Distance from the spindle axis (radius), mm.
    pub x: f64,
    /// Position along the spindle axis, mm.
    pub z: f64,
}

impl Point {
    /// A point from a radius and a Z, mm.
    pub const fn new(x: f64, z: f64) -> Self {
        Self { x, z }
    }

    /// A point from a diameter and a Z.
    pub const fn from_diameter(x: Diameter, z: f64) -> Self {
        Self { x: x.0 / 2.0, z }
    }

    /// The X as a diameter.
    pub const fn diameter(self) -> Diameter {
        Diameter(self.x * 2.0)
    }

    /// As a vector of the working plane, Z to the right and X up:
    ///
    /// ```text
    ///   X (radius)
    ///   ^   left(t)        cross(t, left(t)) > 0: counter-clockwise
    ///   |     |
    ///   |     +----> t
    ///   +-----------------> Z
    /// ```
    pub const fn vector(self) -> DVec2 {
        DVec2::new(self.z, self.x)
    }

    /// The point of a vector of the working plane.
    pub(crate) const fn from_vector(vector: DVec2) -> Self {
        Self::new(vector.y, vector.x)
    }

    /// The distance from the origin, mm.
    pub fn length(self) -> f64 {
        self.vector().length()
    }

    /// The scalar product with another displacement, mm².
    pub fn dot(self, other: Self) -> f64 {
        self.vector().dot(other.vector())
    }

    /// The cross product with another displacement, mm²: greater than 0 when the other
    /// lies counter-clockwise of this one, Z to the right and X up.
    pub fn cross(self, other: Self) -> f64 {
        self.vector().perp_dot(other.vector())
    }

    /// A quarter turn counter-clockwise.
    #[must_use]
    pub fn left(self) -> Self {
        Self::from_vector(self.vector().perp())
    }

    /// The direction of a displacement, of length 1; `None` without one.
    pub fn unit(self) -> Option<Self> {
        self.vector().try_normalize().map(Self::from_vector)
    }

    /// The coordinate of one axis (X as a radius), mm.
    pub const fn get(self, axis: Axis) -> f64 {
        match axis {
            Axis::X => self.x,
            Axis::Z => self.z,
        }
    }

    /// The coordinate of one axis (X as a radius), to be changed.
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

/// From the centre of a tool's nose to its imaginary tip, as signs of X and Z, by the
/// number of the offset table.
///
/// ```text
///   X ^    2   6   1        The number says in which direction the imaginary
///     |      \\ | /          tip lies, seen from the centre of the nose;
///     |    7 - o - 5        0 and 9: the tip is the centre.
///     |      / | \\
///     |    3   8   4        tip = centre + |R| * direction
///     +--------------> Z
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

/// An X value as program words and displays give it: mm of diameter.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Diameter(pub f64);

impl Diameter {
    /// The same X as a radius, mm.
    pub const fn radius(self) -> f64 {
        self.0 / 2.0
    }
}

/// A commanded feed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Feed {
    /// mm per minute (G98).
    PerMinute(f64),
    /// mm per spindle revolution (G99).
    PerRevolution(f64),
}

/// Drive pulses of one axis, counted from the machine zero.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub struct Pulses(pub i64);

/// Milliseconds of machine time in one interpolation tick.
pub const TICK_MS: u32 = 1;

/// Seconds of machine time in one interpolation tick.
pub const TICK_S: f64 = 0.001;

/// Every per cent of a byte as a factor.
static FACTORS: [f64; 256] = {
    let mut factors = [0.0; 256];
    let mut percent = 0;
    while percent < factors.len() {
        factors[percent] = percent as f64 / 100.0;
        percent += 1;
    }
    factors
};

/// Per cent as a factor. The division was made beforehand: it takes as long as ten sums,
/// and overrides are asked for every tick.
#[inline]
pub fn factor(percent: u8) -> f64 {
    FACTORS[usize::from(percent)]
}

/// The smaller of two numbers, neither of them NaN: one instruction, where `min` also looks
/// for NaN.
#[inline]
pub const fn lesser(one: f64, other: f64) -> f64 {
    if one < other { one } else { other }
}

/// The greater of two numbers, neither of them NaN.
#[inline]
pub const fn greater(one: f64, other: f64) -> f64 {
    if one > other { one } else { other }
}

/// What a number below [`SHIFTABLE`] is added to for its whole part: 1.5 · 2^52. The sum
/// has no bits left for a fraction, it is rounded to a whole number (a half to the even
/// one), which stands in its lowest bits.
const SHIFT: f64 = 6_755_399_441_055_744.0;

/// 2^51.
const SHIFTABLE: f64 = 2_251_799_813_685_248.0;

/// A number below [`SHIFTABLE`] rounded to a whole one, halves to the even one, as `i64`
/// and as `f64`: without a conversion, which asks what is beyond an `i64`.
#[inline]
const fn to_even(value: f64) -> (i64, f64) {
    let shifted = value + SHIFT;
    let whole = shifted.to_bits() as i64 - SHIFT.to_bits() as i64;
    (whole, shifted - SHIFT)
}

/// The nearest whole number, halves away from zero: `value.round() as i64` without the call
/// that `round` is where the processor cannot be asked for it.
///
/// ```
/// for value in [0.0, 0.5, 1.5, 2.5, 0.49999999999999994, 2.4, 2.6, 4503599627370494.5, 1e300] {
///     assert_eq!(gsk_units::nearest(value), value.round() as i64);
///     assert_eq!(gsk_units::nearest(-value), (-value).round() as i64);
/// }
/// assert_eq!(gsk_units::nearest(f64::NAN), 0);
/// ```
#[inline]
pub fn nearest(value: f64) -> i64 {
    if value.abs() < SHIFTABLE {
        let (whole, even) = to_even(value);
        if (value - even).abs() < 0.5 {
            return whole;
        }
    }
    // A half, or beyond. The rest is exact.
    let whole = value as i64;
    let rest = value - whole as f64;
    whole.saturating_add((rest + 0.5_f64.copysign(value)) as i64)
}

/// The whole number at or below: `value.floor() as i64`, without the call.
///
/// ```
/// for value in [0.0, -0.0, 0.5, -0.5, 3.0, -3.0, 1e300, -1e300, f64::NAN] {
///     assert_eq!(gsk_units::floor(value), value.floor() as i64);
/// }
/// ```
#[inline]
pub fn floor(value: f64) -> i64 {
    if value.abs() < SHIFTABLE {
        let (whole, even) = to_even(value);
        return whole - i64::from(value < even);
    }
    let whole = value as i64;
    whole.saturating_sub(i64::from(value < whole as f64))
}

/// The nearest whole number, halves away from zero: `value.round()`, its sign of zero and
/// all, without the call.
#[inline]
pub fn round(value: f64) -> f64 {
    // The last number below a half: what is added to a value just below a half does not
    // reach 1, to a half it does.
    const BELOW_HALF: f64 = 0.499_999_999_999_999_94;
    // Beyond, every number is a whole one.
    const ALL_WHOLE: f64 = 4_503_599_627_370_496.0;
    if value.abs() < ALL_WHOLE {
        let whole = (value + BELOW_HALF.copysign(value)) as i64;
        (whole as f64).copysign(value)
    } else {
        value
    }
}
