//! A board with Klipper firmware on an 8 bit processor of 16 MHz.
//!
//! It makes steps at the clocks it is told, stops both axes by itself when a switch
//! is operated or its host falls silent, and shuts down whenever it is asked for
//! something it cannot do: a step in the past, a queue that is full, an output that
//! is not renewed. What hosts trip over is modelled on purpose: replies that are
//! lost for good, a stop that forgets direction and step clock, a dropped queue, a
//! receive buffer that overflows, a configuration that outlives the host.

mod block;
mod commands;
mod dictionary;
mod objects;
mod pins;
mod spindle;
mod stepper;
mod timers;

use std::collections::{BTreeMap, VecDeque};

use crate::wire::Wire;
use block::BufferFront;
pub use block::encode_block;
use dictionary::{Response, response_id};
use objects::{EdgeCounter, Endstop, Output, Trsync};
use spindle::KlipperSpindle;
pub use spindle::SpindleWiring;
use stepper::Stepper;

/// Ticks a second, and places of the common queue.
const CLOCK_HZ: u32 = 16_000_000;
const MOVE_QUEUE_SIZE: usize = 657;
/// Bytes the receive buffer holds.
const RECEIVE_WINDOW_BYTES: usize = 192;
/// From a reset to the first word, ns.
const BOOT_NS: u64 = 60_000_000;
/// Time a block takes, and each command in it, ns.
const BLOCK_NS: u64 = 40_000;
const COMMAND_NS: u64 = 60_000;
/// Time a step takes; a timer that is later than the second ends it all, ns.
const STEP_NS: i64 = 11_000;
const TOO_LATE_NS: i64 = 1_000_000;
/// Between two words about its load, s.
const STATS_S: i64 = 5;

/// What the board is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KlipperState {
    /// It starts.
    Booting,
    /// It works.
    Running,
    /// It has given up, for this reason.
    Shutdown(&'static str),
}

/// How the board is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KlipperHardware {
    /// Bits a second of its line.
    pub baud: u32,
    /// Its clock is so much too fast, millionths.
    pub clock_error_ppm: i32,
    /// It knows the command `reset`; if not, it forgets its configuration only when it
    /// is shut down.
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

/// A switch, or the zero signal of a motor, on the way of a slide: high while the
/// count of its stepper is from `from` to `to`, once or once a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TravelSwitch {
    /// First or second stepper.
    pub stepper: usize,
    /// First pulse on it.
    pub first_pulse: i64,
    /// Last pulse on it.
    pub last_pulse: i64,
    /// Pulses of a turn, when it comes once a turn.
    pub pulses_per_turn: Option<i64>,
}

impl TravelSwitch {
    const fn is_on(self, pulses: [i64; 2]) -> bool {
        let at = pulses[self.stepper % 2];
        match self.pulses_per_turn {
            Some(turn) => {
                (at - self.first_pulse).rem_euclid(turn) <= self.last_pulse - self.first_pulse
            }
            None => self.first_pulse <= at && at <= self.last_pulse,
        }
    }
}

/// A board, its two wires and its pins, in virtual time.
#[derive(Clone, Debug)]
pub struct KlipperTwin {
    now: u64,
    /// Host to board.
    pub to_board: Wire,
    /// Board to host.
    pub to_host: Wire,
    /// Real ticks in a thousand seconds.
    ticks_per_1000_s: u64,
    /// When the clock was zero, ns.
    clock_zero_ns: u64,
    boots_at: Option<u64>,
    shutdown: Option<&'static str>,
    received: VecDeque<u8>,
    /// Bytes up to the next 7E are dropped; the host has been told.
    needs_sync: bool,
    next_sequence: u8,
    busy_until: u64,
    dictionary: Vec<u8>,
    crc: Option<u32>,
    /// How many oids there may be, once the host has said so.
    oid_count: Option<u32>,
    oids: BTreeMap<u32, ConfigObject>,
    /// Steps done until this clock; a busy processor makes them late.
    processor_free_at: i64,
    stats_at: i64,
    input_levels: BTreeMap<u32, bool>,
    /// Switches on the way of the slides.
    travel_switches: BTreeMap<u32, TravelSwitch>,
    spindle: Option<KlipperSpindle>,
    /// Steps made since they are recorded.
    recorded_steps: Option<Vec<MadeStep>>,
    /// Pulses made since power-on at the steppers, in the order of their oids.
    pulses: [i64; 2],
    last_pulse_ns: u64,
    /// When the commands of the last second were carried out.
    recent_command_times: VecDeque<u64>,
    statistics: KlipperStatistics,
}

/// What a test wants to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KlipperStatistics {
    /// Most places ever in use of the common queue.
    pub max_queue_entries: usize,
    /// Shortest time from a step's command to the step, ns.
    pub min_lead_ns: i64,
    /// Commands carried out.
    pub command_count: u64,
    /// Most commands carried out in any second.
    pub max_commands_per_s: u32,
    /// Requests for a piece of the dictionary.
    pub identify_count: u64,
    /// Steps made.
    pub step_count: u64,
    /// Orders for outputs.
    pub output_command_count: u64,
}

/// A step that was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MadeStep {
    /// When, ns.
    pub at_ns: u64,
    /// When it was to be, ns: a processor that makes another step is late.
    pub due_ns: u64,
    /// First or second stepper.
    pub stepper: usize,
    /// Pulses behind it.
    pub position: i64,
}

#[derive(Clone, Debug)]
enum ConfigObject {
    Stepper(Stepper),
    Endstop(Endstop),
    Trsync(Trsync),
    Output(Output, u32),
    EdgeCounter(EdgeCounter),
}

impl KlipperTwin {
    /// A board that has just got power.
    pub fn new(make: KlipperHardware) -> Self {
        let ticks_per_1000_s = (i64::from(CLOCK_HZ) * 1000
            + i64::from(CLOCK_HZ / 1000) * i64::from(make.clock_error_ppm))
        .unsigned_abs();
        let mut twin = Self {
            now: 0,
            to_board: Wire::new(make.baud),
            to_host: Wire::new(make.baud),
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

    /// The reset line, or power: everything is gone.
    pub fn press_reset(&mut self) {
        self.boots_at = Some(self.now + BOOT_NS);
        self.received.clear();
        self.oids.clear();
        self.crc = None;
        self.oid_count = None;
        self.shutdown = None;
        self.drive_spindle(self.now);
    }

    /// What the board is doing.
    pub const fn state(&self) -> KlipperState {
        match (self.boots_at, self.shutdown) {
            (Some(_), _) => KlipperState::Booting,
            (None, Some(reason)) => KlipperState::Shutdown(reason),
            (None, None) => KlipperState::Running,
        }
    }

    /// Pulses made since power-on, first and second stepper: what a counter at the
    /// pins reads.
    pub const fn pulses(&self) -> [i64; 2] {
        self.pulses
    }

    /// When the last pulse came, ns.
    pub const fn last_pulse_ns(&self) -> u64 {
        self.last_pulse_ns
    }

    /// Figures since power-on.
    pub const fn statistics(&self) -> KlipperStatistics {
        self.statistics
    }

    /// Virtual time, ns.
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// Something in the board makes it give up, with this text of its firmware.
    pub fn force_shutdown(&mut self, reason: &'static str) {
        self.shut_down(reason);
    }

    /// Another host has been here and left its configuration behind.
    pub fn configure_for_another_host(&mut self) {
        self.boots_at = self.boots_at.map(|_| self.now);
        if self.boots_at.is_some() {
            self.start();
        }
        self.crc = Some(1);
    }

    /// The firmware loses count: its steppers believe to stand so many pulses beside
    /// their places.
    pub fn add_position_error(&mut self, pulses: [i64; 2]) {
        let mut off = pulses.into_iter();
        for object in self.oids.values_mut() {
            if let ConfigObject::Stepper(stepper) = object {
                stepper.position += off.next().unwrap_or_default();
            }
        }
    }

    /// Gives an input pin a level, whatever switch is there; pins nobody gave one are
    /// low.
    pub fn set_pin(&mut self, name: &str, level: bool) {
        if let Some(pin) = pins::pin_number(name) {
            self.travel_switches.remove(&pin);
            self.input_levels.insert(pin, level);
        }
    }

    /// Puts a switch on the way of a slide; its pin follows the pulses.
    pub fn place_switch(&mut self, name: &str, travel: TravelSwitch) {
        if let Some(pin) = pins::pin_number(name) {
            self.travel_switches.insert(pin, travel);
        }
    }

    /// The slides stand elsewhere when the power comes on.
    pub const fn place_slides(&mut self, pulses: [i64; 2]) {
        self.pulses = pulses;
    }

    /// What an output pin was last given.
    pub fn output(&self, name: &str) -> Option<u32> {
        let wanted = pins::pin_number(name)?;
        self.oids.values().find_map(|object| match object {
            ConfigObject::Output(output, value) if output.pin == wanted => Some(*value),
            _ => None,
        })
    }

    /// Every step is written down from now on.
    pub fn start_recording_steps(&mut self) {
        self.recorded_steps = Some(Vec::new());
    }

    /// The steps written down since the last call.
    pub fn take_recorded_steps(&mut self) -> Vec<MadeStep> {
        self.recorded_steps
            .as_mut()
            .map(core::mem::take)
            .unwrap_or_default()
    }

    /// The host writes bytes.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.send(bytes, self.now);
    }

    /// What has arrived at the host.
    pub fn read(&mut self) -> Vec<u8> {
        let now = self.now;
        std::iter::from_fn(|| self.to_host.receive(now)).collect()
    }

    /// Lets time pass, ns.
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

    /// The clock now.
    fn clock(&self) -> i64 {
        let since = u128::from(self.now - self.clock_zero_ns);
        (since * u128::from(self.ticks_per_1000_s) / 1_000_000_000_000) as i64
    }

    /// When the clock will show this, ns.
    fn clock_to_ns(&self, clock: i64) -> u64 {
        let ticks = u128::from(clock.max(0).unsigned_abs());
        let ns = (ticks * 1_000_000_000_000).div_ceil(u128::from(self.ticks_per_1000_s));
        self.clock_zero_ns + ns as u64
    }

    /// The whole clock of which a message names the low half.
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

    /// The receive interrupt: what does not fit is lost.
    fn receive_bytes(&mut self) {
        while let Some(byte) = self.to_board.receive(self.now) {
            if self.received.len() < RECEIVE_WINDOW_BYTES {
                self.received.push_back(byte);
            }
        }
    }

    /// Blocks, one after the other, as fast as the processor is.
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
                        // Out of turn: it has to come again.
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

    /// Gives up: no axis moves, all outputs fall back.
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

    /// Places of the common queue in use.
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
