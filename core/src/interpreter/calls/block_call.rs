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
use crate::interpreter::context::BlockContext;
use crate::interpreter::flow::Flow;
use crate::interpreter::flow::program_position::{CallKind, ProgramCall, ProgramPosition};
use crate::interpreter::words::SortedWords;
use crate::program::{Program, Syntax, WordNumber};

/// Greatest number of nested calls by G20, G25 and G26.
const MAX_CALL_DEPTH: usize = 4;

/// Plans a G20: calls the subprogram N; L or else P is the number of runs.
///
/// # Errors
/// 076 without N, 043 for a wrong N, 077 for calls that are too deep, 078 for a missing
/// subprogram.
pub(crate) fn plan_call(context: &BlockContext<'_>, words: &SortedWords) -> Result<Flow, Alarm> {
    let Some(name) = words.n else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).with_detail(say::block_call_without_n()));
    };
    let last = context.model.record().last_program;
    if !(1..=u32::from(last)).contains(&name) {
        let rule = say::subprogram_number_out_of_range(name, last);
        return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(rule));
    }
    let runs = words.l.or(words.p).unwrap_or(1);
    let current_program = find_program(context)?;
    let (program, first) = match find_definition(current_program, name, context) {
        Some(block) => (context.position.program, block + 1),
        None => (find_stored_program(context, name)?, 0),
    };
    build_call_flow(
        context,
        program,
        (first, 0),
        runs,
        context.position.next_block(),
    )
}

/// Plans a G25, or with `returns` a G26: runs the blocks N to P, L times.
///
/// # Errors
/// 076 without N, 077 for calls that are too deep, 078 for a missing or reversed range.
pub(crate) fn plan_repeat(
    context: &BlockContext<'_>,
    words: &SortedWords,
    returns: bool,
) -> Result<Flow, Alarm> {
    let (Some(from), Some(to)) = (words.n.map(i64::from), words.p.or(words.n.map(i64::from)))
    else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).with_detail(say::block_call_without_n()));
    };
    let (first, last) = (find_block(context, from)?, find_block(context, to)?);
    if last < first {
        let rule = say::block_call_backwards(from, to);
        return Err(Alarm::new(number::TARGET_MISSING).with_detail(rule));
    }
    let program = context.position.program;
    let back = match returns {
        true => context.position.next_block(),
        false => ProgramPosition {
            program,
            block: last + 1,
        },
    };
    let runs = words.l.unwrap_or(1);
    build_call_flow(context, program, (first, last - first + 1), runs, back)
}

/// Plans a G27: jumps to the block with the sequence number N.
///
/// # Errors
/// 076 without N, 078 for a missing block.
pub(crate) fn plan_endless_jump(
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<Flow, Alarm> {
    let Some(n) = words.n else {
        return Err(Alarm::new(number::CALL_WITHOUT_P).with_detail(say::block_call_without_n()));
    };
    Ok(Flow::Jump(ProgramPosition {
        program: context.position.program,
        block: find_block(context, n.into())?,
    }))
}

fn build_call_flow(
    context: &BlockContext<'_>,
    program: ProgramId,
    (first, count): (u32, u32),
    runs: i64,
    return_position: ProgramPosition,
) -> Result<Flow, Alarm> {
    if context.calls.len() >= MAX_CALL_DEPTH {
        let rule = say::call_too_deep("G20", MAX_CALL_DEPTH + 1, MAX_CALL_DEPTH);
        return Err(Alarm::new(number::CALL_TOO_DEEP).with_detail(rule));
    }
    Ok(Flow::Call(ProgramCall {
        program,
        runs_left: u16::try_from(runs).map_or(1, |runs| runs.max(1)),
        return_position,
        kind: CallKind::Subprogram,
        first_block: first,
        block_count: NonZeroU32::new(count),
        codes_ordinary: false,
    }))
}

fn find_program<'a>(context: &BlockContext<'a>) -> Result<&'a Program, Alarm> {
    if context.is_mdi {
        return Err(Alarm::new(number::BAD_G).with_detail(say::block_call_in_mdi()));
    }
    if context.position.program == ProgramId::Dnc {
        return Err(Alarm::new(number::TARGET_MISSING).with_detail(say::jump_in_dnc()));
    }
    let program = context.programs.get(context.position.program);
    program.ok_or_else(|| Alarm::new(number::PROGRAM_MISSING).with_detail(say::program_gone()))
}

fn find_block(context: &BlockContext<'_>, n: i64) -> Result<u32, Alarm> {
    let program = find_program(context)?;
    let index = u32::try_from(n)
        .ok()
        .and_then(|n| program.find_sequence_block(n, 0..program.block_count()));
    index.ok_or_else(|| Alarm::new(number::TARGET_MISSING).with_detail(say::block_call_missing(n)))
}

/// The index, from 0, of the block `G22 Nnn` that begins the subprogram `name`; `None` if the
/// program has no such block.
fn find_definition(program: &Program, name: u32, context: &BlockContext<'_>) -> Option<u32> {
    let syntax = Syntax {
        model: context.model.id(),
        ..Syntax::default()
    };
    (0..program.block_count()).find(|index| {
        // Parsing is slow, and most texts lack the number 22.
        let text = program.block(*index);
        text.contains("22")
            && program.parse(*index, syntax).is_ok_and(|block| {
                let n = block.number(b'N').map(WordNumber::integer);
                block.has_g(22) && n == Some(name.into())
            })
    })
}

fn find_stored_program(context: &BlockContext<'_>, name: u32) -> Result<ProgramId, Alarm> {
    let number = u16::try_from(name).ok();
    let program = number.and_then(|name| context.programs.find_called(name));
    program.ok_or_else(|| {
        Alarm::new(number::TARGET_MISSING).with_detail(say::subprogram_not_defined(name))
    })
}
