//! Boards of the Grbl family: Grbl 1.1h on an 8 bit processor, grblHAL, and FluidNC.
//!
//! What hosts trip over is modelled on purpose: a receive buffer that drops what
//! does not fit, characters that act at once wherever they stand, a carriage
//! return that ends a line of its own, silence after a hard limit, answers that
//! say "read", not "done", and a reset whenever the port is opened.

mod block;
mod config;
mod fluid;
mod homing;
mod main_loop;
mod pins;
mod planner;
mod report;
mod reset;
mod settings;
mod spindle;

use std::collections::VecDeque;

use crate::wire::Wire;
use block::{Modal, ParsedBlock};
use fluid::FluidState;
use homing::GrblHoming;
pub use pins::GrblPins;
use planner::Planner;
pub use settings::GrblSettings;
use spindle::ThreadPass;
pub use spindle::{GrblSpindle, PassTrace};

/// One step of virtual time, ns.
const STEP_NS: u64 = 100_000;
/// Time a line takes besides its bytes: 447 lines a second, ns.
const LINE_NS: u64 = 2_237_000;
/// From standstill until the board calls the hold complete, ns.
const HOLD_SETTLE_NS: u64 = 35_000_000;
/// From power or reset line to the banner, ns.
const BOOT_NS: u64 = 1_500_000_000;
/// Writing a setting stops the interrupts so long, ns.
const SETTING_WRITE_NS: u64 = 14_000_000;
/// The longest line.
const MAX_LINE_BYTES: usize = 80;
/// The slowest cut the planner makes, mm/s (1 mm/min).
const MIN_CUT_SPEED: f64 = 1.0 / 60.0;
/// Reports between two that name the work offset.
const REPORTS_PER_OFFSET: u32 = 10;

/// Which firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Grbl 1.1h: 15 blocks, 128 bytes.
    Grbl,
    /// grblHAL: 100 blocks, 1024 bytes; after an error every line is refused
    /// until an empty one comes.
    GrblHal,
    /// FluidNC 4.0 on an ESP32: its settings are a tree of named items.
    FluidNc,
}

impl Variant {
    const fn planner_blocks(self) -> usize {
        match self {
            Self::Grbl | Self::FluidNc => 15,
            Self::GrblHal => 100,
        }
    }

    /// Motion the pulse timer is handed in advance, s: pieces of 10 ms, of which the last
    /// is being made.
    const fn prepared_s(self) -> f64 {
        match self {
            Self::Grbl => 0.045,
            Self::GrblHal => 0.085,
            Self::FluidNc => 0.12,
        }
    }

    const fn receive_buffer_bytes(self) -> usize {
        match self {
            Self::Grbl => 128,
            Self::GrblHal => 1024,
            Self::FluidNc => 384,
        }
    }

    const fn emergency_letter(self) -> char {
        match self {
            Self::Grbl => 'R',
            Self::GrblHal | Self::FluidNc => 'E',
        }
    }

    const fn banner(self) -> &'static str {
        match self {
            Self::Grbl => "\r\nGrbl 1.1h ['$' for help]\r\n",
            Self::GrblHal => "\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n",
            Self::FluidNc => "\r\nGrbl 4.0 [FluidNC v4.0.4 (esp32-wifi) '$' for help]\r\n",
        }
    }
}

/// What the board is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrblState {
    /// Nothing.
    Idle,
    /// Moving.
    Run,
    /// Braking to a hold, or held.
    Hold {
        /// It stands.
        complete: bool,
    },
    /// Seeking its switches.
    Home,
    /// Locked.
    Alarm,
    /// Reads programs without moving.
    Check,
    /// FluidNC after a hard limit or an emergency stop: it says it is locked, takes every
    /// block, and carries none out until a reset.
    Critical,
    /// FluidNC before it has read its configuration.
    Starting,
}

/// A board, its two wires and its pins, in virtual time.
#[derive(Clone, Debug)]
pub struct GrblTwin {
    variant: Variant,
    now: u64,
    /// Host to board.
    pub to_board: Wire,
    /// Board to host.
    pub to_host: Wire,
    /// The input pins; the switches below are added.
    pub pins: GrblPins,
    /// Where the limit switches of X and Z are, mm from where the slides stood at the
    /// beginning; operated from there on outwards.
    switches: [f64; 2],
    /// The same in pulses.
    switch_pulses: [i64; 2],
    /// Limit inputs at the last look.
    previous_limits: [bool; 2],
    previous_emergency: bool,
    homing: Option<GrblHoming>,
    settings: GrblSettings,
    received: VecDeque<u8>,
    line: Vec<u8>,
    in_comment: bool,
    too_long: bool,
    /// The firmware is busy until then.
    busy_until: u64,
    /// The receive interrupt is off until then.
    deaf_until: u64,
    boots_at: Option<u64>,
    /// A block that waits for a place in the queue, or for the queue to be empty.
    waiting_block: Option<ParsedBlock>,
    /// The line under way is answered then: a dwell, a setting being written.
    answer_at: Option<u64>,
    modal: Modal,
    planner: Planner,
    /// Pulses made since power-on, X, Y, Z: what a counter at the pins reads.
    pulses: [i64; 3],
    /// What the firmware believes, pulses.
    position: [i64; 3],
    /// By so much it reports another place.
    position_error: [i64; 3],
    state: GrblState,
    /// After a hard limit: nothing but a reset is heard.
    waits_for_reset: bool,
    stopped_since: Option<u64>,
    report_due: bool,
    reports: u32,
    error_latch: bool,
    spindle_code: u8,
    coolant: bool,
    spindle: GrblSpindle,
    pass: Option<ThreadPass>,
    passes: Vec<PassTrace>,
    /// A hold was asked for in a pass, and comes behind it.
    hold_pending: bool,
    /// The main loop waits for what never comes; a reset ends it.
    main_loop_blocked: bool,
    /// Time of this step that a pass has more, or (negative) less, s.
    pass_time_offset_s: f64,
    /// Of G54, mm; kept without power.
    work_offset: [f64; 3],
    fluid: FluidState,
    /// Macros FluidNC was told to run, by a character of its own.
    pub macro_count: u32,
    /// Resets it has carried out since power-on, whether it moved or not.
    pub reset_count: u32,
}

impl GrblTwin {
    /// A board that has just got power, with the settings it holds.
    pub fn new(variant: Variant, settings: GrblSettings) -> Self {
        let mut twin = Self {
            variant,
            now: 0,
            to_board: Wire::new(115_200),
            to_host: Wire::new(115_200),
            pins: GrblPins::default(),
            switches: [20.0, 40.0],
            switch_pulses: [0; 2],
            previous_limits: [false; 2],
            previous_emergency: false,
            homing: None,
            settings: settings.for_variant(variant),
            received: VecDeque::new(),
            line: Vec::new(),
            in_comment: false,
            too_long: false,
            busy_until: 0,
            deaf_until: 0,
            boots_at: None,
            waiting_block: None,
            answer_at: None,
            modal: Modal::default(),
            planner: Planner::new(variant.planner_blocks(), variant.prepared_s()),
            pulses: [0; 3],
            position: [0; 3],
            position_error: [0; 3],
            state: GrblState::Idle,
            waits_for_reset: false,
            stopped_since: None,
            report_due: false,
            reports: 0,
            error_latch: false,
            spindle_code: 5,
            coolant: false,
            spindle: GrblSpindle::default(),
            pass: None,
            passes: Vec::new(),
            hold_pending: false,
            main_loop_blocked: false,
            pass_time_offset_s: 0.0,
            work_offset: [0.0; 3],
            fluid: FluidState::default(),
            macro_count: 0,
            reset_count: 0,
        };
        twin.place_switches([20.0, 40.0]);
        twin.press_reset();
        twin
    }

    /// What the board is doing.
    pub const fn state(&self) -> GrblState {
        self.state
    }

    /// Pulses made since power-on, X and Z: what a counter at the pins reads.
    pub const fn pulses(&self) -> [i64; 2] {
        [self.pulses[0], self.pulses[2]]
    }

    /// The firmware loses count: it believes to stand so many pulses beside its place.
    pub const fn add_position_error(&mut self, [x, z]: [i64; 2]) {
        self.position_error[0] += x;
        self.position_error[2] += z;
    }

    /// Another program has set the offset of G54 for X and Z, mm.
    pub const fn set_work_offset(&mut self, [x, z]: [f64; 2]) {
        self.work_offset = [x, 0.0, z];
    }

    /// Its settings.
    pub const fn settings(&self) -> &GrblSettings {
        &self.settings
    }

    /// Its settings, for somebody who has another way into the board.
    pub const fn settings_mut(&mut self) -> &mut GrblSettings {
        &mut self.settings
    }

    /// The spindle word in force (3, 4, 5), its speed, and coolant.
    pub const fn outputs(&self) -> (u8, f64, bool) {
        (self.spindle_code, self.modal.speed, self.coolant)
    }

    /// Virtual time, ns.
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// The host writes bytes.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.send(bytes, self.now);
    }

    /// What has arrived at the host.
    pub fn read(&mut self) -> Vec<u8> {
        let now = self.now;
        core::iter::from_fn(|| self.to_host.receive(now)).collect()
    }

    /// Lets time pass, ns.
    pub fn advance(&mut self, ns: u64) {
        let end = self.now + ns;
        while self.now < end {
            let step = STEP_NS.min(end - self.now);
            self.now += step;
            self.advance_spindle(step);
            if self.variant == Variant::FluidNc {
                self.advance_fluid(step);
                continue;
            }
            self.receive_bytes();
            if let Some(at) = self.boots_at {
                if self.now < at {
                    continue;
                }
                self.power_on();
            }
            self.check_pins();
            self.move_axes(step);
            self.send_report();
            self.run_main_loop();
        }
    }

    fn send_text(&mut self, text: &str) {
        self.to_host.send(text.as_bytes(), self.now);
    }

    fn send_answer(&mut self, result: Result<(), u8>) {
        match result {
            Ok(()) => self.send_text("ok\r\n"),
            Err(number) => {
                self.error_latch = self.variant == Variant::GrblHal;
                self.send_text(&format!("error:{number}\r\n"));
                if self.is_config_on("verbose_errors") {
                    self.send_text(&format!("[MSG:ERR: This is error {number}]\r\n"));
                }
            }
        }
    }

    fn position_mm(&self) -> [f64; 3] {
        let scale = self.settings.axis_values(100);
        [0, 1, 2].map(|axis| {
            (self.position[axis] + self.position_error[axis]) as f64 / scale[axis].max(1e-9)
        })
    }

    /// The receive interrupt: some characters act at once, the others go into
    /// the buffer, or nowhere when it is full.
    fn receive_bytes(&mut self) {
        while let Some(byte) = self.to_board.receive(self.now) {
            if self.now < self.deaf_until || self.boots_at.is_some() {
                continue;
            }
            match byte {
                b'?' => self.report_due = true,
                b'!' => self.start_hold(),
                b'~' => self.resume(),
                0x18 => self.soft_reset(),
                0x80.. => {}
                _ if self.received.len() + 1 < self.variant.receive_buffer_bytes() => {
                    self.received.push_back(byte);
                }
                _ => {}
            }
        }
    }

    fn start_hold(&mut self) {
        if self.pass.is_some() {
            self.hold_pending = true;
        } else if self.state == GrblState::Run {
            self.state = GrblState::Hold { complete: false };
            self.stopped_since = None;
        } else if self.state == GrblState::Idle {
            self.state = GrblState::Hold { complete: true };
        }
    }

    fn resume(&mut self) {
        if self.state == (GrblState::Hold { complete: true }) {
            self.state = if self.planner.is_empty() {
                GrblState::Idle
            } else {
                GrblState::Run
            };
        }
    }

    fn move_axes(&mut self, step: u64) {
        let seconds = step as f64 * 1e-9 + core::mem::take(&mut self.pass_time_offset_s);
        match self.state {
            GrblState::Run => self.make_pulses(seconds, false),
            GrblState::Hold { complete: false } => {
                self.make_pulses(seconds, true);
                if !self.planner.is_stopped() {
                    return;
                }
                let since = *self.stopped_since.get_or_insert(self.now);
                if self.now >= since + HOLD_SETTLE_NS {
                    self.state = GrblState::Hold { complete: true };
                }
            }
            GrblState::Home => self.advance_homing(seconds),
            _ => {}
        }
        self.record_pass_position();
        let waiting = self.pass.is_some_and(|pass| pass.is_waiting_for_index());
        if self.state == GrblState::Run && self.planner.is_empty() && !waiting {
            self.state = GrblState::Idle;
            self.finish_pass();
        }
    }

    fn make_pulses(&mut self, seconds: f64, hold: bool) {
        let made = self.planner.advance(seconds, hold);
        self.count_all_pulses(made);
    }

    fn count_all_pulses(&mut self, made: [i64; 3]) {
        for (axis, count) in made.into_iter().enumerate() {
            self.count_pulses(axis, count);
        }
    }

    /// The count goes on where the motor of an axis is kept from making pulses.
    const fn count_pulses(&mut self, axis: usize, count: i64) {
        self.position[axis] += count;
        if !self.is_limited(axis) {
            self.pulses[axis] += count;
        }
    }

    fn send_report(&mut self) {
        // The 8 bit board does not answer while it seeks its switches.
        let deaf = self.homing.is_some() && self.variant == Variant::Grbl;
        // Nor does the larger one while it waits for the one-turn signal.
        let deaf = deaf || self.pass.is_some_and(|pass| pass.is_waiting_for_index());
        if deaf || !core::mem::take(&mut self.report_due) || self.waits_for_reset {
            return;
        }
        let text = self.status_report();
        self.reports = self.reports.wrapping_add(1);
        self.send_text(&text);
    }
}

#[cfg(test)]
mod tests;
