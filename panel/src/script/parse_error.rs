//! What is wrong with a line of a script, and what would be right.

use gsk_core::plc::address::AddressError;

/// Why a line of a script cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParseError {
    /// `@` without a tick.
    #[error("\"@{0}\" is no tick: write @ and whole milliseconds, as in @12345 press CS")]
    NoTick(String),
    /// A text without its end.
    #[error("a quotation mark is not closed")]
    NotClosed,
    /// An action in another form.
    #[error("{verb} is written: {form}")]
    Form {
        /// The action.
        verb: String,
        /// Its form.
        form: &'static str,
    },
    /// An action that resembles one.
    #[error("unknown action \"{verb}\"; near: {form}")]
    NearAction {
        /// What was written.
        verb: String,
        /// The form of the one that is near.
        form: &'static str,
    },
    /// No action.
    #[error("unknown action \"{verb}\"; there are {all}")]
    UnknownAction {
        /// What was written.
        verb: String,
        /// What there is.
        all: String,
    },
    /// No key.
    #[error("unknown key \"{0}\"; \"gsk980td keys\" lists the names of all keys")]
    UnknownKey(String),
    /// A name that resembles that of a key.
    #[error("unknown key \"{name}\"; near: {near}")]
    NearKey {
        /// What was written.
        name: String,
        /// Keys.
        near: String,
    },
    /// A character without a key.
    #[error("'{0}' cannot be typed: the edit keyboard has letters, digits and signs of ASCII")]
    NotTypable(char),
    /// No number of graduations.
    #[error("\"{text}\" is no whole number; turn is written: {form}")]
    NoGraduations {
        /// What was written.
        text: String,
        /// The form of `turn`.
        form: &'static str,
    },
    /// No time.
    #[error(
        "\"{0}\" is no time: write a number with ms, s, m or min, up to 100 days, as in 500ms, 1.5s, 2min"
    )]
    NoTime(String),
    /// Neither on nor off.
    #[error("\"{0}\" should be on or off")]
    NotOnOff(String),
    /// Neither 0 nor 1.
    #[error("\"{0}\" should be 0 or 1")]
    NotZeroOne(String),
    /// No fault.
    #[error("unknown fault \"{name}\"; there are {all}")]
    UnknownFault {
        /// What was written.
        name: String,
        /// What there is.
        all: String,
    },
    /// No address of the PLC.
    #[error(transparent)]
    Address(#[from] AddressError),
    /// No whole number.
    #[error("\"{0}\" is no whole number")]
    NotWhole(String),
    /// An address that is no machine input.
    #[error("{0} is no machine input: those are X0.0 to X3.7")]
    NoInput(String),
    /// A window that ends before it begins.
    #[error("{earliest}ms..{latest}ms ends before it begins: the shorter time comes first")]
    Backward {
        /// Its begin, ms.
        earliest: u64,
        /// Its end, ms.
        latest: u64,
    },
    /// No row of the LCD.
    #[error("\"{0}\" is no row: they are 0 to 14")]
    NoRow(String),
    /// No alarm.
    #[error("\"{0}\" is no alarm number; write it as in 011, or none")]
    NoAlarm(String),
    /// No mode.
    #[error("unknown mode \"{text}\"; there are {all}")]
    UnknownMode {
        /// What was written.
        text: String,
        /// What there is.
        all: String,
    },
    /// No coordinate.
    #[error("\"{0}\" is no coordinate; write millimetres, as in -12.345")]
    NoCoordinate(String),
    /// No voltage.
    #[error("\"{0}\" is no voltage; write volts, as in 5.000")]
    NoVoltage(String),
    /// No number of pulses.
    #[error("\"{0}\" is no whole number of pulses")]
    NoPulses(String),
    /// A key without a lamp.
    #[error("the key {0} has no lamp")]
    DarkKey(String),
    /// No lamp.
    #[error("unknown lamp \"{name}\"; keys have lamps, and the strip {strip}")]
    UnknownLamp {
        /// What was written.
        name: String,
        /// Lamps of the strip.
        strip: String,
    },
    /// A name that resembles that of a lamp.
    #[error("unknown lamp \"{name}\"; near: {near}")]
    NearLamp {
        /// What was written.
        name: String,
        /// Lamps.
        near: String,
    },
}
