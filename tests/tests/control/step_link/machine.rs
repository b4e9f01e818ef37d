//! A control, its link and a board of timed steps, in virtual time.

use core::time::Duration;

use gsk_core::cnc::ControlRequest;
use gsk_core::linked::LinkedControl;
use gsk_core::operation::RunState;
use gsk_core::plc::address::BitAddress;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Axis;
use gsk_link::{LinkConfig, LinkState};
use gsk_twins::klipper::{KlipperHardware, KlipperTwin, TravelSwitch};

use super::bench::{MS_IN_NS, config};
use crate::bench::keys::{AUTO, CYCLE_START, RESET, X_PLUS, Z_PLUS, ZERO};

/// A step of Z, and the spindle turns at that moment.
#[derive(Clone, Copy, Debug)]
pub struct StepCut {
    pub place: i64,
    pub turns: f64,
    /// X, pulses.
    pub x: i64,
}

#[derive(Clone)]
pub struct StepMachine {
    pub simulation: Simulation,
    pub linked: LinkedControl,
    pub twin: KlipperTwin,
    /// Board pulses minus the kernel's.
    origin: [i64; 2],
    /// The steps since the last start, if they are recorded.
    pub cuts: Vec<StepCut>,
    /// Sleep of the host between two calls, ms.
    pub sleep: u64,
    pub worst_queue: usize,
}

impl StepMachine {
    /// Electronic gear 1/5, one switch for each axis 2 mm beyond the initial position.
    pub fn new() -> Self {
        Self::with_config(config(), &[])
    }

    /// The same with other wires and parameter bits.
    pub fn with_config(config: LinkConfig, bits: &[(u16, u8, bool)]) -> Self {
        let mut setup = Setup::delivered();
        for (number, bit, value) in bits {
            setup
                .memory
                .parameters
                .set_bit(*number, *bit, *value)
                .unwrap();
        }
        Self::one_switch(KlipperHardware::default(), config, setup)
    }

    /// The same with another board and control.
    pub fn one_switch(make: KlipperHardware, config: LinkConfig, mut setup: Setup) -> Self {
        for bit in [0, 1] {
            setup.memory.parameters.set_bit(7, bit, true).unwrap();
        }
        let mut machine = Self::with_wiring(make, config, setup);
        for (pin, axis, from, to) in [("PC4", 0, 800, 4800), ("PC6", 1, 400, 2400)] {
            let turn = None;
            let travel = TravelSwitch {
                stepper: axis,
                first_pulse: from,
                last_pulse: to,
                pulses_per_turn: turn,
            };
            machine.twin.place_switch(pin, travel);
        }
        machine
    }

    /// Electronic gear 1/5; no switches yet.
    pub fn with_wiring(make: KlipperHardware, config: LinkConfig, mut setup: Setup) -> Self {
        for number in [17, 18] {
            setup.memory.parameters.set(number, 5).unwrap();
        }
        let mut simulation = Simulation::new(setup);
        for _ in 0..100 {
            simulation.tick();
        }
        let mut twin = KlipperTwin::new(make);
        twin.set_pin("PC2", true);
        let linked = LinkedControl::open(config, &mut simulation, Duration::ZERO);
        Self {
            simulation,
            linked,
            twin,
            origin: [0; 2],
            cuts: Vec::new(),
            sleep: 1,
            worst_queue: 0,
        }
    }

    /// Pauses the host for some ms.
    pub fn pause_host(&mut self, ms: u32) {
        for _ in 0..ms {
            self.run_board_ms();
        }
    }

    fn run_board_ms(&mut self) {
        self.twin.advance(MS_IN_NS);
        let [x, _] = self.twin.pulses();
        for step in self.twin.take_recorded_steps() {
            if step.stepper == 1 {
                self.cuts.push(StepCut {
                    place: step.position - self.origin[1],
                    turns: self.twin.spindle_turns(step.at_ns),
                    x: x - self.origin[0],
                });
            }
        }
    }

    pub fn run_one_ms(&mut self) {
        self.run_board_ms();
        if !(self.twin.now() / MS_IN_NS).is_multiple_of(self.sleep) {
            return;
        }
        let now = Duration::from_nanos(self.twin.now());
        let bytes = self.twin.read();
        self.linked.pump(&bytes, now);
        while self.linked.can_tick() {
            self.linked.tick(&mut self.simulation);
        }
        let tx = self.linked.tx().to_vec();
        self.twin.write(&tx);
        self.linked.mark_written(tx.len());
        self.worst_queue = self
            .worst_queue
            .max(self.twin.statistics().max_queue_entries);
    }

    pub fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms {
            self.run_one_ms();
        }
    }

    pub fn run_until(&mut self, limit_ms: u32, until: impl Fn(&Self) -> bool) -> bool {
        (0..limit_ms).any(|_| {
            self.run_one_ms();
            until(self)
        })
    }

    pub fn press(&mut self, key: BitAddress) {
        for down in [true, false] {
            self.simulation.cnc.set_panel_key(key, down);
            self.run_ms(100);
        }
    }

    /// Returns both axes to their machine zero.
    pub fn return_axes(&mut self) {
        assert!(self.run_until(3000, |machine| machine.linked.state() == LinkState::Locked));
        self.press(RESET);
        self.press(ZERO);
        for (key, axis) in [(X_PLUS, Axis::X), (Z_PLUS, Axis::Z)] {
            // 011.2 ZNIK is off: the key must be held.
            self.simulation.cnc.set_panel_key(key, true);
            self.run_until(60_000, |machine| {
                *machine.simulation.cnc.referenced_axes().get(axis)
            });
            self.simulation.cnc.set_panel_key(key, false);
            self.run_ms(500);
        }
        assert_eq!(
            (self.linked.state(), self.alarms()),
            (LinkState::Ready, vec![])
        );
        let [x, z] = self.twin.pulses();
        let kernel = self.simulation.cnc.pulses();
        self.origin = [x - kernel.x.0, z - kernel.z.0];
    }

    pub fn alarms(&self) -> Vec<String> {
        let alarms = self.simulation.cnc.alarms();
        alarms.iter().map(ToString::to_string).collect()
    }

    /// Loads a program and starts it.
    pub fn start_program(&mut self, text: &str) {
        let opened = ControlRequest::OpenExternal(Program::new(text));
        self.simulation.cnc.request(opened).unwrap();
        self.press(AUTO);
        self.cuts.clear();
        self.press(CYCLE_START);
    }

    /// Runs until nothing runs and moves any more.
    pub fn finish(&mut self, limit_ms: u32) {
        let over = self.run_until(limit_ms, |machine| {
            let stands =
                !machine.linked.has_pending_motion() && !machine.simulation.cnc.is_moving();
            stands && machine.simulation.cnc.run_state() != RunState::Run
        });
        assert!(over, "it goes on and on: {:?}", self.alarms());
        self.run_ms(300);
    }

    /// Checks that the board has made what the kernel has commanded.
    #[track_caller]
    pub fn assert_agrees(&self) {
        let kernel = self.simulation.cnc.pulses();
        let [x, z] = self.twin.pulses();
        let made = [x - self.origin[0], z - self.origin[1]];
        assert_eq!(made, [kernel.x.0, kernel.z.0]);
    }

    /// Program coordinates at a count of zero, X as radius. Call it at rest.
    pub fn program_offset(&self) -> (f64, f64) {
        let (at, kernel) = (
            self.simulation.cnc.position_absolute(),
            self.simulation.cnc.pulses(),
        );
        (
            at.x - kernel.x.0 as f64 / 400.0,
            at.z - kernel.z.0 as f64 / 200.0,
        )
    }
}
