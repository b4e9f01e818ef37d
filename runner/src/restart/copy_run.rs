//! A copy of the machine that runs a program with the keys of an operator, without a clock.

use std::collections::VecDeque;

use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::simulation::Simulation;

use crate::machining::CollisionFinding;
use crate::machining::live_part::LivePart;

const AUTO_KEY: BitAddress = BitAddress::new(Area::X, 20, 1);
const START_KEY: BitAddress = BitAddress::new(Area::X, 25, 0);
/// Number of ticks for which a key is pressed, and then released, in the copy.
const PRESS_TICKS: u32 = 100;
/// Number of ticks after the last key within which the run must begin.
const START_TICKS: u32 = 300;

/// A copy of control, lathe and part, with the keys that are still to be pressed.
#[derive(Clone, Debug)]
pub(super) struct CopyRun {
    pub simulation: Simulation,
    pub part: Option<LivePart>,
    /// The keys to press in the copy: address, whether it is pressed, and the ticks until the next
    /// one.
    keys: VecDeque<(BitAddress, bool, u32)>,
    wait_ticks: u32,
    idle_ticks: u32,
    has_begun: bool,
}

/// Whether the program runs in the copy of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CopyProgress {
    /// Keys are being pressed in the copy, or its program runs.
    Running,
    /// The program in the copy waits for cycle start.
    Stopped,
    /// The program in the copy has ended, or it did not start.
    Ended,
}

impl CopyRun {
    /// Creates a run of a machine copy, whose next ticks press AUTO and cycle start.
    pub fn new(simulation: Simulation, part: Option<LivePart>) -> Self {
        let mut run = Self {
            simulation,
            part,
            keys: VecDeque::new(),
            wait_ticks: 0,
            idle_ticks: 0,
            has_begun: false,
        };
        run.press(AUTO_KEY);
        run.press(START_KEY);
        run
    }

    fn press(&mut self, key: BitAddress) {
        self.keys.push_back((key, true, PRESS_TICKS));
        self.keys.push_back((key, false, PRESS_TICKS));
    }

    /// Presses cycle start in the next ticks of the copy.
    pub fn press_cycle_start(&mut self) {
        self.idle_ticks = 0;
        self.press(START_KEY);
    }

    /// Advances the copy by one tick; returns the collisions of the part in this tick.
    pub fn tick(&mut self) -> Vec<CollisionFinding> {
        if self.wait_ticks > 0 {
            self.wait_ticks -= 1;
        } else if let Some((key, is_down, ticks)) = self.keys.pop_front() {
            self.simulation.cnc.set_panel_key(key, is_down);
            self.wait_ticks = ticks;
        }
        self.simulation.tick();
        let is_running = self.simulation.cnc.run_state() == RunState::Run;
        self.has_begun |= is_running;
        self.idle_ticks = if is_running || !self.keys.is_empty() {
            0
        } else {
            self.idle_ticks + 1
        };
        let part = self.part.as_mut();
        part.map_or_else(Vec::new, |part| part.follow_tick(&self.simulation).to_vec())
    }

    /// Returns whether the program in the copy runs, waits or has ended.
    pub fn progress(&self) -> CopyProgress {
        let cnc = &self.simulation.cnc;
        let state = cnc.run_state();
        if state == RunState::Run || cnc.is_moving() {
            return CopyProgress::Running;
        }
        let is_starting = !self.has_begun || !self.keys.is_empty() || self.wait_ticks > 0;
        match state {
            RunState::Reset if self.has_begun => CopyProgress::Ended,
            _ if is_starting && self.idle_ticks < START_TICKS => CopyProgress::Running,
            RunState::Reset => CopyProgress::Ended,
            _ if self.idle_ticks < PRESS_TICKS => CopyProgress::Running,
            _ => CopyProgress::Stopped,
        }
    }
}
