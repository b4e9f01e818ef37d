//! Defines operator scripts for tests and instructors. Each line is an action.
//!
//! [`Script::parse`] reads a script. A [`Runner`] runs it on an
//! [`Emulator`](crate::emulator::Emulator) and passes actions on files to its caller.

mod expect;
mod parse;
mod parse_error;
mod run;
mod state;

use gsk_core::machine::LatheFault;
use gsk_core::plc::address::BitAddress;
use gsk_messages::{Message, say};

pub use expect::{CoordinateSystem, Expectation, UnmetExpectation};
pub use parse_error::ParseError;
pub use run::{Effect, Failure, Runner, ScriptProgress, run};
pub use state::{ExpectedState, OffsetField, ValueRange};

use crate::emulator::WaitCondition;
use crate::keys::Key;

/// The actions with their forms, for help and error messages.
pub const FORMS: [(&str, &str); 20] = [
    ("press", "press KEY"),
    ("hold", "hold KEY 2s"),
    ("down", "down KEY"),
    ("up", "up KEY"),
    ("type", "type O0001"),
    ("load", "load FILE"),
    ("receive", "receive FILE"),
    ("dnc", "dnc FILE | dnc off"),
    ("power", "power off | power on"),
    ("fault", "fault NAME on | off"),
    ("turn", "turn 10 | turn 300 1s"),
    (
        "wait",
        "wait 500ms | wait idle 60s | wait alarm 5s | wait \"text on the LCD\" 5s | wait Y1.6 1 5s | \
         wait Y1.6 1 40ms..60ms",
    ),
    ("set", "set X0.5 0"),
    ("free", "free X0.5"),
    ("force", "force G46.7 1 | force G46.7 free"),
    (
        "expect",
        "expect row 3 \"U 16.000\" | abs X Z | machine X Z | rel U W | slides X Z | pulses X Z | svc 5.000 | \
         lamp KEY on | alarm 011 | alarm none | mode 自动方式 | Y0.3 1 | G43 133",
    ),
    ("expect", state::FORM),
    ("expect", "expect not …"),
    ("show", "show"),
    ("shot", "shot FILE.png [--panel]"),
];

/// A valid script.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// The lines with actions.
    pub lines: Vec<ScriptLine>,
}

/// A line of a script.
#[derive(Clone, Debug, PartialEq)]
pub struct ScriptLine {
    /// Line of the file, from 1.
    pub number: u32,
    /// The text of the line.
    pub text: String,
    /// The tick of the action, counted from the start of the script.
    pub at: Option<u64>,
    /// The action.
    pub action: ScriptAction,
}

/// The action of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum ScriptAction {
    /// Presses a key for 100 ms, then waits 100 ms. After `@tick` without the wait.
    Press(Key),
    /// Holds a key for a number of milliseconds.
    Hold(Key, u64),
    /// Presses a key.
    Down(Key),
    /// Releases a key.
    Up(Key),
    /// Types characters, 100 ms each.
    Type(String),
    /// Loads a program file into the program memory.
    Load(String),
    /// Receives a file through the serial port.
    Receive(String),
    /// Connects a partner that sends this file whenever DNC mode requests a program. `None`
    /// disconnects it.
    Dnc(Option<String>),
    /// Switches the power off (`false`) or on.
    Power(bool),
    /// Sets or clears a fault of the lathe.
    Fault(LatheFault, bool),
    /// Turns the handwheel by a number of graduations in a number of milliseconds, by default
    /// at two turns a second. After `@tick` the default is at once.
    Turn(i32, Option<u64>),
    /// Waits, milliseconds.
    Wait(u64),
    /// Waits for a condition with a least and a greatest time, milliseconds.
    WaitFor(WaitCondition, u64, u64),
    /// Holds a machine input at a value.
    Set(BitAddress, bool),
    /// Releases a machine input to its sensor.
    Free(BitAddress),
    /// Forces a bit of PLC memory against the ladder. `None` releases it.
    Force(BitAddress, Option<bool>),
    /// Checks an expectation.
    Expect(Expectation),
    /// Prints the LCD.
    Show,
    /// Saves a picture of the LCD or of the whole panel.
    Shot {
        /// Path of the picture.
        path: String,
        /// Whether it shows the whole panel.
        panel: bool,
    },
}

/// The reason why a line is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct ScriptError {
    /// Line of the file, from 1.
    pub line: u32,
    /// The error, with a correct form.
    pub cause: ParseError,
}

impl ScriptError {
    /// Returns the message with its line number.
    pub fn message(&self) -> Message {
        say::in_line(self.line, self.cause.message())
    }
}

impl Script {
    /// Parses a script.
    ///
    /// # Errors
    ///
    /// Returns an error for every invalid line, in order.
    pub fn parse(text: &str) -> Result<Self, Vec<ScriptError>> {
        parse::script(text)
    }
}

#[cfg(test)]
mod tests;
