//! What the program under way waits for, once that takes longer than usual.

use gsk_core::command::Source;
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;
use gsk_messages::Message;
use gsk_runner::machining::live::running;

/// So long nothing is said, ticks: a tool post and a spindle take their time.
const USUAL: u64 = 3000;

/// What is waited for, and by which block.
#[derive(Clone, Debug, PartialEq)]
pub struct Waits {
    /// What has to come.
    pub what: Message,
    /// The block.
    pub block: Option<Source>,
}

/// The wait that goes on, and since which tick.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    now: Option<Waits>,
    since: u64,
}

impl Waiting {
    /// Looks again.
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

    /// What is to be said of it; of a program that is held at once.
    pub(super) fn said(&self, tick: u64, run: RunState) -> Option<Waits> {
        let is_long = run == RunState::Hold || tick.saturating_sub(self.since) >= USUAL;
        self.now.clone().filter(|_| is_long)
    }
}
