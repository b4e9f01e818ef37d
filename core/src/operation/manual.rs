//! Rates and directions of manual motion (manual III-4.1, III-6.1).

/// Jog rates by override step, 0 % to 150 %, mm/min (manual III-4.1.3).
const JOG_RATES: [f64; 16] = [
    0.0, 2.0, 3.2, 5.0, 7.9, 12.6, 20.0, 32.0, 50.0, 79.0, 126.0, 200.0, 320.0, 500.0, 790.0,
    1260.0,
];

/// Highest jog rate, mm/min: the dry-run rate of cuts with 快速 on.
pub(crate) const JOG_RATE_MAX: f64 = JOG_RATES[15];

/// The jog rate for a code of G10 (0 = 150 % … 15 = 0 %), mm/min. X moves at this rate in
/// radius.
pub fn jog_rate(code: u8) -> f64 {
    JOG_RATES[usize::from(15 - code.min(15))]
}

/// Direction in which a key moves an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AxisDirection {
    Plus,
    Minus,
}

impl AxisDirection {
    /// The direction of a signed distance; `None` for zero.
    pub(crate) fn from_distance(distance: f64) -> Option<Self> {
        match distance {
            d if d > 0.0 => Some(Self::Plus),
            d if d < 0.0 => Some(Self::Minus),
            _ => None,
        }
    }

    /// Gives a distance the sign of this direction.
    pub(crate) const fn apply_sign(self, distance: f64) -> f64 {
        match self {
            Self::Plus => distance,
            Self::Minus => -distance,
        }
    }
}
