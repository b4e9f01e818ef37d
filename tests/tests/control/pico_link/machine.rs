//! A control, its link and our own pulse board, in virtual time.

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
use gsk_twins::klipper::TravelSwitch;
use gsk_twins::pico::{PicoStep, PicoTwin, SpindleEncoderWiring};

use crate::bench::keys::{AUTO, CYCLE_START, RESET, X_PLUS, Z_PLUS, ZERO};

/// One millisecond, ns.
pub const MS_IN_NS: u64 = 1_000_000;
/// Counts per turn of the spindle encoder.
pub const COUNTS: u32 = 4096;

pub const WIRED: &str = r#"(
    protocol: StepQueue,
    baud: 250000,
    x: (step: "gpio4", dir: "gpio5", limit: "gpio10", dec: "gpio12"),
    z: (step: "gpio2", dir: "gpio3", limit: "gpio22", dec: "gpio13"),
    io: (enable: "gpio14", estop: "gpio11", spindle_cw: "gpio15", spindle_ccw: "gpio19",
         spindle_pwm: "gpio20", coolant: "gpio21", index: "gpio18", encoder: "gpio16",
         encoder_counts: 4096),
)"#;

pub fn config(text: &str) -> LinkConfig {
    let config: LinkConfig = ron::from_str(text).unwrap();
    config.check().unwrap();
    config
}

/// The spindle of the tests: switched by the board, 2000 r/min at full output.
pub const SPINDLE: SpindleEncoderWiring = SpindleEncoderWiring {
    index_pin: 18,
    direction_pins: Some([15, 19]),
    speed_pin: Some(20),
    counts_per_turn: COUNTS,
    full_speed_rpm: 2000.0,
    time_constant_s: 0.2,
};

#[derive(Clone)]
pub struct PicoMachine {
    pub simulation: Simulation,
    pub linked: LinkedControl,
    pub twin: PicoTwin,
    /// Board pulses minus the kernel's.
    pub origin: [i64; 2],
    /// The steps since the last start.
    pub steps: Vec<PicoStep>,
    /// Sleep of the host between two calls, ms.
    pub sleep: u64,
    /// Whether the host has stopped.
    pub is_host_dead: bool,
}

impl PicoMachine {
    /// Electronic gear 1/5: a pulse of Z is 5 µm. A deceleration switch for each axis.
    pub fn new(wired: &str, parameters: &[(u16, i32)]) -> Self {
        let mut setup = Setup::delivered();
        // 001.3: a handwheel in place of the steps.
        for (number, bit) in [(1, 3), (7, 0), (7, 1)] {
            setup.memory.parameters.set_bit(number, bit, true).unwrap();
        }
        let gear = [(17, 5), (18, 5), (37, 2000)];
        for (number, value) in gear.iter().chain(parameters) {
            setup.memory.parameters.set(*number, *value).unwrap();
        }
        let mut simulation = Simulation::new(setup);
        for _ in 0..100 {
            simulation.tick();
        }
        let mut twin = PicoTwin::new();
        for (pin, axis, from, to) in [("gpio12", 0, 800, 4800), ("gpio13", 1, 400, 2400)] {
            let switch = TravelSwitch {
                stepper: axis,
                first_pulse: from,
                last_pulse: to,
                pulses_per_turn: None,
            };
            twin.place_switch(pin, switch);
        }
        twin.attach_spindle(SPINDLE);
        let linked = LinkedControl::open(config(wired), &mut simulation, Duration::ZERO);
        Self {
            simulation,
            linked,
            twin,
            origin: [0; 2],
            steps: Vec::new(),
            sleep: 1,
            is_host_dead: false,
        }
    }

    /// The same, referenced, with its steps recorded.
    pub fn referenced(parameters: &[(u16, i32)]) -> Self {
        let mut machine = Self::new(WIRED, parameters);
        machine.return_axes();
        machine.twin.start_recording_steps();
        machine
    }

    pub fn run_one_ms(&mut self) {
        self.twin.advance(MS_IN_NS);
        self.steps.extend(self.twin.take_recorded_steps());
        if self.is_host_dead || !(self.twin.now() / MS_IN_NS).is_multiple_of(self.sleep) {
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
        let is_open = self.run_until(4000, |machine| machine.linked.state() == LinkState::Locked);
        assert!(is_open, "{:?} {:?}", self.linked.state(), self.alarms());
        self.press(RESET);
        self.press(ZERO);
        for (key, axis) in [(X_PLUS, Axis::X), (Z_PLUS, Axis::Z)] {
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
        self.steps.clear();
        self.press(CYCLE_START);
    }

    pub fn is_over(&self) -> bool {
        let stands = !self.linked.has_pending_motion() && !self.simulation.cnc.is_moving();
        stands && self.simulation.cnc.run_state() != RunState::Run
    }

    /// Runs until nothing runs and moves any more.
    pub fn finish(&mut self, limit_ms: u32) {
        let over = self.run_until(limit_ms, Self::is_over);
        assert!(
            over,
            "it does not end: {:?} {:?} {:?}",
            self.alarms(),
            self.linked.state(),
            self.twin.state()
        );
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
