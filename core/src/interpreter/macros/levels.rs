//! Variables of macro calls, their loops and the modal call.
//!
//! ```text
//!   level 0  main program    #1–#33
//!   level 1  G65 P9010       #1–#33 of its own, filled by its arguments
//!   ...      four levels; M98 stays on the level it is called from
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::command::ProgramId;
use crate::interpreter::context::place::{Call, CallKind};
use crate::interpreter::macros::formula::Value;

/// Highest number of a local variable.
pub(crate) const LOCALS: u32 = 33;

/// Local variables that hold a number.
pub(crate) type Locals = BTreeMap<u8, f64>;

/// What a run over programs keeps for macros.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Levels {
    /// The main program's.
    main: Locals,
    /// Those of the calls under way.
    called: Vec<Level>,
    /// Loops under way, the innermost last.
    loops: Vec<Loop>,
    /// Programs that moves call, the last commanded last.
    modal: Vec<Modal>,
}

/// The variables of one call.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Level {
    /// What they are at the start of each run.
    arguments: Locals,
    values: Locals,
}

/// A loop under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Loop {
    /// Calls under way where it stands.
    pub(crate) depth: usize,
    /// DO m.
    pub(crate) number: u8,
    /// The blocks of DO and END.
    pub(crate) first: u32,
    pub(crate) last: u32,
}

/// G66.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Modal {
    pub(crate) program: ProgramId,
    pub(crate) runs: u16,
    pub(crate) arguments: Locals,
}

impl Levels {
    /// Those of a run that begins.
    pub(crate) const fn new() -> Self {
        Self {
            main: Locals::new(),
            called: Vec::new(),
            loops: Vec::new(),
            modal: Vec::new(),
        }
    }

    /// A local variable of the innermost level.
    pub(crate) fn get(&self, number: u8) -> Value {
        let values = self.called.last().map_or(&self.main, |level| &level.values);
        values.get(&number).copied()
    }

    /// Gives it a value, or none.
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

    /// Another level begins with these arguments.
    pub(crate) fn enter(&mut self, arguments: Locals) {
        let values = arguments.clone();
        self.called.push(Level { arguments, values });
    }

    /// The innermost call is run again: with its arguments anew, but for a modal one.
    pub(crate) fn run_again(&mut self, call: &Call, depth: usize) {
        self.loops.retain(|it| it.depth < depth);
        if let (CallKind::Macro, Some(level)) = (call.kind, self.called.last_mut()) {
            level.values.clone_from(&level.arguments);
        }
    }

    /// A call is over, so many are left. A modal one keeps its variables for the next.
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

    /// The run goes on at another block on the same level: loops around it stay.
    pub(crate) fn jump(&mut self, depth: usize, block: u32) {
        let around = |it: &Loop| (it.first..=it.last).contains(&block);
        self.loops.retain(|it| it.depth < depth || around(it));
    }

    /// The loop that stands innermost among so many calls.
    pub(crate) fn innermost(&self, depth: usize) -> Option<Loop> {
        self.loops.last().copied().filter(|it| it.depth == depth)
    }

    /// A loop is entered, or gone through once more.
    pub(crate) fn enter_loop(&mut self, entered: Loop) {
        if self.innermost(entered.depth) != Some(entered) {
            self.loops.push(entered);
        }
    }

    /// G66; whether there was room for it.
    pub(crate) fn add_modal(&mut self, modal: Modal, most: usize) -> bool {
        let room = self.modal.len() < most;
        if room {
            self.modal.push(modal);
        }
        room
    }

    /// G67: the last G66 is over.
    pub(crate) fn cancel_modal(&mut self) {
        self.modal.pop();
    }

    /// The modal call that a move makes now, with its index: the last one that is not
    /// itself under way.
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

    /// Nothing is kept.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
