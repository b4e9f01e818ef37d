//! The call stack of the block in execution: the main program, subprograms and macros.

use gsk_core::cnc::{Cnc, Event};
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::interpreter::RunningCall;
use gsk_runner::block_calls::calls_of_block;

/// One level of the call stack: the main program or a called program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CallFrame {
    /// The program that this level executes.
    pub program: ProgramId,
    /// The line of the block in execution, or of the block that calls the next level.
    pub line: u32,
    /// Whether the level has separate local variables, as a call of a macro has.
    pub is_macro: bool,
    /// Number of runs left of the call, the current one included; 1 for the main program.
    pub runs_left: u16,
}

/// Follows the call stack from block to block.
///
/// The control reports its calls after the block that it has read, which may be one command
/// ahead. That is a call too many before a subprogram, and one too few at its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CallStack {
    calls: Vec<RunningCall>,
    block: Option<SourcePosition>,
}

impl CallStack {
    /// Follows one tick of the control. Call it after every tick.
    pub fn follow_tick(&mut self, cnc: &Cnc) {
        for event in cnc.events() {
            if let Event::BlockStarted(source, _) = event {
                self.begin_block(cnc, *source);
            }
        }
    }

    fn begin_block(&mut self, cnc: &Cnc, source: SourcePosition) {
        let calls = calls_of_block(cnc, source);
        let innermost = calls.last().map(|call| call.program);
        let previous = self.calls.last().map(|call| call.program);
        let is_returning = innermost != Some(source.program) && previous == Some(source.program);
        if !is_returning {
            self.calls = calls;
        }
        self.block = Some(source);
    }

    /// The block in execution; `None` before the first one.
    pub const fn block(&self) -> Option<SourcePosition> {
        self.block
    }

    /// Number of running calls; 0 in the main program.
    pub const fn depth(&self) -> usize {
        self.calls.len()
    }

    /// The levels, the innermost first; empty before the first block.
    pub fn frames(&self) -> Vec<CallFrame> {
        let Some(block) = self.block else {
            return Vec::new();
        };
        let mut frames = Vec::with_capacity(self.calls.len() + 1);
        let mut line = block.line;
        let mut program = block.program;
        for call in self.calls.iter().rev() {
            frames.push(CallFrame {
                program,
                line,
                is_macro: call.is_macro,
                runs_left: call.runs_left,
            });
            (program, line) = (call.caller, call.caller_line);
        }
        frames.push(CallFrame {
            program,
            line,
            is_macro: false,
            runs_left: 1,
        });
        frames
    }
}
