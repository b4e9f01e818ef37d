//! G04: dwell and exact stop (manual I-3.2.3).
//!
//! ```text
//!   G04 P1500   1500 ms      P before X before U; none of them: exact stop,
//!   G04 X1.5    1.5 s        the next block begins when the axes stand
//!   G04 U1.5    1.5 s
//! ```

use crate::command::Action;
use crate::interpreter::exact::PER_MM;
use crate::interpreter::words::Words;

/// The wait of a G04 block; a negative time is none.
pub(crate) fn dwell(words: &Words) -> Action {
    let ms = match (words.p, words.x.or(words.u)) {
        (Some(p), _) => p,
        (None, Some(seconds)) => (seconds.saturating_mul(1000) + PER_MM / 2) / PER_MM,
        (None, None) => 0,
    };
    Action::Dwell {
        ms: u32::try_from(ms.max(0)).unwrap_or(u32::MAX),
    }
}
