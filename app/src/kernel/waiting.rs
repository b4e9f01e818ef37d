//! Reports what the running program waits for, once that takes longer than usual.

use gsk_core::command::Source;
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;
use gsk_messages::Message;
use gsk_runner::machining::live::running;

/// Usual duration of a wait for tool post or spindle, ticks; shorter waits are not
/// reported.
const USUAL: u64 = 3000;

/// What a program waits for, and in which block.
#[derive(Clone, Debug, PartialEq)]
pub struct Waits {
    /// The condition it waits for.
    pub what: Message,
    pub block: Option<Source>,
}

/// The current wait, and the tick it began at.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    now: Option<Waits>,
    since: u64,
}

impl Waiting {
    /// Updates the current wait.
    pub(super) fn look(&mut self, tick: u64, simulation: &Simulation) {
        let now = simulation.cnc.waits_for().map(|what| Waits {
            what,
            block: running(simulation),
        });
        if self.now != now {
            self.now = now;
            self.since = tick;
        }
    }

    /// Returns the wait if it is longer than usual, or at once if the program is held.
    pub(super) fn said(&self, tick: u64, run: RunState) -> Option<Waits> {
        let is_long = run == RunState::Hold || tick.saturating_sub(self.since) >= USUAL;
        self.now.clone().filter(|_| is_long)
    }
}
