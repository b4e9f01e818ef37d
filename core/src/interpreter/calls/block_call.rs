//! Subprograms in the same file and repeated blocks, as the Huaxing lathes call them.
//!
//! ```text
//!   G20 N05 L3        the subprogram 05 three times: the blocks from G22 N05 to G24
//!   G20 N05.3         in this file or, if they are missing, the program %P05
//!   G25 N100.140.3    N100 to N140 three times, then the block after N140
//!   G26 N100.140.3    the same, then the block after the G26
//!   G27 N100          jumps to N100, endlessly
//! ```

use core::num::NonZeroU32;

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::ProgramId;
use crate::interpreter::context::Context;
use crate::interpreter::context::flow::Flow;
use crate::interpreter::context::place::{Call, CallKind, Place};
use crate::interpreter::context::words::Words;
use crate::program::{Number, Program, Syntax};

/// Greatest depth of nested calls.
const LEVELS: usize = 4;

/// Plans a G20: L (or P) runs of the subprogram N.
///
/// # Errors
/// 076 without N, 043 for a wrong N, 077 for calls that are too deep, 078 for a missing
/// subprogram.
pub(crate) fn call(context: &Context<'_>, words: &Words) -> Result<Flow, Alarm> {
    let Some(name) = words.n else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).because(say::block_call_without_n()));
    };
    let last = context.model.record().last_program;
    if !(1..=u32::from(last)).contains(&name) {
        let rule = say::subprogram_number_out_of_range(name, last);
        return Err(Alarm::new(number::OUT_OF_RANGE).because(rule));
    }
    let runs = words.l.or(words.p).unwrap_or(1);
    let here = program(context)?;
    let (program, first) = match definition(here, name, context) {
        Some(block) => (context.place.program, block + 1),
        None => (own_program(context, name)?, 0),
    };
    enter(context, program, (first, 0), runs, context.place.after())
}

/// Plans a G25, or with `comes_back` a G26: L runs of the blocks N to P.
///
/// # Errors
/// 076 without N, 077 for calls that are too deep, 078 for a missing or reversed range.
pub(crate) fn repeat(
    context: &Context<'_>,
    words: &Words,
    comes_back: bool,
) -> Result<Flow, Alarm> {
    let (Some(from), Some(to)) = (words.n.map(i64::from), words.p.or(words.n.map(i64::from)))
    else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).because(say::block_call_without_n()));
    };
    let (first, last) = (block(context, from)?, block(context, to)?);
    if last < first {
        let rule = say::block_call_backwards(from, to);
        return Err(Alarm::new(number::TARGET_MISSING).because(rule));
    }
    let program = context.place.program;
    let back = match comes_back {
        true => context.place.after(),
        false => Place {
            program,
            block: last + 1,
        },
    };
    let runs = words.l.unwrap_or(1);
    enter(context, program, (first, last - first + 1), runs, back)
}

/// Plans a G27: a jump to the block N.
///
/// # Errors
/// 076 without N, 078 for a missing block.
pub(crate) fn endless(context: &Context<'_>, words: &Words) -> Result<Flow, Alarm> {
    let Some(n) = words.n else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).because(say::block_call_without_n()));
    };
    Ok(Flow::Jump(Place {
        program: context.place.program,
        block: block(context, n.into())?,
    }))
}

fn enter(
    context: &Context<'_>,
    program: ProgramId,
    (first, count): (u32, u32),
    runs: i64,
    back: Place,
) -> Result<Flow, Alarm> {
    if context.calls.len() >= LEVELS {
        let rule = say::call_too_deep("G20", LEVELS + 1, LEVELS);
        return Err(Alarm::new(number::CALL_TOO_DEEP).because(rule));
    }
    Ok(Flow::Call(Call {
        program,
        runs: u16::try_from(runs).map_or(1, |runs| runs.max(1)),
        back,
        kind: CallKind::Subprogram,
        first,
        blocks: NonZeroU32::new(count),
        codes_ordinary: false,
    }))
}

fn program<'a>(context: &Context<'a>) -> Result<&'a Program, Alarm> {
    if context.mdi {
        return Err(Alarm::new(number::BAD_G).because(say::block_call_in_mdi()));
    }
    if context.place.program == ProgramId::Dnc {
        return Err(Alarm::new(number::TARGET_MISSING).because(say::jump_in_dnc()));
    }
    let program = context.programs.get(context.place.program);
    program.ok_or_else(|| Alarm::new(number::PROGRAM_MISSING).because(say::program_gone()))
}

fn block(context: &Context<'_>, n: i64) -> Result<u32, Alarm> {
    let program = program(context)?;
    let found = u32::try_from(n)
        .ok()
        .and_then(|n| program.find_sequence_block(n, 0..program.block_count()));
    found.ok_or_else(|| Alarm::new(number::TARGET_MISSING).because(say::block_call_missing(n)))
}

/// The index of the block `G22 Nnn` that begins the subprogram `name`.
fn definition(program: &Program, name: u32, context: &Context<'_>) -> Option<u32> {
    let syntax = Syntax {
        model: context.model.id(),
        ..Syntax::default()
    };
    (0..program.block_count()).find(|index| {
        // Parsing is slow, and most texts lack the number 22.
        let text = program.block(*index);
        text.contains("22")
            && program.parse(*index, syntax).is_ok_and(|block| {
                let n = block.number(b'N').map(Number::integer);
                block.has_g(22) && n == Some(name.into())
            })
    })
}

fn own_program(context: &Context<'_>, name: u32) -> Result<ProgramId, Alarm> {
    let found = u16::try_from(name).ok();
    let found = found.and_then(|name| context.programs.find(name));
    found.ok_or_else(|| {
        Alarm::new(number::TARGET_MISSING).because(say::subprogram_not_defined(name))
    })
}
