//! The control with its link and a pulse board in virtual time: the firmware in the emulator or its
//! twin, both with the same spindle and the same switches.

#![allow(dead_code, reason = "each test uses a part")]

use std::time::Duration;

use gsk_core::cnc::ControlRequest;
use gsk_core::linked::LinkedControl;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Axis;
use gsk_link::{LinkConfig, LinkState};
use gsk_twins::pico::{PicoTwin, SpindleEncoderWiring};
use pico_bench::{Bench, CYCLES_PER_S};

/// Counts per turn of the spindle encoder.
pub const COUNTS: i64 = 4096;
/// Ripples of the spindle in a turn.
const RIPPLES: f64 = 3.0;
/// Angle of the spindle at power-on, turns.
const FIRST_ANGLE: f64 = 0.3;
/// Intervals in which the deceleration switches are operated, pulses of X and Z.
const SWITCHES: [[i64; 2]; 2] = [[100, 500], [60, 300]];

const WIRED: &str = r#"(
    protocol: StepQueue,
    baud: 250000,
    x: (step: "gpio2", dir: "gpio3", limit: "gpio10", dec: "gpio12"),
    z: (step: "gpio4", dir: "gpio5", dec: "gpio13"),
    io: (enable: "gpio14", estop: "gpio11", spindle_cw: "gpio15", spindle_ccw: "gpio19",
         spindle_pwm: "gpio20", coolant: "gpio21", index: "gpio18", encoder: "gpio16",
         encoder_counts: 4096),
)"#;

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress {
        area: Area::X,
        byte,
        bit,
    }
}

const AUTO: BitAddress = key(20, 1);
const ZERO: BitAddress = key(20, 3);
const X_PLUS: BitAddress = key(23, 1);
const Z_PLUS: BitAddress = key(22, 7);
const CYCLE_START: BitAddress = key(25, 0);
const RESET: BitAddress = key(26, 0);

/// A step of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// 0 is X, 1 is Z.
    pub axis: usize,
    pub is_up: bool,
    /// Count of the spindle.
    pub count: i64,
}

/// A board with its pins in virtual time.
pub trait PulseBoard {
    fn create() -> Self;
    fn now(&self) -> Duration;
    /// Sets the speed of the spindle, negative in reverse, and the amplitude of its ripple as
    /// a fraction.
    fn set_spindle(&mut self, rpm: f64, ripple: f64);
    fn set_input(&mut self, pin: u32, is_high: bool);
    fn run_one_ms(&mut self);
    fn read(&mut self) -> Vec<u8>;
    fn write(&mut self, bytes: &[u8]);
    fn take_steps(&mut self) -> Vec<Step>;
}

/// The built firmware in the emulator.
pub struct Emulated {
    pub bench: Bench,
    spindle: std::rc::Rc<std::cell::Cell<(f64, f64)>>,
}

impl PulseBoard for Emulated {
    fn create() -> Self {
        let mut bench = Bench::start();
        bench.from_board = Some(Vec::new());
        bench.index_counts = 4;
        let spindle = std::rc::Rc::new(std::cell::Cell::new((0.0, 0.0)));
        let (mut turns, mut last, set) = (FIRST_ANGLE, bench.cycle(), spindle.clone());
        bench.set_spindle(move |cycle| {
            let seconds = (cycle - last) as f64 / CYCLES_PER_S;
            last = cycle;
            let (rpm, ripple) = set.get();
            let phase: f64 = turns * RIPPLES * std::f64::consts::TAU;
            turns += rpm / 60.0 * (1.0 + ripple * phase.sin()) * seconds;
            (turns * COUNTS as f64).floor() as i64
        });
        Self { bench, spindle }
    }

    fn now(&self) -> Duration {
        Duration::from_secs_f64(self.bench.cycle() as f64 / CYCLES_PER_S)
    }

    fn set_spindle(&mut self, rpm: f64, ripple: f64) {
        self.spindle.set((rpm, ripple));
    }

    fn set_input(&mut self, pin: u32, is_high: bool) {
        self.bench.drive_input(pin, is_high);
    }

    fn run_one_ms(&mut self) {
        self.bench.run(125_000);
    }

    fn read(&mut self) -> Vec<u8> {
        self.bench
            .from_board
            .replace(Vec::new())
            .unwrap_or_default()
    }

    fn write(&mut self, bytes: &[u8]) {
        self.bench.write(bytes);
    }

    fn take_steps(&mut self) -> Vec<Step> {
        self.bench.falls.clear();
        self.bench.direction_changes.clear();
        let step = |edge: pico_bench::StepEdge| Step {
            axis: edge.axis,
            is_up: edge.is_up,
            count: edge.count,
        };
        self.bench.edges.drain(..).map(step).collect()
    }
}

/// The twin, with the last position of each axis.
pub struct Twin {
    twin: PicoTwin,
    last: [i64; 2],
}

impl PulseBoard for Twin {
    fn create() -> Self {
        let mut twin = PicoTwin::new();
        twin.attach_spindle(SpindleEncoderWiring {
            index_pin: 18,
            direction_pins: None,
            speed_pin: None,
            counts_per_turn: COUNTS as u32,
            full_speed_rpm: 0.0,
            time_constant_s: 0.0,
        });
        twin.start_recording_steps();
        Self { twin, last: [0; 2] }
    }

    fn now(&self) -> Duration {
        Duration::from_nanos(self.twin.now())
    }

    fn set_spindle(&mut self, rpm: f64, ripple: f64) {
        self.twin.run_spindle(rpm);
        self.twin.set_speed_ripple(100.0 * ripple, RIPPLES);
    }

    fn set_input(&mut self, pin: u32, is_high: bool) {
        self.twin.set_pin(&format!("gpio{pin}"), is_high);
    }

    fn run_one_ms(&mut self) {
        self.twin.advance(1_000_000);
    }

    fn read(&mut self) -> Vec<u8> {
        self.twin.read()
    }

    fn write(&mut self, bytes: &[u8]) {
        self.twin.write(bytes);
    }

    fn take_steps(&mut self) -> Vec<Step> {
        let mut recorded = self.twin.take_recorded_steps();
        // The twin records the axes one after the other.
        recorded.sort_by_key(|step| step.at_ns);
        let steps = recorded.iter().map(|step| {
            let last = &mut self.last[step.stepper];
            let is_up = step.position > *last;
            *last = step.position;
            Step {
                axis: step.stepper,
                is_up,
                count: step.count,
            }
        });
        steps.collect()
    }
}

/// The speed of the spindle over a program.
#[derive(Clone, Copy, Debug)]
pub struct SpindleProfile {
    /// Mean speed, r/min, negative in reverse.
    pub rpm: f64,
    /// Amplitude of the ripple as a fraction of the speed.
    pub ripple: f64,
    /// Time from the start of the program and duration of a loss of speed, ms.
    pub dip_ms: [u32; 2],
    /// The fraction of the speed that is lost; 1 is a standstill.
    pub lost: f64,
}

impl SpindleProfile {
    /// Returns the speed at a time after the start of the program, r/min.
    fn speed(&self, ms: u32) -> f64 {
        let [from, duration] = self.dip_ms;
        if (from..from + duration).contains(&ms) {
            self.rpm * (1.0 - self.lost)
        } else {
            self.rpm
        }
    }
}

/// The control, its link and a board.
pub struct Machine<B> {
    pub simulation: Simulation,
    pub linked: LinkedControl,
    pub board: B,
    pub steps: Vec<Step>,
    /// The pulses that the control has commanded, in the order of its ticks.
    pub commanded: [Vec<bool>; 2],
    last_commanded: [i64; 2],
    /// Pulses of both axes since power-on.
    pub pulses: [i64; 2],
    profile: Option<SpindleProfile>,
    /// Time from the start of the program, ms.
    pub ran_ms: u32,
}

impl<B: PulseBoard> Machine<B> {
    /// Opens the board and returns both axes to their machine zero. A pulse is 2.5 µm of X and
    /// 5 µm of Z. The lathe has a chuck, without which M12 stops a program.
    pub fn referenced() -> Self {
        let mut setup = Setup::delivered().with_chuck();
        for bit in [0, 1] {
            setup.memory.parameters.set_bit(7, bit, true).unwrap();
        }
        for (number, value) in [(17, 5), (18, 5), (37, 2000)] {
            setup.memory.parameters.set(number, value).unwrap();
        }
        let mut simulation = Simulation::new(setup);
        for _ in 0..100 {
            simulation.tick();
        }
        let board = B::create();
        let config: LinkConfig = ron::from_str(WIRED).unwrap();
        config.check().unwrap();
        let linked = LinkedControl::open(config, &mut simulation, board.now());
        let mut machine = Self {
            simulation,
            linked,
            board,
            steps: Vec::new(),
            commanded: [Vec::new(), Vec::new()],
            last_commanded: [0; 2],
            pulses: [0; 2],
            profile: None,
            ran_ms: 0,
        };
        machine.return_axes();
        machine
    }

    pub fn run_one_ms(&mut self) {
        if let Some(profile) = self.profile {
            let rpm = profile.speed(self.ran_ms);
            self.board.set_spindle(rpm, profile.ripple);
        }
        self.ran_ms += 1;
        self.board.run_one_ms();
        let steps = self.board.take_steps();
        for step in &steps {
            self.pulses[step.axis] += if step.is_up { 1 } else { -1 };
        }
        if !steps.is_empty() {
            for (pin, at, interval) in [
                (12, self.pulses[0], SWITCHES[0]),
                (13, self.pulses[1], SWITCHES[1]),
            ] {
                let is_operated = (interval[0]..=interval[1]).contains(&at);
                self.board.set_input(pin, is_operated);
            }
        }
        self.steps.extend(steps);
        let bytes = self.board.read();
        self.linked.pump(&bytes, self.board.now());
        while self.linked.can_tick() {
            self.linked.tick(&mut self.simulation);
            self.record_commanded();
        }
        let sent = self.linked.tx().to_vec();
        self.board.write(&sent);
        self.linked.mark_written(sent.len());
    }

    fn record_commanded(&mut self) {
        let pulses = self.simulation.cnc.pulses();
        for (axis, at) in [pulses.x.0, pulses.z.0].into_iter().enumerate() {
            let last = core::mem::replace(&mut self.last_commanded[axis], at);
            let is_up = at > last;
            let count = (at - last).unsigned_abs() as usize;
            self.commanded[axis].extend(std::iter::repeat_n(is_up, count));
        }
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

    fn press(&mut self, key: BitAddress) {
        for is_down in [true, false] {
            self.simulation.cnc.set_panel_key(key, is_down);
            self.run_ms(60);
        }
    }

    fn return_axes(&mut self) {
        for pin in [10, 11, 12, 13] {
            self.board.set_input(pin, false);
        }
        let is_open = self.run_until(4000, |machine| machine.linked.state() == LinkState::Locked);
        assert!(is_open, "{:?} {:?}", self.linked.state(), self.alarms());
        self.press(RESET);
        self.press(ZERO);
        for (key, axis) in [(X_PLUS, Axis::X), (Z_PLUS, Axis::Z)] {
            self.simulation.cnc.set_panel_key(key, true);
            self.run_until(30_000, |machine| {
                *machine.simulation.cnc.referenced_axes().get(axis)
            });
            self.simulation.cnc.set_panel_key(key, false);
            self.run_ms(200);
        }
        assert_eq!(
            (self.linked.state(), self.alarms()),
            (LinkState::Ready, vec![])
        );
        self.press(AUTO);
    }

    /// The active alarms and the message of the ladder, which stops a program as well.
    pub fn alarms(&self) -> Vec<String> {
        let cnc = &self.simulation.cnc;
        let alarms = cnc.alarms().iter().map(ToString::to_string);
        let message = cnc.active_message().map(|message| message.to_string());
        alarms.chain(message).collect()
    }

    /// Starts a program with a spindle; the steps are recorded from now on.
    pub fn start_program(&mut self, text: &str, profile: SpindleProfile) {
        let opened = ControlRequest::OpenExternal(Program::new(text));
        self.simulation.cnc.request(opened).unwrap();
        // The spindle is up to speed when the program starts.
        self.board.set_spindle(profile.rpm, profile.ripple);
        self.profile = None;
        self.run_ms(100);
        self.steps.clear();
        self.commanded = [Vec::new(), Vec::new()];
        self.profile = Some(profile);
        self.ran_ms = 0;
        self.press(CYCLE_START);
    }

    pub fn is_over(&self) -> bool {
        let is_moving = self.linked.has_pending_motion() || self.simulation.cnc.is_moving();
        !is_moving && self.simulation.cnc.run_state() != RunState::Run
    }

    /// Runs a program to its end; returns its steps.
    pub fn run_program(&mut self, text: &str, profile: SpindleProfile) -> Vec<Step> {
        self.start_program(text, profile);
        let is_over = self.run_until(1_500_000, Self::is_over);
        assert!(is_over, "{text}\n{:?}", self.alarms());
        self.run_ms(50);
        assert_eq!(self.alarms(), [""; 0], "{text}");
        std::mem::take(&mut self.steps)
    }
}

/// The directions of the steps of an axis.
pub fn ups(steps: &[Step], axis: usize) -> Vec<bool> {
    let of_axis = steps.iter().filter(|step| step.axis == axis);
    of_axis.map(|step| step.is_up).collect()
}

/// The number of steps that the other axis has made before each step of an axis.
fn others_before(steps: &[Step], axis: usize) -> Vec<i64> {
    let (mut other, mut before) = (0, Vec::new());
    for step in steps {
        if step.axis == axis {
            before.push(other);
        } else {
            other += 1;
        }
    }
    before
}

/// The greatest distance of the paths of two runs whose axes make the same steps, steps.
///
/// It is measured at each step, along the axis in which it is less: where an axis begins to move,
/// a hundredth of a step in its position is many steps of the other axis.
pub fn paths_apart(one: &[Step], other: &[Step]) -> i64 {
    let [one, other] = [one, other].map(|steps| [0, 1].map(|axis| others_before(steps, axis)));
    let mut apart = 0;
    for axis in 0..2 {
        let count = other[axis].len() as i64;
        for (made, (at, at_other)) in (1..).zip(one[axis].iter().zip(&other[axis])) {
            // The steps of this axis while the other one stands there in the other run.
            let passes = &other[1 - axis];
            let index = *at as usize;
            let first = if index == 0 { 0 } else { passes[index - 1] };
            let last = passes.get(index).copied().unwrap_or(count);
            let along = (first - made).max(made - last).max(0);
            apart = apart.max(along.min((at - at_other).abs()));
        }
    }
    apart
}

/// The greatest difference of two values at the same place.
pub fn greatest_difference(one: &[i64], other: &[i64]) -> i64 {
    let pairs = one.iter().zip(other);
    pairs
        .map(|(one, other)| (one - other).abs())
        .max()
        .unwrap_or(0)
}
