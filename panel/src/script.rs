//! Operator scripts: one line an action, for tests and instructors.
//!
//! [`Script::parse`] reads one, a [`Runner`] carries it out on an
//! [`Emulator`](crate::emulator::Emulator) and hands what needs files to its caller.

mod expect;
mod parse;
mod parse_error;
mod run;
mod state;

use gsk_core::machine::Fault;
use gsk_core::plc::address::BitAddress;
use gsk_messages::{Message, say};

pub use expect::{Coordinates, Expect, Unmet};
pub use parse_error::ParseError;
pub use run::{Effect, Failure, Progress, Runner, run};
pub use state::{Column, Range, State};

use crate::emulator::Condition;
use crate::keys::Key;

/// The actions with their forms: what help and error messages list.
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

/// A script that was read without errors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// Its lines with actions.
    pub lines: Vec<Line>,
}

/// One action.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Line of the file, from 1.
    pub number: u32,
    /// The text of the line.
    pub text: String,
    /// The tick at which it happens, counted from the start of the script.
    pub at: Option<u64>,
    /// What to do.
    pub action: Action,
}

/// What a line does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A key goes down, 100 ms, up, 100 ms; after `@tick` without the rest.
    Press(Key),
    /// A key is held for so many milliseconds.
    Hold(Key, u64),
    /// A key goes down.
    Down(Key),
    /// A key comes up.
    Up(Key),
    /// Characters, 100 ms each.
    Type(String),
    /// A program file into the program memory.
    Load(String),
    /// A file through the serial port.
    Receive(String),
    /// A partner that sends this file whenever a program is called for in DNC mode;
    /// `None`: it leaves.
    Dnc(Option<String>),
    /// Power off (`false`) or on.
    Power(bool),
    /// Breaks or mends something of the lathe.
    Fault(Fault, bool),
    /// Turns the handwheel by so many graduations in so many milliseconds; by
    /// itself two turns a second. After `@tick` without a time: at once.
    Turn(i32, Option<u64>),
    /// Lets time pass, milliseconds.
    Wait(u64),
    /// Waits for something, at least and at most so many milliseconds.
    WaitFor(Condition, u64, u64),
    /// Holds a machine input at a value.
    Set(BitAddress, bool),
    /// Gives a machine input back to its sensor.
    Free(BitAddress),
    /// Holds a bit of PLC memory against the ladder; `None` lets it go.
    Force(BitAddress, Option<bool>),
    /// Compares.
    Expect(Expect),
    /// Prints the LCD.
    Show,
    /// Stores a picture of the LCD or of the whole panel.
    Shot {
        /// Where to.
        path: String,
        /// The whole panel.
        panel: bool,
    },
}

/// Why a line cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct ScriptError {
    /// Line of the file, from 1.
    pub line: u32,
    /// What is wrong and what would be right.
    pub cause: ParseError,
}

impl ScriptError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        say::in_line(self.line, self.cause.message())
    }
}

impl Script {
    /// Reads a script.
    ///
    /// # Errors
    /// Every line that cannot be read, in order.
    pub fn parse(text: &str) -> Result<Self, Vec<ScriptError>> {
        parse::script(text)
    }
}

#[cfg(test)]
mod tests;
