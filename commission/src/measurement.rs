//! What a laser or a gauge has measured along an axis.

use gsk_core::units::Axis;

/// Slide travel from the machine zero, or along an axis, mm; X in radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Travel(pub f64);

/// By how much a slide is beyond where it should be, towards plus, µm of slide travel.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Deviation(pub f64);

/// The direction in which a target was approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Direction {
    /// Towards plus.
    Plus,
    /// Towards minus.
    Minus,
}

impl Direction {
    /// The one that this is not.
    pub const fn other(self) -> Self {
        match self {
            Self::Plus => Self::Minus,
            Self::Minus => Self::Plus,
        }
    }

    /// `+` or `-`.
    pub const fn sign(self) -> char {
        match self {
            Self::Plus => '+',
            Self::Minus => '-',
        }
    }
}

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The run it belongs to, from 1.
    pub run: u16,
    /// Where the slide was to be: machine coordinate.
    pub target: Travel,
    /// From where it came.
    pub direction: Direction,
    /// By how much it was beyond it.
    pub deviation: Deviation,
}

/// All readings of an axis, in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// The axis that the file names, if it does.
    pub axis: Option<Axis>,
    /// The readings.
    pub readings: Vec<Reading>,
}

impl Measurement {
    /// How many runs there are.
    pub fn runs(&self) -> usize {
        let mut runs: Vec<u16> = self.readings.iter().map(|it| it.run).collect();
        runs.sort_unstable();
        runs.dedup();
        runs.len()
    }

    /// Targets that are programmed diameters become slide travel.
    #[must_use]
    pub fn from_diameters(mut self) -> Self {
        for reading in &mut self.readings {
            reading.target.0 /= 2.0;
        }
        self
    }
}
