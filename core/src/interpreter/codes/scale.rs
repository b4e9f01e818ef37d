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
use crate::interpreter::exact::{UNITS_PER_MM, scale_rounded as times, to_mm};
use crate::interpreter::state::State;
use crate::interpreter::words::{LeadUnit, OneShot, SortedWords};
use crate::model::ModelRecord;

/// Allowed scale factors (L of G31), in millionths.
const FACTOR_RANGE: core::ops::RangeInclusive<i64> = 1_000..=99_999_000;

/// Stores the scale factor of a G31 (`on`) in the state, or clears it for a G30.
///
/// # Errors
/// 043 for a missing or wrong L of G31.
pub(crate) fn set_scale(state: &mut State, words: &SortedWords, on: bool) -> Result<(), Alarm> {
    if !on {
        state.scale = None;
        return Ok(());
    }
    let rule = match words.l_exact {
        Some(factor) if FACTOR_RANGE.contains(&factor) => {
            state.scale = Some(factor);
            return Ok(());
        }
        Some(factor) => say::scale_out_of_range(to_mm(factor)),
        None => say::scale_missing(),
    };
    Err(Alarm::new(number::OUT_OF_RANGE).with_detail(say::dialect_decided(rule)))
}

/// Returns the words of a block with the lengths multiplied by `scale` (in millionths);
/// unchanged for `None`.
pub(crate) fn apply_scale(
    words: &SortedWords,
    scale: Option<i64>,
    record: &ModelRecord,
) -> SortedWords {
    match scale {
        Some(factor) => scale_words(words, factor, record),
        None => *words,
    }
}

/// Returns the words of a block with the lengths multiplied by `factor` (in millionths).
pub(crate) fn scale_words(words: &SortedWords, factor: i64, record: &ModelRecord) -> SortedWords {
    if matches!(
        words.one_shot,
        Some(OneShot::Dwell | OneShot::Coordinates | OneShot::Scale { .. })
    ) {
        return *words;
    }
    let scale_length = |word: Option<i64>| word.map(|it| times(it, factor, UNITS_PER_MM));
    let is_per_inch = match words.one_shot {
        Some(OneShot::ThreadPass(unit) | OneShot::CountedThread(unit)) => {
            (false, unit == LeadUnit::PerInch)
        }
        Some(OneShot::RigidTap(unit)) => (unit == LeadUnit::PerInch, unit == LeadUnit::PerInch),
        _ => (false, false),
    };
    let scale_unless_count =
        |is_count: bool, word: Option<i64>| if is_count { word } else { scale_length(word) };
    SortedWords {
        x: scale_length(words.x),
        u: scale_length(words.u),
        z: scale_length(words.z),
        w: scale_length(words.w),
        r: scale_length(words.r),
        i: scale_unless_count(is_per_inch.0, words.i),
        j: scale_length(words.j),
        k: scale_unless_count(
            is_per_inch.1 || miscellaneous::is_k_number(words, record),
            words.k,
        ),
        p_exact: scale_length(words.p_exact),
        d_exact: scale_length(words.d_exact),
        ..*words
    }
}
