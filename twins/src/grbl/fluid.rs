//! The parts of FluidNC that differ from the other boards: two tasks with an event queue.
//!
//! ```text
//!   bytes ─► poller ─┬─ ? ──────────────────► report, at once, in every state
//!   pins  ─►  1 ms   ├─ ! ~ Ctrl-X, edges ──► events ─┐
//!                    └─ one line ───────────────────► main: an event, a line, an event …
//!                                                       blocked for 500 ms by an alarm
//! ```
//!
//! The poller takes the next line when the previous line is answered. Until then it polls the
//! bytes only every 51 ms, and less often while polled lines wait. A reset discards the bytes
//! that the poller has not taken. A line that it has taken, but the main task has not started,
//! is executed after the reset.

mod commands;
mod events;
mod homing;

use std::collections::VecDeque;

use super::config::FluidConfig;
use super::planner::Planner;
use super::{BOOT_NS, GrblState, GrblTwin};
use events::FluidEvent;
use homing::HomingCycle;

/// Number of nanoseconds in a millisecond.
const MS: u64 = 1_000_000;
/// Polling interval of received bytes while a line is executed, ns.
const BUSY_POLL_NS: u64 = 51 * MS;
/// Time from the poll that completes a line until the main task receives the line, ns.
const LINE_HANDOVER_NS: u64 = MS;
/// Time after power-on in which received bytes are lost, ns.
const BOOT_DEAF_NS: u64 = 300 * MS;
/// Capacity of the receive buffers of serial driver and chip, bytes.
const RECEIVE_BUFFER_BYTES: usize = 384;
/// Free buffer size in a status report when the buffer is empty, bytes.
const REPORTED_BUFFER_BYTES: usize = 128;
/// Duration of the motion that one segment contains, s.
const SEGMENT_S: f64 = 0.01;
/// Messages at startup, each with its time after power-on, ms.
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

/// The settings that the board reads from the configuration at startup and keeps until the next
/// one.
#[derive(Clone, Debug, Default)]
struct StartupConfig {
    /// Which of X and Z have a limit input connected: at the positive end (`positive`), and at
    /// any end (`limit`).
    positive: [bool; 2],
    limit: [bool; 2],
    emergency: bool,
    door: bool,
    probe: bool,
    /// Whether X and Z have a homing section with a cycle in the configuration.
    homing: [bool; 2],
    /// Duration of the motion that is prepared in advance for the pulse timer, s.
    prepared_s: f64,
    blocks: usize,
    /// Spindle speed at full output, r/min.
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

/// The state of a board with FluidNC, in addition to that of a Grbl board.
#[derive(Clone, Debug, Default)]
pub(super) struct FluidState {
    start: StartupConfig,
    boot_lines: usize,
    events: VecDeque<FluidEvent>,
    /// Time until which an alarm blocks the main task, ns.
    blocked_until: u64,
    /// Time of the next poll while a line is executed, ns.
    next_poll_at: u64,
    /// Received bytes that do not form a complete line yet.
    polled_bytes: VecDeque<u8>,
    after_cr: bool,
    /// A received line that the main task has not started; `None` if there is none.
    line: Option<String>,
    /// A command that waits for the end of all motion; `None` if there is none.
    command: Option<String>,
    /// Whether a homing command is not answered yet.
    is_homing: bool,
    cycle: Option<HomingCycle>,
    /// Whether the board decelerates for a feed hold.
    is_braking: bool,
    /// Levels of the inputs at the last poll: limits of X and Z, emergency stop.
    polled_inputs: [bool; 3],
    /// Levels of the inputs, in the same order, that the main task has processed.
    known_inputs: [bool; 3],
    /// Whether the motors of X and Z are blocked and make no pulses.
    blocked_motors: [bool; 2],
    unhomed: [bool; 2],
    /// Difference of the planner's position of X, Y, Z from the pulse count after failed homing,
    /// pulses.
    planner_error: [i64; 3],
}

impl GrblTwin {
    /// Returns the value of a FluidNC configuration item in memory; `None` for an unknown
    /// item.
    pub fn config_item(&self, path: &str) -> Option<&str> {
        self.settings.tree()?.value(path)
    }

    /// Changes an item in the configuration file and restarts the board, as the owner does.
    /// Returns error 3 for an unknown item and 2 for a wrong value.
    pub fn set_config_item(&mut self, path: &str, value: &str) -> Result<(), u8> {
        self.settings
            .tree_mut()
            .ok_or(3_u8)?
            .set_in_file(path, value)?;
        self.load_startup_config();
        Ok(())
    }

    /// Removes a section from the configuration file.
    #[cfg(test)]
    pub(crate) fn remove_section(&mut self, section: &str) {
        if let Some(tree) = self.settings.tree_mut() {
            tree.remove_section(section);
        }
        self.load_startup_config();
    }

    /// Returns whether the limit switches of X and Z block their motors.
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

    /// Returns whether the motor of a board axis (0 X, 1 Y, 2 Z) is blocked.
    pub(super) const fn is_limited(&self, axis: usize) -> bool {
        let [x, z] = self.fluid.blocked_motors;
        (axis == 0 && x) || (axis == 2 && z)
    }

    /// Returns how far the planner's position of X, Y, Z deviates from the pulse count,
    /// pulses.
    pub(super) const fn planner_error(&self) -> [i64; 3] {
        self.fluid.planner_error
    }

    /// Returns true if no axis still needs homing; otherwise raises alarm 14.
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

    /// Returns the spindle speed at full output, r/min, as read at startup.
    pub(super) const fn full_speed_rpm(&self) -> f64 {
        self.fluid.start.full_speed_rpm
    }

    /// Resets the board as its hardware reset line does.
    pub(super) fn reset_fluid(&mut self) {
        self.fluid = FluidState::default();
        self.state = GrblState::Starting;
        self.coolant = false;
        self.line.clear();
        if let Some(tree) = self.settings.tree_mut() {
            tree.load_file();
        }
        // The unit setting is not kept.
        let _ = self.settings.set(13, 0.0);
        self.load_startup_config();
    }

    /// Advances the board by one time step of `step` ns.
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
        // The startup banner comes before the first line is read.
        for byte in core::mem::take(&mut self.received) {
            self.handle_realtime_byte(byte);
        }
    }

    /// Returns whether the board still has to answer a line.
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

    /// Runs the polling task once: reads the inputs and the received bytes.
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

    /// Executes or queues a realtime byte. Returns false if the byte is part of a line.
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

    /// Returns a letter for each operated input, as a status report does: P, X, Z, D, E.
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

    /// Returns the free size of the receive buffer in a status report, bytes.
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
                // The pulse timer completes the prepared motion.
                let made = self.planner.advance_prepared(seconds);
                self.count_all_pulses(made);
            }
            GrblState::Home if self.now >= self.fluid.blocked_until => {
                self.advance_homing_cycle(seconds);
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
