//! What is wrong with a line of a script, and what would be right.

use gsk_core::plc::address::AddressError;
use gsk_messages::{Message, say};

/// Why a line of a script cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ParseError {
    /// `@` without a tick.
    NoTick(String),
    /// A text without its end.
    NotClosed,
    /// An action in another form.
    Form {
        /// The action.
        verb: String,
        /// Its form.
        form: &'static str,
    },
    /// An action that resembles one.
    NearAction {
        /// What was written.
        verb: String,
        /// The form of the one that is near.
        form: &'static str,
    },
    /// No action.
    UnknownAction {
        /// What was written.
        verb: String,
        /// What there is.
        all: String,
    },
    /// No key.
    UnknownKey(String),
    /// A name that resembles that of a key.
    NearKey {
        /// What was written.
        name: String,
        /// Keys.
        near: String,
    },
    /// A character without a key.
    NotTypable(char),
    /// No number of graduations.
    NoGraduations {
        /// What was written.
        text: String,
        /// The form of `turn`.
        form: &'static str,
    },
    /// No time.
    NoTime(String),
    /// Neither on nor off.
    NotOnOff(String),
    /// Neither 0 nor 1.
    NotZeroOne(String),
    /// No fault.
    UnknownFault {
        /// What was written.
        name: String,
        /// What there is.
        all: String,
    },
    /// No address of the PLC.
    Address(#[from] AddressError),
    /// No whole number.
    NotWhole(String),
    /// An address that is no machine input.
    NoInput(String),
    /// A window that ends before it begins.
    Backward {
        /// Its begin, ms.
        earliest: u64,
        /// Its end, ms.
        latest: u64,
    },
    /// No row of the LCD.
    NoRow(String),
    /// No alarm.
    NoAlarm(String),
    /// No mode.
    UnknownMode {
        /// What was written.
        text: String,
        /// What there is.
        all: String,
    },
    /// No coordinate.
    NoCoordinate(String),
    /// No voltage.
    NoVoltage(String),
    /// No number of pulses.
    NoPulses(String),
    /// No range.
    NoRange(String),
    /// No page.
    UnknownPage {
        /// What was written.
        name: String,
        /// What there is.
        all: String,
    },
    /// A key without a lamp.
    DarkKey(String),
    /// No lamp.
    UnknownLamp {
        /// What was written.
        name: String,
        /// Lamps of the strip.
        strip: String,
    },
    /// A name that resembles that of a lamp.
    NearLamp {
        /// What was written.
        name: String,
        /// Lamps.
        near: String,
    },
}

impl ParseError {
    /// What is wrong and what would be right.
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
