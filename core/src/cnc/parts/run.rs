//! The run of a program, and the block that is read for it.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::interpreter::Explanation;
use crate::interpreter::Interpreter;
use crate::interpreter::Modal;
use crate::memory::Registers;
use crate::motion::Interpolator;
use crate::operation::{Automatic, Handshake, Mode};
use crate::program::MdiBlock;

/// Mode, run state and interpreter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// Operating mode.
    pub mode: Mode,
    /// State of automatic operation.
    pub automatic: Automatic,
    /// M, S, T and their FIN.
    pub handshake: Handshake,
    /// Reads the blocks.
    pub interpreter: Interpreter,
    /// Timer, date and what a program has switched off, for macro B.
    #[serde(default)]
    pub registers: Registers,
    /// The block keyed in on the MDI page.
    pub mdi: MdiBlock,
    /// Modal state of the block in execution.
    pub modal: Modal,
    /// The rest of a held block while the axes are moved by hand.
    pub held: Option<Interpolator>,
    /// Tool and offset number on the T display.
    pub tool: (u8, u8),
    /// The tool-change key turns the tool post.
    pub indexing_by_hand: bool,
    /// Where the next cycle start begins, from 1.
    pub cursor_line: u32,
    /// The program ended: the next cycle start begins at its head.
    pub rewind_at_start: bool,
    /// Explanations of what was read and has not begun yet; `None`: nobody asked.
    #[serde(skip)]
    pub explanations: Option<VecDeque<Option<Explanation>>>,
}

impl Run {
    /// At power-on: nothing runs.
    pub(crate) fn new(interpreter: Interpreter, tool: u8, registers: Registers) -> Self {
        Self {
            mode: Mode::Mdi,
            automatic: Automatic::default(),
            handshake: Handshake::default(),
            modal: *interpreter.modal(),
            interpreter,
            registers,
            mdi: MdiBlock::default(),
            held: None,
            tool: (tool, 0),
            indexing_by_hand: false,
            cursor_line: 1,
            rewind_at_start: false,
            explanations: None,
        }
    }
}
