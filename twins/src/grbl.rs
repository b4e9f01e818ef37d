//! Boards of the Grbl family: Grbl 1.1h on an 8 bit processor, and grblHAL.
//!
//! What hosts trip over is modelled on purpose: a receive buffer that drops what
//! does not fit, characters that act at once wherever they stand, a carriage
//! return that ends a line of its own, silence after a hard limit, answers that
//! say "read", not "done", and a reset whenever the port is opened.

mod block;
mod firmware;
mod homing;
mod planner;
mod report;
mod settings;
mod spindle;

use std::collections::VecDeque;

use crate::wire::Wire;
use block::{Asked, Modal};
use homing::Homing;
use planner::Planner;
pub use settings::Settings;
use spindle::Pass;
pub use spindle::{PassTrace, Spindle};

/// One step of virtual time, ns.
const STEP_NS: u64 = 100_000;
/// Time a line takes besides its bytes: 447 lines a second, ns.
const LINE_NS: u64 = 2_237_000;
/// Motion already handed to the pulse timer when a hold comes, ns.
const PREPARED_NS: u64 = 45_000_000;
/// From standstill until the board calls the hold complete, ns.
const HOLD_SETTLES_NS: u64 = 35_000_000;
/// From power or reset line to the banner, ns.
const BOOT_NS: u64 = 1_500_000_000;
/// Writing a setting stops the interrupts so long, ns.
const SETTING_WRITE_NS: u64 = 14_000_000;
/// The longest line.
const LINE_BYTES: usize = 80;
/// The slowest cut the planner makes, mm/s (1 mm/min).
const LEAST_CUT: f64 = 1.0 / 60.0;
/// Reports between two that name the work offset.
const OFFSET_EVERY: u32 = 10;

/// Which firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Grbl 1.1h: 15 blocks, 128 bytes.
    Grbl,
    /// grblHAL: 100 blocks, 1024 bytes; after an error every line is refused
    /// until an empty one comes.
    GrblHal,
}

impl Variant {
    const fn blocks(self) -> usize {
        match self {
            Self::Grbl => 15,
            Self::GrblHal => 100,
        }
    }

    const fn receive_bytes(self) -> usize {
        match self {
            Self::Grbl => 128,
            Self::GrblHal => 1024,
        }
    }

    const fn emergency_letter(self) -> char {
        match self {
            Self::Grbl => 'R',
            Self::GrblHal => 'E',
        }
    }

    const fn banner(self) -> &'static str {
        match self {
            Self::Grbl => "\r\nGrbl 1.1h ['$' for help]\r\n",
            Self::GrblHal => "\r\nGrblHAL 1.1f ['$' or '$HELP' for help]\r\n",
        }
    }
}

/// What the board is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
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
}

/// The input pins; true is "switch operated".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pins {
    /// Limit of X.
    pub limit_x: bool,
    /// Limit of Z.
    pub limit_z: bool,
    /// Door.
    pub door: bool,
    /// Probe.
    pub probe: bool,
    /// Emergency stop (the larger board), or reset (the 8 bit board).
    pub emergency: bool,
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
    pub pins: Pins,
    /// Where the limit switches of X and Z are, mm from where the slides stood at the
    /// beginning; operated from there on outwards.
    switches: [f64; 2],
    /// The same in pulses.
    switch_pulses: [i64; 2],
    /// Limit inputs at the last look.
    limits_were: [bool; 2],
    emergency_was: bool,
    homing: Option<Homing>,
    settings: Settings,
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
    waiting: Option<Asked>,
    /// The line under way is answered then: a dwell, a setting being written.
    answers_at: Option<u64>,
    modal: Modal,
    planner: Planner,
    /// Pulses made since power-on, X, Y, Z: what a counter at the pins reads.
    pulses: [i64; 3],
    /// What the firmware believes, pulses.
    position: [i64; 3],
    /// By so much it reports another place.
    miscounted: [i64; 3],
    state: State,
    /// After a hard limit: nothing but a reset is heard.
    silent: bool,
    hold_from: Option<u64>,
    stands_since: Option<u64>,
    report_due: bool,
    reports: u32,
    error_latch: bool,
    spindle: u8,
    coolant: bool,
    shaft: Spindle,
    pass: Option<Pass>,
    passes: Vec<PassTrace>,
    /// A hold was asked for in a pass, and comes behind it.
    hold_pending: bool,
    /// The main loop waits for what never comes; a reset ends it.
    stuck: bool,
    /// Time of this step that a pass has more, or (negative) less, s.
    head_start: f64,
}

impl GrblTwin {
    /// A board that has just got power, with the settings it holds.
    pub fn new(variant: Variant, settings: Settings) -> Self {
        let mut twin = Self {
            variant,
            now: 0,
            to_board: Wire::new(115_200),
            to_host: Wire::new(115_200),
            pins: Pins::default(),
            switches: [20.0, 40.0],
            switch_pulses: [0; 2],
            limits_were: [false; 2],
            emergency_was: false,
            homing: None,
            settings,
            received: VecDeque::new(),
            line: Vec::new(),
            in_comment: false,
            too_long: false,
            busy_until: 0,
            deaf_until: 0,
            boots_at: None,
            waiting: None,
            answers_at: None,
            modal: Modal::default(),
            planner: Planner::new(variant.blocks()),
            pulses: [0; 3],
            position: [0; 3],
            miscounted: [0; 3],
            state: State::Idle,
            silent: false,
            hold_from: None,
            stands_since: None,
            report_due: false,
            reports: 0,
            error_latch: false,
            spindle: 5,
            coolant: false,
            shaft: Spindle::default(),
            pass: None,
            passes: Vec::new(),
            hold_pending: false,
            stuck: false,
            head_start: 0.0,
        };
        twin.place_switches([20.0, 40.0]);
        twin.press_reset();
        twin
    }

    /// The reset line: opening the port does this to boards with the usual USB
    /// chip. Everything but the settings is gone, the position too.
    pub fn press_reset(&mut self) {
        self.boots_at = Some(self.now + BOOT_NS);
        self.received.clear();
        self.planner.clear();
        self.waiting = None;
        self.homing = None;
        self.pass = None;
        // The output that drives the spindle drops.
        self.spindle = 5;
    }

    /// Whether the limit inputs of X and Z are operated.
    pub fn limits(&self) -> [bool; 2] {
        let at = |place: i64, switch: i64| place * switch.signum() >= switch.abs();
        let [x, z] = self.switch_pulses;
        [
            self.pins.limit_x || at(self.pulses[0], x),
            self.pins.limit_z || at(self.pulses[2], z),
        ]
    }

    /// Puts the limit switches of X and Z so many mm from where the slides stood at
    /// the beginning; they are operated from there on outwards.
    pub fn place_switches(&mut self, switches: [f64; 2]) {
        self.switches = switches;
        self.set_switches();
    }

    fn set_switches(&mut self) {
        let [x, _, z] = self.settings.axes(100);
        let [at_x, at_z] = self.switches;
        self.switch_pulses = [(at_x * x).round() as i64, (at_z * z).round() as i64];
    }

    /// What the board is doing.
    pub const fn state(&self) -> State {
        self.state
    }

    /// Pulses made since power-on, X and Z: what a counter at the pins reads.
    pub const fn pulses(&self) -> [i64; 2] {
        [self.pulses[0], self.pulses[2]]
    }

    /// The firmware loses count: it believes to stand so many pulses beside its place.
    pub const fn miscount(&mut self, [x, z]: [i64; 2]) {
        self.miscounted[0] += x;
        self.miscounted[2] += z;
    }

    /// The board stops itself with this alarm of its firmware; from the smaller numbers
    /// it has to be unlocked.
    pub fn give_up(&mut self, number: u8) {
        self.planner.clear();
        self.waiting = None;
        self.homing = None;
        self.state = State::Alarm;
        self.say(&format!("ALARM:{number}\r\n"));
    }

    /// Its settings.
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Its settings, for somebody who has another way into the board.
    pub const fn settings_mut(&mut self) -> &mut Settings {
        &mut self.settings
    }

    /// The spindle word in force (3, 4, 5), its speed, and coolant.
    pub const fn outputs(&self) -> (u8, f64, bool) {
        (self.spindle, self.modal.speed, self.coolant)
    }

    /// Virtual time, ns.
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// The host writes bytes.
    pub fn write(&mut self, bytes: &[u8]) {
        self.to_board.give(bytes, self.now);
    }

    /// What has arrived at the host.
    pub fn read(&mut self) -> Vec<u8> {
        let now = self.now;
        core::iter::from_fn(|| self.to_host.take(now)).collect()
    }

    /// Lets time pass, ns.
    pub fn advance(&mut self, ns: u64) {
        let end = self.now + ns;
        while self.now < end {
            let step = STEP_NS.min(end - self.now);
            self.now += step;
            self.turn_spindle(step);
            self.receive();
            if let Some(at) = self.boots_at {
                if self.now < at {
                    continue;
                }
                self.power_on();
            }
            self.watch_pins();
            self.move_axes(step);
            self.send_report();
            self.work();
        }
    }

    fn say(&mut self, text: &str) {
        self.to_host.give(text.as_bytes(), self.now);
    }

    fn answer(&mut self, result: Result<(), u8>) {
        match result {
            Ok(()) => self.say("ok\r\n"),
            Err(number) => {
                self.error_latch = self.variant == Variant::GrblHal;
                self.say(&format!("error:{number}\r\n"));
            }
        }
    }

    fn power_on(&mut self) {
        self.boots_at = None;
        self.position = [0; 3];
        self.miscounted = [0; 3];
        self.modal = Modal::default();
        self.state = if self.settings.is_on(22) {
            State::Alarm
        } else {
            State::Idle
        };
        self.start_firmware();
    }

    /// What power-on and a soft reset have in common.
    fn start_firmware(&mut self) {
        self.received.clear();
        self.line.clear();
        let off = core::mem::take(&mut self.miscounted);
        for (place, off) in self.position.iter_mut().zip(off) {
            *place += off;
        }
        self.in_comment = false;
        self.too_long = false;
        self.waiting = None;
        self.answers_at = None;
        self.planner.clear();
        self.homing = None;
        self.pass = None;
        self.hold_pending = false;
        self.stuck = false;
        self.hold_from = None;
        self.stands_since = None;
        self.silent = false;
        self.error_latch = false;
        self.spindle = 5;
        self.coolant = false;
        self.modal = Modal {
            position: self.millimetres(),
            ..Modal::default()
        };
        self.say(self.variant.banner());
        if self.state == State::Alarm {
            self.say("[MSG:'$H'|'$X' to unlock]\r\n");
        } else {
            self.state = State::Idle;
        }
    }

    fn millimetres(&self) -> [f64; 3] {
        let scale = self.settings.axes(100);
        [0, 1, 2].map(|axis| {
            (self.position[axis] + self.miscounted[axis]) as f64 / scale[axis].max(1e-9)
        })
    }

    /// The receive interrupt: some characters act at once, the others go into
    /// the buffer, or nowhere when it is full.
    fn receive(&mut self) {
        while let Some(byte) = self.to_board.take(self.now) {
            if self.now < self.deaf_until || self.boots_at.is_some() {
                continue;
            }
            match byte {
                b'?' => self.report_due = true,
                b'!' => self.hold(),
                b'~' => self.resume(),
                0x18 => self.soft_reset(),
                0x80.. => {}
                _ if self.received.len() + 1 < self.variant.receive_bytes() => {
                    self.received.push_back(byte);
                }
                _ => {}
            }
        }
    }

    fn hold(&mut self) {
        if self.pass.is_some() {
            self.hold_pending = true;
        } else if self.state == State::Run {
            self.state = State::Hold { complete: false };
            self.hold_from = Some(self.now + PREPARED_NS);
            self.stands_since = None;
        } else if self.state == State::Idle {
            self.state = State::Hold { complete: true };
        }
    }

    fn resume(&mut self) {
        if self.state == (State::Hold { complete: true }) {
            self.hold_from = None;
            self.state = if self.planner.is_empty() {
                State::Idle
            } else {
                State::Run
            };
        }
    }

    fn soft_reset(&mut self) {
        let moving = matches!(self.state, State::Run | State::Hold { complete: false });
        if self.state == State::Home {
            self.state = State::Alarm;
            self.say("ALARM:6\r\n");
        } else if moving {
            self.state = State::Alarm;
            self.say("ALARM:3\r\n");
        } else if self.state == (State::Hold { complete: true }) || self.state == State::Check {
            self.state = State::Idle;
        }
        self.start_firmware();
    }

    /// Limit inputs act on their edges. The 8 bit board looks at no level: letting go
    /// of a switch is an edge too.
    fn watch_pins(&mut self) {
        let pressed = self.pins.emergency && !self.emergency_was;
        self.emergency_was = self.pins.emergency;
        match self.variant {
            Variant::Grbl if pressed => self.soft_reset(),
            Variant::GrblHal if pressed => {
                self.state = State::Alarm;
                self.say("ALARM:10\r\n");
                self.start_firmware();
            }
            _ => {}
        }
        let limits = self.limits();
        let were = core::mem::replace(&mut self.limits_were, limits);
        let edge = (0..2).any(|axis| match self.variant {
            Variant::Grbl => limits[axis] != were[axis],
            Variant::GrblHal => limits[axis] && !were[axis],
        });
        let watched = !matches!(self.state, State::Alarm | State::Home);
        if edge && watched && self.settings.is_on(21) && !self.silent {
            self.planner.clear();
            self.waiting = None;
            self.pass = None;
            self.state = State::Alarm;
            self.say("ALARM:1\r\n[MSG:Reset to continue]\r\n");
            self.silent = true;
        }
    }

    fn move_axes(&mut self, step: u64) {
        let seconds = step as f64 * 1e-9 + core::mem::take(&mut self.head_start);
        let holding = self.hold_from.is_some_and(|from| self.now >= from);
        match self.state {
            State::Run => self.make_pulses(seconds, false),
            State::Hold { complete: false } => {
                self.make_pulses(seconds, holding);
                if self.planner.speed() > 0.0 && !self.planner.is_empty() {
                    return;
                }
                let since = *self.stands_since.get_or_insert(self.now);
                if self.now >= since + HOLD_SETTLES_NS {
                    self.state = State::Hold { complete: true };
                }
            }
            State::Home => self.home(seconds),
            _ => {}
        }
        self.trace_pass();
        let waiting = self.pass.is_some_and(|pass| pass.is_waiting());
        if self.state == State::Run && self.planner.is_empty() && !waiting {
            self.state = State::Idle;
            self.end_pass();
        }
    }

    fn make_pulses(&mut self, seconds: f64, hold: bool) {
        let made = self.planner.advance(seconds, hold);
        for (axis, count) in made.into_iter().enumerate() {
            self.pulses[axis] += count;
            self.position[axis] += count;
        }
    }

    fn send_report(&mut self) {
        // The 8 bit board does not answer while it seeks its switches.
        let deaf = self.homing.is_some() && self.variant == Variant::Grbl;
        // Nor does the larger one while it waits for the one-turn signal.
        let deaf = deaf || self.pass.is_some_and(|pass| pass.is_waiting());
        if deaf || !core::mem::take(&mut self.report_due) || self.silent {
            return;
        }
        let text = self.report();
        self.reports = self.reports.wrapping_add(1);
        self.say(&text);
    }
}

#[cfg(test)]
mod tests;
