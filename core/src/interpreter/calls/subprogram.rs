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
use crate::interpreter::context::BlockContext;
use crate::interpreter::flow::Flow;
use crate::interpreter::flow::program_position::{CallKind, ProgramCall, ProgramPosition};

/// Greatest number of nested subprogram calls (M98).
pub(crate) const MAX_CALL_DEPTH: usize = 4;

/// Plans an M98: `p` is the number of runs (0 means one run) times 10000 plus the program
/// number.
///
/// # Errors
/// 076 without P, 077 for calls that are too deep, 078 for a missing program.
pub(crate) fn plan_call(context: &BlockContext<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
    let Some(p) = p else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).with_detail(say::call_without_program()));
    };
    let (count, number) = (p / 10_000, p % 10_000);
    let runs = u16::try_from(count).unwrap_or(u16::MAX).max(1);
    build_call_flow(context, number, runs, &format_args!("M98 P{p}"))
}

/// Plans a call by an M, S or T code (006.5 CM98, or parameters of macro B).
///
/// # Errors
/// As for [`plan_call`].
pub(crate) fn plan_special_call(
    context: &BlockContext<'_>,
    call: SpecialCall,
) -> Result<Flow, Alarm> {
    let SpecialCall {
        program,
        address,
        code,
        ..
    } = call;
    let name = format_args!("{address}{code:02}");
    let flow = build_call_flow(context, program.into(), call.runs, &name)?;
    Ok(match flow {
        Flow::Call(entered) => Flow::Call(ProgramCall {
            codes_ordinary: call.codes_ordinary,
            ..entered
        }),
        other => other,
    })
}

fn build_call_flow(
    context: &BlockContext<'_>,
    number: i64,
    runs: u16,
    name: &core::fmt::Arguments<'_>,
) -> Result<Flow, Alarm> {
    let nested = context.calls.iter().filter(|it| it.kind.is_subprogram());
    if nested.count() >= MAX_CALL_DEPTH {
        return Err(
            Alarm::new(number::CALL_TOO_DEEP).with_detail(say::call_too_deep(
                name,
                MAX_CALL_DEPTH + 1,
                MAX_CALL_DEPTH,
            )),
        );
    }
    let program = u16::try_from(number).ok();
    let Some(program) = program.and_then(|it| context.programs.find_called(it)) else {
        return Err(
            Alarm::new(number::TARGET_MISSING).with_detail(say::call_program_missing(name, number))
        );
    };
    Ok(Flow::Call(ProgramCall {
        program,
        runs_left: runs,
        return_position: context.position.next_block(),
        kind: CallKind::Subprogram,
        first_block: 0,
        block_count: None,
        codes_ordinary: false,
    }))
}

/// Plans an M99, or the end of a subprogram's text: the next run of the innermost call, or the
/// return from that call. With P the return leads to the block N`p` of the caller. Without a
/// call the main program starts again.
///
/// # Errors
/// 078 if the block N`p` is missing.
pub(crate) fn plan_return(context: &BlockContext<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
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
fn plan_restart(context: &BlockContext<'_>, p: Option<i64>) -> Result<Flow, Alarm> {
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
pub(crate) fn is_restart(context: &BlockContext<'_>, flow: &Flow) -> bool {
    match flow {
        Flow::Jump(place) => place.block <= context.position.block,
        _ => false,
    }
}

fn find_block(context: &BlockContext<'_>, program: ProgramId, n: i64) -> Result<u32, Alarm> {
    if program == ProgramId::Dnc {
        return Err(Alarm::new(number::TARGET_MISSING).with_detail(say::jump_in_dnc()));
    }
    let block = u16::try_from(n).ok().and_then(|n| {
        let text = context.programs.get(program)?;
        text.find_sequence_block(n.into(), 0..text.block_count())
    });
    block.ok_or_else(|| {
        Alarm::new(number::TARGET_MISSING).with_detail(say::return_target_missing(n))
    })
}
