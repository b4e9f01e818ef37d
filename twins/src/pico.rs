//! Twin of the pulse board with our own firmware: the engine of the firmware itself
//! (`firmware/motion`), with its line, its pins and a spindle in virtual time.

mod port;
mod spindle;

use gsk_motion::messages::REASONS;
use gsk_motion::{DICTIONARY, Engine, EngineState, Session};

use crate::klipper::TravelSwitch;
use crate::wire::TwinWire;
pub use port::TwinAxisEncoder;
use port::{PicoPort, TICK_NS};
use spindle::EncoderSpindle;
pub use spindle::{SpindleEncoderWiring, SpindleLoad};

/// Rate of the serial line, bits/s.
const BAUD: u32 = 250_000;
/// Time from a reset to the first message, ns.
const BOOT_NS: u64 = 20_000_000;
/// Ticks between two calls of the engine while an axis is active: 4 µs.
const ACTIVE_TICKS: u64 = 62;
/// Ticks between two calls while no axis is active: 32 µs.
const IDLE_TICKS: u64 = 500;
/// Greatest number of counts of the spindle between two calls.
const MAX_COUNTS: f64 = 2.0;

/// The state of the firmware on the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PicoState {
    /// The firmware is starting.
    Booting,
    /// The firmware takes commands.
    Running,
    /// The lease has expired: the axes slow down.
    Stopping,
    /// The firmware has shut down for this reason.
    Shutdown(&'static str),
}

/// One step of an axis, as recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PicoStep {
    /// Time of the step, ns.
    pub at_ns: u64,
    /// Index of the stepper, 0 or 1.
    pub stepper: usize,
    /// Position of the stepper after the step, pulses.
    pub position: i64,
    /// Position of the other stepper, pulses.
    pub other_position: i64,
    /// Turns of the spindle, negative in reverse.
    pub turns: f64,
    /// Count of the spindle encoder.
    pub count: i64,
}

/// A Raspberry Pi Pico with our firmware, its serial line and its pins, in virtual time.
#[derive(Clone, Debug)]
pub struct PicoTwin {
    now_ns: u64,
    /// Serial line from the host to the board.
    pub to_board: TwinWire,
    /// Serial line from the board to the host.
    pub to_host: TwinWire,
    session: Session,
    dictionary: &'static [u8],
    engine: Engine,
    port: PicoPort,
    boots_at: Option<u64>,
    starts: u32,
}

impl Default for PicoTwin {
    fn default() -> Self {
        Self::new()
    }
}

/// Reads the number of a pin from its name, `gpio16`.
fn pin_number(name: &str) -> Option<u32> {
    name.strip_prefix("gpio")?.parse().ok()
}

impl PicoTwin {
    /// Creates a board that has just been switched on.
    pub fn new() -> Self {
        Self {
            now_ns: 0,
            to_board: TwinWire::new(BAUD),
            to_host: TwinWire::new(BAUD),
            session: Session::default(),
            dictionary: DICTIONARY,
            engine: Engine::new(),
            port: PicoPort::default(),
            boots_at: Some(BOOT_NS),
            starts: 0,
        }
    }

    /// Resets the board as its RUN pin or a power cycle does: outputs go off, and the board loses
    /// its configuration.
    pub fn press_reset(&mut self) {
        self.boots_at = Some(self.now_ns + BOOT_NS);
        self.session = Session::with_dictionary(self.dictionary);
        self.engine = Engine::new();
        self.port.reset(self.now_ns / TICK_NS);
    }

    /// Returns the state of the firmware.
    pub fn state(&self) -> PicoState {
        match self.engine.state() {
            _ if self.boots_at.is_some() => PicoState::Booting,
            EngineState::Running => PicoState::Running,
            EngineState::Stopping(_) => PicoState::Stopping,
            EngineState::ShutDown(reason) => PicoState::Shutdown(REASONS[reason as usize]),
        }
    }

    /// Returns the virtual time, ns.
    pub const fn now(&self) -> u64 {
        self.now_ns
    }

    /// Returns how often the firmware has started.
    pub const fn starts(&self) -> u32 {
        self.starts
    }

    /// Returns the pulses of both axes since power-on, as a counter at the pins reads them.
    pub const fn pulses(&self) -> [i64; 2] {
        self.port.pulses
    }

    /// Returns the number of steps of both axes since power-on.
    pub const fn step_count(&self) -> u64 {
        self.port.step_count
    }

    /// Returns the time of the last pulse, ns.
    pub const fn last_pulse_ns(&self) -> u64 {
        self.port.last_pulse_tick * TICK_NS
    }

    /// Sets the position of the slides at power-on, pulses.
    pub const fn place_slides(&mut self, pulses: [i64; 2]) {
        self.port.pulses = pulses;
    }

    /// Sets the level of the input pin `name` and removes its travel switch.
    pub fn set_pin(&mut self, name: &str, is_high: bool) {
        if let Some(pin) = pin_number(name) {
            self.port.set_level(pin, is_high);
        }
    }

    /// Connects a switch on the travel of a slide to the pin `name`.
    pub fn place_switch(&mut self, name: &str, switch: TravelSwitch) {
        if let Some(pin) = pin_number(name) {
            self.port.place_switch(pin, switch);
        }
    }

    /// Returns the value of the output pin `name` as a share of the full one; `None` if it is not
    /// set up.
    pub fn output(&self, name: &str) -> Option<f64> {
        self.port.outputs.get(&pin_number(name)?).copied()
    }

    /// Starts to record every step of both axes.
    pub fn start_recording_steps(&mut self) {
        self.port.steps = Some(Vec::new());
    }

    /// Returns the steps recorded since the last call.
    pub fn take_recorded_steps(&mut self) -> Vec<PicoStep> {
        let steps = self.port.steps.as_mut();
        steps.map(core::mem::take).unwrap_or_default()
    }

    /// Connects the encoder of an axis (0 or 1).
    pub fn attach_axis_encoder(&mut self, axis: usize, encoder: TwinAxisEncoder) {
        if let Some(slot) = self.port.axis_encoders.get_mut(axis) {
            *slot = Some(encoder);
        }
    }

    /// Turns the handwheel by some counts of its encoder.
    pub const fn turn_wheel(&mut self, counts: i32) {
        self.port.wheel_count = self.port.wheel_count.wrapping_add(counts);
    }

    /// Lets the motor of an axis lose steps.
    pub fn lose_steps(&mut self, axis: usize, steps: i64) {
        if let Some(encoder) = self
            .port
            .axis_encoders
            .get_mut(axis)
            .and_then(Option::as_mut)
        {
            encoder.lost_steps += steps;
        }
    }

    /// Attaches a spindle with its encoder.
    pub fn attach_spindle(&mut self, wiring: SpindleEncoderWiring) {
        self.port.spindle = Some(EncoderSpindle::new(wiring));
    }

    fn change_spindle(&mut self, change: impl FnOnce(&mut EncoderSpindle)) {
        if let Some(spindle) = &mut self.port.spindle {
            change(spindle);
        }
    }

    /// Sets the speed of a spindle that the board does not switch, r/min.
    pub fn run_spindle(&mut self, rpm: f64) {
        self.change_spindle(|spindle| spindle.set_speed(rpm / 60.0));
    }

    /// Adds a ripple to the spindle speed: amplitude in per cent, number in a turn.
    pub fn set_speed_ripple(&mut self, percent: f64, per_turn: f64) {
        self.change_spindle(|spindle| spindle.ripple = (percent / 100.0, per_turn));
    }

    /// Sets the load that slows the spindle down when a slide enters an interval.
    pub fn set_load(&mut self, load: Option<SpindleLoad>) {
        self.change_spindle(|spindle| spindle.load = load);
    }

    /// Stalls the spindle, or ends that.
    pub fn set_stalled(&mut self, is_stalled: bool) {
        self.change_spindle(|spindle| spindle.is_stalled = is_stalled);
    }

    /// Lets the spindle keep its speed and direction whatever the outputs are, or ends that.
    pub fn set_spindle_drive_stuck(&mut self, is_stuck: bool) {
        self.change_spindle(|spindle| spindle.is_drive_stuck = is_stuck);
    }

    /// Takes the effect from the output that reverses the spindle, or restores it.
    pub fn set_reverse_missing(&mut self, is_missing: bool) {
        self.change_spindle(|spindle| spindle.is_reverse_missing = is_missing);
    }

    /// Makes the firmware an older one: its dictionary does not have a command.
    pub fn use_older_firmware(&mut self, missing_command: &str) {
        let unpacked = miniz_oxide::inflate::decompress_to_vec_zlib(DICTIONARY).unwrap_or_default();
        let text = String::from_utf8_lossy(&unpacked);
        let text = text.replace(&format!("\"{missing_command} "), "\"unknown_command ");
        let packed = miniz_oxide::deflate::compress_to_vec_zlib(text.as_bytes(), 9);
        // The firmware's dictionary is static, too.
        self.dictionary = packed.leak();
        self.session = Session::with_dictionary(self.dictionary);
    }

    /// Exchanges A and B of the spindle encoder, or ends that.
    pub fn set_encoder_reversed(&mut self, is_reversed: bool) {
        self.change_spindle(|spindle| spindle.is_encoder_reversed = is_reversed);
    }

    /// Shifts the count of the spindle encoder, as lost or doubled edges do.
    pub fn jump_encoder(&mut self, counts: i64) {
        self.change_spindle(|spindle| spindle.jumped += counts);
    }

    /// Suppresses the index signal, or restores it.
    pub fn set_index_lost(&mut self, is_lost: bool) {
        self.change_spindle(|spindle| spindle.is_index_lost = is_lost);
    }

    /// Holds the index signal high, as a disturbance does, or ends that.
    pub fn set_index_stuck(&mut self, is_stuck: bool) {
        self.change_spindle(|spindle| spindle.is_index_stuck = is_stuck);
    }

    /// Returns the turns of the spindle since power-on, negative in reverse.
    pub fn spindle_turns(&self) -> f64 {
        self.port.spindle.map_or(0.0, |spindle| spindle.turns)
    }

    /// Returns the spindle speed, r/min, negative in reverse.
    pub fn spindle_rpm(&self) -> f64 {
        let spindle = self.port.spindle;
        spindle.map_or(0.0, |spindle| spindle.actual_speed() * 60.0)
    }

    /// Sends bytes from the host to the board.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.send(bytes, self.now_ns);
    }

    /// Returns the bytes that have arrived at the host, and removes them.
    pub fn read(&mut self) -> Vec<u8> {
        let now = self.now_ns;
        std::iter::from_fn(|| self.to_host.receive(now)).collect()
    }

    /// Advances the virtual time by `ns`.
    pub fn advance(&mut self, ns: u64) {
        let end = self.now_ns + ns;
        while self.now_ns < end {
            let ticks = self.ticks_to_next_call();
            let ticks = ticks.min((end - self.now_ns).div_ceil(TICK_NS)).max(1);
            self.now_ns += ticks * TICK_NS;
            self.port.advance(ticks);
            if let Some(at) = self.boots_at {
                while self.to_board.receive(self.now_ns).is_some() {}
                if self.now_ns < at {
                    continue;
                }
                self.boots_at = None;
                self.starts += 1;
                self.port.clock_zero = self.now_ns / TICK_NS;
                self.port.clock = 0;
                self.engine.report_start();
            }
            self.receive();
            self.engine.poll(&mut self.port);
            while let Some(event) = self.engine.next_event() {
                let block = self.session.encode(&event);
                self.to_host.send(&block, self.now_ns);
            }
            if self.port.restarts {
                self.press_reset();
            }
        }
    }

    fn ticks_to_next_call(&self) -> u64 {
        let most = if self.engine.is_idle() {
            IDLE_TICKS
        } else {
            ACTIVE_TICKS
        };
        let Some(spindle) = &self.port.spindle else {
            return most;
        };
        let turns = spindle.actual_speed().abs().max(1e-3);
        let counts = turns * f64::from(spindle.wiring.counts_per_turn) * TICK_NS as f64 * 1e-9;
        most.min((MAX_COUNTS / counts) as u64).max(1)
    }

    fn receive(&mut self) {
        while let Some(byte) = self.to_board.receive(self.now_ns) {
            let (to_host, now) = (&mut self.to_host, self.now_ns);
            let (engine, port) = (&mut self.engine, &mut self.port);
            self.session.push(
                byte,
                |block| to_host.send(&block, now),
                |request| engine.execute(&request, port),
            );
            if self.port.restarts {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests;
