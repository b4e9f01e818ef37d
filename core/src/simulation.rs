//! A control and a simulated lathe, wired.

use gsk_plc::address::{Area, BitAddress};
use serde::{Deserialize, Serialize};

use crate::board::{BoardInputs, BoardOrders};
use crate::cnc::Cnc;
use crate::machine::{BoardContacts, Inputs, Lathe};
use crate::operation::RunState;
use crate::setup::Setup;
use crate::units::TICK_MS;

/// The 自动 key, X20.1.
const AUTO_KEY: BitAddress = BitAddress {
    area: Area::X,
    byte: 20,
    bit: 1,
};
/// The 运行 key, X25.0.
const CYCLE_START_KEY: BitAddress = BitAddress {
    area: Area::X,
    byte: 25,
    bit: 0,
};
/// How long a finger presses, and rests, ticks.
const KEY_TICKS: u32 = 100;

/// A [`Cnc`] with the simulated lathe that hangs on it.
///
/// ```
/// use gsk_core::simulation::{Outcome, Simulation, Until};
/// use gsk_core::setup::Setup;
/// let mut simulation = Simulation::new(Setup::default());
/// assert_eq!(simulation.run_until(Until::Stopped, 1000), Outcome::Reached);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Simulation {
    /// The control.
    pub cnc: Cnc,
    /// The lathe.
    pub lathe: Lathe,
    inputs: Inputs,
    /// What the last tick wants of a pulse board.
    #[serde(skip)]
    board_orders: Option<Box<BoardOrders>>,
}

/// What [`Simulation::run_until`] waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Until {
    /// No program runs (reset, block end or alarm) and the axes stand.
    Stopped,
    /// A block has ended or the run has stopped.
    BlockEnd,
}

/// How [`Simulation::run_until`] ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The condition came true.
    Reached,
    /// The time limit came first.
    TimedOut,
}

impl Simulation {
    /// Wires a control to its lathe, at power-on.
    pub fn new(setup: Setup) -> Self {
        let wired = setup.wired.as_ref().unwrap_or(&setup.memory.parameters);
        let mut lathe = Lathe::new(setup.lathe.clone(), wired);
        for (address, state) in &setup.forced_inputs {
            lathe.force_input(*address, Some(*state));
        }
        if let Some(rpm) = setup.spindle_rpm {
            lathe.turn_spindle(rpm);
        }
        if let Some(place) = setup.slides.or(setup.start) {
            lathe.put_slides(place);
        }
        let cnc = Cnc::new(setup);
        lathe.stand_at(cnc.pulses());
        let inputs = lathe.inputs();
        Self {
            cnc,
            lathe,
            inputs,
            board_orders: None,
        }
    }

    /// One millisecond.
    pub fn tick(&mut self) {
        let outputs = self.cnc.tick(&self.inputs);
        self.lathe.tick(&outputs, &mut self.inputs);
        if self.cnc.samples_contacts_next() || self.lathe.contacts_bounce() {
            self.lathe.read_contacts(&mut self.inputs);
        }
        self.board_orders = outputs.board;
    }

    /// The slides are real from now on, and nobody knows where they stand.
    pub(crate) fn attach_board(&mut self) {
        self.lathe.set_real_slides(true);
        self.cnc.attach_board();
        self.board_orders = None;
    }

    /// The slides are simulated again.
    pub(crate) fn detach_board(&mut self) {
        self.inputs.board = None;
        self.board_orders = None;
        self.cnc.detach_board();
        self.lathe.set_real_slides(false);
    }

    /// What a pulse board says to the control in the next tick.
    pub(crate) fn set_board(&mut self, board: BoardInputs) {
        self.inputs.board = Some(Box::new(board));
    }

    /// What the last tick wants of the board; before the first one, what the control
    /// stands for.
    pub(crate) fn board_orders(&self) -> BoardOrders {
        self.board_orders
            .as_deref()
            .map_or_else(|| self.cnc.board_orders(), |orders| *orders)
    }

    /// The contacts that a pulse board has wired, over the simulated ones.
    pub(crate) fn add_board_contacts(&mut self, board: &BoardContacts) {
        self.lathe.add_board_contacts(&mut self.inputs, board);
    }

    /// Ticks until the condition holds, at most `limit_ms` of machine time. The
    /// condition is looked at after each tick.
    pub fn run_until(&mut self, until: Until, limit_ms: u64) -> Outcome {
        let block = self.cnc.cursor();
        for _ in 0..limit_ms / u64::from(TICK_MS) {
            self.tick();
            let stopped = self.cnc.run_state() != RunState::Run && !self.cnc.is_moving();
            let reached = match until {
                Until::Stopped => stopped,
                Until::BlockEnd => stopped || self.cnc.cursor() != block,
            };
            if reached {
                return Outcome::Reached;
            }
        }
        Outcome::TimedOut
    }

    /// Selects AUTO and presses cycle start, as fingers do: down 100 ms, up.
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

    /// Switches the control off and on again: retained memory is kept, the lathe
    /// stays where it stands. Its spindle is driven as 001.4 says then.
    pub fn power_cycle(&mut self) {
        self.cnc.power_cycle();
        self.lathe.fit_spindle(self.cnc.parameters());
        self.lathe.stand_at(self.cnc.pulses());
        self.inputs = self.lathe.inputs();
    }
}
