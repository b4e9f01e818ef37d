//! Rates and directions of manual motion (manual III-4.1, III-6.1).

/// Jog rates of the override steps from 0 % to 150 %, mm/min (manual III-4.1.3).
const JOG_RATES: [f64; 16] = [
    0.0, 2.0, 3.2, 5.0, 7.9, 12.6, 20.0, 32.0, 50.0, 79.0, 126.0, 200.0, 320.0, 500.0, 790.0,
    1260.0,
];

/// Highest jog rate, mm/min; also the dry-run rate of cuts with 快速 on.
pub(crate) const JOG_RATE_MAX: f64 = JOG_RATES[15];

/// The jog rate for a code of G10 (0 = 150 % … 15 = 0 %), mm/min. For X the rate
/// applies to the radius.
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
    /// The direction of a signed distance; `None` if the distance is zero.
    pub(crate) fn from_distance(distance: f64) -> Option<Self> {
        match distance {
            d if d > 0.0 => Some(Self::Plus),
            d if d < 0.0 => Some(Self::Minus),
            _ => None,
        }
    }

    /// Returns a distance with the sign of this direction.
    pub(crate) const fn apply_sign(self, distance: f64) -> f64 {
        match self {
            Self::Plus => distance,
            Self::Minus => -distance,
        }
    }
}
