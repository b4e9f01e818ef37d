//! G40, G41, G42: checks what blocks may command while the nose radius compensation acts
//! (manual II, C compensation).

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::compensation::{Fault, check_arc};
use crate::interpreter::context::exact::{Exact, PER_MM};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{ArcWords, Words};
use crate::interpreter::context::{Compensated, Context};
use crate::memory::Parameters;
use crate::units::Point;

/// Checks that the control has the option of G41 and G42 (002.1).
///
/// # Errors
/// 010 without it.
pub(crate) fn check_option(words: &Words, parameters: &Parameters) -> Result<(), Alarm> {
    match words.nose {
        Some(code @ (41 | 42)) if !parameters.has_nose_compensation() => {
            Err(Alarm::new(number::BAD_G).because(say::nose_not_installed(code)))
        }
        _ => Ok(()),
    }
}

/// Checks an arc under nose radius compensation: arcs cannot start or cancel it (034, 056),
/// and their data must fit (048, 051, 052).
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

/// Checks a call (M98) or a return (M99) under nose radius compensation. `contour` is whether
/// the block moves along a contour, where it could cancel the compensation.
///
/// # Errors
/// 036 in offset mode.
pub(crate) fn check_call(state: &State, context: &Context<'_>, contour: bool) -> Result<(), Alarm> {
    let on = match context.compensated {
        Compensated::Never => false,
        Compensated::Off => contour && state.compensates(),
        Compensated::On => !(contour && state.modal.nose_compensation == 40),
    };
    if on { Err(call_fault()) } else { Ok(()) }
}

/// Alarm 036: a call under nose radius compensation.
pub(crate) fn call_fault() -> Alarm {
    Fault::Call.alarm()
}
