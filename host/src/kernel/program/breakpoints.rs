//! Breakpoints on the learner's own simulated lathe: machine time stands still when one is hit,
//! until the operator continues.
//!
//! ```text
//!   tick --> a breakpoint, or the block after a step --> halt: no more ticks
//!     ^                                                    |
//!     +-- Continue, Next block, Ladder slot, a stop key ---+
//! ```

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Event;
use gsk_core::command::SourcePosition;
use gsk_core::simulation::Simulation;
use gsk_debugger::breakpoints::BreakpointSet;
use gsk_debugger::location::BreakLocation;
use gsk_messages::say;
use gsk_panel::keys::{Key, KeyRole};
use gsk_panel::panel::KeyEvent;
use gsk_runner::machining::live_part::running_block;

use super::super::edges::ends_motion;
use super::super::monitor::variable_values;
use super::super::{Command, Kernel, Notice};

#[cfg(test)]
mod tests;

/// A command of the window for the breakpoints.
#[derive(Clone, Debug, PartialEq)]
pub enum BreakpointCommand {
    /// Replace all breakpoints by those at these locations.
    Set(Vec<BreakLocation>),
    /// End the halt and continue machine time.
    Continue,
    /// Continue machine time until the next block begins.
    NextBlock,
    /// Continue machine time until the next slot of the ladder (8 ms) has run.
    NextSlot,
}

/// A halt of machine time, as the window shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct BreakpointHalt {
    /// The text of the breakpoint that was hit; `None` after a step.
    pub location: Option<String>,
    /// The block that begins, or the one that is being executed.
    pub block: Option<SourcePosition>,
    /// The alarm of a condition that could not be evaluated.
    pub fault: Option<Alarm>,
    /// Number and value of the variables that are neither null nor 0.
    pub variables: Vec<(u16, f64)>,
}

/// A step from one halt to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HaltStep {
    Block,
    Slot,
}

impl HaltStep {
    /// Whether the last tick ends the step, and the block that begins or is being executed.
    fn find_end(self, simulation: &Simulation) -> Option<Option<SourcePosition>> {
        let mut events = simulation.cnc.events().iter();
        match self {
            Self::Block => events.find_map(|event| match event {
                Event::BlockStarted(source, _) => Some(Some(*source)),
                _ => None,
            }),
            Self::Slot => {
                let has_run = simulation.cnc.has_run_ladder_slot();
                has_run.then(|| running_block(simulation))
            }
        }
    }
}

/// The breakpoints, and the halt at one of them.
#[derive(Debug, Default)]
pub(in crate::kernel) struct ProgramBreakpoints {
    breakpoints: BreakpointSet,
    /// The step that is under way; `None` without one.
    step: Option<HaltStep>,
    /// The halt of machine time; `None` while machine time runs.
    halt: Option<BreakpointHalt>,
}

impl ProgramBreakpoints {
    pub(in crate::kernel) const fn is_halted(&self) -> bool {
        self.halt.is_some()
    }

    pub(in crate::kernel) fn halt(&self) -> Option<BreakpointHalt> {
        self.halt.clone()
    }

    /// Ends the halt and a step; the breakpoints remain.
    pub(in crate::kernel) fn release(&mut self) {
        self.halt = None;
        self.step = None;
    }
}

impl Kernel {
    pub(in crate::kernel) fn execute_breakpoint_command(&mut self, command: BreakpointCommand) {
        let own = &mut self.program_breakpoints;
        match command {
            BreakpointCommand::Set(locations) => {
                own.breakpoints = BreakpointSet::default();
                for location in locations {
                    own.breakpoints.add(location);
                }
                self.resync_breakpoints();
            }
            BreakpointCommand::Continue => own.release(),
            BreakpointCommand::NextBlock => {
                own.halt = None;
                own.step = Some(HaltStep::Block);
            }
            BreakpointCommand::NextSlot => {
                own.halt = None;
                own.step = Some(HaltStep::Slot);
            }
        }
    }

    /// Takes the current state as that of the last tick, after the machine has gone to another
    /// moment.
    pub(in crate::kernel) fn resync_breakpoints(&mut self) {
        let simulation = self.emulator.simulation();
        let block = running_block(simulation);
        self.program_breakpoints
            .breakpoints
            .resync(simulation, block);
    }

    /// Halts machine time if the last tick has hit a breakpoint. Real slides and the machine of
    /// a lesson or an exercise have none.
    pub(in crate::kernel) fn follow_breakpoints(&mut self, has_collided: bool) {
        let own = &mut self.program_breakpoints;
        let is_armed = own.step.is_some() || !own.breakpoints.is_empty();
        if !is_armed || self.has_real_slides || self.lesson.is_some() {
            return;
        }
        let simulation = self.emulator.simulation();
        let hit = (own.breakpoints.follow_tick(simulation, has_collided))
            .into_iter()
            .next();
        let step_end = own.step.and_then(|step| step.find_end(simulation));
        let (location, block, fault) = match (hit, step_end) {
            (Some(hit), _) => {
                let location = own.breakpoints.location(hit.id);
                (location.map(|it| it.text.clone()), hit.block, hit.fault)
            }
            (None, Some(block)) => (None, block, None),
            (None, None) => return,
        };
        own.step = None;
        own.halt = Some(BreakpointHalt {
            location,
            block,
            fault,
            variables: variable_values(&simulation.cnc)
                .filter_map(|(number, value)| Some((number, value.filter(|it| *it != 0.0)?)))
                .collect(),
        });
    }

    /// Handles a command while machine time stands at a breakpoint; returns true if it is
    /// done. A stop key and cycle start let time run on, and act; page keys act at once, other
    /// keys not at all.
    pub(in crate::kernel) fn is_settled_in_halt(&mut self, command: &Command) -> bool {
        if !self.program_breakpoints.is_halted() {
            return false;
        }
        let key = match command {
            Command::Key { key, down: true } | Command::Tap(key) => *key,
            Command::Type(_) | Command::Turn(_) => {
                self.notify(Notice::Message(say::breakpoint_time_stands()));
                return true;
            }
            Command::Lesson(_)
            | Command::Exercise(_)
            | Command::PowerCycle
            | Command::OpenSample { .. }
            | Command::FreeLathe => {
                self.program_breakpoints.release();
                return false;
            }
            _ => return false,
        };
        if key == Key::CycleStart {
            self.program_breakpoints.release();
            return true;
        }
        if key == Key::EmergencyStop || ends_motion(key) {
            self.program_breakpoints.release();
            return false;
        }
        if key.row().role == KeyRole::Page {
            self.pass_key_event(KeyEvent::Down(key));
            self.pass_key_event(KeyEvent::Up(key));
        } else {
            self.notify(Notice::Message(say::breakpoint_time_stands()));
        }
        true
    }
}
