//! Parses operator scripts.

use core::ops::RangeInclusive;

use gsk_core::operation::OperatingMode;
use gsk_core::plc::address::{Area, BitAddress, ByteAddress};
use gsk_core::units::parse_finite;

use super::state::{ExpectedState, parse_fault};
use super::{
    CoordinateSystem, Expectation, FORMS, ParseError, Script, ScriptAction, ScriptError, ScriptLine,
};
use crate::emulator::WaitCondition;
use crate::keys::{self, Key};
use crate::panel::is_typable;
use crate::screen::ROWS;
use crate::why::CauseSubject;

/// Time limit of a `wait` that does not give one, milliseconds.
const DEFAULT_LIMIT: u64 = 60_000;
/// Greatest time that a script may contain, milliseconds: a hundred days.
const LONGEST: f64 = 100.0 * 24.0 * 3600.0 * 1000.0;

pub(super) fn script(text: &str) -> Result<Script, Vec<ScriptError>> {
    let mut script = Script::default();
    let mut errors = Vec::new();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (number, text) in (1..).zip(text.lines()) {
        match line(number, text) {
            Ok(line) => script.lines.extend(line),
            Err(cause) => errors.push(ScriptError {
                line: number,
                cause,
            }),
        }
    }
    if errors.is_empty() {
        Ok(script)
    } else {
        Err(errors)
    }
}

/// A word of a script line; `quoted`: it was in quotation marks.
#[derive(Clone, Debug, PartialEq)]
struct Word<'a> {
    text: &'a str,
    quoted: bool,
}

fn line(number: u32, text: &str) -> Result<Option<ScriptLine>, ParseError> {
    let code = without_comment(text)?.trim();
    if code.is_empty() {
        return Ok(None);
    }
    let (at, rest) = match code.strip_prefix('@') {
        Some(rest) => {
            let (word, rest) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            let tick = word.parse();
            let tick = tick.map_err(|_| ParseError::NoTick(word.to_owned()))?;
            (Some(tick), rest.trim())
        }
        None => (None, code),
    };
    let (verb, rest) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
    let action = action(verb, rest.trim())?;
    Ok(Some(ScriptLine {
        number,
        text: code.to_owned(),
        at,
        action,
    }))
}

/// Returns the line up to a `#` that begins a word outside quotation marks.
fn without_comment(text: &str) -> Result<&str, ParseError> {
    let (mut quoted, mut blank) = (false, true);
    for (at, character) in text.char_indices() {
        match character {
            '"' => quoted = !quoted,
            '#' if blank && !quoted => return Ok(&text[..at]),
            _ => {}
        }
        blank = character.is_whitespace();
    }
    if quoted {
        return Err(ParseError::NotClosed);
    }
    Ok(text)
}

fn words(text: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let (text, quoted, after) = match rest.strip_prefix('"') {
            Some(inner) => {
                let (text, after) = inner.split_once('"').unwrap_or((inner, ""));
                (text, true, after)
            }
            None => {
                let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
                (&rest[..end], false, &rest[end..])
            }
        };
        words.push(Word { text, quoted });
        rest = after.trim_start();
    }
    words
}

/// Returns the correct form of an action, for messages; empty if the action is unknown.
fn form(verb: &str) -> &'static str {
    let found = FORMS.iter().find(|(name, _)| *name == verb);
    found.map_or("", |(_, form)| form)
}

fn wrong(verb: &str) -> ParseError {
    ParseError::Form {
        verb: verb.to_owned(),
        form: form(verb),
    }
}

fn action(verb: &str, rest: &str) -> Result<ScriptAction, ParseError> {
    let words = words(rest);
    let texts: Vec<&str> = words.iter().map(|word| word.text).collect();
    match (verb, texts.as_slice()) {
        ("press", [name]) => Ok(ScriptAction::Press(key(name)?)),
        ("hold", [name, time]) => Ok(ScriptAction::Hold(key(name)?, duration(time)?)),
        ("down", [name]) => Ok(ScriptAction::Down(key(name)?)),
        ("up", [name]) => Ok(ScriptAction::Up(key(name)?)),
        ("type", [_, ..]) => typed(rest, &words),
        ("load", [_, ..]) => Ok(ScriptAction::Load(path(rest, &words))),
        ("receive", [_, ..]) => Ok(ScriptAction::Receive(path(rest, &words))),
        ("udisk", ["off"]) => Ok(ScriptAction::Udisk(None)),
        ("udisk", [_, ..]) => Ok(ScriptAction::Udisk(Some(path(rest, &words)))),
        ("dnc", ["off"]) => Ok(ScriptAction::Dnc(None)),
        ("dnc", [_, ..]) => Ok(ScriptAction::Dnc(Some(path(rest, &words)))),
        ("power", ["off"]) => Ok(ScriptAction::Power(false)),
        ("power", ["on"]) => Ok(ScriptAction::Power(true)),
        ("fault", [name, state]) => Ok(ScriptAction::Fault(parse_fault(name)?, on_off(state)?)),
        ("turn", [count]) => Ok(ScriptAction::Turn(graduations(count)?, None)),
        ("turn", [count, time]) => Ok(ScriptAction::Turn(
            graduations(count)?,
            Some(duration(time)?),
        )),
        ("wait", [_, ..]) => wait(&words),
        ("set", [address, state]) => Ok(ScriptAction::Set(input(address)?, zero_one(state)?)),
        ("free", [address]) => Ok(ScriptAction::Free(input(address)?)),
        ("force", [address, "free"]) => Ok(ScriptAction::Force(bit(address)?, None)),
        ("force", [address, state]) => {
            Ok(ScriptAction::Force(bit(address)?, Some(zero_one(state)?)))
        }
        ("expect", [_, ..]) => expect(&texts).map(ScriptAction::Expect),
        ("why", [kind, name]) => Ok(ScriptAction::Why(subject(kind, name)?)),
        ("show", []) => Ok(ScriptAction::Show),
        ("shot", [path]) if *path != "--panel" => Ok(shot(path, false)),
        ("shot", [path, "--panel"] | ["--panel", path]) => Ok(shot(path, true)),
        _ if !form(verb).is_empty() => Err(wrong(verb)),
        _ => Err(unknown_verb(verb)),
    }
}

fn shot(path: &str, panel: bool) -> ScriptAction {
    ScriptAction::Shot {
        path: path.to_owned(),
        panel,
    }
}

/// Returns a file name in quotation marks, or else the rest of the line.
fn path(rest: &str, words: &[Word<'_>]) -> String {
    match words {
        [Word { text, quoted: true }] => (*text).to_owned(),
        _ => rest.to_owned(),
    }
}

fn unknown_verb(verb: &str) -> ParseError {
    let near = FORMS
        .iter()
        .map(|(name, _)| (keys::distance(&verb.to_lowercase(), name), *name))
        .filter(|(distance, _)| *distance <= 2)
        .min();
    let mut all: Vec<&str> = FORMS.iter().map(|(name, _)| *name).collect();
    all.dedup();
    let verb = verb.to_owned();
    match near {
        Some((_, name)) => ParseError::NearAction {
            verb,
            form: form(name),
        },
        None => ParseError::UnknownAction {
            verb,
            all: all.join(" "),
        },
    }
}

fn key(name: &str) -> Result<Key, ParseError> {
    if let Some(key) = Key::from_id(name) {
        return Ok(key);
    }
    let near = keys::near_ids(name);
    if near.is_empty() {
        return Err(ParseError::UnknownKey(name.to_owned()));
    }
    Err(ParseError::NearKey {
        name: name.to_owned(),
        near: near.join(" "),
    })
}

fn typed(rest: &str, words: &[Word<'_>]) -> Result<ScriptAction, ParseError> {
    let text = match words {
        [Word { text, quoted: true }] => *text,
        _ => rest,
    };
    if let Some(strange) = text.chars().find(|c| !is_typable(*c)) {
        return Err(ParseError::NotTypable(strange));
    }
    Ok(ScriptAction::Type(text.to_ascii_uppercase()))
}

fn graduations(text: &str) -> Result<i32, ParseError> {
    text.parse().map_err(|_| ParseError::NoGraduations {
        text: text.to_owned(),
        form: form("turn"),
    })
}

/// Parses a time (`500ms`, `2s`, `1.5s`, `10m`, `10min`) and returns it in milliseconds. Returns an
/// error for another text.
fn duration(text: &str) -> Result<u64, ParseError> {
    let end = text
        .find(|c: char| c.is_ascii_alphabetic())
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let factor = match unit {
        "ms" => 1.0,
        "s" => 1000.0,
        "m" | "min" => 60_000.0,
        _ => 0.0,
    };
    let plain = number.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    match parse_finite(number) {
        Some(value) if plain && factor > 0.0 && value * factor <= LONGEST => {
            Ok((value * factor).round() as u64)
        }
        _ => Err(ParseError::NoTime(text.to_owned())),
    }
}

fn on_off(text: &str) -> Result<bool, ParseError> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(ParseError::NotOnOff(text.to_owned())),
    }
}

fn zero_one(text: &str) -> Result<bool, ParseError> {
    match text {
        "1" => Ok(true),
        "0" => Ok(false),
        _ => Err(ParseError::NotZeroOne(text.to_owned())),
    }
}

fn bit(text: &str) -> Result<BitAddress, ParseError> {
    Ok(text.parse()?)
}

/// Parses the address of a byte or entry of PLC memory. Returns an error for another text.
fn byte(text: &str) -> Result<ByteAddress, ParseError> {
    Ok(text.parse()?)
}

fn whole_number(text: &str) -> Result<i32, ParseError> {
    text.parse()
        .map_err(|_| ParseError::NotWhole(text.to_owned()))
}

/// Parses the address of a machine input: X0.0 to X3.7, and X4.0 to X4.7 of models with more
/// inputs. Returns an error for another text.
fn input(text: &str) -> Result<BitAddress, ParseError> {
    let address = bit(text)?;
    if address.area == Area::X && address.byte <= 4 {
        return Ok(address);
    }
    Err(ParseError::NoInput(text.to_owned()))
}

/// Parses `wait Y1.6 1 5s`, or with a window of time `wait Y1.6 1 40ms..60ms`.
fn wait_for_bit(
    address: &str,
    state: &str,
    times: Option<&str>,
) -> Result<ScriptAction, ParseError> {
    let condition = WaitCondition::Bit(bit(address)?, zero_one(state)?);
    let (earliest, latest) = match times.map(|times| times.split_once("..").ok_or(times)) {
        None => (0, DEFAULT_LIMIT),
        Some(Err(limit)) => (0, duration(limit)?),
        Some(Ok((from, to))) => (duration(from)?, duration(to)?),
    };
    if earliest > latest {
        return Err(ParseError::Backward { earliest, latest });
    }
    Ok(ScriptAction::WaitFor(condition, earliest, latest))
}

fn wait(words: &[Word<'_>]) -> Result<ScriptAction, ParseError> {
    if let [address, state, times @ ..] = words
        && !address.quoted
        && address.text.contains('.')
        && address.text.starts_with(|c: char| c.is_ascii_uppercase())
        && times.len() <= 1
    {
        return wait_for_bit(
            address.text,
            state.text,
            times.first().map(|word| word.text),
        );
    }
    let (first, limit) = match words {
        [first] => (first, None),
        [first, limit] => (first, Some(duration(limit.text)?)),
        _ => return Err(wrong("wait")),
    };
    let condition = match first {
        Word { text, quoted: true } => WaitCondition::Text((*text).to_owned()),
        Word { text: "idle", .. } => WaitCondition::Stopped,
        Word { text: "alarm", .. } => WaitCondition::Alarm,
        Word { text, .. } if limit.is_none() => return duration(text).map(ScriptAction::Wait),
        _ => return Err(wrong("wait")),
    };
    Ok(ScriptAction::WaitFor(
        condition,
        0,
        limit.unwrap_or(DEFAULT_LIMIT),
    ))
}

impl Expectation {
    /// Parses the words after `expect` in a script line.
    ///
    /// # Errors
    ///
    /// Returns why the words are invalid, with a correct form.
    pub fn parse(text: &str) -> Result<Self, ParseError> {
        let code = without_comment(text)?;
        let words = words(code);
        let texts: Vec<&str> = words.iter().map(|word| word.text).collect();
        expect(&texts)
    }
}

fn expect(words: &[&str]) -> Result<Expectation, ParseError> {
    if let Some(state) = ExpectedState::read(words) {
        return state.map(Expectation::State);
    }
    Ok(match words {
        ["not", rest @ ..] if rest.first() != Some(&"not") => {
            Expectation::Not(Box::new(expect(rest)?))
        }
        ["row", row, text] => {
            let number = row.strip_prefix('R').unwrap_or(row);
            let row = number.parse().ok().filter(|row| *row < ROWS);
            let row = row.ok_or_else(|| ParseError::NoRow(number.to_owned()))?;
            Expectation::Row(row, (*text).to_owned())
        }
        [kind @ ("abs" | "machine" | "rel"), x, z] => {
            let coordinates = match *kind {
                "abs" => CoordinateSystem::Absolute,
                "machine" => CoordinateSystem::Machine,
                _ => CoordinateSystem::Relative,
            };
            Expectation::Position(coordinates, coordinate(x)?, coordinate(z)?)
        }
        ["slides", x, z] => Expectation::Slides(coordinate(x)?, coordinate(z)?),
        ["svc", volts] => Expectation::Volts(voltage(volts)?),
        ["pulses", x, z] => Expectation::Pulses(pulses(x)?, pulses(z)?),
        ["lamp", name, state] => {
            let lamp = keys::lamp_of(name).ok_or_else(|| no_lamp(name))?;
            Expectation::Lamp((*name).to_owned(), lamp, on_off(state)?)
        }
        ["why", kind, name, text] => Expectation::Cause(subject(kind, name)?, (*text).to_owned()),
        ["alarm", "none"] => Expectation::NoAlarm,
        ["alarm", number] => Expectation::Alarm(
            number
                .parse()
                .map_err(|_| ParseError::NoAlarm((*number).to_owned()))?,
        ),
        ["mode", text] => {
            let mode = OperatingMode::ALL.iter().find(|mode| mode.text() == *text);
            Expectation::Mode(*mode.ok_or_else(|| {
                let all: Vec<&str> = OperatingMode::ALL.iter().map(|mode| mode.text()).collect();
                ParseError::UnknownMode {
                    text: (*text).to_owned(),
                    all: all.join(" "),
                }
            })?)
        }
        [address, state] if address.starts_with(|c: char| c.is_ascii_uppercase()) => {
            if address.contains('.') {
                Expectation::Bit(bit(address)?, zero_one(state)?)
            } else {
                Expectation::Value(byte(address)?, whole_number(state)?)
            }
        }
        _ => return Err(wrong("expect")),
    })
}

fn subject(kind: &str, name: &str) -> Result<CauseSubject, ParseError> {
    CauseSubject::parse(kind, name).ok_or_else(|| ParseError::NoSubject(format!("{kind} {name}")))
}

fn coordinate(text: &str) -> Result<f64, ParseError> {
    let plain = text
        .bytes()
        .all(|b| b.is_ascii_digit() || matches!(b, b'.' | b'-'));
    match parse_finite(text) {
        Some(value) if plain => Ok(value),
        _ => Err(ParseError::NoCoordinate(text.to_owned())),
    }
}

fn voltage(text: &str) -> Result<f64, ParseError> {
    let number = text.strip_suffix('V').unwrap_or(text);
    coordinate(number).map_err(|_| ParseError::NoVoltage(text.to_owned()))
}

/// Parses a number of pulses, or a range `LOW..HIGH`. Returns an error for another text.
fn pulses(text: &str) -> Result<RangeInclusive<i64>, ParseError> {
    let (low, high) = text.split_once("..").unwrap_or((text, text));
    let number = |text: &str| {
        text.parse()
            .map_err(|_| ParseError::NoPulses(text.to_owned()))
    };
    Ok(number(low)?..=number(high)?)
}

fn no_lamp(name: &str) -> ParseError {
    if Key::from_id(name).is_some() {
        return ParseError::DarkKey(name.to_owned());
    }
    let strip: Vec<&str> = keys::STRIP.iter().map(|lamp| lamp.id).collect();
    let near = keys::near_ids(name);
    let name = name.to_owned();
    if near.is_empty() {
        ParseError::UnknownLamp {
            name,
            strip: strip.join(" "),
        }
    } else {
        ParseError::NearLamp {
            name,
            near: near.join(" "),
        }
    }
}
