//! Connects a control to a simulated lathe.

use gsk_plc::address::{Area, BitAddress};
use serde::{Deserialize, Serialize};

use crate::board::{BoardInputs, BoardOrders};
use crate::cnc::Cnc;
use crate::machine::{BoardContacts, MachineInputs, SimulatedLathe};
use crate::operation::RunState;
use crate::setup::Setup;
use crate::units::{Point, TICK_MS};

/// PLC address of the key 自动 (automatic mode), X20.1.
const AUTO_KEY: BitAddress = BitAddress {
    area: Area::X,
    byte: 20,
    bit: 1,
};
/// PLC address of the key 运行 (cycle start), X25.0.
const CYCLE_START_KEY: BitAddress = BitAddress {
    area: Area::X,
    byte: 25,
    bit: 0,
};
/// Time for which a simulated key press holds the key, and the pause after its release,
/// ticks.
const KEY_TICKS: u32 = 100;

/// A [`Cnc`] connected to a simulated lathe.
///
/// ```
/// use gsk_core::simulation::{RunUntilResult, Simulation, StopCondition};
/// use gsk_core::setup::Setup;
/// let mut simulation = Simulation::new(Setup::default());
/// assert_eq!(simulation.run_until(StopCondition::Stopped, 1000), RunUntilResult::Reached);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simulation {
    /// The simulated control of the lathe.
    pub cnc: Cnc,
    /// The simulated lathe that the control drives.
    pub lathe: SimulatedLathe,
    inputs: MachineInputs,
    /// Orders for the pulse board from the last tick; `None` before the first tick or
    /// without a board.
    #[serde(skip)]
    board_orders: Option<Box<BoardOrders>>,
}

/// The condition for which [`Simulation::run_until`] waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopCondition {
    /// No program is running (reset, block end or alarm) and the axes are stationary.
    Stopped,
    /// The block at the cursor has changed, or the run has stopped.
    BlockEnd,
}

/// Whether [`Simulation::run_until`] reached its condition or its time limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunUntilResult {
    /// The condition became true within the time limit.
    Reached,
    /// The time limit expired before the condition became true.
    TimedOut,
}

impl Simulation {
    /// Connects a control to its lathe and switches both on.
    pub fn new(setup: Setup) -> Self {
        let wired = setup.wired.as_ref().unwrap_or(&setup.memory.parameters);
        let mut lathe = SimulatedLathe::new(setup.lathe.clone(), wired);
        for (address, state) in &setup.forced_inputs {
            lathe.force_input(*address, Some(*state));
        }
        if let Some(rpm) = setup.spindle_rpm {
            lathe.turn_spindle(rpm);
        }
        if let Some(position) = setup.slides.or(setup.start) {
            lathe.move_slides(position);
        }
        let cnc = Cnc::new(setup);
        lathe.set_count(cnc.pulses());
        let inputs = lathe.inputs();
        Self {
            cnc,
            lathe,
            inputs,
            board_orders: None,
        }
    }

    /// Simulates one tick of 1 ms.
    pub fn tick(&mut self) {
        let outputs = self.cnc.tick(&self.inputs);
        self.lathe.tick(&outputs, &mut self.inputs);
        if self.cnc.will_sample_contacts() || self.lathe.has_bouncing_contacts() {
            self.lathe.read_contacts(&mut self.inputs);
        }
        self.board_orders = outputs.board;
    }

    /// Disconnects the simulated slides: a board moves the real ones, whose position is
    /// unknown.
    pub(crate) fn attach_board(&mut self) {
        self.lathe.set_real_slides(true);
        self.cnc.attach_board();
        self.board_orders = None;
    }

    /// Connects the simulated slides again, after the board was disconnected.
    pub(crate) fn detach_board(&mut self) {
        self.inputs.board = None;
        self.board_orders = None;
        self.cnc.detach_board();
        self.lathe.set_real_slides(false);
    }

    /// A copy of the machine in which a program can be tried. Slides that a pulse board moves are
    /// simulated in it: they are where they stand now, with the same reference.
    pub fn trial_copy(&self) -> Self {
        let mut copy = self.clone();
        if copy.cnc.has_board() {
            copy.inputs.board = None;
            copy.board_orders = None;
            copy.cnc.simulate_slides();
            copy.lathe.set_real_slides(false);
            copy.place_slides(self.cnc.position_machine());
        }
        copy
    }

    /// Stores the reports of a pulse board as inputs of the next tick.
    pub(crate) fn set_board(&mut self, board: BoardInputs) {
        self.inputs.board = Some(Box::new(board));
    }

    /// Orders for the board from the last tick. Before the first tick with a board, the
    /// orders for the current state of the control.
    pub(crate) fn board_orders(&self) -> BoardOrders {
        self.board_orders
            .as_deref()
            .map_or_else(|| self.cnc.board_orders(), |orders| *orders)
    }

    /// Replaces simulated contacts by the contacts that are wired to a pulse board.
    pub(crate) fn add_board_contacts(&mut self, board: &BoardContacts) {
        self.lathe.add_board_contacts(&mut self.inputs, board);
    }

    /// Runs ticks until the condition `until` is true, at most for `limit_ms` of machine
    /// time. The condition is checked after each tick.
    pub fn run_until(&mut self, until: StopCondition, limit_ms: u64) -> RunUntilResult {
        let block = self.cnc.cursor();
        for _ in 0..limit_ms / u64::from(TICK_MS) {
            self.tick();
            let stopped = self.cnc.run_state() != RunState::Run && !self.cnc.is_moving();
            let reached = match until {
                StopCondition::Stopped => stopped,
                StopCondition::BlockEnd => stopped || self.cnc.cursor() != block,
            };
            if reached {
                return RunUntilResult::Reached;
            }
        }
        RunUntilResult::TimedOut
    }

    /// Selects AUTO and presses cycle start; each key is down for 100 ms.
    pub fn start_automatic(&mut self) {
        for key in [AUTO_KEY, CYCLE_START_KEY] {
            for down in [true, false] {
                self.cnc.set_panel_key(key, down);
                for _ in 0..KEY_TICKS {
                    self.tick();
                }
            }
        }
    }

    /// Places the slides, which stand still, at another position, mm (X as a radius). The
    /// control knows the new position.
    pub fn place_slides(&mut self, position: Point) {
        self.cnc.place_slides(position);
        self.lathe.move_slides(position);
        self.lathe.set_count(self.cnc.pulses());
        self.inputs = self.lathe.inputs();
    }

    /// Switches the power of the control off and on. Retained memory is kept and the lathe
    /// does not move. The spindle drive is rewired to match 001.4.
    pub fn power_cycle(&mut self) {
        self.cnc.power_cycle();
        self.lathe.rewire_spindle(self.cnc.parameters());
        self.lathe.set_count(self.cnc.pulses());
        self.inputs = self.lathe.inputs();
    }
}
