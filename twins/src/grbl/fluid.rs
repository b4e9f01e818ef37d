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

use super::config::FluidConfig;
use super::planner::Planner;
use super::{BOOT_NS, GrblState, GrblTwin};
use events::FluidEvent;
use homing::HomingCycle;

/// One millisecond.
const MS: u64 = 1_000_000;
/// The poller looks at the bytes so often while a line is being carried out.
const BUSY_POLL_NS: u64 = 51 * MS;
/// From taking a line until the main task has it.
const LINE_HANDOVER_NS: u64 = MS;
/// From power-on until bytes are kept.
const BOOT_DEAF_NS: u64 = 300 * MS;
/// Bytes the serial driver and the chip keep for the poller.
const RECEIVE_BUFFER_BYTES: usize = 384;
/// What a report calls the room when nothing is kept.
const REPORTED_BUFFER_BYTES: usize = 128;
/// Motion handed to the pulse timer for each segment of the configuration, s.
const SEGMENT_S: f64 = 0.01;
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
struct StartupConfig {
    /// Wired limit inputs of X and Z: that of the positive end, and any.
    positive: [bool; 2],
    limit: [bool; 2],
    emergency: bool,
    door: bool,
    probe: bool,
    /// Axes that have a way to be homed.
    homing: [bool; 2],
    /// Motion handed to the pulse timer in advance, s.
    prepared_s: f64,
    blocks: usize,
    /// Speed at full output, r/min.
    full_speed_rpm: f64,
}

impl StartupConfig {
    fn read(config: &FluidConfig) -> Self {
        let number = |path: &str| config.file_value(path).and_then(|value| value.parse().ok());
        let pin = |path: &str| config.is_wired(path);
        let both = |of: &dyn Fn(&str) -> bool| ["axes/x", "axes/z"].map(of);
        let at = |axis: &str, end: &str| pin(&format!("{axis}/motor0/limit_{end}_pin"));
        let map = config.file_value("10V/speed_map").unwrap_or_default();
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
            prepared_s: number("stepping/segments").unwrap_or(12.0) * SEGMENT_S,
            blocks: (number("planner_blocks").unwrap_or(16.0) as usize).saturating_sub(1),
            full_speed_rpm: last.and_then(|speed| speed.parse().ok()).unwrap_or(0.0),
        }
    }
}

/// What this firmware remembers besides what all of them do.
#[derive(Clone, Debug, Default)]
pub(super) struct FluidState {
    start: StartupConfig,
    boot_lines: usize,
    events: VecDeque<FluidEvent>,
    /// The main task stands still until then.
    blocked_until: u64,
    /// The poller has looked at bytes while a line was being carried out.
    next_poll_at: u64,
    /// Bytes the poller has looked at and no line was made of.
    polled_bytes: VecDeque<u8>,
    after_cr: bool,
    /// A line taken and not begun.
    line: Option<String>,
    /// A command that waits for the end of all motion.
    command: Option<String>,
    /// A homing command is under way.
    is_homing: bool,
    cycle: Option<HomingCycle>,
    /// It brakes to a hold.
    is_braking: bool,
    /// Inputs as the poller saw them last: limits of X and Z, emergency stop.
    polled_inputs: [bool; 3],
    /// Inputs as the main task knows them.
    known_inputs: [bool; 3],
    /// Motors of X and Z that make no pulses.
    blocked_motors: [bool; 2],
    unhomed: [bool; 2],
    /// The planner was not told of what homing did: it believes to stand so many pulses
    /// beside the count.
    planner_error: [i64; 3],
}

impl GrblTwin {
    /// The value of an item of FluidNC's configuration, as it is in memory.
    pub fn config_item(&self, path: &str) -> Option<&str> {
        self.settings.tree()?.value(path)
    }

    /// The owner writes an item into the file and starts the board, whatever is to be
    /// said about it: 3 no such item, 2 no such value.
    pub fn set_config_item(&mut self, path: &str, value: &str) -> Result<(), u8> {
        self.settings
            .tree_mut()
            .ok_or(3_u8)?
            .set_in_file(path, value)?;
        self.load_startup_config();
        Ok(())
    }

    /// The owner takes a section and all it holds out of the file.
    #[cfg(test)]
    pub(crate) fn remove_section(&mut self, section: &str) {
        if let Some(tree) = self.settings.tree_mut() {
            tree.remove_section(section);
        }
        self.load_startup_config();
    }

    /// Whether the motors of X and Z make no pulses because of their switches.
    pub const fn blocked_motors(&self) -> [bool; 2] {
        self.fluid.blocked_motors
    }

    pub(super) fn load_startup_config(&mut self) {
        if let Some(tree) = self.settings.tree() {
            self.fluid.start = StartupConfig::read(tree);
            if self.planner.is_empty() {
                self.planner = Planner::new(self.fluid.start.blocks, self.fluid.start.prepared_s);
            }
            self.update_switch_pulses();
        }
    }

    /// Whether the motor of an axis of the board makes no pulses.
    pub(super) const fn is_limited(&self, axis: usize) -> bool {
        let [x, z] = self.fluid.blocked_motors;
        (axis == 0 && x) || (axis == 2 && z)
    }

    /// By how many pulses the planner is wrong about the count.
    pub(super) const fn planner_error(&self) -> [i64; 3] {
        self.fluid.planner_error
    }

    /// No block is planned while an axis should be homed first: an alarm instead.
    pub(super) fn check_homed(&mut self) -> bool {
        let unhomed = self.fluid.unhomed != [false; 2];
        if unhomed {
            self.send_text("[MSG:INFO: Unhomed axes]\r\n");
            self.push_event(FluidEvent::Alarm(14));
        }
        !unhomed
    }

    pub(super) fn is_config_on(&self, path: &str) -> bool {
        self.settings.tree().is_some_and(|tree| tree.is_on(path))
    }

    fn config_number(&self, path: &str) -> f64 {
        self.settings.tree().map_or(0.0, |tree| tree.number(path))
    }

    /// Speed at full output as the last start found it, r/min.
    pub(super) const fn full_speed_rpm(&self) -> f64 {
        self.fluid.start.full_speed_rpm
    }

    /// What the reset line does to this board.
    pub(super) fn reset_fluid(&mut self) {
        self.fluid = FluidState::default();
        self.state = GrblState::Starting;
        self.coolant = false;
        self.line.clear();
        if let Some(tree) = self.settings.tree_mut() {
            tree.load_file();
        }
        // Inches are forgotten too.
        let _ = self.settings.set(13, 0.0);
        self.load_startup_config();
    }

    /// A step of the board.
    pub(super) fn advance_fluid(&mut self, step: u64) {
        let booted = self
            .boots_at
            .map(|at| self.now.saturating_sub(at.saturating_sub(BOOT_NS)));
        while let Some(byte) = self.to_board.receive(self.now) {
            let deaf = booted.is_some_and(|since| since < BOOT_DEAF_NS);
            if !deaf && self.received.len() < RECEIVE_BUFFER_BYTES {
                self.received.push_back(byte);
            }
        }
        if let (Some(since), Some(at)) = (booted, self.boots_at) {
            while let Some((when, text)) = BOOT_TEXT.get(self.fluid.boot_lines)
                && since >= when * MS
            {
                self.send_text(text);
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
        self.move_fluid_axes(step as f64 * 1e-9);
        self.run_fluid_main();
    }

    fn fluid_power_on(&mut self) {
        self.boots_at = None;
        self.position = [0; 3];
        self.position_error = [0; 3];
        self.poll_pins();
        self.push_event(FluidEvent::Start);
        // The first banner comes before a line is looked at.
        for byte in core::mem::take(&mut self.received) {
            self.handle_realtime_byte(byte);
        }
    }

    /// A line is taken and not answered yet.
    fn is_line_pending(&self) -> bool {
        let fluid = &self.fluid;
        let begun =
            fluid.command.is_some() || self.waiting_block.is_some() || self.answer_at.is_some();
        fluid.line.is_some() || fluid.is_homing || begun
    }

    fn poll_pins(&mut self) {
        let [x, z] = self.limits();
        let start = &self.fluid.start;
        let emergency = self.pins.emergency && start.emergency;
        let inputs = [x && start.limit[0], z && start.limit[1], emergency];
        let were = core::mem::replace(&mut self.fluid.polled_inputs, inputs);
        for axis in 0..2 {
            if inputs[axis] != were[axis] {
                self.push_event(FluidEvent::Limit(axis, inputs[axis]));
            }
        }
        if inputs[2] != were[2] {
            self.push_event(FluidEvent::Emergency(inputs[2]));
        }
    }

    /// The poller's turn.
    fn poll(&mut self) {
        self.poll_pins();
        if self.is_line_pending() {
            if self.now < self.fluid.next_poll_at {
                return;
            }
            while let Some(byte) = self.received.pop_front() {
                if !self.handle_realtime_byte(byte) {
                    self.fluid.polled_bytes.push_back(byte);
                }
            }
        } else {
            self.take_line();
        }
        self.fluid.next_poll_at = self.now + BUSY_POLL_NS;
    }

    fn take_line(&mut self) {
        while self.fluid.line.is_none() {
            let byte = if let Some(byte) = self.fluid.polled_bytes.pop_front() {
                byte
            } else {
                match self.received.pop_front() {
                    Some(byte) if self.handle_realtime_byte(byte) => continue,
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
                    self.busy_until = self.now + LINE_HANDOVER_NS;
                }
                8 => {
                    self.line.pop();
                }
                _ if self.line.len() < commands::MAX_LINE_BYTES => self.line.push(byte),
                _ => {}
            }
        }
    }

    /// Whether a byte is no part of a line; what it asks for is done, or waits.
    fn handle_realtime_byte(&mut self, byte: u8) -> bool {
        match byte {
            b'?' => {
                let text = self.status_report();
                self.reports = self.reports.wrapping_add(1);
                self.send_text(&text);
            }
            b'!' => self.push_event(FluidEvent::Hold),
            b'~' => self.push_event(FluidEvent::Resume),
            0x18 => self.push_event(FluidEvent::Reset),
            0x87..=0x8a => self.push_event(FluidEvent::Macro),
            0x80.. => {}
            _ => return false,
        }
        true
    }

    /// Letters of the inputs, as the main task knows them.
    pub(super) fn pin_letters(&self) -> String {
        let [x, z, emergency] = self.fluid.known_inputs;
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
    pub(super) fn reported_buffer_free(&self) -> usize {
        REPORTED_BUFFER_BYTES.saturating_sub(self.received.len())
    }

    fn move_fluid_axes(&mut self, seconds: f64) {
        match self.state {
            GrblState::Run => {
                self.make_pulses(seconds, false);
                if self.planner.is_empty() {
                    self.state = GrblState::Idle;
                }
            }
            GrblState::Hold { complete: false } if self.fluid.is_braking => {
                self.make_pulses(seconds, true);
                if self.planner.is_stopped() {
                    self.state = GrblState::Hold { complete: true };
                    self.fluid.is_braking = false;
                }
            }
            GrblState::Alarm => {
                // The pulse timer makes what it has been handed.
                let made = self.planner.advance_prepared(seconds);
                self.count_all_pulses(made);
            }
            GrblState::Home if self.now >= self.fluid.blocked_until => {
                self.advance_homing_cycle(seconds)
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
