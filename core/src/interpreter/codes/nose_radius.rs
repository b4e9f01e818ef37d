//! G40, G41, G42: checks what blocks may command while the nose radius compensation acts
//! (manual II, C compensation).

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::compensation::{CompensationFault, check_arc};
use crate::interpreter::context::{BlockContext, CompensationMode};
use crate::interpreter::exact::{ExactPoint, UNITS_PER_MM};
use crate::interpreter::state::State;
use crate::interpreter::words::{ArcWords, SortedWords};
use crate::memory::ControlParameters;
use crate::units::Point;

/// Checks that the control has the option of G41 and G42 (002.1).
///
/// # Errors
/// 010 for a G41 or G42 on a control without the option.
pub(crate) fn check_option(
    words: &SortedWords,
    parameters: &ControlParameters,
) -> Result<(), Alarm> {
    match words.nose {
        Some(code @ (41 | 42)) if !parameters.has_nose_compensation() => {
            Err(Alarm::new(number::BAD_G).with_detail(say::nose_not_installed(code)))
        }
        _ => Ok(()),
    }
}

/// Checks an arc under nose radius compensation: an arc cannot start or cancel the compensation
/// (034, 056), and its data must fit (048, 051, 052). Returns the alarm as error.
pub(crate) fn check_arc_block(
    state: &State,
    compensation: CompensationMode,
    end: ExactPoint,
    words: ArcWords,
) -> Result<(), Alarm> {
    let start = state.position;
    let has_no_length = words.r.is_some() && start == end;
    let fault = match compensation {
        _ if has_no_length => None,
        CompensationMode::Never => None,
        CompensationMode::Off => state
            .is_compensating()
            .then_some(CompensationFault::StartOnArc),
        CompensationMode::On if state.modal.nose_compensation == 40 => {
            Some(CompensationFault::CancelOnArc)
        }
        CompensationMode::On => check_center(start, end, words).err(),
    };
    fault.map_or(Ok(()), |fault| Err(fault.alarm()))
}

fn check_center(
    start: ExactPoint,
    end: ExactPoint,
    words: ArcWords,
) -> Result<(), CompensationFault> {
    if words.r.is_some() || (words.i.is_none() && words.k.is_none()) {
        return Ok(());
    }
    let mm = |units: Option<i64>| units.unwrap_or(0) as f64 / UNITS_PER_MM as f64;
    let center = Point::new(mm(words.i), mm(words.k));
    let to_end = (end - start).to_point();
    check_arc(center.length(), (to_end - center).length())
}

/// Checks a call (M98) or a return (M99) under nose radius compensation. `is_contour` is
/// whether the block moves along a contour, so that the block can cancel the compensation.
///
/// # Errors
/// 036 if the block is compensated (offset mode).
pub(crate) fn check_call(
    state: &State,
    context: &BlockContext<'_>,
    is_contour: bool,
) -> Result<(), Alarm> {
    let is_compensating = match context.compensation {
        CompensationMode::Never => false,
        CompensationMode::Off => is_contour && state.is_compensating(),
        CompensationMode::On => !(is_contour && state.modal.nose_compensation == 40),
    };
    if is_compensating {
        Err(call_alarm())
    } else {
        Ok(())
    }
}

/// Alarm 036, for a call or return under nose radius compensation.
pub(crate) fn call_alarm() -> Alarm {
    CompensationFault::Call.alarm()
}
