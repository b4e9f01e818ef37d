//! Twin of a board with Klipper firmware on an 8 bit processor at 16 MHz.
//!
//! It makes steps at the commanded clocks, stops both axes when a switch trips or the host
//! does not renew its timeout, and shuts down on every request it cannot carry out: a step
//! in the past, a full move queue, an output that is not renewed. It models on purpose what
//! hosts get wrong: lost replies that are not repeated, a stop that clears direction and
//! step clock, a discarded queue, a receive buffer that overflows, and a configuration that
//! outlives the host.

mod block;
mod commands;
mod dictionary;
mod objects;
mod pins;
mod spindle;
mod stepper;
mod timers;

use std::collections::{BTreeMap, VecDeque};

use crate::wire::TwinWire;
use block::BufferFront;
pub use block::encode_block;
use dictionary::{Response, response_id};
use objects::{EdgeCounter, Endstop, Trsync, TwinOutput};
use spindle::KlipperSpindle;
pub use spindle::SpindleWiring;
use stepper::Stepper;

/// Clock frequency of the board, Hz, and number of entries in the move queue that all objects
/// share.
const CLOCK_HZ: u32 = 16_000_000;
const MOVE_QUEUE_SIZE: usize = 657;
/// Capacity of the receive buffer, bytes.
const RECEIVE_WINDOW_BYTES: usize = 192;
/// Time from a reset until the board can receive, ns.
const BOOT_NS: u64 = 60_000_000;
/// Processing time of a message block, ns.
const BLOCK_NS: u64 = 40_000;
const COMMAND_NS: u64 = 60_000;
/// Processing time of a step, ns, and the delay of a timer that causes a shutdown, ns.
const STEP_NS: i64 = 11_000;
const TOO_LATE_NS: i64 = 1_000_000;
/// Interval of `stats` messages, s.
const STATS_S: i64 = 5;

/// The state of the Klipper firmware on the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KlipperState {
    /// The firmware is starting and receives nothing.
    Booting,
    /// The firmware is running.
    Running,
    /// The firmware has shut down; the value is its reason.
    Shutdown(&'static str),
}

/// Properties of the board's hardware and firmware build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KlipperHardware {
    /// Rate of the serial line, bits/s.
    pub baud: u32,
    /// Error of the board's clock, millionths; positive if the clock is too fast.
    pub clock_error_ppm: i32,
    /// Whether the firmware has the command `reset`. Without it, only a shutdown lets the
    /// host clear the configuration.
    pub has_reset_command: bool,
}

impl Default for KlipperHardware {
    fn default() -> Self {
        Self {
            baud: 250_000,
            clock_error_ppm: 0,
            has_reset_command: true,
        }
    }
}

/// A switch on the travel of a slide, or the index signal of a motor. The signal is high while
/// the stepper is between two positions, once on the travel or once in every turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TravelSwitch {
    /// Index of the stepper whose position operates the switch, 0 or 1.
    pub stepper: usize,
    /// First position at which the signal is high, pulses.
    pub first_pulse: i64,
    /// Last position at which the signal is high, pulses.
    pub last_pulse: i64,
    /// Pulses per turn if the signal comes once in every turn; `None` for a switch.
    pub pulses_per_turn: Option<i64>,
}

impl TravelSwitch {
    pub(crate) const fn is_on(self, pulses: [i64; 2]) -> bool {
        let at = pulses[self.stepper % 2];
        match self.pulses_per_turn {
            Some(turn) => {
                (at - self.first_pulse).rem_euclid(turn) <= self.last_pulse - self.first_pulse
            }
            None => self.first_pulse <= at && at <= self.last_pulse,
        }
    }
}

/// A Klipper board with its two serial lines and its pins, in virtual time.
#[derive(Clone, Debug)]
pub struct KlipperTwin {
    now: u64,
    /// Serial line from the host to the board.
    pub to_board: TwinWire,
    /// Serial line from the board to the host.
    pub to_host: TwinWire,
    /// Number of clock ticks that the board counts in 1000 s.
    ticks_per_1000_s: u64,
    /// Time at which the clock was 0, ns.
    clock_zero_ns: u64,
    boots_at: Option<u64>,
    shutdown: Option<&'static str>,
    received: VecDeque<u8>,
    /// Whether the firmware drops bytes up to the next 7E. Its acknowledgement is already
    /// sent.
    needs_sync: bool,
    next_sequence: u8,
    busy_until: u64,
    dictionary: Vec<u8>,
    crc: Option<u32>,
    /// Number of object ids (oids) that the host has allocated; `None` before it has.
    oid_count: Option<u32>,
    oids: BTreeMap<u32, ConfigObject>,
    /// Clock, ticks, at which the processor has finished its last step. Later steps wait for
    /// it.
    processor_free_at: i64,
    stats_at: i64,
    input_levels: BTreeMap<u32, bool>,
    /// The switches that slides operate, by the number of their pin.
    travel_switches: BTreeMap<u32, TravelSwitch>,
    spindle: Option<KlipperSpindle>,
    /// Steps since the last call of [`KlipperTwin::take_recorded_steps`]; `None` if recording
    /// is off.
    recorded_steps: Option<Vec<MadeStep>>,
    /// Number of pulses of each stepper since power-on, with signs, in the order of their oids.
    pulses: [i64; 2],
    last_pulse_ns: u64,
    /// Times at which the commands of the last second were executed, ns.
    recent_command_times: VecDeque<u64>,
    statistics: KlipperStatistics,
}

/// Numbers and times that the board has measured since power-on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KlipperStatistics {
    /// Greatest number of entries in the shared move queue so far.
    pub max_queue_entries: usize,
    /// Shortest time from the command of a move to its first step, ns.
    pub min_lead_ns: i64,
    /// Number of commands that were executed.
    pub command_count: u64,
    /// Greatest number of commands executed within a second so far.
    pub max_commands_per_s: u32,
    /// Number of received requests for a part of the dictionary (`identify`).
    pub identify_count: u64,
    /// Number of steps that all steppers made.
    pub step_count: u64,
    /// Number of received commands for outputs.
    pub output_command_count: u64,
}

/// One step of a stepper, as recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MadeStep {
    /// Time of the step, ns.
    pub at_ns: u64,
    /// Scheduled time of the step, ns. The step is later if the processor is busy.
    pub due_ns: u64,
    /// Index of the stepper, 0 or 1.
    pub stepper: usize,
    /// Position of the stepper after the step, in pulses.
    pub position: i64,
}

#[derive(Clone, Debug)]
enum ConfigObject {
    Stepper(Stepper),
    Endstop(Endstop),
    Trsync(Trsync),
    Output(TwinOutput, u32),
    EdgeCounter(EdgeCounter),
}

impl KlipperTwin {
    /// Creates a board that has just been switched on.
    pub fn new(make: KlipperHardware) -> Self {
        let ticks_per_1000_s = (i64::from(CLOCK_HZ) * 1000
            + i64::from(CLOCK_HZ / 1000) * i64::from(make.clock_error_ppm))
        .unsigned_abs();
        let mut twin = Self {
            now: 0,
            to_board: TwinWire::new(make.baud),
            to_host: TwinWire::new(make.baud),
            ticks_per_1000_s,
            clock_zero_ns: 0,
            boots_at: None,
            shutdown: None,
            received: VecDeque::new(),
            needs_sync: false,
            next_sequence: 1,
            busy_until: 0,
            dictionary: dictionary::compressed_dictionary(
                CLOCK_HZ,
                RECEIVE_WINDOW_BYTES as u32,
                make.has_reset_command,
            ),
            crc: None,
            oid_count: None,
            oids: BTreeMap::new(),
            processor_free_at: 0,
            stats_at: 0,
            input_levels: BTreeMap::new(),
            travel_switches: BTreeMap::new(),
            spindle: None,
            recorded_steps: None,
            pulses: [0; 2],
            last_pulse_ns: 0,
            recent_command_times: VecDeque::new(),
            statistics: KlipperStatistics {
                max_queue_entries: 0,
                min_lead_ns: i64::MAX,
                command_count: 0,
                max_commands_per_s: 0,
                identify_count: 0,
                step_count: 0,
                output_command_count: 0,
            },
        };
        twin.press_reset();
        twin
    }

    /// Resets the board as the reset line or a power cycle does. The board loses its
    /// configuration.
    pub fn press_reset(&mut self) {
        self.boots_at = Some(self.now + BOOT_NS);
        self.received.clear();
        self.oids.clear();
        self.crc = None;
        self.oid_count = None;
        self.shutdown = None;
        self.drive_spindle(self.now);
    }

    /// Returns the state of the firmware.
    pub const fn state(&self) -> KlipperState {
        match (self.boots_at, self.shutdown) {
            (Some(_), _) => KlipperState::Booting,
            (None, Some(reason)) => KlipperState::Shutdown(reason),
            (None, None) => KlipperState::Running,
        }
    }

    /// Returns the pulses of both steppers since power-on, as a counter at the pins reads
    /// them.
    pub const fn pulses(&self) -> [i64; 2] {
        self.pulses
    }

    /// Returns the time of the last pulse of any stepper, ns.
    pub const fn last_pulse_ns(&self) -> u64 {
        self.last_pulse_ns
    }

    /// Returns the statistics since power-on.
    pub const fn statistics(&self) -> KlipperStatistics {
        self.statistics
    }

    /// Returns the current virtual time, ns.
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// Shuts the firmware down with this reason, as an internal fault does.
    pub fn force_shutdown(&mut self, reason: &'static str) {
        self.shut_down(reason);
    }

    /// Configures the board, so that it is in the state in which another host has left it.
    pub fn configure_for_another_host(&mut self) {
        self.boots_at = self.boots_at.map(|_| self.now);
        if self.boots_at.is_some() {
            self.start();
        }
        self.crc = Some(1);
    }

    /// Adds an error, pulses of each stepper, to the positions that the firmware reports.
    pub fn add_position_error(&mut self, pulses: [i64; 2]) {
        let mut off = pulses.into_iter();
        for object in self.oids.values_mut() {
            if let ConfigObject::Stepper(stepper) = object {
                stepper.position += off.next().unwrap_or_default();
            }
        }
    }

    /// Sets the level of the input pin `name` and removes its travel switch. Input pins that
    /// are not set are low.
    pub fn set_pin(&mut self, name: &str, level: bool) {
        if let Some(pin) = pins::pin_number(name) {
            self.travel_switches.remove(&pin);
            self.input_levels.insert(pin, level);
        }
    }

    /// Connects a switch on the travel of a slide to the pin `name`. The pin follows the
    /// position of the stepper.
    pub fn place_switch(&mut self, name: &str, travel: TravelSwitch) {
        if let Some(pin) = pins::pin_number(name) {
            self.travel_switches.insert(pin, travel);
        }
    }

    /// Sets the position of the slides at power-on, pulses.
    pub const fn place_slides(&mut self, pulses: [i64; 2]) {
        self.pulses = pulses;
    }

    /// Returns the last value of the output pin `name`; `None` if it is not configured.
    pub fn output(&self, name: &str) -> Option<u32> {
        let wanted = pins::pin_number(name)?;
        self.oids.values().find_map(|object| match object {
            ConfigObject::Output(output, value) if output.pin == wanted => Some(*value),
            _ => None,
        })
    }

    /// Starts to record every step of all steppers.
    pub fn start_recording_steps(&mut self) {
        self.recorded_steps = Some(Vec::new());
    }

    /// Returns the steps recorded since the last call.
    pub fn take_recorded_steps(&mut self) -> Vec<MadeStep> {
        self.recorded_steps
            .as_mut()
            .map(core::mem::take)
            .unwrap_or_default()
    }

    /// Sends bytes from the host to the board.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.send(bytes, self.now);
    }

    /// Returns the bytes that have arrived at the host, and removes them.
    pub fn read(&mut self) -> Vec<u8> {
        let now = self.now;
        std::iter::from_fn(|| self.to_host.receive(now)).collect()
    }

    /// Advances the virtual time by `ns` nanoseconds.
    pub fn advance(&mut self, ns: u64) {
        let end = self.now + ns;
        loop {
            let next = self.next_event().filter(|next| *next <= end);
            self.now = self.now.max(next.unwrap_or(end));
            if let Some(at) = self.boots_at {
                while self.to_board.receive(self.now).is_some() {}
                if self.now >= at {
                    self.start();
                }
            } else {
                self.run_timers();
                self.receive_bytes();
                self.process_blocks();
            }
            if next.is_none() {
                return;
            }
        }
    }

    fn next_event(&self) -> Option<u64> {
        if let Some(at) = self.boots_at {
            return Some(at);
        }
        let work =
            (!self.received.is_empty() && self.busy_until > self.now).then_some(self.busy_until);
        let timer = self
            .next_timer()
            .map(|clock| self.clock_to_ns(clock).max(self.now));
        let arrival = self.to_board.next_arrival().map(|at| at.max(self.now));
        [work, timer, arrival].into_iter().flatten().min()
    }

    fn start(&mut self) {
        self.boots_at = None;
        self.clock_zero_ns = self.now;
        self.next_sequence = 1;
        self.needs_sync = false;
        self.busy_until = self.now;
        self.processor_free_at = 0;
        self.stats_at = STATS_S * i64::from(CLOCK_HZ);
        self.send_response(Response::Starting, &[]);
        self.send_acknowledgement();
    }

    /// Returns the clock of the board at the current time, ticks.
    fn clock(&self) -> i64 {
        let since = u128::from(self.now - self.clock_zero_ns);
        (since * u128::from(self.ticks_per_1000_s) / 1_000_000_000_000) as i64
    }

    /// Returns the time at which the clock of the board reaches `clock` ticks, ns.
    fn clock_to_ns(&self, clock: i64) -> u64 {
        let ticks = u128::from(clock.max(0).unsigned_abs());
        let ns = (ticks * 1_000_000_000_000).div_ceil(u128::from(self.ticks_per_1000_s));
        self.clock_zero_ns + ns as u64
    }

    /// Extends the low 32 bits of a clock in a message to the full clock, ticks, that is
    /// nearest to now.
    fn extend_clock(&self, low: u32) -> i64 {
        let now = self.clock();
        now + i64::from(low.wrapping_sub(now as u32) as i32)
    }

    fn pin_level(&self, pin: u32) -> bool {
        let index = self
            .spindle
            .and_then(|spindle| spindle.level(pin, self.now));
        let travel = || {
            let travel = self.travel_switches.get(&pin)?;
            Some(travel.is_on(self.pulses))
        };
        let level = || self.input_levels.get(&pin).copied();
        index.or_else(travel).or_else(level).unwrap_or(false)
    }

    fn send(&mut self, content: &[u8]) {
        let block = encode_block(self.next_sequence, content);
        self.to_host.send(&block, self.now);
    }

    fn send_acknowledgement(&mut self) {
        self.send(&[]);
    }

    fn send_response(&mut self, response: Response, numbers: &[i64]) {
        let mut content = Vec::new();
        block::encode_vlq(&mut content, response_id(response));
        for number in numbers {
            block::encode_vlq(&mut content, *number);
        }
        self.send(&content);
    }

    /// Stores the bytes that arrive, as the receive interrupt does. Bytes that do not fit into
    /// the buffer are lost.
    fn receive_bytes(&mut self) {
        while let Some(byte) = self.to_board.receive(self.now) {
            if self.received.len() < RECEIVE_WINDOW_BYTES {
                self.received.push_back(byte);
            }
        }
    }

    /// Processes the received blocks at the speed of the processor.
    fn process_blocks(&mut self) {
        while self.now >= self.busy_until && self.boots_at.is_none() {
            if self.needs_sync {
                let end = self.received.iter().position(|&byte| byte == 0x7E);
                let count = end.map_or(self.received.len(), |end| end + 1);
                self.received.drain(..count);
                if end.is_none() {
                    return;
                }
                self.needs_sync = false;
                self.send_acknowledgement();
                continue;
            }
            match block::parse_front(self.received.make_contiguous()) {
                BufferFront::Incomplete => return,
                BufferFront::Skip(count) => {
                    self.received.drain(..count);
                }
                BufferFront::Invalid => self.needs_sync = true,
                BufferFront::Block(length, sequence) => {
                    let block: Vec<u8> = self.received.drain(..length).collect();
                    if sequence != self.next_sequence {
                        // Wrong sequence number: the host has to send the block again.
                        self.send_acknowledgement();
                        continue;
                    }
                    self.next_sequence = (sequence + 1) & 0x0F;
                    let count = self.execute(&block[2..length - 3]);
                    self.busy_until = self.now + BLOCK_NS + COMMAND_NS * count;
                    if self.boots_at.is_none() {
                        self.send_acknowledgement();
                    }
                }
            }
        }
    }

    /// Shuts the firmware down: stops all steppers and sets all outputs to their default
    /// values.
    fn shut_down(&mut self, reason: &'static str) {
        if self.shutdown.is_some() {
            return;
        }
        self.shutdown = Some(reason);
        for object in self.oids.values_mut() {
            match object {
                ConfigObject::Stepper(stepper) => stepper.stop(),
                ConfigObject::Endstop(endstop) => endstop.next = None,
                ConfigObject::Trsync(trsync) => *trsync = Trsync::default(),
                ConfigObject::Output(output, value) => {
                    output.queue.clear();
                    output.max_duration_end = None;
                    *value = output.default;
                }
                ConfigObject::EdgeCounter(counter) => counter.next = None,
            }
        }
        self.drive_spindle(self.now);
        let clock = self.clock();
        self.send_response(
            Response::Shutdown,
            &[
                i64::from(clock as u32),
                dictionary::static_string_id(reason),
            ],
        );
    }

    /// Returns the number of used entries in the shared move queue.
    fn queue_entries(&self) -> usize {
        let waiting = |object: &ConfigObject| match object {
            ConfigObject::Stepper(stepper) => stepper.queue_length(),
            ConfigObject::Output(output, _) => output.queue.len(),
            _ => 0,
        };
        self.oids.values().map(waiting).sum()
    }
}

#[cfg(test)]
mod tests;
