//! G40, G41, G42: what a block must not say while the compensation acts (manual II, C
//! compensation).

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::compensation::{Fault, check_arc};
use crate::interpreter::context::exact::{Exact, PER_MM};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{ArcWords, Words};
use crate::interpreter::context::{Compensated, Context};
use crate::memory::Parameters;
use crate::units::Point;

/// G41 and G42 are an option (002.1): alarm 010 without it.
pub(crate) fn check_option(words: &Words, parameters: &Parameters) -> Result<(), Alarm> {
    match words.nose {
        Some(code @ (41 | 42)) if !parameters.has_nose_compensation() => {
            Err(Alarm::new(number::BAD_G).because(say::nose_not_installed(code)))
        }
        _ => Ok(()),
    }
}

/// Arcs start and cancel nothing (034, 056), and their data must be good (048,
/// 051, 052).
pub(crate) fn check_arc_block(
    state: &State,
    compensated: Compensated,
    end: Exact,
    words: ArcWords,
) -> Result<(), Alarm> {
    let start = state.position;
    let stands = words.r.is_some() && start == end;
    let fault = match compensated {
        _ if stands => None,
        Compensated::Never => None,
        Compensated::Off => state.compensates().then_some(Fault::StartOnArc),
        Compensated::On if state.modal.nose_compensation == 40 => Some(Fault::CancelOnArc),
        Compensated::On => check_center(start, end, words).err(),
    };
    fault.map_or(Ok(()), |fault| Err(fault.alarm()))
}

fn check_center(start: Exact, end: Exact, words: ArcWords) -> Result<(), Fault> {
    if words.r.is_some() || (words.i.is_none() && words.k.is_none()) {
        return Ok(());
    }
    let mm = |units: Option<i64>| units.unwrap_or(0) as f64 / PER_MM as f64;
    let center = Point::new(mm(words.i), mm(words.k));
    let to_end = (end - start).point();
    check_arc(center.length(), (to_end - center).length())
}

/// M98 in offset mode, and M99 that returns: alarm 036.
///
/// `contour`: the block moves along a contour, where the compensation acts.
pub(crate) fn check_call(state: &State, context: &Context<'_>, contour: bool) -> Result<(), Alarm> {
    let on = match context.compensated {
        Compensated::Never => false,
        Compensated::Off => contour && state.compensates(),
        Compensated::On => !(contour && state.modal.nose_compensation == 40),
    };
    if on { Err(call_fault()) } else { Ok(()) }
}

/// The alarm of a call in compensation.
pub(crate) fn call_fault() -> Alarm {
    Fault::Call.alarm()
}
