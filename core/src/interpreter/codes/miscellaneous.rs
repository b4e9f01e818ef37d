//! M functions of the GSK980TD (manual I-3.3) and of other models.

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::dialect;
use crate::interpreter::codes::tool::ToolWord;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::PER_MM;
use crate::interpreter::context::words::Words;
use crate::model::{MCode, MFunction, Record, hx31, ncb08};

/// What an M code commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    /// M00: program stop.
    Stop,
    /// M30: end of the program.
    End,
    /// M98: subprogram call.
    Call,
    /// M99: return.
    Return,
    /// The code that the PLC receives.
    Output(u8),
    /// Switches outputs or waits for an input of the control, without the PLC.
    Interface,
}

/// Whether the control or the machine's ladder has this M code.
pub(crate) fn has_function(code: u8, context: &Context<'_>) -> bool {
    context.machine_codes.has(code) || context.model.record().m_function(code).is_some()
}

/// What an M code commands.
///
/// # Errors
/// 019 for a code that the control does not have, or not in MDI or without gears.
pub(crate) fn function(code: u8, context: &Context<'_>) -> Result<Function, Alarm> {
    let Some(function) = context.model.record().m_function(code) else {
        if context.machine_codes.has(code) {
            return Ok(Function::Output(code));
        }
        let advice = dialect::instead_of_m(code);
        return Err(fault(dialect::advised(say::m_unknown(code), advice)));
    };
    match function.does {
        MCode::Stop => Ok(Function::Stop),
        MCode::End => Ok(Function::End),
        MCode::Call | MCode::Return if context.mdi => Err(fault(say::m_call_in_mdi(code))),
        MCode::Call => Ok(Function::Call),
        MCode::Return => Ok(Function::Return),
        MCode::Gear1 | MCode::Gear2 | MCode::Gear3 | MCode::Gear4
            if !context.parameters.automatic_gears() =>
        {
            Err(fault(say::m_needs_gear_change(code)))
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
        | MCode::TailstockIn => Ok(Function::Interface),
        _ => Ok(Function::Output(code)),
    }
}

/// The outputs that an M code switches, or the input that it waits for; `None` if it does
/// neither.
///
/// # Errors
/// 043 for a wrong output, relay or input number.
pub(crate) fn interface(
    code: u8,
    words: &Words,
    context: &Context<'_>,
) -> Result<Option<Action>, Alarm> {
    let Some(MFunction { does, on, off }) = context.model.record().m_function(code) else {
        return Ok(None);
    };
    let bits = |numbers: &[u8]| numbers.iter().fold(0_u32, |bits, it| bits | 1 << it);
    let switched = |on, off, ms| Ok(Some(Action::Outputs { on, off, ms }));
    match does {
        MCode::InputWait => input_wait(words).map(Some),
        // D is a time in ms; 0 leaves the output on until another code switches it.
        MCode::OutputOn => switched(1 << output(words)?, 0, milliseconds(words)),
        MCode::OutputOff => switched(0, 1 << output(words)?, 0),
        MCode::RelayOn => switched(1 << relay(words)?, 0, 0),
        MCode::RelayOff => switched(0, 1 << relay(words)?, 0),
        MCode::PulseOutput => {
            let ms = context.model.parameter(hx31::PULSE_TIME);
            let output = u32::from(code.saturating_sub(hx31::FIRST_PULSE));
            switched(1 << output.min(23), 0, ms.unsigned_abs())
        }
        MCode::Clamp => {
            let ms = context.model.parameter(ncb08::CLAMP_TIME);
            switched(bits(on), bits(off), ms.unsigned_abs())
        }
        _ if on.is_empty() && off.is_empty() => Ok(None),
        _ => switched(bits(on), bits(off), 0),
    }
}

/// Whether K of a block is a relay or offset number and so no word of its motion.
pub(crate) fn takes_k(words: &Words, record: &Record) -> bool {
    let function = words.m.and_then(|code| record.m_function(code));
    function.is_some_and(|it| {
        matches!(
            it.does,
            MCode::RelayOn | MCode::RelayOff | MCode::OffsetNumber
        )
    })
}

/// D of M10: ms.
fn milliseconds(words: &Words) -> u32 {
    let ms = words.d_exact.map_or(0, whole);
    u32::try_from(ms).unwrap_or(0)
}

/// P: output number, 0 to 15.
fn output(words: &Words) -> Result<u8, Alarm> {
    match words.p.map(u8::try_from) {
        Some(Ok(number @ 0..=15)) => Ok(number),
        Some(_) => Err(out_of_range(say::output_number_wrong())),
        None => Err(out_of_range(say::output_number_missing())),
    }
}

/// K: relay number, 1 to 17. Returns the output number, which counts from 0.
fn relay(words: &Words) -> Result<u8, Alarm> {
    match words.k.map(whole).map(u8::try_from) {
        Some(Ok(number @ 1..=17)) => Ok(number - 1),
        Some(_) => Err(out_of_range(say::relay_number_wrong())),
        None => Err(out_of_range(say::relay_number_missing())),
    }
}

/// M24 K: puts an offset number into force; `None` for other M codes.
///
/// # Errors
/// 043 for a wrong offset number.
pub(crate) fn offset(words: &Words, context: &Context<'_>) -> Result<Option<ToolWord>, Alarm> {
    let function = words
        .m
        .and_then(|code| context.model.record().m_function(code));
    if function.is_none_or(|it| it.does != MCode::OffsetNumber) {
        return Ok(None);
    }
    match words.k.map(whole).map(u8::try_from) {
        Some(Ok(offset @ 0..=8)) => Ok(Some(ToolWord { tool: None, offset })),
        _ => Err(out_of_range(say::offset_number_wrong())),
    }
}

/// The integer of a word that was read in millionths.
const fn whole(millionths: i64) -> i64 {
    millionths / PER_MM
}

/// Waits for an input, 0 to 23: H until it is on, L until it is off.
fn input_wait(words: &Words) -> Result<Action, Alarm> {
    let (number, high) = match (words.h, words.l) {
        (Some(_), Some(_)) | (None, None) => return Err(out_of_range(say::input_level_unclear())),
        (Some(number), None) => (number.into(), true),
        (None, Some(number)) => (number, false),
    };
    match u8::try_from(number) {
        Ok(input @ 0..=23) => Ok(Action::InputWait { input, high }),
        _ => Err(out_of_range(say::input_number_wrong())),
    }
}

fn out_of_range(detail: Message) -> Alarm {
    Alarm::new(number::OUT_OF_RANGE).because(detail)
}

fn fault(detail: Message) -> Alarm {
    Alarm::new(number::BAD_M).because(detail)
}
