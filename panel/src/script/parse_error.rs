//! Defines the errors in a line of a script.

use gsk_core::plc::address::AddressError;
use gsk_messages::{Message, say};

/// The reason why a line of a script is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ParseError {
    /// The word after `@` is not a number of ticks; the value is the word.
    NoTick(String),
    /// A text has no closing quotation mark.
    NotClosed,
    /// The words after a known action do not have its form.
    Form {
        /// Name of the action in the line.
        verb: String,
        /// The form that the action requires.
        form: &'static str,
    },
    /// The action is unknown, but resembles an existing one.
    NearAction {
        /// The unknown word in the script.
        verb: String,
        /// The correct form of the similar action.
        form: &'static str,
    },
    /// The action is unknown and resembles no other.
    UnknownAction {
        /// The unknown word in the script.
        verb: String,
        /// The names of all actions.
        all: String,
    },
    /// This key is unknown and resembles no other.
    UnknownKey(String),
    /// The key is unknown, but resembles existing ones.
    NearKey {
        /// The unknown word in the script.
        name: String,
        /// The names of the similar keys.
        near: String,
    },
    /// The panel has no key for this character of the text.
    NotTypable(char),
    /// The word after `turn` is not a number of handwheel graduations.
    NoGraduations {
        /// The invalid word in the script.
        text: String,
        /// The correct form of `turn`.
        form: &'static str,
    },
    /// This word is not a time with a unit.
    NoTime(String),
    /// This word is neither `on` nor `off`.
    NotOnOff(String),
    /// This word is neither 0 nor 1.
    NotZeroOne(String),
    /// The lathe has no fault with this name.
    UnknownFault {
        /// The unknown name in the script.
        name: String,
        /// The names of all faults.
        all: String,
    },
    /// A PLC address is invalid, with the reason.
    Address(#[from] AddressError),
    /// This word is not an integer.
    NotWhole(String),
    /// This address is not a machine input.
    NoInput(String),
    /// The time window of a `wait` ends before it begins.
    Backward {
        /// Beginning of the time window, ms.
        earliest: u64,
        /// End of the time window, ms.
        latest: u64,
    },
    /// This word is not a row of the LCD.
    NoRow(String),
    /// This word is not an alarm number.
    NoAlarm(String),
    /// The control has no operating mode with this name.
    UnknownMode {
        /// The unknown name in the script.
        text: String,
        /// The names of all operating modes.
        all: String,
    },
    /// These words do not name a state that can be explained.
    NoSubject(String),
    /// This word is not a coordinate.
    NoCoordinate(String),
    /// This word is not a voltage.
    NoVoltage(String),
    /// This word is not a number of pulses.
    NoPulses(String),
    /// This word is not a value or a range `FROM..TO`.
    NoRange(String),
    /// The LCD has no page with this name.
    UnknownPage {
        /// The unknown name in the script.
        name: String,
        /// The names of all pages.
        all: String,
    },
    /// The key with this name has no lamp.
    DarkKey(String),
    /// No lamp has this name or a similar one.
    UnknownLamp {
        /// The unknown name in the script.
        name: String,
        /// The names of the lamps in the status strip.
        strip: String,
    },
    /// No lamp has this name, but existing ones resemble it.
    NearLamp {
        /// The unknown name in the script.
        name: String,
        /// The names of the similar lamps.
        near: String,
    },
}

impl ParseError {
    /// Returns the message that a script line is invalid: the wrong word and a correct form.
    pub fn message(&self) -> Message {
        match self {
            Self::NoTick(text) => say::script_no_tick(text),
            Self::NotClosed => say::script_not_closed(),
            Self::Form { verb, form } => say::script_form(verb, form),
            Self::NearAction { verb, form } => say::script_unknown_action_near(verb, form),
            Self::UnknownAction { verb, all } => say::script_unknown_action(verb, all),
            Self::UnknownKey(name) => say::script_key_unknown(name),
            Self::NearKey { name, near } => say::script_key_near(name, near),
            Self::NotTypable(character) => say::script_not_typable(character),
            Self::NoGraduations { text, form } => say::script_no_graduations(text, form),
            Self::NoTime(text) => say::script_no_time(text),
            Self::NotOnOff(text) => say::script_not_on_off(text),
            Self::NotZeroOne(text) => say::script_not_zero_one(text),
            Self::UnknownFault { name, all } => say::script_unknown_fault(name, all),
            Self::Address(error) => error.message(),
            Self::NotWhole(text) => say::script_not_whole(text),
            Self::NoInput(address) => say::script_no_input(address),
            Self::Backward { earliest, latest } => say::script_backward(earliest, latest),
            Self::NoRow(text) => say::script_no_row(text),
            Self::NoAlarm(text) => say::script_no_alarm_number(text),
            Self::UnknownMode { text, all } => say::script_mode_unknown(text, all),
            Self::NoSubject(text) => say::script_no_why(text),
            Self::NoCoordinate(text) => say::script_no_coordinate(text),
            Self::NoVoltage(text) => say::script_no_voltage(text),
            Self::NoPulses(text) => say::script_no_pulses(text),
            Self::NoRange(text) => say::script_no_range(text),
            Self::UnknownPage { name, all } => say::script_unknown_page(name, all),
            Self::DarkKey(key) => say::script_dark_key(key),
            Self::UnknownLamp { name, strip } => say::script_lamp_unknown(name, strip),
            Self::NearLamp { name, near } => say::script_lamp_near(name, near),
        }
    }
}
