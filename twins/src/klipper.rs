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
use block::Front;
pub use block::block;
use dictionary::{Response, response_id};
use objects::{Counter, Endstop, Group, Output};
use spindle::Spindle;
pub use spindle::SpindleMake;
use stepper::Stepper;

/// Ticks a second, and places of the common queue.
const RATE: u32 = 16_000_000;
const QUEUE: usize = 657;
/// Bytes the receive buffer holds.
const WINDOW: usize = 192;
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
pub enum State {
    /// It starts.
    Boots,
    /// It works.
    Runs,
    /// It has given up, for this reason.
    Shutdown(&'static str),
}

/// How the board is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Make {
    /// Bits a second of its line.
    pub baud: u32,
    /// Its clock is so much too fast, millionths.
    pub ppm: i32,
    /// It knows the command `reset`; if not, it forgets its configuration only when it
    /// is shut down.
    pub resets: bool,
}

impl Default for Make {
    fn default() -> Self {
        Self {
            baud: 250_000,
            ppm: 0,
            resets: true,
        }
    }
}

/// A switch, or the zero signal of a motor, on the way of a slide: high while the
/// count of its stepper is from `from` to `to`, once or once a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Travel {
    /// First or second stepper.
    pub axis: usize,
    /// First pulse on it.
    pub from: i64,
    /// Last pulse on it.
    pub to: i64,
    /// Pulses of a turn, when it comes once a turn.
    pub turn: Option<i64>,
}

impl Travel {
    const fn is_on(self, pulses: [i64; 2]) -> bool {
        let at = pulses[self.axis % 2];
        match self.turn {
            Some(turn) => (at - self.from).rem_euclid(turn) <= self.to - self.from,
            None => self.from <= at && at <= self.to,
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
    kiloticks: u64,
    /// When the clock was zero, ns.
    epoch: u64,
    boots_at: Option<u64>,
    shutdown: Option<&'static str>,
    received: VecDeque<u8>,
    /// Bytes up to the next 7E are dropped; the host has been told.
    out_of_step: bool,
    expected: u8,
    busy_until: u64,
    dictionary: Vec<u8>,
    crc: Option<u32>,
    /// How many oids there may be, once the host has said so.
    most_oids: Option<u32>,
    oids: BTreeMap<u32, Object>,
    /// Steps done until this clock; a busy processor makes them late.
    free_at: i64,
    stats_at: i64,
    levels: BTreeMap<u32, bool>,
    /// Switches on the way of the slides.
    travel: BTreeMap<u32, Travel>,
    spindle: Option<Spindle>,
    /// Steps made since they are recorded.
    recorded: Option<Vec<Made>>,
    /// Pulses made since power-on at the steppers, in the order of their oids.
    pulses: [i64; 2],
    last_pulse: u64,
    /// When the commands of the last second were carried out.
    recent: VecDeque<u64>,
    figures: Figures,
}

/// What a test wants to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Figures {
    /// Most places ever in use of the common queue.
    pub queue: usize,
    /// Shortest time from a step's command to the step, ns.
    pub lead: i64,
    /// Commands carried out.
    pub commands: u64,
    /// Most commands carried out in any second.
    pub busiest: u32,
    /// Requests for a piece of the dictionary.
    pub identify: u64,
    /// Steps made.
    pub steps: u64,
    /// Orders for outputs.
    pub outputs: u64,
}

/// A step that was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    /// When, ns.
    pub at: u64,
    /// When it was to be, ns: a processor that makes another step is late.
    pub due: u64,
    /// First or second stepper.
    pub axis: usize,
    /// Pulses behind it.
    pub place: i64,
}

#[derive(Clone, Debug)]
enum Object {
    Stepper(Stepper),
    Endstop(Endstop),
    Group(Group),
    Output(Output, u32),
    Counter(Counter),
}

impl KlipperTwin {
    /// A board that has just got power.
    pub fn new(make: Make) -> Self {
        let kiloticks =
            (i64::from(RATE) * 1000 + i64::from(RATE / 1000) * i64::from(make.ppm)).unsigned_abs();
        let mut twin = Self {
            now: 0,
            to_board: Wire::new(make.baud),
            to_host: Wire::new(make.baud),
            kiloticks,
            epoch: 0,
            boots_at: None,
            shutdown: None,
            received: VecDeque::new(),
            out_of_step: false,
            expected: 1,
            busy_until: 0,
            dictionary: dictionary::packed(RATE, WINDOW as u32, make.resets),
            crc: None,
            most_oids: None,
            oids: BTreeMap::new(),
            free_at: 0,
            stats_at: 0,
            levels: BTreeMap::new(),
            travel: BTreeMap::new(),
            spindle: None,
            recorded: None,
            pulses: [0; 2],
            last_pulse: 0,
            recent: VecDeque::new(),
            figures: Figures {
                queue: 0,
                lead: i64::MAX,
                commands: 0,
                busiest: 0,
                identify: 0,
                steps: 0,
                outputs: 0,
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
        self.most_oids = None;
        self.shutdown = None;
        self.drive_spindle(self.now);
    }

    /// What the board is doing.
    pub const fn state(&self) -> State {
        match (self.boots_at, self.shutdown) {
            (Some(_), _) => State::Boots,
            (None, Some(reason)) => State::Shutdown(reason),
            (None, None) => State::Runs,
        }
    }

    /// Pulses made since power-on, first and second stepper: what a counter at the
    /// pins reads.
    pub const fn pulses(&self) -> [i64; 2] {
        self.pulses
    }

    /// When the last pulse came, ns.
    pub const fn last_pulse(&self) -> u64 {
        self.last_pulse
    }

    /// Figures since power-on.
    pub const fn figures(&self) -> Figures {
        self.figures
    }

    /// Virtual time, ns.
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// Something in the board makes it give up, with this text of its firmware.
    pub fn shut_down_for(&mut self, reason: &'static str) {
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
    pub fn miscount(&mut self, pulses: [i64; 2]) {
        let mut off = pulses.into_iter();
        for object in self.oids.values_mut() {
            if let Object::Stepper(stepper) = object {
                stepper.position += off.next().unwrap_or_default();
            }
        }
    }

    /// Gives an input pin a level, whatever switch is there; pins nobody gave one are
    /// low.
    pub fn set_pin(&mut self, name: &str, level: bool) {
        if let Some(pin) = pins::number(name) {
            self.travel.remove(&pin);
            self.levels.insert(pin, level);
        }
    }

    /// Puts a switch on the way of a slide; its pin follows the pulses.
    pub fn put_switch(&mut self, name: &str, travel: Travel) {
        if let Some(pin) = pins::number(name) {
            self.travel.insert(pin, travel);
        }
    }

    /// The slides stand elsewhere when the power comes on.
    pub const fn put_slides(&mut self, pulses: [i64; 2]) {
        self.pulses = pulses;
    }

    /// What an output pin was last given.
    pub fn output(&self, name: &str) -> Option<u32> {
        let wanted = pins::number(name)?;
        self.oids.values().find_map(|object| match object {
            Object::Output(output, value) if output.pin == wanted => Some(*value),
            _ => None,
        })
    }

    /// Every step is written down from now on.
    pub fn record_steps(&mut self) {
        self.recorded = Some(Vec::new());
    }

    /// The steps written down since the last call.
    pub fn recorded_steps(&mut self) -> Vec<Made> {
        self.recorded
            .as_mut()
            .map(core::mem::take)
            .unwrap_or_default()
    }

    /// The host writes bytes.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.give(bytes, self.now);
    }

    /// What has arrived at the host.
    pub fn read(&mut self) -> Vec<u8> {
        let now = self.now;
        std::iter::from_fn(|| self.to_host.take(now)).collect()
    }

    /// Lets time pass, ns.
    pub fn advance(&mut self, ns: u64) {
        let end = self.now + ns;
        loop {
            let next = self.next_event().filter(|next| *next <= end);
            self.now = self.now.max(next.unwrap_or(end));
            if let Some(at) = self.boots_at {
                while self.to_board.take(self.now).is_some() {}
                if self.now >= at {
                    self.start();
                }
            } else {
                self.run_timers();
                self.receive();
                self.work();
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
            .map(|clock| self.moment(clock).max(self.now));
        let arrival = self.to_board.next_arrival().map(|at| at.max(self.now));
        [work, timer, arrival].into_iter().flatten().min()
    }

    fn start(&mut self) {
        self.boots_at = None;
        self.epoch = self.now;
        self.expected = 1;
        self.out_of_step = false;
        self.busy_until = self.now;
        self.free_at = 0;
        self.stats_at = STATS_S * i64::from(RATE);
        self.say(Response::Starting, &[]);
        self.acknowledge();
    }

    /// The clock now.
    fn clock(&self) -> i64 {
        let since = u128::from(self.now - self.epoch);
        (since * u128::from(self.kiloticks) / 1_000_000_000_000) as i64
    }

    /// When the clock will show this, ns.
    fn moment(&self, clock: i64) -> u64 {
        let ticks = u128::from(clock.max(0).unsigned_abs());
        let ns = (ticks * 1_000_000_000_000).div_ceil(u128::from(self.kiloticks));
        self.epoch + ns as u64
    }

    /// The whole clock of which a message names the low half.
    fn whole(&self, low: u32) -> i64 {
        let now = self.clock();
        now + i64::from(low.wrapping_sub(now as u32) as i32)
    }

    fn level(&self, pin: u32) -> bool {
        let index = self
            .spindle
            .and_then(|spindle| spindle.level(pin, self.now));
        let travel = || {
            let travel = self.travel.get(&pin)?;
            Some(travel.is_on(self.pulses))
        };
        let level = || self.levels.get(&pin).copied();
        index.or_else(travel).or_else(level).unwrap_or(false)
    }

    fn send(&mut self, content: &[u8]) {
        let block = block(self.expected, content);
        self.to_host.give(&block, self.now);
    }

    fn acknowledge(&mut self) {
        self.send(&[]);
    }

    fn say(&mut self, response: Response, numbers: &[i64]) {
        let mut content = Vec::new();
        block::put(&mut content, response_id(response));
        for number in numbers {
            block::put(&mut content, *number);
        }
        self.send(&content);
    }

    /// The receive interrupt: what does not fit is lost.
    fn receive(&mut self) {
        while let Some(byte) = self.to_board.take(self.now) {
            if self.received.len() < WINDOW {
                self.received.push_back(byte);
            }
        }
    }

    /// Blocks, one after the other, as fast as the processor is.
    fn work(&mut self) {
        while self.now >= self.busy_until && self.boots_at.is_none() {
            if self.out_of_step {
                let end = self.received.iter().position(|&byte| byte == 0x7E);
                let count = end.map_or(self.received.len(), |end| end + 1);
                self.received.drain(..count);
                if end.is_none() {
                    return;
                }
                self.out_of_step = false;
                self.acknowledge();
                continue;
            }
            match block::front(self.received.make_contiguous()) {
                Front::Incomplete => return,
                Front::Skip(count) => {
                    self.received.drain(..count);
                }
                Front::Bad => self.out_of_step = true,
                Front::Block(length, sequence) => {
                    let block: Vec<u8> = self.received.drain(..length).collect();
                    if sequence != self.expected {
                        // Out of turn: it has to come again.
                        self.acknowledge();
                        continue;
                    }
                    self.expected = (sequence + 1) & 0x0F;
                    let count = self.execute(&block[2..length - 3]);
                    self.busy_until = self.now + BLOCK_NS + COMMAND_NS * count;
                    if self.boots_at.is_none() {
                        self.acknowledge();
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
                Object::Stepper(stepper) => stepper.stop(),
                Object::Endstop(endstop) => endstop.next = None,
                Object::Group(group) => *group = Group::default(),
                Object::Output(output, value) => {
                    output.queue.clear();
                    output.until = None;
                    *value = output.default;
                }
                Object::Counter(counter) => counter.next = None,
            }
        }
        self.drive_spindle(self.now);
        let clock = self.clock();
        self.say(
            Response::Shutdown,
            &[i64::from(clock as u32), dictionary::text_id(reason)],
        );
    }

    /// Places of the common queue in use.
    fn queued(&self) -> usize {
        let waiting = |object: &Object| match object {
            Object::Stepper(stepper) => stepper.waiting(),
            Object::Output(output, _) => output.queue.len(),
            _ => 0,
        };
        self.oids.values().map(waiting).sum()
    }
}

#[cfg(test)]
mod tests;
