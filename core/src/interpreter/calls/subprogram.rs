//! M98 and M99: subprogram calls, returns and repetition (manual I-2.3, I-3.3.1.3).
//!
//! ```text
//!   M98 P 0005 1002     main --> O1002 --> ... four levels
//!         |    |             5 times
//!         |    +- program    M99: to the block after the call; M99 P n: to block N n
//!         +------ count      of the caller; in the main program: from the start
//! ```

use core::fmt::Display;

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::ProgramId;
use crate::interpreter::calls::special_call::SpecialCall;
use crate::interpreter::flow::Flow;
use crate::interpreter::flow::call_context::CallContext;
use crate::interpreter::flow::program_position::{CallKind, ProgramCall, ProgramPosition};

/// Greatest number of nested subprogram calls (M98), and of nested macro calls.
const MAX_CALL_DEPTH: usize = 4;

/// Plans an M98: `p` is the number of runs (0 means one run) times 10000 plus the program
/// number.
///
/// # Errors
/// 076 without P, 077 for calls that are too deep, 078 for a missing program.
pub(crate) fn plan_call(context: &CallContext<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
    let Some(p) = p else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).with_detail(say::call_without_program()));
    };
    let (count, number) = (p / 10_000, p % 10_000);
    let runs = u16::try_from(count).unwrap_or(u16::MAX).max(1);
    let name = format_args!("M98 P{p}");
    new_call(context, CallKind::Subprogram, number, runs, &name).map(Flow::Call)
}

/// Plans a call by an M, S or T code (006.5 CM98, or parameters of macro B).
///
/// # Errors
/// As for [`plan_call`].
pub(crate) fn plan_special_call(
    context: &CallContext<'_>,
    call: SpecialCall,
) -> Result<Flow, Alarm> {
    let SpecialCall {
        program,
        address,
        code,
        ..
    } = call;
    let name = format_args!("{address}{code:02}");
    let kind = CallKind::Subprogram;
    let entered = new_call(context, kind, program.into(), call.runs, &name)?;
    Ok(Flow::Call(ProgramCall {
        codes_ordinary: call.codes_ordinary,
        ..entered
    }))
}

/// The call of the program `number`, `runs` times. `name` is the calling code, for messages.
///
/// # Errors
/// 077 for calls of this kind that are too deep, 078 for a missing program.
pub(crate) fn new_call(
    context: &CallContext<'_>,
    kind: CallKind,
    number: i64,
    runs: u16,
    name: &impl Display,
) -> Result<ProgramCall, Alarm> {
    let is_same_kind = |call: &&ProgramCall| call.kind.is_subprogram() == kind.is_subprogram();
    if context.calls.iter().filter(is_same_kind).count() >= MAX_CALL_DEPTH {
        let detail = say::call_too_deep(name, MAX_CALL_DEPTH + 1, MAX_CALL_DEPTH);
        return Err(Alarm::new(number::CALL_TOO_DEEP).with_detail(detail));
    }
    let found = u16::try_from(number).ok();
    let found = found.and_then(|it| context.programs.find_called(it));
    let program = found.ok_or_else(|| {
        let detail = say::call_program_missing(name, number);
        Alarm::new(number::TARGET_MISSING).with_detail(detail)
    })?;
    Ok(ProgramCall {
        program,
        runs_left: runs,
        return_position: context.position.next_block(),
        kind,
        first_block: 0,
        block_count: None,
        codes_ordinary: false,
    })
}

/// Plans an M99, or the end of a subprogram's text: the next run of the innermost call, or the
/// return from that call. With P the return leads to the block N`p` of the caller. Without a
/// call the main program starts again.
///
/// # Errors
/// 078 if the block N`p` is missing.
pub(crate) fn plan_return(context: &CallContext<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
    let Some(call) = context.calls.last() else {
        return plan_restart(context, p);
    };
    if call.runs_left > 1 {
        return Ok(Flow::RunAgain);
    }
    let Some(n) = p else {
        return Ok(Flow::Return(call.return_position));
    };
    let block = find_block(context, call.return_position.program, n)?;
    Ok(Flow::Return(ProgramPosition {
        program: call.return_position.program,
        block,
    }))
}

/// Plans an M99 of the main program: jumps to the first block, or to the block N`p`. Returns an
/// alarm as error if the block is missing or the program is received in DNC.
fn plan_restart(context: &CallContext<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
    let program = context.position.program;
    if program == ProgramId::Dnc {
        return Err(Alarm::new(number::TARGET_MISSING).with_detail(say::jump_in_dnc()));
    }
    let block = match p {
        None => 0,
        Some(n) => find_block(context, program, n)?,
    };
    Ok(Flow::Jump(ProgramPosition { program, block }))
}

/// Whether `flow` restarts the main program with a jump back, so that the control counts a
/// part. A jump forward (M99 P) restarts nothing.
pub(crate) fn is_restart(context: &CallContext<'_>, flow: &Flow) -> bool {
    match flow {
        Flow::Jump(place) => place.block <= context.position.block,
        _ => false,
    }
}

fn find_block(context: &CallContext<'_>, program: ProgramId, n: i64) -> Result<u32, Alarm> {
    if program == ProgramId::Dnc {
        return Err(Alarm::new(number::TARGET_MISSING).with_detail(say::jump_in_dnc()));
    }
    let target = u32::try_from(n).ok().filter(|n| *n <= context.last_target);
    let block = target.and_then(|n| {
        let text = context.programs.get(program)?;
        text.find_sequence_block(n, 0..text.block_count())
    });
    block.ok_or_else(|| {
        Alarm::new(number::TARGET_MISSING).with_detail(say::return_target_missing(n))
    })
}
