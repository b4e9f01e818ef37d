//! Defines the expectations of lessons: ranges, offsets, parameters, programs, and the state of
//! a run.

use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::machine::LatheFault;
use gsk_core::operation::RunState;
use gsk_core::units::{Axis, parse_finite};
use gsk_messages::{Language, Message, say};

use super::{CoordinateSystem, ParseError};
use crate::emulator::{Emulator, fold_blanks};
use crate::face::{find_page, page_names};
use crate::keys::{self, Key};
use crate::pages::PageId;
use crate::screen::ROWS;

/// Greatest difference of two values that the display shows alike, mm or the value's own unit.
const TOLERANCE: f64 = 0.000_500_1;

/// The forms of `expect` in a script, for help and messages.
pub(super) const FORM: &str = "expect screen \"TEXT\" | page oft | key ESTOP down | at abs X 20..30 | offset 1 X -2.5 | \
     param 22 3800 | param 1.4 1 | program 1 \"G01 X20\" | selected 1 | tool 2 | tool 0202 | \
     spindle 500..600 | run run|hold|stop|reset | parts 1..9999 | power on | referenced X | fault NAME on";

/// A range of expected values, including both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueRange {
    from: f64,
    to: f64,
}

impl ValueRange {
    fn read(text: &str) -> Result<Self, ParseError> {
        let (from, to) = text.split_once("..").unwrap_or((text, text));
        let number = |text: &str| {
            let plain = text
                .bytes()
                .all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'-'));
            parse_finite(text).filter(|_| plain)
        };
        match (number(from), number(to)) {
            (Some(from), Some(to)) if from <= to => Ok(Self { from, to }),
            _ => Err(ParseError::NoRange(text.to_owned())),
        }
    }

    fn contains(self, value: f64) -> bool {
        (self.from - TOLERANCE..=self.to + TOLERANCE).contains(&value)
    }
}

/// A column of the offset page that a script expects a value in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffsetField {
    /// The X value of a tool offset as typed, mm.
    X,
    /// The Z value of a tool offset, mm.
    Z,
    /// The nose radius of a tool offset, mm.
    Radius,
    /// The imaginary tip number of a tool offset.
    Tip,
}

/// A state of control, panel or lathe that a lesson or script expects.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpectedState {
    /// A row of the LCD contains this text. Runs of blanks count as one.
    Screen(String),
    /// Expects that the LCD shows this page.
    Page(PageId),
    /// This key is down, or the emergency stop latched (`true`); or it is not (`false`).
    Key(Key, bool),
    /// The displayed coordinate of an axis is in this range, mm (X as displayed).
    At(CoordinateSystem, Axis, ValueRange),
    /// A column of the offset with this number is in this range, mm.
    Offset(u8, OffsetField, ValueRange),
    /// Expects that a parameter (number), or one of its bits (0 to 7), has this value.
    Parameter(u16, Option<u8>, i32),
    /// The memory has the program with this number. If a text is given, the program contains
    /// it without regard to blanks.
    Program(u16, Option<String>),
    /// Expects that the program with this number is selected.
    Selected(u16),
    /// The current tool is this one, and the offset in force is this one if given.
    Tool(u8, Option<u8>),
    /// The spindle speed is in this range, r/min, negative in reverse.
    Spindle(ValueRange),
    /// Expects that the program run is in this state.
    Run(RunState),
    /// Expects that the part counter is in this range.
    Parts(ValueRange),
    /// Expects that the power is on (`true`) or off (`false`).
    Power(bool),
    /// Expects that this axis has been referenced since power-on.
    Referenced(Axis),
    /// Expects that the lathe has this fault (`true`) or not (`false`).
    Fault(LatheFault, bool),
}

impl ExpectedState {
    /// Parses the words after `expect`. `None` if they do not begin an expected state; an
    /// error if the rest is invalid.
    pub(super) fn read(words: &[&str]) -> Option<Result<Self, ParseError>> {
        Some(match words {
            ["screen", text] => Ok(Self::Screen(fold_blanks(text))),
            ["page", name] => page(name).map(Self::Page),
            ["key", name, state @ ("down" | "up")] => {
                key(name).map(|key| Self::Key(key, *state == "down"))
            }
            [
                "at",
                kind @ ("abs" | "machine" | "rel"),
                name @ ("X" | "Z"),
                range,
            ] => {
                let coordinates = match *kind {
                    "abs" => CoordinateSystem::Absolute,
                    "machine" => CoordinateSystem::Machine,
                    _ => CoordinateSystem::Relative,
                };
                ValueRange::read(range).map(|range| Self::At(coordinates, axis(name), range))
            }
            ["offset", number, column @ ("X" | "Z" | "R" | "T"), range] => {
                let column = match *column {
                    "X" => OffsetField::X,
                    "Z" => OffsetField::Z,
                    "R" => OffsetField::Radius,
                    _ => OffsetField::Tip,
                };
                whole(number).and_then(|number| {
                    ValueRange::read(range).map(|range| Self::Offset(number, column, range))
                })
            }
            ["param", name, value] => parameter(name, value),
            ["program", name] => number(name).map(|number| Self::Program(number, None)),
            ["program", name, text] => {
                number(name).map(|number| Self::Program(number, Some(tight(text))))
            }
            ["selected", name] => number(name).map(Self::Selected),
            ["tool", word] => tool(word),
            ["spindle", range] => ValueRange::read(range).map(Self::Spindle),
            ["run", "run"] => Ok(Self::Run(RunState::Run)),
            ["run", "hold"] => Ok(Self::Run(RunState::Hold)),
            ["run", "stop"] => Ok(Self::Run(RunState::Stop)),
            ["run", "reset"] => Ok(Self::Run(RunState::Reset)),
            ["parts", range] => ValueRange::read(range).map(Self::Parts),
            ["power", state @ ("on" | "off")] => Ok(Self::Power(*state == "on")),
            ["referenced", name @ ("X" | "Z")] => Ok(Self::Referenced(axis(name))),
            ["fault", name, state @ ("on" | "off")] => {
                parse_fault(name).map(|fault| Self::Fault(fault, *state == "on"))
            }
            [
                "screen" | "page" | "key" | "at" | "offset" | "param" | "program" | "selected"
                | "tool" | "spindle" | "run" | "parts" | "power" | "referenced" | "fault",
                ..,
            ] => Err(ParseError::Form {
                verb: "expect".to_owned(),
                form: FORM,
            }),
            _ => return None,
        })
    }

    /// Checks whether control, panel and lathe are in the expected state.
    ///
    /// # Errors
    ///
    /// Returns the message about the actual state if it differs.
    pub(super) fn check(&self, emulator: &Emulator) -> Result<(), Message> {
        let (cnc, lathe) = (emulator.cnc(), emulator.lathe());
        match self {
            Self::Screen(text) => {
                let screen = emulator.screen();
                let shown = (0..ROWS).any(|row| fold_blanks(&screen.row(row)).contains(text));
                verdict(shown, || say::script_state_is(format!("\n{screen}")))
            }
            Self::Page(page) => {
                let seen = emulator.panel().page();
                verdict(seen == *page, || {
                    say::script_page_is(seen.title().text(Language::Zh))
                })
            }
            Self::Key(key, down) => {
                let seen = emulator.panel().pressed().contains(key);
                verdict(seen == *down, || {
                    say::script_value_is(key.id(), if seen { "down" } else { "up" })
                })
            }
            Self::At(coordinates, axis, range) => {
                let (x, z) = coordinates.shown(emulator);
                let seen = match axis {
                    Axis::X => x,
                    Axis::Z => z,
                };
                let name = format!("{axis:?}");
                verdict(range.contains(seen), || {
                    say::script_value_is(name, format!("{seen:.3}"))
                })
            }
            Self::Offset(number, column, range) => check_offset(cnc, *number, *column, *range),
            Self::Parameter(number, bit, value) => check_parameter(cnc, *number, *bit, *value),
            Self::Program(number, text) => check_program(emulator, *number, text.as_deref()),
            Self::Selected(number) => {
                let seen = cnc.programs().selected();
                verdict(seen == Some(ProgramId::Stored(*number)), || {
                    say::script_selected_is(match seen {
                        Some(ProgramId::Stored(number)) => format!("O{number:04}"),
                        _ => "-".to_owned(),
                    })
                })
            }
            Self::Tool(tool, offset) => {
                let (station, active) = cnc.tool();
                let fits = station == *tool && offset.is_none_or(|offset| offset == active);
                verdict(fits, || {
                    say::script_tool_is(format!("T{station:02}{active:02}"))
                })
            }
            Self::Spindle(range) => {
                let seen = lathe.spindle_rpm();
                verdict(range.contains(seen), || {
                    say::script_value_is("S", format!("{seen:.0}"))
                })
            }
            Self::Run(state) => {
                let seen = cnc.run_state();
                verdict(seen == *state, || {
                    say::script_run_is(format!("{seen:?}").to_lowercase())
                })
            }
            Self::Parts(range) => {
                let seen = cnc.counters().parts;
                verdict(range.contains(seen.into()), || say::script_parts_are(seen))
            }
            Self::Power(on) => {
                let seen = emulator.panel().powered();
                verdict(seen == *on, || {
                    say::script_state_is(if seen { "on" } else { "off" })
                })
            }
            Self::Referenced(axis) => verdict(*cnc.referenced_axes().get(*axis), || {
                say::script_no_reference(format!("{axis:?}"))
            }),
            Self::Fault(fault, on) => {
                let seen = lathe.has_fault(*fault);
                verdict(seen == *on, || {
                    say::script_state_is(if seen { "on" } else { "off" })
                })
            }
        }
    }
}

fn check_offset(
    cnc: &Cnc,
    number: u8,
    column: OffsetField,
    range: ValueRange,
) -> Result<(), Message> {
    let row = cnc.offsets().get(number);
    let (name, seen, digits) = match column {
        OffsetField::X => ("X", row.x, 3),
        OffsetField::Z => ("Z", row.z, 3),
        OffsetField::Radius => ("R", row.r, 3),
        OffsetField::Tip => ("T", row.t.into(), 0),
    };
    verdict(range.contains(seen), || {
        say::script_value_is(format!("{number:03} {name}"), format!("{seen:.digits$}"))
    })
}

fn check_parameter(cnc: &Cnc, number: u16, bit: Option<u8>, value: i32) -> Result<(), Message> {
    let parameters = cnc.parameters();
    let (name, seen) = match bit {
        None => (format!("No.{number:03}"), parameters.value(number)),
        Some(bit) => (
            format!("No.{number:03}.{bit}"),
            i32::from(parameters.bit(number, bit)),
        ),
    };
    verdict(seen == value, || say::script_value_is(name, seen))
}

fn check_program(emulator: &Emulator, number: u16, text: Option<&str>) -> Result<(), Message> {
    let edited = emulator.panel().edited().filter(|(it, _)| *it == number);
    let stored = || {
        let programs = emulator.cnc().programs();
        programs.stored(number).cloned()
    };
    let program = edited.map(|(_, program)| program).or_else(stored);
    match (program, text) {
        (None, _) => Err(say::script_value_is(format!("O{number:04}"), "-")),
        (Some(_), None) => Ok(()),
        (Some(program), Some(text)) => {
            let seen = program.text();
            verdict(tight(seen).contains(text), || say::script_state_is(seen))
        }
    }
}

fn verdict(fits: bool, seen: impl FnOnce() -> Message) -> Result<(), Message> {
    if fits { Ok(()) } else { Err(seen()) }
}

/// Returns the text without blanks, in upper case.
fn tight(text: &str) -> String {
    let solid = text.chars().filter(|c| !c.is_whitespace());
    solid.collect::<String>().to_ascii_uppercase()
}

fn axis(name: &str) -> Axis {
    if name == "X" { Axis::X } else { Axis::Z }
}

fn whole<T: core::str::FromStr>(text: &str) -> Result<T, ParseError> {
    text.parse()
        .map_err(|_| ParseError::NotWhole(text.to_owned()))
}

/// Parses the number of a program: `1`, `0001`, `O0001`. Returns an error for another text.
fn number(text: &str) -> Result<u16, ParseError> {
    whole(text.strip_prefix('O').unwrap_or(text))
}

fn page(name: &str) -> Result<PageId, ParseError> {
    find_page(name).map(|row| row.page).ok_or_else(|| {
        let all: Vec<&str> = page_names().collect();
        ParseError::UnknownPage {
            name: name.to_owned(),
            all: all.join(" "),
        }
    })
}

fn key(name: &str) -> Result<Key, ParseError> {
    Key::from_id(name).ok_or_else(|| match keys::near_ids(name) {
        near if near.is_empty() => ParseError::UnknownKey(name.to_owned()),
        near => ParseError::NearKey {
            name: name.to_owned(),
            near: near.join(" "),
        },
    })
}

fn parameter(name: &str, value: &str) -> Result<ExpectedState, ParseError> {
    let (number, bit) = match name.split_once('.') {
        None => (name, None),
        Some((number, bit)) => {
            let bit = whole(bit).ok().filter(|bit| *bit < 8);
            let bit = bit.ok_or_else(|| ParseError::NotWhole(name.to_owned()))?;
            (number, Some(bit))
        }
    };
    Ok(ExpectedState::Parameter(whole(number)?, bit, whole(value)?))
}

/// Parses a tool word: `2` is the tool, `0202` tool and offset. Returns an error for another text.
fn tool(word: &str) -> Result<ExpectedState, ParseError> {
    match word.len() {
        4 if word.is_ascii() => Ok(ExpectedState::Tool(
            whole(&word[..2])?,
            Some(whole(&word[2..])?),
        )),
        _ => Ok(ExpectedState::Tool(whole(word)?, None)),
    }
}

/// Reads the name of a fault of the lathe. Returns an error that lists all names for another text.
pub(super) fn parse_fault(name: &str) -> Result<LatheFault, ParseError> {
    LatheFault::from_name(name).ok_or_else(|| {
        let names: Vec<&str> = LatheFault::ALL.iter().map(|(name, _)| *name).collect();
        ParseError::UnknownFault {
            name: name.to_owned(),
            all: names.join(" "),
        }
    })
}
