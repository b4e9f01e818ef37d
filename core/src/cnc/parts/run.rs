//! The program run: mode, state, and the block that is read for it.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::interpreter::Explanation;
use crate::interpreter::Interpreter;
use crate::interpreter::ModalState;
use crate::memory::Registers;
use crate::motion::Interpolator;
use crate::operation::{AutomaticRun, Handshake, OperatingMode};
use crate::program::MdiBlock;

/// State of the program run, with mode, interpreter and MDI block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CncRun {
    /// Operating mode that the ladder has selected.
    pub mode: OperatingMode,
    /// State of automatic operation: run, commands and current block.
    pub automatic: AutomaticRun,
    /// Handshakes of the M, S and T functions with the PLC.
    pub handshake: Handshake,
    /// Reads the blocks of the program.
    pub interpreter: Interpreter,
    /// Timer, date, and functions that a macro B program has switched off.
    #[serde(default)]
    pub registers: Registers,
    /// The block keyed in on the MDI page.
    pub mdi: MdiBlock,
    /// Modal state of the block that is being executed.
    pub modal: ModalState,
    /// The interpolator with the rest of a held motion, while the axes are moved manually; `None`
    /// otherwise.
    #[serde(rename = "held")]
    pub held_motion: Option<Interpolator>,
    /// Tool number and offset number on the T display.
    pub tool: (u8, u8),
    /// Whether the tool-change key is turning the tool post.
    #[serde(rename = "indexing_by_hand")]
    pub indexing_by_key: bool,
    /// Line of the program at which the next cycle start begins, from 1.
    pub cursor_line: u32,
    /// Whether the next cycle start begins at the head of the program, because the program
    /// ended.
    pub rewind_at_start: bool,
    /// Explanations of the commands that were read but have not begun, one per command (`None` for
    /// one without); `None` if explanations are off.
    #[serde(skip)]
    pub explanations: Option<VecDeque<Option<Explanation>>>,
    /// The begin of a command before which the run stops; `None` except in a copy that looks
    /// for the state at a block.
    #[serde(skip)]
    pub stop: Option<RunStop>,
}

/// The begin of a command, counted from now on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunStop {
    /// Number of blocks that still begin before the block.
    pub blocks_before: u64,
    /// The pass of the block's cycle, from 1; `None` for the begin of the block.
    pub pass: Option<u64>,
    /// Whether the block of the pass has begun.
    pub is_in_block: bool,
}

impl RunStop {
    /// Whether the run stops before a command that is about to begin. `pass` is the pass of a
    /// cycle to which the command belongs.
    pub(crate) fn stops_before(&mut self, begins_block: bool, pass: Option<u64>) -> bool {
        if begins_block {
            if self.is_in_block {
                return true;
            }
            if self.blocks_before > 0 {
                self.blocks_before -= 1;
                return false;
            }
            self.is_in_block = true;
        }
        let is_pass = self.pass.is_none_or(|wanted| pass == Some(wanted));
        self.is_in_block && is_pass
    }
}

impl CncRun {
    /// Creates the state at power-on: no program runs, and the tool number `tool` is in position.
    pub(crate) fn new(interpreter: Interpreter, tool: u8, registers: Registers) -> Self {
        Self {
            mode: OperatingMode::Mdi,
            automatic: AutomaticRun::default(),
            handshake: Handshake::default(),
            modal: *interpreter.modal(),
            interpreter,
            registers,
            mdi: MdiBlock::default(),
            held_motion: None,
            tool: (tool, 0),
            indexing_by_key: false,
            cursor_line: 1,
            rewind_at_start: false,
            explanations: None,
            stop: None,
        }
    }
}
