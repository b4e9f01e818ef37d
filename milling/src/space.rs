//! Defines lengths, points and planes in X, Y and Z with a fourth and a fifth axis.

use core::ops::{Add, Neg, Sub};

/// A length in whole nanometres. 0.001 mm and 0.0001 inch are both exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Length(i64);

/// Number of nanometres in a millimetre.
const PER_MM: f64 = 1e6;
/// Number of nanometres in the least increment, 0.001 mm.
const INCREMENT: i64 = 1000;

impl Length {
    /// A length of 0.
    pub const ZERO: Self = Self(0);

    /// Creates a length from nanometres.
    pub const fn from_nm(nm: i64) -> Self {
        Self(nm)
    }

    /// Creates a length from increments of 0.001 mm, the unit of parameters of a metric machine.
    pub const fn from_increments(increments: i64) -> Self {
        Self(increments.saturating_mul(INCREMENT))
    }

    /// Creates the length nearest to a value in mm.
    pub fn from_mm(mm: f64) -> Self {
        Self(libm::round(mm * PER_MM) as i64)
    }

    /// Returns the length in nanometres.
    pub const fn nm(self) -> i64 {
        self.0
    }

    /// Returns the length in mm.
    pub const fn mm(self) -> f64 {
        self.0 as f64 / PER_MM
    }

    /// Returns the length rounded to 0.001 mm, halves away from zero.
    #[must_use]
    pub const fn rounded(self) -> Self {
        self.rounded_to(INCREMENT)
    }

    /// Returns the length rounded to a multiple of `increment` nanometres, which is positive,
    /// halves away from zero.
    #[must_use]
    pub(crate) const fn rounded_to(self, increment: i64) -> Self {
        let half = if self.0 < 0 {
            -increment / 2
        } else {
            increment / 2
        };
        Self(self.0.saturating_add(half) / increment * increment)
    }

    /// Returns the length without its sign.
    #[must_use]
    pub const fn abs(self) -> Self {
        Self(self.0.saturating_abs())
    }
}

impl Add for Length {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Length {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Length {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

/// An axis of the mill. The value is the index in [`AxisValues`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MillAxis {
    /// The axis that moves the table left and right.
    X,
    /// The axis that moves the table forward and back.
    Y,
    /// The axis that moves the spindle.
    Z,
    /// The fourth axis: A, B or C, if the machine has it (1010, 1020).
    Fourth,
    /// The fifth axis: A, B or C, if the machine has it.
    Fifth,
}

impl MillAxis {
    /// All axes that a mill can have.
    pub const ALL: [Self; 5] = [Self::X, Self::Y, Self::Z, Self::Fourth, Self::Fifth];
    /// The axes X, Y and Z, which every machine has.
    pub const BASIC: [Self; 3] = [Self::X, Self::Y, Self::Z];
    /// The fourth and the fifth axis.
    pub const FURTHER: [Self; 2] = [Self::Fourth, Self::Fifth];
}

/// A value for each axis, in the order of [`MillAxis`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxisValues<T>(pub [T; 5]);

/// A point, or a distance between points. A rotary axis counts a degree as a millimetre.
pub type MillPosition = AxisValues<Length>;

impl<T: Copy> AxisValues<T> {
    /// Creates values from those of X, Y and Z, and one value for both the fourth and fifth
    /// axis.
    pub const fn basic([x, y, z]: [T; 3], further: T) -> Self {
        Self([x, y, z, further, further])
    }

    /// Returns the value that belongs to an axis.
    pub const fn get(&self, axis: MillAxis) -> T {
        self.0[axis as usize]
    }

    /// Sets the value that belongs to an axis.
    pub const fn set(&mut self, axis: MillAxis, value: T) {
        self.0[axis as usize] = value;
    }
}

impl MillPosition {
    /// Returns X, Y and Z of the point in mm.
    pub fn mm(&self) -> [f64; 3] {
        MillAxis::BASIC.map(|axis| self.get(axis).mm())
    }

    /// Returns the point with X, Y and Z replaced by these values.
    #[must_use]
    pub(crate) fn with_basic(mut self, [x, y, z]: [Length; 3]) -> Self {
        for (axis, value) in MillAxis::BASIC.into_iter().zip([x, y, z]) {
            self.set(axis, value);
        }
        self
    }

    /// Returns the point with its fourth and fifth axis replaced by those of `other`.
    #[must_use]
    pub(crate) const fn with_further_of(mut self, other: &Self) -> Self {
        self.set(MillAxis::Fourth, other.get(MillAxis::Fourth));
        self.set(MillAxis::Fifth, other.get(MillAxis::Fifth));
        self
    }

    /// Returns the point's coordinates along the first and second axis of a plane, mm.
    pub fn flat(&self, plane: Plane) -> PlanePoint {
        let [first, second, _] = plane.axes();
        PlanePoint::new(self.get(first).mm(), self.get(second).mm())
    }

    /// Returns the distance to another point along X, Y and Z, mm.
    pub fn distance(&self, other: &Self) -> f64 {
        let [x, y, z] = (*other - *self).mm();
        libm::sqrt(x * x + y * y + z * z)
    }
}

impl Add for MillPosition {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|axis| self.0[axis] + other.0[axis]))
    }
}

impl Sub for MillPosition {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(core::array::from_fn(|axis| self.0[axis] - other.0[axis]))
    }
}

/// The plane in which arcs, rotation and cutter compensation act. Holes are made across it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plane {
    /// The plane of X and Y (G17).
    #[default]
    Xy,
    /// The plane of Z and X (G18).
    Zx,
    /// The plane of Y and Z (G19).
    Yz,
}

impl Plane {
    /// Returns the first and second axis of the plane, and the axis perpendicular to it.
    pub const fn axes(self) -> [MillAxis; 3] {
        match self {
            Self::Xy => [MillAxis::X, MillAxis::Y, MillAxis::Z],
            Self::Zx => [MillAxis::Z, MillAxis::X, MillAxis::Y],
            Self::Yz => [MillAxis::Y, MillAxis::Z, MillAxis::X],
        }
    }

    /// Returns the axis perpendicular to the plane.
    pub const fn across(self) -> MillAxis {
        self.axes()[2]
    }
}

/// A point in a plane, or the displacement between two points, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanePoint {
    /// Coordinate along the first axis of the plane, mm.
    pub first: f64,
    /// Coordinate along the second axis of the plane, mm.
    pub second: f64,
}

impl PlanePoint {
    /// Creates a point from its first and second coordinate, mm.
    pub const fn new(first: f64, second: f64) -> Self {
        Self { first, second }
    }

    /// Returns the distance of the point from the origin, mm.
    pub fn length(self) -> f64 {
        libm::sqrt(self.first * self.first + self.second * self.second)
    }

    /// Returns the point with both coordinates multiplied by a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self::new(self.first * factor, self.second * factor)
    }

    /// Returns the point rotated counter-clockwise about the origin by `degrees`. Quarter
    /// turns are exact.
    #[must_use]
    pub fn rotated(self, degrees: f64) -> Self {
        let (sine, cosine) = sine_cosine(degrees);
        Self::new(
            self.first * cosine - self.second * sine,
            self.first * sine + self.second * cosine,
        )
    }

    /// Returns the angle from this direction to `other`, clockwise or counter-clockwise, rad,
    /// from 0 to below a full turn.
    pub fn sweep(self, other: Self, clockwise: bool) -> f64 {
        let cross = self.first * other.second - self.second * other.first;
        let dot = self.first * other.first + self.second * other.second;
        let angle = libm::atan2(cross, dot) * if clockwise { -1.0 } else { 1.0 };
        if angle < 0.0 {
            angle + core::f64::consts::TAU
        } else {
            angle
        }
    }
}

impl Add for PlanePoint {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.first + other.first, self.second + other.second)
    }
}

impl Sub for PlanePoint {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.first - other.first, self.second - other.second)
    }
}

/// Returns the sine and the cosine of an angle in degrees. Quarter turns are exact.
pub fn sine_cosine(degrees: f64) -> (f64, f64) {
    let turned = degrees.rem_euclid(360.0);
    if turned == 0.0 {
        (0.0, 1.0)
    } else if turned == 90.0 {
        (1.0, 0.0)
    } else if turned == 180.0 {
        (0.0, -1.0)
    } else if turned == 270.0 {
        (-1.0, 0.0)
    } else {
        let angle = turned.to_radians();
        (libm::sin(angle), libm::cos(angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn increments_of_both_systems_are_exact() {
        assert_eq!(Length::from_mm(0.001), Length::from_increments(1));
        assert_eq!(Length::from_mm(0.00254), Length::from_nm(2540));
        assert_eq!(Length::from_nm(1500).rounded(), Length::from_increments(2));
        assert_eq!(
            Length::from_nm(-1500).rounded(),
            Length::from_increments(-2)
        );
    }

    #[test]
    fn planes_are_right_handed() {
        let sense = |plane: Plane| {
            let [a, b, c] = plane.axes().map(|axis| axis as usize);
            [(a, b, c)].contains(&(a, (a + 1) % 3, (a + 2) % 3)) && b == (a + 1) % 3
        };
        assert!([Plane::Xy, Plane::Zx, Plane::Yz].into_iter().all(sense));
    }

    #[test]
    fn a_sweep_takes_its_direction() {
        let (right, up) = (PlanePoint::new(1.0, 0.0), PlanePoint::new(0.0, 1.0));
        assert!((right.sweep(up, false).to_degrees() - 90.0).abs() < 1e-9);
        assert!((right.sweep(up, true).to_degrees() - 270.0).abs() < 1e-9);
        assert_eq!(right.rotated(90.0), up);
    }
}
