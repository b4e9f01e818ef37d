//! Read access for a debugger: formulas that no program contains, and the running calls.

use super::{Cnc, SLOT_TICKS};
use crate::alarm::Alarm;
use crate::interpreter::RunningCall;
use crate::program::WatchFormula;

impl Cnc {
    /// Evaluates a formula as macro B does; a comparison gives 1 or 0, and `None` is null. The
    /// values are those after the block that the control has read last. That block is at most
    /// one command ahead of the one in execution. Nothing changes.
    ///
    /// # Errors
    /// 111 for a value out of range, 112 for a division by 0, 115 for an unknown variable, 119
    /// for a wrong argument.
    pub fn evaluate(&self, formula: &WatchFormula) -> Result<Option<f64>, Alarm> {
        // The interpreter reads the control through a host that can also write.
        let mut copy = self.clone();
        let (interpreter, host) = copy.interpreter_and_world(true);
        interpreter.evaluate_watch(formula, &host)
    }

    /// Whether the last tick has run a slot of the ladder.
    pub const fn has_run_ladder_slot(&self) -> bool {
        self.ticks_since_ladder_slot() == 0
    }

    /// Number of ticks since the last slot of the ladder has run: 0 to 7.
    pub const fn ticks_since_ladder_slot(&self) -> u64 {
        (self.ticks + SLOT_TICKS - 1) % SLOT_TICKS
    }

    /// The running calls of subprograms and macros after the block that the control has read
    /// last, the innermost last.
    pub fn running_calls(&self) -> impl Iterator<Item = RunningCall> + '_ {
        self.run.interpreter.running_calls(&self.memory.programs)
    }
}
