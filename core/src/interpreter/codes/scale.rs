//! G31 and G30 of the Huaxing lathes: scale programmed lengths by L.
//!
//! ```text
//!   G31 L2                 scale the following blocks by 2
//!   G01 X40 Z-10 F100      moves to X80 Z-20; F is not scaled
//!   G02 X40 Z-20 I0 K-10   the centre is twice as far away, too
//!   G30                    scaling off
//! ```
//!
//! X, Z, U, W, R, I, J, K, D and a lead are scaled. F, times, counts, threads per inch and the
//! numbers of relays and offsets are not. G92 sets coordinates as written.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::codes::miscellaneous;
use crate::interpreter::context::exact::{PER_MM, mm, scaled as times};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{LeadUnit, OneShot, Words};
use crate::model::Record;

/// Range of L, in millionths.
const FACTORS: core::ops::RangeInclusive<i64> = 1_000..=99_999_000;

/// Applies a G31 (`on`) or a G30 to the state.
///
/// # Errors
/// 043 for a missing or wrong L of G31.
pub(crate) fn set(state: &mut State, words: &Words, on: bool) -> Result<(), Alarm> {
    if !on {
        state.scale = None;
        return Ok(());
    }
    let rule = match words.l_exact {
        Some(factor) if FACTORS.contains(&factor) => {
            state.scale = Some(factor);
            return Ok(());
        }
        Some(factor) => say::scale_out_of_range(mm(factor)),
        None => say::scale_missing(),
    };
    Err(Alarm::new(number::OUT_OF_RANGE).because(say::dialect_decided(rule)))
}

/// The words of a block, scaled by the factor in force, if any.
pub(crate) fn applied(words: &Words, scale: Option<i64>, record: &Record) -> Words {
    match scale {
        Some(factor) => scaled(words, factor, record),
        None => *words,
    }
}

/// The words of a block, scaled by `factor` millionths.
pub(crate) fn scaled(words: &Words, factor: i64, record: &Record) -> Words {
    if matches!(
        words.one_shot,
        Some(OneShot::Dwell | OneShot::Coordinates | OneShot::Scale { .. })
    ) {
        return *words;
    }
    let length = |word: Option<i64>| word.map(|it| times(it, factor, PER_MM));
    let per_inch = match words.one_shot {
        Some(OneShot::ThreadPass(unit) | OneShot::CountedThread(unit)) => {
            (false, unit == LeadUnit::PerInch)
        }
        Some(OneShot::RigidTap(unit)) => (unit == LeadUnit::PerInch, unit == LeadUnit::PerInch),
        _ => (false, false),
    };
    let unless = |is_count: bool, word: Option<i64>| if is_count { word } else { length(word) };
    Words {
        x: length(words.x),
        u: length(words.u),
        z: length(words.z),
        w: length(words.w),
        r: length(words.r),
        i: unless(per_inch.0, words.i),
        j: length(words.j),
        k: unless(per_inch.1 || miscellaneous::takes_k(words, record), words.k),
        p_exact: length(words.p_exact),
        d_exact: length(words.d_exact),
        ..*words
    }
}
