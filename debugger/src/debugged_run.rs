//! A program that runs on the simulated lathe under a debugger: the machine, its part, and the
//! operator's keys.

use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::simulation::Simulation;
use gsk_runner::machining::CollisionFinding;
use gsk_runner::machining::live_part::LivePart;

use crate::call_stack::{CallFrame, CallStack};
use crate::source_files::find_block_line;

const AUTO_KEY: BitAddress = BitAddress::new(Area::X, 20, 1);
const START_KEY: BitAddress = BitAddress::new(Area::X, 25, 0);
/// Ticks for which a key is down, and the pause after its release.
const PRESS_TICKS: u32 = 100;
/// Ticks after cycle start within which the program must run.
const START_TICKS: u32 = 300;

/// The operator's keys: AUTO, then cycle start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum KeyStage {
    /// AUTO is pressed, for this number of further ticks; then it is up.
    Mode(u32),
    /// Cycle start is pressed, for this number of further ticks; then it is up.
    Start(u32),
    /// All keys are up; this number of ticks has passed since cycle start.
    Released(u32),
}

/// A machine and its run at one time, with all that a debugger needs to continue from there. A
/// clone stores this state.
#[derive(Clone, Debug)]
pub struct DebuggedRun {
    simulation: Simulation,
    part: Option<LivePart>,
    calls: CallStack,
    keys: KeyStage,
    has_begun: bool,
}

/// Whether the program of a run executes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunProgress {
    /// The keys of the operator start the program.
    Starting,
    /// The program is running.
    Running,
    /// The program has stopped at M00 or for single block: cycle start continues it.
    Stopped,
    /// The program has ended, or it did not start.
    Ended,
}

impl DebuggedRun {
    /// A run that begins with the next tick: the operator presses AUTO and cycle start. With
    /// `part` the run cuts the part and finds collisions.
    pub fn new(mut simulation: Simulation, part: Option<LivePart>) -> Self {
        simulation.cnc.set_explaining(true);
        Self {
            simulation,
            part,
            calls: CallStack::default(),
            keys: KeyStage::Mode(2 * PRESS_TICKS),
            has_begun: false,
        }
    }

    /// Advances control, lathe and part by one tick (1 ms). Returns the collisions of the tick.
    pub fn tick(&mut self) -> Vec<CollisionFinding> {
        self.move_keys();
        self.simulation.tick();
        let cnc = &self.simulation.cnc;
        self.has_begun |= cnc.run_state() == RunState::Run;
        self.calls.follow_tick(cnc);
        let found = self.part.as_mut();
        found.map_or_else(Vec::new, |part| part.follow_tick(&self.simulation).to_vec())
    }

    fn move_keys(&mut self) {
        let cnc = &mut self.simulation.cnc;
        self.keys = match self.keys {
            KeyStage::Mode(0) => KeyStage::Start(PRESS_TICKS),
            KeyStage::Mode(left) => {
                cnc.set_panel_key(AUTO_KEY, left > PRESS_TICKS);
                KeyStage::Mode(left - 1)
            }
            KeyStage::Start(0) => {
                cnc.set_panel_key(START_KEY, false);
                KeyStage::Released(0)
            }
            KeyStage::Start(left) => {
                cnc.set_panel_key(START_KEY, true);
                KeyStage::Start(left - 1)
            }
            KeyStage::Released(ticks) => KeyStage::Released(ticks.saturating_add(1)),
        };
    }

    /// Presses cycle start again, after a stop of the program.
    pub const fn press_cycle_start(&mut self) {
        self.keys = KeyStage::Start(PRESS_TICKS);
    }

    /// Returns whether the program is starting, running, stopped or ended.
    pub fn progress(&self) -> RunProgress {
        let cnc = &self.simulation.cnc;
        let KeyStage::Released(ticks) = self.keys else {
            return RunProgress::Starting;
        };
        match cnc.run_state() {
            RunState::Run => RunProgress::Running,
            _ if cnc.is_moving() => RunProgress::Running,
            // Cycle start does not continue it.
            _ if cnc.is_in_alarm() => RunProgress::Ended,
            RunState::Reset if self.has_begun => RunProgress::Ended,
            _ if ticks < START_TICKS => RunProgress::Starting,
            RunState::Stop | RunState::Hold => RunProgress::Stopped,
            RunState::Reset => RunProgress::Ended,
        }
    }

    /// Advances by one tick as a session does: a program that waits for cycle start continues.
    pub(crate) fn tick_again(&mut self) -> Vec<CollisionFinding> {
        if self.progress() == RunProgress::Stopped {
            self.press_cycle_start();
        }
        self.tick()
    }

    /// Returns the simulated control and lathe.
    pub const fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The call stack of the block in execution.
    pub const fn calls(&self) -> &CallStack {
        &self.calls
    }

    /// The levels of the call stack, the innermost first. Before the first block it is the main
    /// program alone, at that block.
    pub fn frames(&self) -> Vec<CallFrame> {
        let Some((program, line)) = self.entry_block() else {
            return self.calls.frames();
        };
        vec![CallFrame {
            program,
            line,
            is_macro: false,
            runs_left: 1,
        }]
    }

    /// Program and line of the first block while no block has begun; `None` after it has. The
    /// line of a program without a block is 1.
    pub(crate) fn entry_block(&self) -> Option<(ProgramId, u32)> {
        if self.calls.block().is_some() {
            return None;
        }
        let programs = self.simulation.cnc.programs();
        let program = programs.selected()?;
        let first = find_block_line(programs, &[program], 1);
        Some(first.unwrap_or((program, 1)))
    }

    /// The part that the run cuts; `None` without one.
    pub const fn part(&self) -> Option<&LivePart> {
        self.part.as_ref()
    }

    /// Returns the number of ticks (1 ms) since power-on.
    pub const fn ticks(&self) -> u64 {
        self.simulation.cnc.ticks()
    }
}
