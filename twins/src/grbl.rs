//! Twins of Grbl boards: Grbl 1.1h on an 8 bit processor, grblHAL, and FluidNC.
//!
//! They model on purpose what hosts get wrong: a receive buffer that drops what does not
//! fit, realtime characters that act within a line, a carriage return that ends a separate
//! line, silence after a hard limit, an `ok` that means "read" and not "done", and a
//! reset whenever the port is opened.

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

use crate::wire::TwinWire;
use block::{Modal, ParsedBlock};
use fluid::FluidState;
use homing::GrblHoming;
pub use pins::GrblPins;
use planner::Planner;
pub use settings::GrblSettings;
use spindle::TwinThreadPass;
pub use spindle::{GrblSpindle, PassTrace};

/// Time step in which virtual time advances, ns.
const STEP_NS: u64 = 100_000;
/// Time that the firmware takes to process a line, ns: 447 lines/s.
const LINE_NS: u64 = 2_237_000;
/// Time from standstill until the board reports the hold as complete, ns.
const HOLD_SETTLE_NS: u64 = 35_000_000;
/// Time from power-on or reset line to the banner, ns.
const BOOT_NS: u64 = 1_500_000_000;
/// Time for which writing a setting disables interrupts, ns.
const SETTING_WRITE_NS: u64 = 14_000_000;
/// Maximum length of a line, bytes.
const MAX_LINE_BYTES: usize = 80;
/// Minimum speed of a cut in the planner, mm/s (1 mm/min).
const MIN_CUT_SPEED: f64 = 1.0 / 60.0;
/// Number of status reports from one that contains the work offset to the next.
const REPORTS_PER_OFFSET: u32 = 10;

/// The firmware that a board runs: Grbl, grblHAL or FluidNC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Grbl 1.1h: planner with 15 blocks, receive buffer of 128 bytes.
    Grbl,
    /// grblHAL: planner with 100 blocks, receive buffer of 1024 bytes. After an error it
    /// refuses all lines until an empty line.
    GrblHal,
    /// FluidNC 4.0 on an ESP32. Its settings are a tree of named items.
    FluidNc,
}

impl Variant {
    const fn planner_blocks(self) -> usize {
        match self {
            Self::Grbl | Self::FluidNc => 15,
            Self::GrblHal => 100,
        }
    }

    /// Returns the duration of the motion that the firmware prepares in advance for the pulse
    /// timer, s.
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

/// The state of the board, as status reports name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrblState {
    /// The board makes no motion.
    Idle,
    /// The board is in motion.
    Run,
    /// A feed hold decelerates the axes or holds them.
    Hold {
        /// Whether the axes have stopped, so that the hold is complete.
        complete: bool,
    },
    /// The board is homing its axes.
    Home,
    /// An alarm locks the board.
    Alarm,
    /// Check mode: the board reads programs without motion.
    Check,
    /// FluidNC after a hard limit or an emergency stop: it reports an alarm, accepts all
    /// blocks, but executes none until a reset.
    Critical,
    /// FluidNC has not read its configuration yet.
    Starting,
}

/// A Grbl board with its two serial lines and its pins, in virtual time.
#[derive(Clone, Debug)]
pub struct GrblTwin {
    variant: Variant,
    now: u64,
    /// Serial line from the host to the board.
    pub to_board: TwinWire,
    /// Serial line from the board to the host.
    pub to_host: TwinWire,
    /// Input pins, in addition to the limit switches of [`GrblTwin::place_switches`].
    pub pins: GrblPins,
    /// Distances of the limit switches of X and Z from the slides at power-on, mm.
    switches: [f64; 2],
    /// Distances of the limit switches of X and Z from the slides at power-on, pulses.
    switch_pulses: [i64; 2],
    /// Whether the limit inputs of X and Z were operated at the last check.
    previous_limits: [bool; 2],
    previous_emergency: bool,
    homing: Option<GrblHoming>,
    settings: GrblSettings,
    received: VecDeque<u8>,
    line: Vec<u8>,
    in_comment: bool,
    too_long: bool,
    /// Time until which the firmware is busy, ns.
    busy_until: u64,
    /// Time until which the board receives nothing, ns: the receive interrupt is off.
    deaf_until: u64,
    boots_at: Option<u64>,
    /// A parsed block that waits until the planner has space, or until its queue is empty.
    waiting_block: Option<ParsedBlock>,
    /// Time at which the current line is answered, ns; set by a dwell or a setting.
    answer_at: Option<u64>,
    modal: Modal,
    planner: Planner,
    /// Pulses of X, Y, Z since power-on, as a counter at the pins reads them.
    pulses: [i64; 3],
    /// Position that the firmware counts for X, Y, Z, pulses.
    position: [i64; 3],
    /// Error added to the position of X, Y, Z in reports, pulses.
    position_error: [i64; 3],
    state: GrblState,
    /// Whether the board ignores everything except a reset, as after a hard limit.
    waits_for_reset: bool,
    stopped_since: Option<u64>,
    report_due: bool,
    reports: u32,
    error_latch: bool,
    spindle_code: u8,
    coolant: bool,
    spindle: GrblSpindle,
    pass: Option<TwinThreadPass>,
    passes: Vec<PassTrace>,
    /// Whether a feed hold was received during a thread pass; it acts at the end of the pass.
    hold_pending: bool,
    /// Whether the main loop waits forever; only a reset ends the wait.
    main_loop_blocked: bool,
    /// Time to add to the current step of a thread pass, s; negative if the pass starts within
    /// the step.
    pass_time_offset_s: f64,
    /// Work offset of G54 for X, Y, Z, mm; survives power-off.
    work_offset: [f64; 3],
    fluid: FluidState,
    /// Number of FluidNC macros that realtime characters have started since power-on.
    pub macro_count: u32,
    /// Number of resets since power-on, with the axes in motion or at rest.
    pub reset_count: u32,
}

impl GrblTwin {
    /// Creates a board that has just been switched on, with its stored settings.
    pub fn new(variant: Variant, settings: GrblSettings) -> Self {
        let mut twin = Self {
            variant,
            now: 0,
            to_board: TwinWire::new(115_200),
            to_host: TwinWire::new(115_200),
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

    /// Returns the state of the board.
    pub const fn state(&self) -> GrblState {
        self.state
    }

    /// Returns the pulses of X and Z since power-on, as a counter at the pins reads them.
    pub const fn pulses(&self) -> [i64; 2] {
        [self.pulses[0], self.pulses[2]]
    }

    /// Adds an error to the position that the firmware reports, pulses of X and Z.
    pub const fn add_position_error(&mut self, [x, z]: [i64; 2]) {
        self.position_error[0] += x;
        self.position_error[2] += z;
    }

    /// Sets the work offset of G54 for X and Z, mm, as another host program does.
    pub const fn set_work_offset(&mut self, [x, z]: [f64; 2]) {
        self.work_offset = [x, 0.0, z];
    }

    /// Returns the settings that the board has stored.
    pub const fn settings(&self) -> &GrblSettings {
        &self.settings
    }

    /// Returns the stored settings for a change, as if another host program had changed them.
    pub const fn settings_mut(&mut self) -> &mut GrblSettings {
        &mut self.settings
    }

    /// Returns the outputs: spindle code (3, 4 or 5 for M03 to M05), S value in r/min, and
    /// whether the coolant is on.
    pub const fn outputs(&self) -> (u8, f64, bool) {
        (self.spindle_code, self.modal.speed, self.coolant)
    }

    /// Returns the current virtual time, ns.
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// Sends bytes from the host to the board.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.send(bytes, self.now);
    }

    /// Returns the bytes that have arrived at the host, and removes them.
    pub fn read(&mut self) -> Vec<u8> {
        let now = self.now;
        core::iter::from_fn(|| self.to_host.receive(now)).collect()
    }

    /// Advances the virtual time by `ns` nanoseconds.
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

    /// Receive interrupt: executes realtime characters and stores the others in the buffer.
    /// Bytes that do not fit are lost.
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

    /// Adds pulses of an axis to the position. The motor of a blocked axis makes no pulses,
    /// but the position still changes.
    const fn count_pulses(&mut self, axis: usize, count: i64) {
        self.position[axis] += count;
        if !self.is_limited(axis) {
            self.pulses[axis] += count;
        }
    }

    fn send_report(&mut self) {
        // Grbl 1.1h does not report during homing.
        let deaf = self.homing.is_some() && self.variant == Variant::Grbl;
        // grblHAL does not report while a thread pass waits for the index signal.
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
