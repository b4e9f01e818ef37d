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
use crate::interpreter::flow::program_position::{CallKind, ProgramCall};
use crate::interpreter::macros::formula::FormulaValue;

/// Greatest number of a local variable, #33.
pub(crate) const LAST_LOCAL: u32 = 33;

/// The local variables that have a value, by their numbers.
pub(crate) type LocalVariables = BTreeMap<u8, f64>;

/// The local variables, loops and modal calls (G66) of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Levels {
    /// Local variables of the main program, outside all calls.
    main: LocalVariables,
    /// Local variables of the running macro calls, the innermost last.
    called: Vec<MacroLevel>,
    /// Running loops (DO to END), the innermost last.
    loops: Vec<RunningLoop>,
    /// Modal calls (G66) in force, in the order of their commands.
    modal: Vec<ModalCall>,
}

/// The local variables of one running macro call.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct MacroLevel {
    /// Values of the variables at the start of each run.
    arguments: LocalVariables,
    values: LocalVariables,
}

/// A running loop of macro B, DO to END.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct RunningLoop {
    /// Number of running calls when the loop was entered.
    #[serde(rename = "depth")]
    pub(crate) call_depth: usize,
    /// Number of the loop, m of DO m, 1 to 3.
    pub(crate) number: u8,
    /// Index of the block of DO, from 0.
    #[serde(rename = "first")]
    pub(crate) first_block: u32,
    /// Index of the block of END, from 0.
    #[serde(rename = "last")]
    pub(crate) last_block: u32,
}

/// A modal call by G66: each block that moves calls this program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModalCall {
    pub(crate) program: ProgramId,
    pub(crate) runs: u16,
    pub(crate) arguments: LocalVariables,
}

impl Levels {
    /// The levels of a new run, without variables and calls.
    pub(crate) const fn new() -> Self {
        Self {
            main: LocalVariables::new(),
            called: Vec::new(),
            loops: Vec::new(),
            modal: Vec::new(),
        }
    }

    /// The value of a local variable of the innermost macro call; `None` is null.
    pub(crate) fn get(&self, number: u8) -> FormulaValue {
        let values = self.called.last().map_or(&self.main, |level| &level.values);
        values.get(&number).copied()
    }

    /// Sets a local variable of the innermost macro call; `None` makes the variable null.
    pub(crate) fn set(&mut self, number: u8, value: FormulaValue) {
        let values = match self.called.last_mut() {
            Some(level) => &mut level.values,
            None => &mut self.main,
        };
        match value {
            Some(value) => values.insert(number, value),
            None => values.remove(&number),
        };
    }

    /// Adds a level for a new macro call; its variables begin with the values of `arguments`.
    pub(crate) fn push_level(&mut self, arguments: LocalVariables) {
        let values = arguments.clone();
        self.called.push(MacroLevel { arguments, values });
    }

    /// Prepares the next run of the innermost of `depth` calls: ends the loops of the call. A
    /// G65 call gets its arguments again; a modal call keeps its variables.
    pub(crate) fn prepare_next_run(&mut self, call: &ProgramCall, depth: usize) {
        self.loops.retain(|it| it.call_depth < depth);
        if let (CallKind::Macro, Some(level)) = (call.kind, self.called.last_mut()) {
            level.values.clone_from(&level.arguments);
        }
    }

    /// Removes the level of a call that has ended; `depth` calls are left. The variables of a
    /// modal call are stored for its next run.
    pub(crate) fn pop_level(&mut self, call: &ProgramCall, depth: usize) {
        self.loops.retain(|it| it.call_depth <= depth);
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

    /// Ends the loops that a jump to `block` leaves. `depth` is the number of running calls;
    /// loops of callers and loops that contain `block` stay.
    pub(crate) fn end_left_loops(&mut self, depth: usize, block: u32) {
        let contains_target = |it: &RunningLoop| (it.first_block..=it.last_block).contains(&block);
        self.loops
            .retain(|it| it.call_depth < depth || contains_target(it));
    }

    /// The innermost running loop; `None` if that loop was not begun at `depth` running calls.
    pub(crate) fn innermost_loop(&self, depth: usize) -> Option<RunningLoop> {
        self.loops
            .last()
            .copied()
            .filter(|it| it.call_depth == depth)
    }

    /// Adds a loop, unless the innermost loop is the same one, which its DO repeats.
    pub(crate) fn enter_loop(&mut self, entered: RunningLoop) {
        if self.innermost_loop(entered.call_depth) != Some(entered) {
            self.loops.push(entered);
        }
    }

    /// Adds a modal call (G66). Returns false if `max_calls` calls exist already.
    pub(crate) fn add_modal_call(&mut self, modal: ModalCall, max_calls: usize) -> bool {
        let has_capacity = self.modal.len() < max_calls;
        if has_capacity {
            self.modal.push(modal);
        }
        has_capacity
    }

    /// Cancels the modal call that was made last (G67).
    pub(crate) fn cancel_modal_call(&mut self) {
        self.modal.pop();
    }

    /// The modal call that a move makes, with its index from 0: the last modal call that is
    /// not running. `None` if there is no such call.
    pub(crate) fn find_modal_call(&self, calls: &[ProgramCall]) -> Option<(u8, &ModalCall)> {
        let is_running = |index| {
            let kind = CallKind::Modal(index);
            calls.iter().any(|call| call.kind == kind)
        };
        let all = self.modal.iter().enumerate().rev();
        all.map(|(index, modal)| (index as u8, modal))
            .find(|(index, _)| !is_running(*index))
    }

    /// Whether a modal call is in force, so that a move may call a program.
    pub(crate) const fn has_modal_call(&self) -> bool {
        !self.modal.is_empty()
    }

    /// Whether there are no local variables with a value, no loops and no modal calls.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
