//! M functions of the GSK980TD (manual I-3.3) and of other models.

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::dialect;
use crate::interpreter::codes::tool::ToolWord;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::UNITS_PER_MM;
use crate::interpreter::words::SortedWords;
use crate::model::{MCode, MFunction, ModelRecord, hx31, ncb08};

/// The function of an M code for the control itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MCodeFunction {
    /// M00: stops the run until the next cycle start.
    Stop,
    /// M30, or M02: ends the program.
    End,
    /// M98: calls a subprogram.
    Call,
    /// M99: returns from a subprogram, or restarts the main program.
    Return,
    /// The control sends this M code to the PLC.
    Output(u8),
    /// The control carries out the code without the PLC: it switches outputs, waits for an
    /// input, reads an offset number, or does nothing.
    Interface,
}

/// Whether the control or the machine's ladder carries out the M code `code`.
pub(crate) fn has_function(code: u8, context: &BlockContext<'_>) -> bool {
    context.machine_codes.contains(code) || context.model.record().m_function(code).is_some()
}

/// Finds the function of the M code `code` for the control.
///
/// # Errors
///
/// 019 for a code that the control does not have, for a call or return in MDI, and for a gear code
/// on a machine without automatic gear change.
pub(crate) fn classify_m_code(
    code: u8,
    context: &BlockContext<'_>,
) -> Result<MCodeFunction, Alarm> {
    let Some(function) = context.model.record().m_function(code) else {
        if context.machine_codes.contains(code) {
            return Ok(MCodeFunction::Output(code));
        }
        let advice = dialect::advice_for_m_code(code);
        return Err(m_code_alarm(dialect::with_advice(
            say::m_unknown(code),
            advice,
        )));
    };
    match function.meaning {
        MCode::Stop => Ok(MCodeFunction::Stop),
        MCode::End => Ok(MCodeFunction::End),
        MCode::Call | MCode::Return if context.is_mdi => {
            Err(m_code_alarm(say::m_call_in_mdi(code)))
        }
        MCode::Call => Ok(MCodeFunction::Call),
        MCode::Return => Ok(MCodeFunction::Return),
        MCode::Gear1 | MCode::Gear2 | MCode::Gear3 | MCode::Gear4
            if !context.parameters.has_automatic_gears() =>
        {
            Err(m_code_alarm(say::m_needs_gear_change(code)))
        }
        // This lathe has no relays for these codes, and its panel no switch for the optional
        // stop.
        MCode::OptionalStop
        | MCode::SpindleClamp
        | MCode::SpindleRelease
        | MCode::HighGearOn
        | MCode::HighGearOff
        | MCode::SpeedMode
        | MCode::PositionMode
        | MCode::OffsetNumber
        | MCode::RelayOn
        | MCode::RelayOff
        | MCode::PulseOutput
        | MCode::InputWait
        | MCode::OutputOn
        | MCode::OutputOff
        | MCode::Clamp
        | MCode::ClampOff
        | MCode::OutputPair
        | MCode::TailstockOut
        | MCode::TailstockIn => Ok(MCodeFunction::Interface),
        _ => Ok(MCodeFunction::Output(code)),
    }
}

/// Plans the switching of outputs or the wait for an input that an M code commands; `None` if
/// the code does neither.
///
/// # Errors
/// 043 for a wrong output, relay or input number.
pub(crate) fn plan_interface(
    code: u8,
    words: &SortedWords,
    context: &BlockContext<'_>,
) -> Result<Option<Action>, Alarm> {
    let Some(MFunction {
        meaning: does,
        on,
        off,
    }) = context.model.record().m_function(code)
    else {
        return Ok(None);
    };
    let bits = |numbers: &[u8]| {
        let signals = numbers.iter().fold(0_u32, |bits, it| bits | 1 << it);
        context.model.outputs_of(signals)
    };
    let outputs_action = |on, off, ms| Ok(Some(Action::Outputs { on, off, ms }));
    match does {
        MCode::InputWait => plan_input_wait(words).map(Some),
        // D is a time in ms; 0 leaves the output on until another code switches it.
        MCode::OutputOn => outputs_action(1 << read_output(words)?, 0, read_milliseconds(words)),
        MCode::OutputOff => outputs_action(0, 1 << read_output(words)?, 0),
        MCode::RelayOn => outputs_action(1 << read_relay(words)?, 0, 0),
        MCode::RelayOff => outputs_action(0, 1 << read_relay(words)?, 0),
        MCode::PulseOutput => {
            let ms = context.model.parameter(hx31::PULSE_TIME);
            let output = u32::from(code.saturating_sub(hx31::FIRST_PULSE));
            outputs_action(1 << output.min(23), 0, ms.unsigned_abs())
        }
        MCode::Clamp => {
            let ms = context.model.parameter(ncb08::CLAMP_TIME);
            outputs_action(bits(on), bits(off), ms.unsigned_abs())
        }
        _ if on.is_empty() && off.is_empty() => Ok(None),
        _ => outputs_action(bits(on), bits(off), 0),
    }
}

/// Whether K of a block is the relay or offset number of its M code, so that the motion of the
/// block must not read K.
pub(crate) fn is_k_number(words: &SortedWords, record: &ModelRecord) -> bool {
    let function = words.m.and_then(|code| record.m_function(code));
    function.is_some_and(|it| {
        matches!(
            it.meaning,
            MCode::RelayOn | MCode::RelayOff | MCode::OffsetNumber
        )
    })
}

/// Reads D of M10, a time in ms; 0 if D is missing or negative.
fn read_milliseconds(words: &SortedWords) -> u32 {
    let ms = words.d_exact.map_or(0, to_integer);
    u32::try_from(ms).unwrap_or(0)
}

/// Reads the output number of P, 0 to 15. Returns an alarm as error if it is missing or out of
/// range.
fn read_output(words: &SortedWords) -> Result<u8, Alarm> {
    match words.p.map(u8::try_from) {
        Some(Ok(number @ 0..=15)) => Ok(number),
        Some(_) => Err(out_of_range_alarm(say::output_number_wrong())),
        None => Err(out_of_range_alarm(say::output_number_missing())),
    }
}

/// Reads the relay number of K, 1 to 17. Returns the output number, which counts from 0. Returns an
/// alarm as error if K is missing or out of range.
fn read_relay(words: &SortedWords) -> Result<u8, Alarm> {
    match words.k.map(to_integer).map(u8::try_from) {
        Some(Ok(number @ 1..=17)) => Ok(number - 1),
        Some(_) => Err(out_of_range_alarm(say::relay_number_wrong())),
        None => Err(out_of_range_alarm(say::relay_number_missing())),
    }
}

/// Reads the offset number that M24 K puts into force; `None` for other M codes.
///
/// # Errors
/// 043 for a wrong offset number.
pub(crate) fn read_offset_word(
    words: &SortedWords,
    context: &BlockContext<'_>,
) -> Result<Option<ToolWord>, Alarm> {
    let function = words
        .m
        .and_then(|code| context.model.record().m_function(code));
    if function.is_none_or(|it| it.meaning != MCode::OffsetNumber) {
        return Ok(None);
    }
    match words.k.map(to_integer).map(u8::try_from) {
        Some(Ok(offset @ 0..=8)) => Ok(Some(ToolWord { tool: None, offset })),
        _ => Err(out_of_range_alarm(say::offset_number_wrong())),
    }
}

/// Converts the value of a word from millionths to an integer; decimals are cut off.
const fn to_integer(millionths: i64) -> i64 {
    millionths / UNITS_PER_MM
}

/// Plans the wait for an input, 0 to 23: H waits until the input is on, L until it is off. Returns
/// an alarm as error unless exactly one of them has a valid number.
fn plan_input_wait(words: &SortedWords) -> Result<Action, Alarm> {
    let (number, high) = match (words.h, words.l) {
        (Some(_), Some(_)) | (None, None) => {
            return Err(out_of_range_alarm(say::input_level_unclear()));
        }
        (Some(number), None) => (number.into(), true),
        (None, Some(number)) => (number, false),
    };
    match u8::try_from(number) {
        Ok(input @ 0..=23) => Ok(Action::InputWait { input, high }),
        _ => Err(out_of_range_alarm(say::input_number_wrong())),
    }
}

fn out_of_range_alarm(detail: Message) -> Alarm {
    Alarm::new(number::OUT_OF_RANGE).with_detail(detail)
}

fn m_code_alarm(detail: Message) -> Alarm {
    Alarm::new(number::BAD_M).with_detail(detail)
}
