//! The section `link` of the machine file (RON).

use core::time::Duration;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use thiserror::Error;

use super::pin::PinName;
use super::{Input, contacts};

/// A pulse board and how it is wired.
///
/// ```
/// use gsk_link::LinkConfig;
/// let link: LinkConfig = ron::from_str(r#"(port: "/dev/ttyUSB0", line: (max_rate: 30000))"#).unwrap();
/// assert_eq!(link.lookahead().as_millis(), 150);
/// assert!(link.check().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkConfig {
    /// What the board understands.
    pub protocol: Protocol,
    /// Serial device, best by its unchanging name under `/dev/serial/by-id/`.
    pub port: String,
    /// Bits a second.
    pub baud: u32,
    /// How far the kernel may run ahead of the board, ms, 50–400. Every hold is
    /// later by this. `None`: 150 with lines, 100 with steps.
    pub lookahead_ms: Option<u32>,
    /// Up to this feed the reference stays valid after a stop without a ramp,
    /// mm/min of the slide.
    pub flush_keep_speed: u32,
    /// Wiring of the cross slide.
    pub x: LinkAxis,
    /// Wiring of the carriage.
    pub z: LinkAxis,
    /// Wiring of the rest, where the board has no fixed pins.
    pub io: LinkIo,
    /// Contacts X0.0 to X3.7 of the control that are wired to the board, closed while
    /// the pin is high (`!`: low): `{"X1.4": "^PD0"}`. A line board tells letters.
    pub inputs: BTreeMap<String, String>,
    /// Boards that read lines (Grbl, grblHAL).
    pub line: LineConfig,
}

impl Default for LinkConfig {
    fn default() -> Self {
        Self {
            protocol: Protocol::Line,
            port: String::new(),
            baud: 115_200,
            lookahead_ms: None,
            flush_keep_speed: 300,
            x: LinkAxis::default(),
            z: LinkAxis::default(),
            io: LinkIo::default(),
            inputs: BTreeMap::new(),
            line: LineConfig::default(),
        }
    }
}

/// What a board understands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Protocol {
    /// Lines of text: Grbl 1.1, grblHAL.
    #[default]
    Line,
    /// Times of steps: boards with Klipper firmware.
    StepQueue,
}

/// One axis at the board. Pins are named as the board names them; `^` before the
/// name turns its pull-up on, `!` turns its level over. An empty name: not wired.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkAxis {
    /// The direction is turned over: in a board that reads lines by $3, in one of timed
    /// steps together with the `!` of the pin.
    pub invert_direction: bool,
    /// Step pin.
    pub step: String,
    /// Direction pin.
    pub dir: String,
    /// Length of a step pulse, µs.
    pub step_pulse_us: u32,
    /// Time between the last pulse one way and the first the other, µs.
    pub dir_setup_us: u32,
    /// The most pulses a second. `None`: what this processor is known to make.
    pub max_rate: Option<u32>,
    /// Limit switches of the axis.
    pub limit: String,
    /// Deceleration switch for machine zero return.
    pub dec: String,
    /// Zero signal of the drive.
    pub zero: String,
    /// On a board that returns by itself the reference switch is at the end of falling
    /// board positions ($23).
    pub home_negative: bool,
    /// Machine coordinate of the position where a return to a limit switch ends, mm (X in
    /// diameter).
    pub home_at: f64,
}

impl Default for LinkAxis {
    fn default() -> Self {
        Self {
            invert_direction: false,
            step: String::new(),
            dir: String::new(),
            step_pulse_us: 2,
            dir_setup_us: 10,
            max_rate: None,
            limit: String::new(),
            dec: String::new(),
            zero: String::new(),
            home_negative: false,
            home_at: 0.0,
        }
    }
}

impl LinkAxis {
    /// On a board of timed steps: the level of the direction pin is turned over.
    pub(super) fn is_turned_over(&self) -> bool {
        self.invert_direction != PinName::read(&self.dir).inverted
    }
}

/// How the board seeks its reference switches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HomeConfig {
    /// Speed towards the switch, mm/min ($25).
    pub seek: u32,
    /// Speed of the second, exact approach, mm/min ($24).
    pub locate: u32,
    /// Way back off the switch, µm ($27).
    pub pull_off_um: u32,
}

impl Default for HomeConfig {
    fn default() -> Self {
        Self {
            seek: 500,
            locate: 25,
            pull_off_um: 1000,
        }
    }
}

/// The other pins of a board of timed steps; named as those of the axes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkIo {
    /// Enable input of the drives.
    pub enable: String,
    /// Sense of the emergency stop chain.
    pub estop: String,
    /// Alarm of the drives.
    pub drive_alarm: String,
    /// Spindle clockwise (M03).
    pub spindle_cw: String,
    /// Spindle counterclockwise (M04).
    pub spindle_ccw: String,
    /// Spindle speed, pulse width for 0–10 V.
    pub spindle_pwm: String,
    /// Coolant (M08).
    pub coolant: String,
    /// One-turn signal of the spindle.
    pub index: String,
}

/// What only boards of the Grbl family need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LineConfig {
    /// Reference return.
    pub home: HomeConfig,
    /// Duration of a segment, ms, 5–40.
    pub period_ms: u32,
    /// The most pulses a second and axis the board makes without losing one.
    pub max_rate: u32,
    /// Length of a step pulse, µs ($0).
    pub step_pulse_us: u32,
    /// Limit switches open when operated ($5).
    pub invert_limits: bool,
    /// The step pins of both axes are turned over in the board ($2).
    pub invert_step: bool,
    /// The enable output is turned over in the board ($4): the drives are on while it is
    /// high.
    pub invert_enable: bool,
    /// Time after which a switch counts as settled in a reference return, ms ($26).
    pub debounce_ms: u32,
    /// The owner has cut the proof thread and found its lead right.
    pub thread_proved: bool,
}

impl Default for LineConfig {
    fn default() -> Self {
        Self {
            home: HomeConfig::default(),
            period_ms: 10,
            max_rate: 30_000,
            step_pulse_us: 10,
            invert_limits: false,
            invert_step: false,
            invert_enable: false,
            debounce_ms: 250,
            thread_proved: false,
        }
    }
}

/// A field that is not as it must be.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}", self.message())]
pub struct LinkConfigError {
    /// Name of the field.
    pub field: &'static str,
    /// What is wrong with it.
    pub fault: FaultyLinkConfig,
}

/// What is wrong with a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{}", self.message())]
pub enum FaultyLinkConfig {
    /// A value out of its range.
    Range {
        /// The value.
        value: u32,
        /// Least value allowed.
        least: u32,
        /// Greatest value allowed.
        most: u32,
    },
    /// A pin without which nothing works.
    Missing,
    /// The name of an input is no contact.
    NoContact,
    /// A contact that has a setting of its own.
    HasSetting {
        /// The contact.
        contact: &'static str,
        /// What it is for.
        signal: &'static str,
        /// The setting.
        field: &'static str,
    },
    /// A contact without a pin.
    ContactWithoutPin,
    /// A contact at a line board without one of its letters.
    NoLetter,
    /// A pull-up (`^`) that a line board does not have.
    LetterPullUp,
    /// A pull-up (`^`) of an output.
    OutputPullUp,
    /// An index that is turned over (`!`).
    IndexTurnedOver,
    /// The pin of this other field, too.
    Twice(&'static str),
    /// No position on an axis.
    Place,
}

impl FaultyLinkConfig {
    /// In words.
    pub fn message(&self) -> Message {
        match self {
            Self::Range { value, least, most } => say::link_value_wrong(value, least, most),
            Self::Missing => say::link_pin_missing(),
            Self::NoContact => say::link_contact_wrong(),
            Self::HasSetting {
                contact,
                signal,
                field,
            } => say::link_contact_has_setting(contact, signal, field),
            Self::ContactWithoutPin => say::link_contact_without_pin(),
            Self::NoLetter => say::link_contact_letter_wrong(),
            Self::LetterPullUp => say::link_letter_pull_up(),
            Self::OutputPullUp => say::link_output_pull_up(),
            Self::IndexTurnedOver => say::link_index_turned_over(),
            Self::Twice(other) => say::link_pin_twice(other),
            Self::Place => say::link_place_wrong(MAX_HOME_MM),
        }
    }
}

impl LinkConfigError {
    /// Field and fault.
    pub fn message(&self) -> Message {
        say::machine_field(format_args!("link.{}", self.field), self.fault.message())
    }
}

/// The greatest coordinate of the control, mm.
const MAX_HOME_MM: f64 = 9999.999;

impl LinkConfig {
    /// Contacts of the control that are wired to inputs of the board.
    pub fn contacts(&self) -> impl Iterator<Item = Input> {
        contacts::wired(&self.inputs).map(|(contact, _)| contact)
    }

    /// How far the kernel may run ahead of the board.
    pub fn lookahead(&self) -> Duration {
        let usual = match self.protocol {
            Protocol::Line => 150,
            Protocol::StepQueue => 100,
        };
        Duration::from_millis(self.lookahead_ms.unwrap_or(usual).into())
    }

    /// Checks the ranges, and that the pins are named without which nothing works.
    ///
    /// # Errors
    /// The first field that is not as it must be.
    pub fn check(&self) -> Result<(), LinkConfigError> {
        let line = &self.line;
        let ranges = [
            ("baud", Some(self.baud), 9600, 4_000_000),
            ("lookahead_ms", self.lookahead_ms, 50, 400),
            (
                "flush_keep_speed",
                Some(self.flush_keep_speed),
                0,
                1_000_000,
            ),
            ("x.step_pulse_us", Some(self.x.step_pulse_us), 1, 255),
            ("z.step_pulse_us", Some(self.z.step_pulse_us), 1, 255),
            ("x.dir_setup_us", Some(self.x.dir_setup_us), 1, 1000),
            ("z.dir_setup_us", Some(self.z.dir_setup_us), 1, 1000),
            ("x.max_rate", self.x.max_rate, 1000, 1_000_000),
            ("z.max_rate", self.z.max_rate, 1000, 1_000_000),
            ("line.period_ms", Some(line.period_ms), 5, 40),
            ("line.max_rate", Some(line.max_rate), 1000, 1_000_000),
            ("line.step_pulse_us", Some(line.step_pulse_us), 3, 255),
            ("line.debounce_ms", Some(line.debounce_ms), 1, 1000),
            ("line.home.seek", Some(line.home.seek), 10, 5000),
            ("line.home.locate", Some(line.home.locate), 1, 1000),
            (
                "line.home.pull_off_um",
                Some(line.home.pull_off_um),
                100,
                20_000,
            ),
        ];
        for (field, value, least, most) in ranges {
            if let Some(value) = value.filter(|value| !(least..=most).contains(value)) {
                let fault = FaultyLinkConfig::Range { value, least, most };
                return Err(LinkConfigError { field, fault });
            }
        }
        if let Err(fault) = contacts::check(&self.inputs, self.protocol == Protocol::Line) {
            return Err(LinkConfigError {
                field: "inputs",
                fault,
            });
        }
        for (field, place) in [("x.home_at", self.x.home_at), ("z.home_at", self.z.home_at)] {
            if !(-MAX_HOME_MM..=MAX_HOME_MM).contains(&place) {
                let fault = FaultyLinkConfig::Place;
                return Err(LinkConfigError { field, fault });
            }
        }
        match self.protocol {
            // Such a board has its pins.
            Protocol::Line => Ok(()),
            Protocol::StepQueue => self.check_pins(),
        }
    }

    fn check_pins(&self) -> Result<(), LinkConfigError> {
        let (x, z, io) = (&self.x, &self.z, &self.io);
        let needed = [
            ("x.step", &x.step),
            ("x.dir", &x.dir),
            ("z.step", &z.step),
            ("z.dir", &z.dir),
            ("io.enable", &io.enable),
        ];
        let missing = needed
            .iter()
            .find(|(_, pin)| PinName::read(pin).name.is_empty());
        if let Some((field, _)) = missing {
            let fault = FaultyLinkConfig::Missing;
            return Err(LinkConfigError { field, fault });
        }
        let switched = [
            ("io.spindle_cw", &io.spindle_cw),
            ("io.spindle_ccw", &io.spindle_ccw),
            ("io.spindle_pwm", &io.spindle_pwm),
            ("io.coolant", &io.coolant),
        ];
        let read = [
            ("x.limit", &x.limit),
            ("z.limit", &z.limit),
            ("x.dec", &x.dec),
            ("z.dec", &z.dec),
            ("x.zero", &x.zero),
            ("z.zero", &z.zero),
            ("io.estop", &io.estop),
            ("io.drive_alarm", &io.drive_alarm),
            ("io.index", &io.index),
        ];
        let contacts = self.inputs.values().map(|pin| ("inputs", pin));
        let named =
            |(field, pin): (&'static str, &'_ String)| (field, PinName::read(pin).name.to_owned());
        // Two inputs may be one switch; an output is one thing only.
        let outputs = needed.into_iter().chain(switched);
        let mut known: Vec<_> = read.into_iter().chain(contacts).map(named).collect();
        for (field, pin) in outputs {
            let (_, name) = named((field, pin));
            if name.is_empty() {
                continue;
            }
            if PinName::read(pin).pull_up {
                let fault = FaultyLinkConfig::OutputPullUp;
                return Err(LinkConfigError { field, fault });
            }
            if let Some((other, _)) = known.iter().find(|(_, pin)| *pin == name) {
                let fault = FaultyLinkConfig::Twice(other);
                return Err(LinkConfigError { field, fault });
            }
            known.push((field, name));
        }
        if PinName::read(&io.index).inverted {
            let fault = FaultyLinkConfig::IndexTurnedOver;
            return Err(LinkConfigError {
                field: "io.index",
                fault,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_name_their_field() {
        let config = LinkConfig {
            lookahead_ms: Some(20),
            ..LinkConfig::default()
        };
        let error = config.check().unwrap_err();
        assert_eq!(
            error.to_string(),
            "link.lookahead_ms: 20 is not from 50 to 400"
        );
    }

    fn refused(text: &str) -> String {
        let config: LinkConfig = ron::from_str(text).unwrap();
        config.check().unwrap_err().to_string()
    }

    #[test]
    fn a_return_ends_at_a_place() {
        for text in ["NaN", "inf", "1e300", "-10000.0"] {
            assert_eq!(
                refused(&format!("(z: (home_at: {text}))")),
                "link.z.home_at: must be from -9999.999 to 9999.999"
            );
        }
    }

    #[test]
    fn an_output_has_a_pin_of_its_own_and_signs_have_a_meaning() {
        let with = |x: &str, io: &str| {
            format!(
                r#"(protocol: StepQueue, x: (step: "PA0", dir: "PA1", {x}),
                z: (step: "PA2", dir: "!PA3"), io: (enable: "!PL0", {io}))"#
            )
        };
        for (x, io, text) in [
            (
                "",
                r#"coolant: "!PA0""#,
                "io.coolant: is the pin of link.x.step, too",
            ),
            (
                r#"limit: "^PA3""#,
                "",
                "z.dir: is the pin of link.x.limit, too",
            ),
            (
                "",
                r#"spindle_cw: "^PB4""#,
                "io.spindle_cw: an output has no pull-up (^)",
            ),
            (
                "",
                r#"index: "^!PC3""#,
                "io.index: the index counts both edges: ! has no meaning",
            ),
        ] {
            assert_eq!(refused(&with(x, io)), format!("link.{text}"));
        }
        // One switch may do for both axes.
        let shared = r#"limit: "^PC0", dec: "^PC0""#;
        let config: LinkConfig = ron::from_str(&with(shared, r#"index: "^PC3""#)).unwrap();
        assert_eq!(config.check(), Ok(()));
    }

    #[test]
    fn a_missing_pin_is_named() {
        let text = r#"(protocol: StepQueue, x: (step: "PA0", dir: "PA1"), z: (step: "PA2"))"#;
        let config: LinkConfig = ron::from_str(text).unwrap();
        assert_eq!(
            config.check().unwrap_err().to_string(),
            "link.z.dir: must name a pin of the board"
        );
        assert!(ron::from_str::<LinkConfig>("(io: (enabel: \"PL0\"))").is_err());
    }
}
