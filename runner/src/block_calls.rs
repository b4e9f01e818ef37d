//! The calls that lead to a block which begins.

use gsk_core::cnc::Cnc;
use gsk_core::command::SourcePosition;
use gsk_core::interpreter::RunningCall;

/// The running calls of a block that has just begun, the innermost last.
pub fn calls_of_block(cnc: &Cnc, block: SourcePosition) -> Vec<RunningCall> {
    let mut calls: Vec<RunningCall> = cnc.running_calls().collect();
    // Calls that the control has read ahead, and the one that the block itself has made.
    while let Some(call) = calls.last() {
        let is_made_by_block =
            call.is_at_begin && (call.caller, call.caller_line) == (block.program, block.line);
        let is_outside = call.program != block.program
            && calls.iter().any(|other| other.caller == block.program);
        if !is_made_by_block && !is_outside {
            break;
        }
        calls.pop();
    }
    calls
}
