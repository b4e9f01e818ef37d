//! Reads the thread lead of the Huaxing lathes: K (G33, G86) or P in mm, K threads per inch
//! (G34, G87); for taps K in mm (G84), I or K threads per inch (G85).

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::context::exact::mm;
use crate::interpreter::context::words::{LeadUnit, Words};
use crate::interpreter::threads::thread::{LEADS, MM_PER_INCH, PER_INCH};

/// The lead of a thread block, mm per revolution. `code` is its G code, for messages.
///
/// # Errors
/// 011 without a lead, 043 for a lead out of range.
pub(crate) fn lead(words: &Words, unit: LeadUnit, code: u8) -> Result<f64, Alarm> {
    let given = match unit {
        LeadUnit::Millimetres => words.k.or(words.p_exact),
        LeadUnit::PerInch => words.k,
    };
    of(given, unit, code)
}

/// The lead of a tap block, mm per revolution; I may hold its threads per inch.
///
/// # Errors
/// As for [`lead`].
pub(crate) fn tap_lead(words: &Words, unit: LeadUnit, code: u8) -> Result<f64, Alarm> {
    match unit {
        LeadUnit::Millimetres => lead(words, unit, code),
        LeadUnit::PerInch => of(words.i.or(words.k), unit, code),
    }
}

fn of(given: Option<i64>, unit: LeadUnit, code: u8) -> Result<f64, Alarm> {
    let Some(value) = given else {
        let missing = match unit {
            LeadUnit::Millimetres => say::thread_word_lead_missing(code),
            LeadUnit::PerInch => say::thread_word_per_inch_missing(code),
        };
        return Err(Alarm::new(number::NO_FEED).because(say::dialect_decided(missing)));
    };
    let (lead, fits) = match unit {
        LeadUnit::Millimetres => (mm(value), LEADS.contains(&mm(value))),
        LeadUnit::PerInch => (MM_PER_INCH / mm(value), PER_INCH.contains(&value)),
    };
    match fits {
        true => Ok(lead),
        false => {
            let rule = match unit {
                LeadUnit::Millimetres => say::thread_word_lead_out_of_range(code, mm(value)),
                LeadUnit::PerInch => say::thread_word_per_inch_out_of_range(code, mm(value)),
            };
            Err(Alarm::new(number::OUT_OF_RANGE).because(rule))
        }
    }
}
