//! Calls of subprograms by M, S and T codes without a function of their own on this machine,
//! when 006.5 CM98 is on (manual I-3.3, III-11.1).
//!
//! ```text
//!   M61  O9061      any M without a function
//!   S21  O9121      S10–S99 of the stepped spindle (001.4 = 0)
//!   T15  O9215      T10–T99 of two digits
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::interpreter::codes::miscellaneous;
use crate::interpreter::context::BlockContext;
use crate::interpreter::flow::code_calls::PlainCall;
use crate::interpreter::words::{OneShot, SortedWords};

/// S and T codes that may call a subprogram.
const CALLING_CODES: core::ops::RangeInclusive<i64> = 10..=99;

/// A subprogram call by an M, S or T word. `address` and `code` are the letter and the number
/// of that word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SpecialCall {
    pub(crate) program: u16,
    pub(crate) address: char,
    pub(crate) code: i64,
    /// Number of times that the subprogram runs, at least 1.
    pub(crate) runs: u16,
    /// Whether codes that call by parameters of macro B are ordinary codes in the subprogram,
    /// which call no program.
    pub(crate) codes_ordinary: bool,
}

/// Allowed values of L, the number of runs, in a call by a parameter of macro B.
const RUN_RANGE: core::ops::RangeInclusive<i64> = 1..=9999;

impl SpecialCall {
    /// Copies the words of the block without the calling word, and without the L of a call by
    /// a parameter of macro B.
    pub(crate) const fn without_calling_word(self, words: &SortedWords) -> SortedWords {
        let mut words = *words;
        match self.address {
            'M' => {
                words.m = None;
                if self.codes_ordinary {
                    words.l = None;
                }
            }
            'S' => words.s = None,
            _ => words.t = None,
        }
        words
    }
}

/// The call that a block makes by its M, S or T word; `None` if it makes none.
///
/// # Errors
/// 012 for two calls in a block, 043 for a wrong count of runs, or an alarm for a call from
/// the MDI page.
pub(crate) fn find(
    words: &SortedWords,
    context: &BlockContext<'_>,
) -> Result<Option<SpecialCall>, Alarm> {
    if let Some(calls) = context.code_calls
        && let Some(call) = calls.find_subprogram(words)
    {
        return from_parameter_call(call, words).map(Some);
    }
    if !context.parameters.special_codes_call() {
        return Ok(None);
    }
    let m = words
        .m
        .filter(|code| !miscellaneous::has_function(*code, context))
        .map(i64::from);
    // S of G50 is a speed limit.
    let is_stepped = !context.parameters.has_analog_spindle()
        && words.one_shot != Some(OneShot::Coordinates)
        && words.s_digits <= 2;
    let s = words.s.filter(|s| is_stepped && CALLING_CODES.contains(s));
    let t = words
        .t
        .filter(|t| words.t_digits <= 2 && CALLING_CODES.contains(t));
    if context.is_mdi {
        return mdi_alarm(m, s, t).map_or(Ok(None), Err);
    }
    let mut call = None;
    for (address, first, code) in [('M', 9000, m), ('S', 9100, s), ('T', 9200, t)] {
        let Some(code) = code else { continue };
        if call.is_some() || (address != 'M' && matches!(words.m, Some(30 | 98 | 99))) {
            return Err(Alarm::new(number::TOO_MANY_WORDS)
                .with_detail(say::call_twice_in_block(address, code)));
        }
        call = Some(SpecialCall {
            program: first + code as u16,
            address,
            code,
            runs: 1,
            codes_ordinary: false,
        });
    }
    Ok(call)
}

/// Completes a call by the parameters 240 to 243 of macro B: L is the number of runs of a call by
/// M; a T calls once. Returns an alarm as error if L is out of range.
fn from_parameter_call(call: PlainCall, words: &SortedWords) -> Result<SpecialCall, Alarm> {
    let PlainCall {
        program,
        address,
        code,
    } = call;
    let runs = match words.l {
        Some(runs) if address == 'M' => runs,
        _ => 1,
    };
    if !RUN_RANGE.contains(&runs) {
        let detail = say::macro_runs_out_of_range(runs, *RUN_RANGE.end());
        return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
    }
    Ok(SpecialCall {
        program,
        address,
        code,
        runs: runs as u16,
        codes_ordinary: true,
    })
}

/// The alarm for a call by an M, S or T code from the MDI page, which may call nothing; `None`
/// without such a code.
fn mdi_alarm(m: Option<i64>, s: Option<i64>, t: Option<i64>) -> Option<Alarm> {
    let (number, name, code) = match (m, s, t) {
        (Some(m), ..) => (number::BAD_M, 'M', m),
        (_, Some(s), _) => (number::BAD_VALUE, 'S', s),
        (_, _, Some(t)) => (number::BAD_TOOL, 'T', t),
        _ => return None,
    };
    let detail = say::call_in_mdi(name, code);
    Some(Alarm::new(number).with_detail(detail))
}
