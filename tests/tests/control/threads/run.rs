//! A program on the simulated lathe, with a record of its events.

use gsk_core::cnc::Event;
use gsk_core::command::ExecutedMove;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

use crate::bench::program::{started, with_program};

const MINUTE: u32 = 60_000;

pub const SINGLE_BLOCK: BitAddress = BitAddress::new(Area::X, 20, 6);
pub const DRY_RUN: BitAddress = BitAddress::new(Area::X, 21, 2);
pub const FEED_HOLD: BitAddress = BitAddress::new(Area::X, 24, 7);
pub const CYCLE_START: BitAddress = BitAddress::new(Area::X, 25, 0);
pub const RESET: BitAddress = BitAddress::new(Area::X, 26, 0);
pub const SPINDLE_FASTER: BitAddress = BitAddress::new(Area::X, 24, 1);

/// Three blocks after the thread.
pub const G32: &str =
    "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG32 Z-20 F2\nG32 Z-30\nG00 X60\nZ5\nM30\n";

/// The dry-run set-up with other parameters.
pub fn setup(changes: &[(u16, i32)]) -> Setup {
    let mut setup = Setup::default();
    for (number, value) in changes {
        assert!(setup.memory.parameters.set(*number, *value).is_ok());
    }
    setup
}

/// A simulation with a record of its events.
pub struct ThreadRun {
    pub simulation: Simulation,
    pub moves: Vec<ExecutedMove>,
}

impl ThreadRun {
    pub fn new(text: &str, changes: &[(u16, i32)]) -> Self {
        Self::from_simulation(with_program(setup(changes), text))
    }

    pub fn started(text: &str, changes: &[(u16, i32)]) -> Self {
        Self::from_simulation(started(setup(changes), text))
    }

    fn from_simulation(simulation: Simulation) -> Self {
        Self {
            simulation,
            moves: Vec::new(),
        }
    }

    pub fn start(&mut self) {
        self.simulation.start_automatic();
    }

    pub fn tick(&mut self) {
        self.simulation.tick();
        for event in self.simulation.cnc.events() {
            if let Event::MoveEnded(piece) = event {
                self.moves.push(*piece);
            }
        }
    }

    pub fn run_ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    pub fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            self.run_ticks(100);
        }
    }

    /// Runs until the condition holds.
    #[track_caller]
    pub fn run_until(&mut self, what: &str, mut reached: impl FnMut(&Simulation) -> bool) {
        let come = (0..5 * MINUTE).any(|_| {
            self.tick();
            reached(&self.simulation)
        });
        assert!(
            come,
            "never {what}: line {} {:?} at {:?} {:?}",
            self.line(),
            self.state(),
            self.simulation.cnc.position_absolute(),
            self.simulation.cnc.alarms()
        );
    }

    #[track_caller]
    pub fn finish(&mut self) {
        self.run_until("stopped", |simulation| {
            simulation.cnc.run_state() != RunState::Run && !simulation.cnc.is_moving()
        });
    }

    #[track_caller]
    pub fn run_until_z(&mut self, z: f64) {
        self.run_until("at that Z", |simulation| {
            simulation.cnc.position_absolute().z <= z
        });
    }

    pub fn state(&self) -> RunState {
        self.simulation.cnc.run_state()
    }

    pub fn line(&self) -> u32 {
        self.simulation.cnc.cursor().line
    }

    pub fn z(&self) -> f64 {
        self.simulation.cnc.position_absolute().z
    }

    pub fn alarm(&self) -> Option<u16> {
        self.simulation
            .cnc
            .alarms()
            .first()
            .map(|alarm| alarm.number)
    }
}
