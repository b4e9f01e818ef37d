//! What a FluidNC board does otherwise than the others of its family: two tasks and a
//! queue of events between them.
//!
//! ```text
//!   bytes ─► poller ─┬─ ? ──────────────────► report, at once, whatever the other does
//!   pins  ─►  1 ms   ├─ ! ~ Ctrl-X, edges ──► events ─┐
//!                    └─ one line ───────────────────► main: an event, a line, an event …
//!                                                       stands still 500 ms at an alarm
//! ```
//!
//! The poller takes the next line when the one before is answered; until then it looks
//! at the bytes every 51 ms only, and later still while there are lines it has already
//! looked at. A reset empties what it has not taken yet; a line it has taken, and the
//! main task has not begun, is carried out behind the reset.

mod commands;
mod events;
mod homing;

use std::collections::VecDeque;

use super::config::Config;
use super::planner::Planner;
use super::{BOOT_NS, GrblTwin, State};
use events::Event;
use homing::Cycle;

/// One millisecond.
const MS: u64 = 1_000_000;
/// The poller looks at the bytes so often while a line is being carried out.
const SELDOM_NS: u64 = 51 * MS;
/// From taking a line until the main task has it.
const LINE_NS: u64 = MS;
/// From power-on until bytes are kept.
const DEAF_NS: u64 = 300 * MS;
/// Bytes the serial driver and the chip keep for the poller.
const KEPT_BYTES: usize = 384;
/// What a report calls the room when nothing is kept.
const TOLD_BYTES: usize = 128;
/// Motion handed to the pulse timer for each segment of the configuration, s.
const SEGMENT: f64 = 0.01;
/// What the chip and the firmware say when they start, and when, ms after power-on.
const BOOT_TEXT: [(u64, &str); 6] = [
    (20, "rst:0x1 (POWERON_RESET),boot:0x13\r\n"),
    (30, "load:0x3fff0030,len:1184\r\n"),
    (
        350,
        "[MSG:INFO: FluidNC v4.0.4 https://github.com/bdring/FluidNC]\r\n",
    ),
    (700, "[MSG:INFO: Machine Lathe]\r\n"),
    (705, "[MSG:INFO: Board Breakout]\r\n"),
    (1100, "[MSG:INFO: Axis count 3]\r\n"),
];

/// What a start reads from the file, and nothing changes afterwards.
#[derive(Clone, Debug, Default)]
struct Started {
    /// Wired limit inputs of X and Z: that of the positive end, and any.
    positive: [bool; 2],
    limit: [bool; 2],
    emergency: bool,
    door: bool,
    probe: bool,
    /// Axes that have a way to be homed.
    homing: [bool; 2],
    /// Motion handed to the pulse timer in advance, s.
    prepared: f64,
    blocks: usize,
    /// Speed at full output, r/min.
    top: f64,
}

impl Started {
    fn read(config: &Config) -> Self {
        let number = |path: &str| config.on_file(path).and_then(|value| value.parse().ok());
        let pin = |path: &str| config.is_wired(path);
        let both = |of: &dyn Fn(&str) -> bool| ["axes/x", "axes/z"].map(of);
        let at = |axis: &str, end: &str| pin(&format!("{axis}/motor0/limit_{end}_pin"));
        let map = config.on_file("10V/speed_map").unwrap_or_default();
        let last = map
            .rsplit(' ')
            .next()
            .and_then(|entry| entry.split('=').next());
        Self {
            positive: both(&|axis| at(axis, "pos")),
            limit: both(&|axis| ["neg", "pos", "all"].iter().any(|end| at(axis, end))),
            emergency: pin("control/estop_pin"),
            door: pin("control/safety_door_pin"),
            probe: pin("probe/pin"),
            homing: both(&|axis| {
                number(&format!("{axis}/homing/cycle")).is_some_and(|cycle: f64| cycle >= 0.0)
            }),
            prepared: number("stepping/segments").unwrap_or(12.0) * SEGMENT,
            blocks: (number("planner_blocks").unwrap_or(16.0) as usize).saturating_sub(1),
            top: last.and_then(|speed| speed.parse().ok()).unwrap_or(0.0),
        }
    }
}

/// What this firmware remembers besides what all of them do.
#[derive(Clone, Debug, Default)]
pub(super) struct Fluid {
    start: Started,
    boot_lines: usize,
    events: VecDeque<Event>,
    /// The main task stands still until then.
    blocked_until: u64,
    /// The poller has looked at bytes while a line was being carried out.
    looks_at: u64,
    /// Bytes the poller has looked at and no line was made of.
    looked_at: VecDeque<u8>,
    after_cr: bool,
    /// A line taken and not begun.
    line: Option<String>,
    /// A command that waits for the end of all motion.
    command: Option<String>,
    /// A homing command is under way.
    homes: bool,
    cycle: Option<Cycle>,
    /// It brakes to a hold.
    brakes: bool,
    /// Inputs as the poller saw them last: limits of X and Z, emergency stop.
    polled: [bool; 3],
    /// Inputs as the main task knows them.
    seen: [bool; 3],
    /// Motors of X and Z that make no pulses.
    limited: [bool; 2],
    unhomed: [bool; 2],
    /// The planner was not told of what homing did: it believes to stand so many pulses
    /// beside the count.
    astray: [i64; 3],
}

impl GrblTwin {
    /// The value of an item of FluidNC's configuration, as it is in memory.
    pub fn item(&self, path: &str) -> Option<&str> {
        self.settings.tree()?.value(path)
    }

    /// The owner writes an item into the file and starts the board, whatever is to be
    /// said about it: 3 no such item, 2 no such value.
    pub fn set_item(&mut self, path: &str, value: &str) -> Result<(), u8> {
        self.settings.tree_mut().ok_or(3_u8)?.preset(path, value)?;
        self.read_start();
        Ok(())
    }

    /// The owner takes a section and all it holds out of the file.
    #[cfg(test)]
    pub(crate) fn take_out(&mut self, section: &str) {
        if let Some(tree) = self.settings.tree_mut() {
            tree.take_out(section);
        }
        self.read_start();
    }

    /// Whether the motors of X and Z make no pulses because of their switches.
    pub const fn limited(&self) -> [bool; 2] {
        self.fluid.limited
    }

    pub(super) fn read_start(&mut self) {
        if let Some(tree) = self.settings.tree() {
            self.fluid.start = Started::read(tree);
            if self.planner.is_empty() {
                self.planner = Planner::new(self.fluid.start.blocks, self.fluid.start.prepared);
            }
            self.set_switches();
        }
    }

    /// Whether the motor of an axis of the board makes no pulses.
    pub(super) const fn is_limited(&self, axis: usize) -> bool {
        let [x, z] = self.fluid.limited;
        (axis == 0 && x) || (axis == 2 && z)
    }

    /// By how many pulses the planner is wrong about the count.
    pub(super) const fn astray(&self) -> [i64; 3] {
        self.fluid.astray
    }

    /// No block is planned while an axis should be homed first: an alarm instead.
    pub(super) fn may_plan(&mut self) -> bool {
        let unhomed = self.fluid.unhomed != [false; 2];
        if unhomed {
            self.say("[MSG:INFO: Unhomed axes]\r\n");
            self.put(Event::Alarm(14));
        }
        !unhomed
    }

    pub(super) fn is_set(&self, path: &str) -> bool {
        self.settings.tree().is_some_and(|tree| tree.is_on(path))
    }

    fn number(&self, path: &str) -> f64 {
        self.settings.tree().map_or(0.0, |tree| tree.number(path))
    }

    /// Speed at full output as the last start found it, r/min.
    pub(super) const fn top_speed(&self) -> f64 {
        self.fluid.start.top
    }

    /// What the reset line does to this board.
    pub(super) fn fluid_off(&mut self) {
        self.fluid = Fluid::default();
        self.state = State::Starting;
        self.coolant = false;
        self.line.clear();
        if let Some(tree) = self.settings.tree_mut() {
            tree.load();
        }
        // Inches are forgotten too.
        let _ = self.settings.set(13, 0.0);
        self.read_start();
    }

    /// A step of the board.
    pub(super) fn fluid_step(&mut self, step: u64) {
        let booted = self
            .boots_at
            .map(|at| self.now.saturating_sub(at.saturating_sub(BOOT_NS)));
        while let Some(byte) = self.to_board.take(self.now) {
            let deaf = booted.is_some_and(|since| since < DEAF_NS);
            if !deaf && self.received.len() < KEPT_BYTES {
                self.received.push_back(byte);
            }
        }
        if let (Some(since), Some(at)) = (booted, self.boots_at) {
            while let Some((when, text)) = BOOT_TEXT.get(self.fluid.boot_lines)
                && since >= when * MS
            {
                self.say(text);
                self.fluid.boot_lines += 1;
            }
            if self.now < at {
                return;
            }
            self.fluid_power_on();
        }
        if self.now / MS != (self.now - step) / MS {
            self.poll();
        }
        self.handle_events();
        self.fluid_move(step as f64 * 1e-9);
        self.fluid_work();
    }

    fn fluid_power_on(&mut self) {
        self.boots_at = None;
        self.position = [0; 3];
        self.miscounted = [0; 3];
        self.poll_pins();
        self.put(Event::Start);
        // The first banner comes before a line is looked at.
        for byte in core::mem::take(&mut self.received) {
            self.acts_at_once(byte);
        }
    }

    /// A line is taken and not answered yet.
    fn in_hand(&self) -> bool {
        let fluid = &self.fluid;
        let begun = fluid.command.is_some() || self.waiting.is_some() || self.answers_at.is_some();
        fluid.line.is_some() || fluid.homes || begun
    }

    fn poll_pins(&mut self) {
        let [x, z] = self.limits();
        let start = &self.fluid.start;
        let emergency = self.pins.emergency && start.emergency;
        let inputs = [x && start.limit[0], z && start.limit[1], emergency];
        let were = core::mem::replace(&mut self.fluid.polled, inputs);
        for axis in 0..2 {
            if inputs[axis] != were[axis] {
                self.put(Event::Limit(axis, inputs[axis]));
            }
        }
        if inputs[2] != were[2] {
            self.put(Event::Emergency(inputs[2]));
        }
    }

    /// The poller's turn.
    fn poll(&mut self) {
        self.poll_pins();
        if self.in_hand() {
            if self.now < self.fluid.looks_at {
                return;
            }
            while let Some(byte) = self.received.pop_front() {
                if !self.acts_at_once(byte) {
                    self.fluid.looked_at.push_back(byte);
                }
            }
        } else {
            self.take_line();
        }
        self.fluid.looks_at = self.now + SELDOM_NS;
    }

    fn take_line(&mut self) {
        while self.fluid.line.is_none() {
            let byte = if let Some(byte) = self.fluid.looked_at.pop_front() {
                byte
            } else {
                match self.received.pop_front() {
                    Some(byte) if self.acts_at_once(byte) => continue,
                    Some(byte) => byte,
                    None => return,
                }
            };
            let after_cr = core::mem::replace(&mut self.fluid.after_cr, byte == b'\r');
            match byte {
                b'\n' if after_cr => {}
                b'\n' | b'\r' => {
                    let line = core::mem::take(&mut self.line);
                    self.fluid.line = Some(String::from_utf8_lossy(&line).into_owned());
                    self.busy_until = self.now + LINE_NS;
                }
                8 => {
                    self.line.pop();
                }
                _ if self.line.len() < commands::LINE_BYTES => self.line.push(byte),
                _ => {}
            }
        }
    }

    /// Whether a byte is no part of a line; what it asks for is done, or waits.
    fn acts_at_once(&mut self, byte: u8) -> bool {
        match byte {
            b'?' => {
                let text = self.report();
                self.reports = self.reports.wrapping_add(1);
                self.say(&text);
            }
            b'!' => self.put(Event::Hold),
            b'~' => self.put(Event::Resume),
            0x18 => self.put(Event::Reset),
            0x87..=0x8a => self.put(Event::Macro),
            0x80.. => {}
            _ => return false,
        }
        true
    }

    /// Letters of the inputs, as the main task knows them.
    pub(super) fn pin_letters(&self) -> String {
        let [x, z, emergency] = self.fluid.seen;
        let start = &self.fluid.start;
        let letters = [
            (self.pins.probe && start.probe, 'P'),
            (x, 'X'),
            (z, 'Z'),
            (self.pins.door && start.door, 'D'),
            (emergency, 'E'),
        ];
        let operated = letters.iter().filter(|(operated, _)| *operated);
        operated.map(|(_, letter)| *letter).collect()
    }

    /// Room for bytes, as a report tells it.
    pub(super) fn told_room(&self) -> usize {
        TOLD_BYTES.saturating_sub(self.received.len())
    }

    fn fluid_move(&mut self, seconds: f64) {
        match self.state {
            State::Run => {
                self.make_pulses(seconds, false);
                if self.planner.is_empty() {
                    self.state = State::Idle;
                }
            }
            State::Hold { complete: false } if self.fluid.brakes => {
                self.make_pulses(seconds, true);
                if self.planner.stands() {
                    self.state = State::Hold { complete: true };
                    self.fluid.brakes = false;
                }
            }
            State::Alarm => {
                // The pulse timer makes what it has been handed.
                let made = self.planner.coast(seconds);
                self.count_all(made);
            }
            State::Home if self.now >= self.fluid.blocked_until => self.home_cycle(seconds),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
