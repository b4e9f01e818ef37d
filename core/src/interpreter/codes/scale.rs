//! G31 and G30 of the Huaxing lathes: programmed lengths multiplied by L.
//!
//! ```text
//!   G31 L2                 from here on
//!   G01 X40 Z-10 F100      goes to X80 Z-20; F is what it is
//!   G02 X40 Z-20 I0 K-10   the centre is twice as far away, too
//!   G30                    no more
//! ```
//!
//! What is a length in millimetres is multiplied: X, Z, U, W, R, I, J, K, D and a lead.
//! What is no length is not: F, times, counts, threads an inch, numbers of relays and
//! offsets. G92 gives the tip the coordinates that it says.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::codes::miscellaneous;
use crate::interpreter::context::exact::{PER_MM, mm, scaled as times};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{LeadUnit, OneShot, Words};
use crate::model::Record;

/// Factors of L, in millionths.
const FACTORS: core::ops::RangeInclusive<i64> = 1_000..=99_999_000;

/// G31, or G30 where it is off.
///
/// # Errors
/// 043 without a factor, or with one that is none.
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

/// The words of a block under a factor, if one is in force.
pub(crate) fn applied(words: &Words, scale: Option<i64>, record: &Record) -> Words {
    match scale {
        Some(factor) => scaled(words, factor, record),
        None => *words,
    }
}

/// The words of a block under a factor in millionths.
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
