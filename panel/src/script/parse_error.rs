//! Defines the errors in a line of a script.

use gsk_core::plc::address::AddressError;
use gsk_messages::{Message, say};

/// The reason why a line of a script is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ParseError {
    /// `@` without a tick.
    NoTick(String),
    /// A text without its closing quotation mark.
    NotClosed,
    /// An action with wrong words.
    Form {
        /// The action.
        verb: String,
        /// Its form.
        form: &'static str,
    },
    /// An unknown action that resembles an existing one.
    NearAction {
        /// The word in the script.
        verb: String,
        /// The form of the similar action.
        form: &'static str,
    },
    /// An unknown action.
    UnknownAction {
        /// The word in the script.
        verb: String,
        /// All actions.
        all: String,
    },
    /// An unknown key.
    UnknownKey(String),
    /// An unknown key that resembles an existing one.
    NearKey {
        /// The word in the script.
        name: String,
        /// The similar keys.
        near: String,
    },
    /// A character without a key.
    NotTypable(char),
    /// An invalid number of graduations.
    NoGraduations {
        /// The word in the script.
        text: String,
        /// The form of `turn`.
        form: &'static str,
    },
    /// An invalid time.
    NoTime(String),
    /// Neither `on` nor `off`.
    NotOnOff(String),
    /// Neither 0 nor 1.
    NotZeroOne(String),
    /// An unknown fault.
    UnknownFault {
        /// The word in the script.
        name: String,
        /// All faults.
        all: String,
    },
    /// An invalid PLC address.
    Address(#[from] AddressError),
    /// Not an integer.
    NotWhole(String),
    /// An address that is not a machine input.
    NoInput(String),
    /// A time window that ends before it begins.
    Backward {
        /// Its begin, ms.
        earliest: u64,
        /// Its end, ms.
        latest: u64,
    },
    /// An invalid row of the LCD.
    NoRow(String),
    /// An invalid alarm number.
    NoAlarm(String),
    /// An unknown mode.
    UnknownMode {
        /// The word in the script.
        text: String,
        /// All modes.
        all: String,
    },
    /// An invalid coordinate.
    NoCoordinate(String),
    /// An invalid voltage.
    NoVoltage(String),
    /// An invalid number of pulses.
    NoPulses(String),
    /// An invalid range.
    NoRange(String),
    /// An unknown page.
    UnknownPage {
        /// The word in the script.
        name: String,
        /// All pages.
        all: String,
    },
    /// A key without a lamp.
    DarkKey(String),
    /// An unknown lamp.
    UnknownLamp {
        /// The word in the script.
        name: String,
        /// Lamps of the strip.
        strip: String,
    },
    /// An unknown lamp that resembles an existing one.
    NearLamp {
        /// The word in the script.
        name: String,
        /// The similar lamps.
        near: String,
    },
}

impl ParseError {
    /// Returns the message about the error with a correct form.
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
