//! Position deviations along an axis, measured with a laser or a gauge.

use gsk_core::units::Axis;

/// Slide travel in mm: a position relative to the machine zero, or a distance. X is a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct SlideTravel(pub f64);

/// Position deviation of a slide in µm: actual minus target position, X as a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct AxisDeviation(pub f64);

/// Direction in which a target was approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ApproachDirection {
    /// Motion towards plus.
    Plus,
    /// Motion towards minus.
    Minus,
}

impl ApproachDirection {
    /// Returns the opposite direction.
    pub const fn other(self) -> Self {
        match self {
            Self::Plus => Self::Minus,
            Self::Minus => Self::Plus,
        }
    }

    /// Returns `+` or `-`.
    pub const fn sign(self) -> char {
        match self {
            Self::Plus => '+',
            Self::Minus => '-',
        }
    }
}

/// One measured position deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisReading {
    /// Number of the run, from 1.
    pub run: u16,
    /// Target position in machine coordinates.
    pub target: SlideTravel,
    /// Direction of the approach.
    pub direction: ApproachDirection,
    /// Actual minus target position.
    pub deviation: AxisDeviation,
}

/// All readings of an axis in the order of measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// Axis from the file; `None` if the file names none.
    pub axis: Option<Axis>,
    /// The readings.
    pub readings: Vec<AxisReading>,
}

impl Measurement {
    /// Counts the runs.
    pub fn runs(&self) -> usize {
        let mut runs: Vec<u16> = self.readings.iter().map(|it| it.run).collect();
        runs.sort_unstable();
        runs.dedup();
        runs.len()
    }

    /// Converts targets from programmed diameters to slide travel.
    #[must_use]
    pub fn from_diameters(mut self) -> Self {
        for reading in &mut self.readings {
            reading.target.0 /= 2.0;
        }
        self
    }
}
