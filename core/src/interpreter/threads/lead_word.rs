//! Reads the thread lead of the Huaxing lathes: K (G33, G86) or P in mm, K threads per inch
//! (G34, G87); for taps K in mm (G84), I or K threads per inch (G85).

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::exact::to_mm;
use crate::interpreter::threads::thread::{LEAD_RANGE_MM, MM_PER_INCH, PER_INCH_RANGE};
use crate::interpreter::words::{LeadUnit, SortedWords};

/// Reads the lead of a thread block, mm per revolution. `code` is the G code of the block, for
/// messages.
///
/// # Errors
/// 011 without a lead, 043 for a lead out of range.
pub(crate) fn read_lead(words: &SortedWords, unit: LeadUnit, code: u8) -> Result<f64, Alarm> {
    let given = match unit {
        LeadUnit::Millimetres => words.k.or(words.p_exact),
        LeadUnit::PerInch => words.k,
    };
    check_lead(given, unit, code)
}

/// Reads the lead of a tapping block, mm per revolution. I, or else K, holds threads per inch.
///
/// # Errors
/// As for [`read_lead`].
pub(crate) fn read_tap_lead(words: &SortedWords, unit: LeadUnit, code: u8) -> Result<f64, Alarm> {
    match unit {
        LeadUnit::Millimetres => read_lead(words, unit, code),
        LeadUnit::PerInch => check_lead(words.i.or(words.k), unit, code),
    }
}

fn check_lead(given: Option<i64>, unit: LeadUnit, code: u8) -> Result<f64, Alarm> {
    let Some(value) = given else {
        let missing = match unit {
            LeadUnit::Millimetres => say::thread_word_lead_missing(code),
            LeadUnit::PerInch => say::thread_word_per_inch_missing(code),
        };
        return Err(Alarm::new(number::NO_FEED).with_detail(say::dialect_decided(missing)));
    };
    let (lead, is_in_range) = match unit {
        LeadUnit::Millimetres => (to_mm(value), LEAD_RANGE_MM.contains(&to_mm(value))),
        LeadUnit::PerInch => (MM_PER_INCH / to_mm(value), PER_INCH_RANGE.contains(&value)),
    };
    match is_in_range {
        true => Ok(lead),
        false => {
            let rule = match unit {
                LeadUnit::Millimetres => say::thread_word_lead_out_of_range(code, to_mm(value)),
                LeadUnit::PerInch => say::thread_word_per_inch_out_of_range(code, to_mm(value)),
            };
            Err(Alarm::new(number::OUT_OF_RANGE).with_detail(rule))
        }
    }
}
