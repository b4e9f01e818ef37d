//! Lengths, points and planes: of X, Y and Z, and what a fourth and a fifth axis add.

use core::ops::{Add, Neg, Sub};

/// A length in whole nanometres: 0.001 mm and 0.0001 inch are both exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Length(i64);

/// Nanometres in a millimetre.
const PER_MM: f64 = 1e6;
/// Nanometres in the least increment, 0.001 mm.
const INCREMENT: i64 = 1000;

impl Length {
    /// None.
    pub const ZERO: Self = Self(0);

    /// Of so many nanometres, which are the millionths of a number in mm.
    pub const fn from_nm(nm: i64) -> Self {
        Self(nm)
    }

    /// Of so many least increments of 0.001 mm, as parameters hold them.
    pub const fn from_increments(increments: i64) -> Self {
        Self(increments.saturating_mul(INCREMENT))
    }

    /// The nearest one to a value in mm.
    pub fn from_mm(mm: f64) -> Self {
        Self(libm::round(mm * PER_MM) as i64)
    }

    /// In nanometres.
    pub const fn nm(self) -> i64 {
        self.0
    }

    /// In mm.
    pub const fn mm(self) -> f64 {
        self.0 as f64 / PER_MM
    }

    /// To the least increment of 0.001 mm, halves away from zero.
    #[must_use]
    pub const fn rounded(self) -> Self {
        let half = if self.0 < 0 {
            -INCREMENT / 2
        } else {
            INCREMENT / 2
        };
        Self(self.0.saturating_add(half) / INCREMENT * INCREMENT)
    }

    /// Its size.
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

/// An axis of the mill.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// The table, to and fro.
    X,
    /// The table, across.
    Y,
    /// The spindle.
    Z,
    /// The fourth axis: A, B or C, where the machine has it (1010, 1020).
    Fourth,
    /// The fifth one.
    Fifth,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::X, Self::Y, Self::Z, Self::Fourth, Self::Fifth];
    /// Those of the planes, which every machine has.
    pub const BASIC: [Self; 3] = [Self::X, Self::Y, Self::Z];
    /// Those that a machine may have besides.
    pub const FURTHER: [Self; 2] = [Self::Fourth, Self::Fifth];
}

/// A value of each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Each<T>(pub [T; 5]);

/// A point, or the way from one to another. What is a length of X, Y and Z is an angle of
/// an axis that turns: a degree in the place of a millimetre.
pub type Position = Each<Length>;

impl<T: Copy> Each<T> {
    /// Of X, Y and Z, and the same for both further axes.
    pub const fn basic([x, y, z]: [T; 3], further: T) -> Self {
        Self([x, y, z, further, further])
    }

    /// That of an axis.
    pub const fn get(&self, axis: Axis) -> T {
        self.0[axis as usize]
    }

    /// Gives an axis its value.
    pub const fn set(&mut self, axis: Axis, value: T) {
        self.0[axis as usize] = value;
    }
}

impl Position {
    /// X, Y and Z in mm.
    pub fn mm(&self) -> [f64; 3] {
        Axis::BASIC.map(|axis| self.get(axis).mm())
    }

    /// The same point with another X, Y and Z.
    #[must_use]
    pub(crate) fn with_basic(mut self, [x, y, z]: [Length; 3]) -> Self {
        for (axis, value) in Axis::BASIC.into_iter().zip([x, y, z]) {
            self.set(axis, value);
        }
        self
    }

    /// The same point with the further axes of another one.
    #[must_use]
    pub(crate) const fn turned_as(mut self, other: &Self) -> Self {
        self.set(Axis::Fourth, other.get(Axis::Fourth));
        self.set(Axis::Fifth, other.get(Axis::Fifth));
        self
    }

    /// Where it lies in a plane: along its first axis and its second, mm.
    pub fn flat(&self, plane: Plane) -> Flat {
        let [first, second, _] = plane.axes();
        Flat::new(self.get(first).mm(), self.get(second).mm())
    }

    /// The same point at another place of the plane, to the least increment.
    #[must_use]
    pub fn at(mut self, plane: Plane, flat: Flat) -> Self {
        let [first, second, _] = plane.axes();
        self.set(first, Length::from_mm(flat.first).rounded());
        self.set(second, Length::from_mm(flat.second).rounded());
        self
    }

    /// How far it is from another point along X, Y and Z, mm.
    pub fn distance(&self, other: &Self) -> f64 {
        let [x, y, z] = (*other - *self).mm();
        libm::sqrt(x * x + y * y + z * z)
    }
}

impl Add for Position {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|axis| self.0[axis] + other.0[axis]))
    }
}

impl Sub for Position {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(core::array::from_fn(|axis| self.0[axis] - other.0[axis]))
    }
}

/// The plane of arcs, rotation, cutter radius and holes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plane {
    /// G17.
    #[default]
    Xy,
    /// G18.
    Zx,
    /// G19.
    Yz,
}

impl Plane {
    /// Its first axis, its second, and the one across it.
    pub const fn axes(self) -> [Axis; 3] {
        match self {
            Self::Xy => [Axis::X, Axis::Y, Axis::Z],
            Self::Zx => [Axis::Z, Axis::X, Axis::Y],
            Self::Yz => [Axis::Y, Axis::Z, Axis::X],
        }
    }

    /// The axis across it.
    pub const fn across(self) -> Axis {
        self.axes()[2]
    }
}

/// A point in a plane, or the way from one to another, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flat {
    /// Along the first axis of the plane.
    pub first: f64,
    /// Along the second.
    pub second: f64,
}

impl Flat {
    /// Of both.
    pub const fn new(first: f64, second: f64) -> Self {
        Self { first, second }
    }

    /// Its length.
    pub fn length(self) -> f64 {
        libm::sqrt(self.first * self.first + self.second * self.second)
    }

    /// Multiplied.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self::new(self.first * factor, self.second * factor)
    }

    /// Turned by an angle, counter-clockwise. Quarter turns are exact.
    #[must_use]
    pub fn turned(self, degrees: f64) -> Self {
        let (sine, cosine) = sine_cosine(degrees);
        Self::new(
            self.first * cosine - self.second * sine,
            self.first * sine + self.second * cosine,
        )
    }

    /// The angle from here to another way in a sense, rad, 0 up to a full turn.
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

impl Add for Flat {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.first + other.first, self.second + other.second)
    }
}

impl Sub for Flat {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.first - other.first, self.second - other.second)
    }
}

/// Sine and cosine of an angle in degrees.
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
    fn angles_go_the_way_they_are_asked() {
        let (right, up) = (Flat::new(1.0, 0.0), Flat::new(0.0, 1.0));
        assert!((right.sweep(up, false).to_degrees() - 90.0).abs() < 1e-9);
        assert!((right.sweep(up, true).to_degrees() - 270.0).abs() < 1e-9);
        assert_eq!(right.turned(90.0), up);
    }
}
