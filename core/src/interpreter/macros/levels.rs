//! Local variables of macro calls, loops, and modal calls (G66).
//!
//! ```text
//!   level 0  main program    #1–#33
//!   level 1  G65 P9010       separate #1–#33, filled by its arguments
//!   ...      four levels; M98 stays on the level of its caller
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::command::ProgramId;
use crate::interpreter::context::place::{Call, CallKind};
use crate::interpreter::macros::formula::Value;

/// Greatest number of a local variable.
pub(crate) const LOCALS: u32 = 33;

/// Local variables with a value, by number.
pub(crate) type Locals = BTreeMap<u8, f64>;

/// Variables, loops and modal calls of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Levels {
    /// Variables of the main program.
    main: Locals,
    /// Variables of the running macro calls, the innermost last.
    called: Vec<Level>,
    /// Running loops, the innermost last.
    loops: Vec<Loop>,
    /// Modal calls, the last commanded last.
    modal: Vec<Modal>,
}

/// The local variables of one call.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Level {
    /// Their values at the start of each run.
    arguments: Locals,
    values: Locals,
}

/// A running loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Loop {
    /// Number of running calls at the loop.
    #[serde(rename = "depth")]
    pub(crate) depth: usize,
    /// m of DO m, 1 to 3.
    pub(crate) number: u8,
    /// Index of the blocks of DO and END.
    #[serde(rename = "first")]
    pub(crate) first: u32,
    #[serde(rename = "last")]
    pub(crate) last: u32,
}

/// A modal call by G66: each move calls its program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Modal {
    pub(crate) program: ProgramId,
    pub(crate) runs: u16,
    pub(crate) arguments: Locals,
}

impl Levels {
    /// The levels of a new run, without variables and calls.
    pub(crate) const fn new() -> Self {
        Self {
            main: Locals::new(),
            called: Vec::new(),
            loops: Vec::new(),
            modal: Vec::new(),
        }
    }

    /// The value of a local variable of the innermost level; `None` is null.
    pub(crate) fn get(&self, number: u8) -> Value {
        let values = self.called.last().map_or(&self.main, |level| &level.values);
        values.get(&number).copied()
    }

    /// Sets a local variable of the innermost level; `None` makes it null.
    pub(crate) fn set(&mut self, number: u8, value: Value) {
        let values = match self.called.last_mut() {
            Some(level) => &mut level.values,
            None => &mut self.main,
        };
        match value {
            Some(value) => values.insert(number, value),
            None => values.remove(&number),
        };
    }

    /// Adds a level for a macro call with these arguments.
    pub(crate) fn enter(&mut self, arguments: Locals) {
        let values = arguments.clone();
        self.called.push(Level { arguments, values });
    }

    /// Prepares the next run of the innermost of `depth` calls: ends its loops, and restores
    /// its arguments unless it is modal.
    pub(crate) fn run_again(&mut self, call: &Call, depth: usize) {
        self.loops.retain(|it| it.depth < depth);
        if let (CallKind::Macro, Some(level)) = (call.kind, self.called.last_mut()) {
            level.values.clone_from(&level.arguments);
        }
    }

    /// Removes the level of a call; `depth` calls are left. A modal call keeps its variables
    /// for the next move.
    pub(crate) fn leave(&mut self, call: &Call, depth: usize) {
        self.loops.retain(|it| it.depth <= depth);
        let level = match call.kind {
            CallKind::Subprogram => return,
            CallKind::Macro | CallKind::Modal(_) => self.called.pop(),
        };
        if let (CallKind::Modal(index), Some(level)) = (call.kind, level)
            && let Some(modal) = self.modal.get_mut(usize::from(index))
        {
            modal.arguments = level.values;
        }
    }

    /// Ends the loops that a jump to `block` leaves, on the same level; loops around it stay.
    pub(crate) fn jump(&mut self, depth: usize, block: u32) {
        let around = |it: &Loop| (it.first..=it.last).contains(&block);
        self.loops.retain(|it| it.depth < depth || around(it));
    }

    /// The innermost loop, if it is on the level of `depth` calls.
    pub(crate) fn innermost(&self, depth: usize) -> Option<Loop> {
        self.loops.last().copied().filter(|it| it.depth == depth)
    }

    /// Adds a loop, unless it is running already.
    pub(crate) fn enter_loop(&mut self, entered: Loop) {
        if self.innermost(entered.depth) != Some(entered) {
            self.loops.push(entered);
        }
    }

    /// Adds a modal call (G66). Returns false if `most` calls exist already.
    pub(crate) fn add_modal(&mut self, modal: Modal, most: usize) -> bool {
        let room = self.modal.len() < most;
        if room {
            self.modal.push(modal);
        }
        room
    }

    /// Cancels the last modal call (G67).
    pub(crate) fn cancel_modal(&mut self) {
        self.modal.pop();
    }

    /// The modal call that a move makes, with its index: the last one that is not running.
    pub(crate) fn modal(&self, calls: &[Call]) -> Option<(u8, &Modal)> {
        let under_way = |index| {
            let kind = CallKind::Modal(index);
            calls.iter().any(|call| call.kind == kind)
        };
        let all = self.modal.iter().enumerate().rev();
        all.map(|(index, modal)| (index as u8, modal))
            .find(|(index, _)| !under_way(*index))
    }

    /// Whether a move may call a program.
    pub(crate) const fn has_modal_call(&self) -> bool {
        !self.modal.is_empty()
    }

    /// Whether there are no variables, loops and modal calls.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
