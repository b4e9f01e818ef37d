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
use crate::why::CauseSubject;

/// The names of the actions with their forms, for help and error messages.
pub const FORMS: [(&str, &str); 23] = [
    ("press", "press KEY"),
    ("hold", "hold KEY 2s"),
    ("down", "down KEY"),
    ("up", "up KEY"),
    ("type", "type O0001"),
    ("load", "load FILE"),
    ("receive", "receive FILE"),
    ("udisk", "udisk FILE | udisk off"),
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
    ("expect", "expect why axis Z \"feed override\""),
    ("expect", "expect not …"),
    ("show", "show"),
    ("shot", "shot FILE.png [--panel]"),
    (
        "why",
        "why bit Y0.3 | why lamp KEY | why key KEY | why axis X|Z | why alarm 207",
    ),
];

/// An operator script whose lines are valid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// The lines that contain an action, in order.
    pub lines: Vec<ScriptLine>,
}

/// A line of a script with its action.
#[derive(Clone, Debug, PartialEq)]
pub struct ScriptLine {
    /// Number of the line in the script file, from 1.
    pub number: u32,
    /// Text of the line without its comment.
    pub text: String,
    /// The tick (ms) at which the action starts, counted from the start of the script; `None`
    /// starts it after the line before.
    pub at: Option<u64>,
    /// The action that the line performs.
    pub action: ScriptAction,
}

/// The action that a line of a script performs.
#[derive(Clone, Debug, PartialEq)]
pub enum ScriptAction {
    /// Presses a key for 100 ms, then waits 100 ms. A line with `@tick` does not wait.
    Press(Key),
    /// Holds a key down for this number of milliseconds.
    Hold(Key, u64),
    /// Presses a key and keeps it down.
    Down(Key),
    /// Releases a key that is down.
    Up(Key),
    /// Types these characters, one each 100 ms.
    Type(String),
    /// Loads the program file with this path into the program memory.
    Load(String),
    /// Receives the file with this path through the serial port.
    Receive(String),
    /// Adds the file with this path to the plugged U disk, and plugs one if there is none. `None`
    /// pulls the U disk out.
    Udisk(Option<String>),
    /// Connects a partner that sends the file with this path whenever DNC mode requests a
    /// program. `None` disconnects the partner.
    Dnc(Option<String>),
    /// Switches the power on (`true`) or off (`false`).
    Power(bool),
    /// Sets (`true`) or clears (`false`) a fault of the lathe.
    Fault(LatheFault, bool),
    /// Turns the handwheel by a number of graduations in a number of milliseconds, by default
    /// at two turns a second. After `@tick` the default is at once.
    Turn(i32, Option<u64>),
    /// Waits for this number of milliseconds.
    Wait(u64),
    /// Waits for a condition. It must become true not earlier than the first and not later
    /// than the second time, milliseconds.
    WaitFor(WaitCondition, u64, u64),
    /// Forces a machine input to a value instead of its sensor's.
    Set(BitAddress, bool),
    /// Ends the forcing of a machine input, so that it has the value of its sensor.
    Free(BitAddress),
    /// Forces a bit of PLC memory to a value against the ladder. `None` releases the bit.
    Force(BitAddress, Option<bool>),
    /// Fails the script if an expectation is not met.
    Expect(Expectation),
    /// Prints the text of the LCD.
    Show,
    /// Prints the chain of causes of a state.
    Why(CauseSubject),
    /// Saves a picture of the LCD or of the whole panel to a file.
    Shot {
        /// Path of the picture file.
        path: String,
        /// Whether the picture shows the whole panel instead of the LCD.
        panel: bool,
    },
}

impl ScriptAction {
    /// Whether a hand at the panel does it: keys, handwheel, and waits between them.
    pub const fn is_by_hand(&self) -> bool {
        matches!(
            self,
            Self::Press(_)
                | Self::Hold(..)
                | Self::Down(_)
                | Self::Up(_)
                | Self::Type(_)
                | Self::Turn(..)
                | Self::Wait(_)
                | Self::WaitFor(..)
        )
    }
}

/// The reason why a line of a script is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct ScriptError {
    /// Number of the line in the script file, from 1.
    pub line: u32,
    /// The error in the line, with a correct form.
    pub cause: ParseError,
}

impl ScriptError {
    /// Returns the message that a script line is invalid, with its number and the reason.
    pub fn message(&self) -> Message {
        say::in_line(self.line, self.cause.message())
    }
}

impl Script {
    /// Parses the text of a script.
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
