//! Reports what the running program waits for, once that takes longer than usual.

use gsk_core::command::SourcePosition;
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;
use gsk_messages::Message;
use gsk_runner::machining::live_part::running_block;

/// Usual duration of a wait for tool post or spindle, ticks of 1 ms; shorter waits are not
/// reported.
const USUAL_WAIT_TICKS: u64 = 3000;

/// The condition for which a program waits, and the block that waits.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramWait {
    /// Describes the condition for which the program waits.
    pub condition: Message,
    pub block: Option<SourcePosition>,
}

/// The current wait of the program, and the tick at which it began.
#[derive(Debug, Default)]
pub(in crate::kernel) struct WaitWatch {
    current: Option<ProgramWait>,
    since_tick: u64,
}

impl WaitWatch {
    /// Stores what the program waits for at `tick`.
    pub(in crate::kernel) fn update(&mut self, tick: u64, simulation: &Simulation) {
        let now = simulation.cnc.wait_reason().map(|what| ProgramWait {
            condition: what,
            block: running_block(simulation),
        });
        if self.current != now {
            self.current = now;
            self.since_tick = tick;
        }
    }

    /// Returns the wait if it is longer than usual, or at once if the program is held; else
    /// `None`.
    pub(in crate::kernel) fn report(&self, tick: u64, run: RunState) -> Option<ProgramWait> {
        let is_long =
            run == RunState::Hold || tick.saturating_sub(self.since_tick) >= USUAL_WAIT_TICKS;
        self.current.clone().filter(|_| is_long)
    }
}
