//! Position deviations along an axis, measured with a laser or a gauge.

use gsk_core::units::Axis;

/// Slide travel in mm: a position relative to the machine zero, or a distance. X is a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct SlideTravel(pub f64);

/// Position deviation of a slide in µm: actual minus target position, X as a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct AxisDeviation(pub f64);

/// Direction in which a target position was approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ApproachDirection {
    /// The slide moved towards plus.
    Plus,
    /// The slide moved towards minus.
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

    /// Returns the sign of the direction, `+` or `-`.
    pub const fn sign(self) -> char {
        match self {
            Self::Plus => '+',
            Self::Minus => '-',
        }
    }
}

/// One measured position deviation of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisReading {
    /// Number of the measuring run, from 1.
    pub run: u16,
    /// Target position in machine coordinates, mm.
    pub target: SlideTravel,
    /// Direction in which the target was approached.
    pub direction: ApproachDirection,
    /// Actual minus target position, µm.
    pub deviation: AxisDeviation,
}

/// All readings of an axis in the order of measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// Axis that the file names; `None` if it names none.
    pub axis: Option<Axis>,
    /// The readings in the order of measurement.
    pub readings: Vec<AxisReading>,
}

impl Measurement {
    /// Returns the number of different runs.
    pub fn runs(&self) -> usize {
        let mut runs: Vec<u16> = self.readings.iter().map(|it| it.run).collect();
        runs.sort_unstable();
        runs.dedup();
        runs.len()
    }

    /// Returns the measurement with its targets halved: from programmed diameters to slide
    /// travel.
    #[must_use]
    pub fn from_diameters(mut self) -> Self {
        for reading in &mut self.readings {
            reading.target.0 /= 2.0;
        }
        self
    }
}
