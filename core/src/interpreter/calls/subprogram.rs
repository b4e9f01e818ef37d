//! M98 and M99: subprogram calls, returns and repetition (manual I-2.3, I-3.3.1.3).
//!
//! ```text
//!   M98 P 0005 1002     main --> O1002 --> ... four levels
//!         |    |             5 times
//!         |    +- program    M99: to the block after the call; M99 P n: to block N n
//!         +------ count      of the caller; in the main program: from the start
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::ProgramId;
use crate::interpreter::calls::special_call::SpecialCall;
use crate::interpreter::context::Context;
use crate::interpreter::context::flow::Flow;
use crate::interpreter::context::place::{Call, CallKind, Place};

/// Greatest depth of nested calls.
pub(crate) const LEVELS: usize = 4;

/// Plans an M98: P holds the count of runs (0 is one run) and the program number.
///
/// # Errors
/// 076 without P, 077 for calls that are too deep, 078 for a missing program.
pub(crate) fn call(context: &Context<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
    let Some(p) = p else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).because(say::call_without_program()));
    };
    let (count, number) = (p / 10_000, p % 10_000);
    let runs = u16::try_from(count).unwrap_or(u16::MAX).max(1);
    enter(context, number, runs, &format_args!("M98 P{p}"))
}

/// Plans a call by an M, S or T code (006.5 CM98, or parameters of macro B).
///
/// # Errors
/// As for [`call`].
pub(crate) fn call_special(context: &Context<'_>, call: SpecialCall) -> Result<Flow, Alarm> {
    let SpecialCall {
        program,
        address,
        code,
        ..
    } = call;
    let name = format_args!("{address}{code:02}");
    let flow = enter(context, program.into(), call.runs, &name)?;
    Ok(match flow {
        Flow::Call(entered) => Flow::Call(Call {
            codes_ordinary: call.codes_ordinary,
            ..entered
        }),
        other => other,
    })
}

fn enter(
    context: &Context<'_>,
    number: i64,
    runs: u16,
    name: &core::fmt::Arguments<'_>,
) -> Result<Flow, Alarm> {
    let nested = context.calls.iter().filter(|it| it.kind.is_subprogram());
    if nested.count() >= LEVELS {
        return Err(
            Alarm::new(number::CALL_TOO_DEEP).because(say::call_too_deep(name, LEVELS + 1, LEVELS)),
        );
    }
    let program = u16::try_from(number).ok();
    let Some(program) = program.and_then(|it| context.programs.find(it)) else {
        return Err(
            Alarm::new(number::TARGET_MISSING).because(say::call_program_missing(name, number))
        );
    };
    Ok(Flow::Call(Call {
        program,
        runs,
        back: context.place.after(),
        kind: CallKind::Subprogram,
        first: 0,
        blocks: None,
        codes_ordinary: false,
    }))
}

/// Plans an M99, or the end of a subprogram's text: the next run of the innermost call, or the
/// return from it. With P the return leads to the block N of the caller. Without a call the
/// main program starts again.
///
/// # Errors
/// 078 for a missing target.
pub(crate) fn back(context: &Context<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
    let Some(call) = context.calls.last() else {
        return restart(context, p);
    };
    if call.runs > 1 {
        return Ok(Flow::Again);
    }
    let Some(n) = p else {
        return Ok(Flow::Return(call.back));
    };
    let block = find_block(context, call.back.program, n)?;
    Ok(Flow::Return(Place {
        program: call.back.program,
        block,
    }))
}

/// Plans an M99 of the main program: a jump to its first block, or to N of P.
fn restart(context: &Context<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
    let program = context.place.program;
    if program == ProgramId::Dnc {
        return Err(Alarm::new(number::TARGET_MISSING).because(say::jump_in_dnc()));
    }
    let block = match p {
        None => 0,
        Some(n) => find_block(context, program, n)?,
    };
    Ok(Flow::Jump(Place { program, block }))
}

/// Whether a jump restarts the main program, so that it counts a part. A jump forward (M99 P)
/// does not.
pub(crate) fn repeats(context: &Context<'_>, flow: &Flow) -> bool {
    match flow {
        Flow::Jump(place) => place.block <= context.place.block,
        _ => false,
    }
}

fn find_block(context: &Context<'_>, program: ProgramId, n: i64) -> Result<u32, Alarm> {
    if program == ProgramId::Dnc {
        return Err(Alarm::new(number::TARGET_MISSING).because(say::jump_in_dnc()));
    }
    let block = u16::try_from(n).ok().and_then(|n| {
        let text = context.programs.get(program)?;
        text.find_sequence_block(n.into(), 0..text.block_count())
    });
    block.ok_or_else(|| Alarm::new(number::TARGET_MISSING).because(say::return_target_missing(n)))
}
