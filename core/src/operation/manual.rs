//! Rates and directions of motion by hand (manual III-4.1, III-6.1).

/// Jog rates in mm/min by override step, 0 %…150 % (manual III-4.1.3).
const JOG_RATES: [f64; 16] = [
    0.0, 2.0, 3.2, 5.0, 7.9, 12.6, 20.0, 32.0, 50.0, 79.0, 126.0, 200.0, 320.0, 500.0, 790.0,
    1260.0,
];

/// Highest jog rate, mm/min: the dry-run rate of cuts with 快速 on.
pub(crate) const JOG_RATE_MAX: f64 = JOG_RATES[15];

/// The jog rate for a code of G10 (0 = 150 % … 15 = 0 %), mm/min. X moves at it
/// in radius.
pub fn jog_rate(code: u8) -> f64 {
    JOG_RATES[usize::from(15 - code.min(15))]
}

/// Which way a key drives an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Plus,
    Minus,
}

impl Direction {
    /// The way of a signed distance; none for zero.
    pub(crate) fn of(distance: f64) -> Option<Self> {
        match distance {
            d if d > 0.0 => Some(Self::Plus),
            d if d < 0.0 => Some(Self::Minus),
            _ => None,
        }
    }

    /// A distance this way, with its sign.
    pub(crate) const fn signed(self, distance: f64) -> f64 {
        match self {
            Self::Plus => distance,
            Self::Minus => -distance,
        }
    }
}
