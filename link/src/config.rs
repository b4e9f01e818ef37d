//! Reads and checks the section `link` of the machine file (RON).

use core::time::Duration;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use thiserror::Error;

use super::pin::PinName;
use super::wires::{LinkAxis, LinkIo};
use super::{Input, contacts};

/// A pulse board and its wiring.
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
    /// The protocol of the board: lines of G code or timed steps.
    pub protocol: Protocol,
    /// Serial device; prefer its stable name under `/dev/serial/by-id/`.
    pub port: String,
    /// Baud rate, bit/s, 9600–4 000 000.
    pub baud: u32,
    /// Time by which the kernel may run ahead of the board, ms, 50–400; each feed hold is delayed
    /// by this time. `None`: 150 for a line board, 100 for timed steps.
    pub lookahead_ms: Option<u32>,
    /// Greatest speed of the slide at which the reference remains valid after a stop
    /// without deceleration, mm/min.
    pub flush_keep_speed: u32,
    /// Wiring and settings of the cross slide (X).
    pub x: LinkAxis,
    /// Wiring and settings of the carriage (Z).
    pub z: LinkAxis,
    /// Wiring of the other pins, for boards without fixed pins.
    pub io: LinkIo,
    /// Contacts X0.0 to X3.7 of the control that are wired to the board, with their pins:
    /// `{"X1.4": "^PD0"}`. A contact is closed while its pin is high, with `!` while it
    /// is low. For a line board the pin is a letter of its status report.
    pub inputs: BTreeMap<String, String>,
    /// Settings for line boards (Grbl, grblHAL, FluidNC).
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

/// The protocol that a board understands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Protocol {
    /// The board executes lines of G code: Grbl 1.1, grblHAL, FluidNC.
    #[default]
    Line,
    /// The board executes timed steps: Klipper firmware.
    StepQueue,
}

/// The homing parameters of a line board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HomeConfig {
    /// Speed of the first approach to the switch, mm/min, 10–5000 ($25).
    pub seek: u32,
    /// Speed of the second, slow approach, mm/min, 1–1000 ($24).
    pub locate: u32,
    /// Distance from the switch at the end of homing, µm, 100–20 000 ($27).
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

/// Settings for line boards only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LineConfig {
    /// Parameters of homing in the board.
    pub home: HomeConfig,
    /// Duration of a motion segment, ms, 5–40.
    pub period_ms: u32,
    /// Greatest pulse rate of each axis, 1/s, 1000–1 000 000.
    pub max_rate: u32,
    /// Length of a step pulse, µs, 3–255 ($0).
    pub step_pulse_us: u32,
    /// Whether limit switches open when operated ($5).
    pub invert_limits: bool,
    /// Whether the board inverts the step pins of both axes ($2).
    pub invert_step: bool,
    /// Whether the board inverts the enable output ($4): high enables the drives.
    pub invert_enable: bool,
    /// Debounce time of a switch during homing, ms, 1–1000 ($26).
    pub debounce_ms: u32,
    /// Whether the owner confirms that he has cut the proof thread and measured the correct lead.
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

/// An invalid field of the section `link`.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}", self.message())]
pub struct LinkConfigError {
    /// Path of the invalid field, without `link.`.
    pub field: &'static str,
    /// The error in the value of the field.
    pub fault: FaultyLinkConfig,
}

/// The error in a field of the section `link`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{}", self.message())]
pub enum FaultyLinkConfig {
    /// The number of the field is outside its range.
    Range {
        /// The invalid value of the field.
        value: u32,
        /// Least valid value of the field.
        least: u32,
        /// Greatest valid value of the field.
        most: u32,
    },
    /// The pin of the field is empty, but required.
    Missing,
    /// A key of `inputs` is not a contact X0.0 to X3.7.
    NoContact,
    /// The contact has a separate setting and must not be listed in `inputs`.
    HasSetting {
        /// Address of the contact, for instance `X0.5`.
        contact: &'static str,
        /// Name of the contact's signal, for instance `*ESP`.
        signal: &'static str,
        /// The path of the contact's setting, for instance `io.estop`.
        field: &'static str,
    },
    /// An entry of `inputs` names a contact but no pin.
    ContactWithoutPin,
    /// The pin of a contact of a line board is not a letter of its status report.
    NoLetter,
    /// The pin has a pull-up (`^`), but line boards have no such setting.
    LetterPullUp,
    /// The pin of an output has a pull-up (`^`).
    OutputPullUp,
    /// The pin of the one-turn signal is inverted (`!`), which is not possible.
    IndexInverted,
    /// The pin is also used by the field with this path.
    Twice(&'static str),
    /// The homing position is out of range or not a number.
    HomePosition,
}

impl FaultyLinkConfig {
    /// Returns the message that describes the error and gives the valid values.
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
            Self::IndexInverted => say::link_index_turned_over(),
            Self::Twice(other) => say::link_pin_twice(other),
            Self::HomePosition => say::link_place_wrong(MAX_HOME_MM),
        }
    }
}

impl LinkConfigError {
    /// Returns the message with the path of the field and its error.
    pub fn message(&self) -> Message {
        say::machine_field(format_args!("link.{}", self.field), self.fault.message())
    }
}

/// Greatest absolute value of the machine coordinate after homing, mm.
const MAX_HOME_MM: f64 = 9999.999;

impl LinkConfig {
    /// Returns the contacts of the control that are wired to the board.
    pub fn contacts(&self) -> impl Iterator<Item = Input> {
        contacts::wired(&self.inputs).map(|(contact, _)| contact)
    }

    /// Returns the time by which the kernel may run ahead of the board: `lookahead_ms` or its
    /// default.
    pub fn lookahead(&self) -> Duration {
        let default_ms = match self.protocol {
            Protocol::Line => 150,
            Protocol::StepQueue => 100,
        };
        Duration::from_millis(self.lookahead_ms.unwrap_or(default_ms).into())
    }

    /// Checks all ranges, the contacts and the required pins.
    ///
    /// # Errors
    /// The first invalid field.
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
            (
                "io.encoder_counts",
                Some(self.io.encoder_counts),
                100,
                1_000_000,
            ),
            ("io.wheel_counts", Some(self.io.wheel_counts), 1, 100),
            (
                "x.encoder.counts",
                Some(self.x.encoder.counts),
                1,
                1_000_000,
            ),
            (
                "z.encoder.counts",
                Some(self.z.encoder.counts),
                1,
                1_000_000,
            ),
            ("x.encoder.steps", Some(self.x.encoder.steps), 1, 1_000_000),
            ("z.encoder.steps", Some(self.z.encoder.steps), 1, 1_000_000),
            ("x.encoder.limit", Some(self.x.encoder.limit), 1, 100_000),
            ("z.encoder.limit", Some(self.z.encoder.limit), 1, 100_000),
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
        for (field, position) in [("x.home_at", self.x.home_at), ("z.home_at", self.z.home_at)] {
            if !(-MAX_HOME_MM..=MAX_HOME_MM).contains(&position) {
                let fault = FaultyLinkConfig::HomePosition;
                return Err(LinkConfigError { field, fault });
            }
        }
        match self.protocol {
            // A line board has fixed pins.
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
            ("io.encoder", &io.encoder),
            ("io.wheel", &io.wheel),
            ("x.encoder.pin", &x.encoder.pin),
            ("z.encoder.pin", &z.encoder.pin),
        ];
        let contacts = self.inputs.values().map(|pin| ("inputs", pin));
        let named =
            |(field, pin): (&'static str, &'_ String)| (field, PinName::read(pin).name.to_owned());
        // Inputs may share a pin, outputs may not.
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
            let fault = FaultyLinkConfig::IndexInverted;
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
    fn a_range_error_names_its_field() {
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
    fn an_invalid_homing_position_is_refused() {
        for text in ["NaN", "inf", "1e300", "-10000.0"] {
            assert_eq!(
                refused(&format!("(z: (home_at: {text}))")),
                "link.z.home_at: must be from -9999.999 to 9999.999"
            );
        }
    }

    #[test]
    fn shared_output_pins_and_signs_without_meaning_are_refused() {
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
                "io.coolant: is also the pin of link.x.step",
            ),
            (
                r#"limit: "^PA3""#,
                "",
                "z.dir: is also the pin of link.x.limit",
            ),
            (
                "",
                r#"spindle_cw: "^PB4""#,
                "io.spindle_cw: an output has no pull-up (^)",
            ),
            (
                "",
                r#"index: "^!PC3""#,
                "io.index: the index counts both edges: ! has no effect",
            ),
        ] {
            assert_eq!(refused(&with(x, io)), format!("link.{text}"));
        }
        // Inputs may share a pin.
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
