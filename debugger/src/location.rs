//! Where a run stops: events and values, written as text, each with an optional condition.

use gsk_core::command::ProgramId;
use gsk_core::program::WatchFormula;
use gsk_messages::{Message, say};

use crate::source_files::ProgramSources;
use crate::watch::WatchTarget;

/// Relations between a value and a number, the longer signs first.
const RELATIONS: [(&str, ValueRelation); 6] = [
    ("<>", ValueRelation::NotEqual),
    ("<=", ValueRelation::LessOrEqual),
    (">=", ValueRelation::GreaterOrEqual),
    ("=", ValueRelation::Equal),
    ("<", ValueRelation::Less),
    (">", ValueRelation::Greater),
];

/// A relation between a value and a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueRelation {
    /// The value equals the number: `=`.
    Equal,
    /// The value differs from the number: `<>`.
    NotEqual,
    /// The value is less than the number: `<`.
    Less,
    /// The value is at most the number: `<=`.
    LessOrEqual,
    /// The value is greater than the number: `>`.
    Greater,
    /// The value is at least the number: `>=`.
    GreaterOrEqual,
}

impl ValueRelation {
    /// Whether the relation holds between two numbers.
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Equal => left == right,
            Self::NotEqual => left != right,
            Self::Less => left < right,
            Self::LessOrEqual => left <= right,
            Self::Greater => left > right,
            Self::GreaterOrEqual => left >= right,
        }
    }
}

/// The programs in which a block is looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProgramFilter {
    /// The breakpoint applies to every program.
    Any,
    /// The program with this O number.
    Number(u16),
    /// These programs, which come from one file.
    Listed(Vec<ProgramId>),
}

/// The kind of event that stops a run.
#[derive(Clone, Debug, PartialEq)]
pub enum BreakEvent {
    /// A block in this line begins.
    Line(ProgramFilter, u32),
    /// The block with this N word begins.
    Sequence(ProgramFilter, u32),
    /// The first block of the program with this O number begins.
    Program(u16),
    /// An alarm is raised: this one, or any.
    Alarm(Option<u16>),
    /// A message of the ladder appears: this one, or any.
    Message(Option<u16>),
    /// A tool collides with the part or the lathe.
    Collision,
    /// A pass of a cycle begins.
    Pass,
    /// This number of milliseconds since power-on is reached.
    Tick(u64),
    /// The value of this target changes.
    Change(WatchTarget),
    /// A comparison of a value with a number becomes true.
    Comparison(WatchTarget, ValueRelation, f64),
}

/// An event that stops a run, with its condition.
#[derive(Clone, Debug, PartialEq)]
pub struct BreakLocation {
    /// The text as it was written.
    pub text: String,
    /// The event that stops the run.
    pub event: BreakEvent,
    /// The run stops only if this comparison holds, or this formula is not 0.
    pub condition: Option<WatchFormula>,
}

impl BreakLocation {
    /// Parses a location: `12`, `sub.CNC:12`, `O12:3`, `N50`, `O12`, `alarm 11`, `Y1.2=1`,
    /// `X<20`, `tick 5000`, each with an optional `if #100 GT 5`.
    ///
    /// # Errors
    /// The message that names the text and the rule that it breaks.
    pub fn parse(text: &str, files: &ProgramSources) -> Result<Self, Message> {
        let (location, condition) = match split_condition(text) {
            Some((location, condition)) => (location, Some(parse_condition(condition)?)),
            None => (text, None),
        };
        Ok(Self {
            text: text.trim().to_owned(),
            event: parse_event(location.trim(), files)?,
            condition,
        })
    }

    /// Whether the location needs the collisions of the part.
    pub const fn needs_part(&self) -> bool {
        matches!(self.event, BreakEvent::Collision)
    }

    /// Whether the location needs the explanations of cycle passes.
    pub const fn needs_passes(&self) -> bool {
        matches!(self.event, BreakEvent::Pass)
    }
}

/// Parses a condition in the syntax of macro B: `#100 GT 5`.
///
/// # Errors
/// The message that names the text, the column and the rule.
pub fn parse_condition(text: &str) -> Result<WatchFormula, Message> {
    WatchFormula::parse(text)
        .map_err(|error| say::debug_formula_wrong(text.trim(), error.column, error.detail))
}

/// Splits `WHERE if COND`; `None` without a condition.
fn split_condition(text: &str) -> Option<(&str, &str)> {
    let lower = text.to_ascii_lowercase();
    let at = lower.find(" if ")?;
    Some((text.get(..at)?, text.get(at + 4..)?))
}

fn parse_event(text: &str, files: &ProgramSources) -> Result<BreakEvent, Message> {
    let mut words = text.split_whitespace();
    let first = words.next().unwrap_or_default().to_ascii_lowercase();
    let rest = words.next();
    let is_alone = words.next().is_none();
    match first.as_str() {
        "alarm" if is_alone => return Ok(BreakEvent::Alarm(parse_optional(text, rest)?)),
        "message" if is_alone => return Ok(BreakEvent::Message(parse_optional(text, rest)?)),
        "collision" if rest.is_none() => return Ok(BreakEvent::Collision),
        "pass" if rest.is_none() => return Ok(BreakEvent::Pass),
        "tick" if is_alone && rest.is_some_and(|rest| !rest.starts_with(['=', '<', '>'])) => {
            let tick = rest.and_then(|rest| rest.parse().ok());
            return tick
                .map(BreakEvent::Tick)
                .ok_or_else(|| say::debug_number_wrong(text));
        }
        _ => {}
    }
    if let Some(event) = parse_block(text, files) {
        return event;
    }
    parse_value(text)
}

fn parse_optional(text: &str, number: Option<&str>) -> Result<Option<u16>, Message> {
    let parsed = number.map(str::parse).transpose();
    parsed.map_err(|_| say::debug_number_wrong(text))
}

/// Parses a line, an N word or a program; `None` for another form.
fn parse_block(text: &str, files: &ProgramSources) -> Option<Result<BreakEvent, Message>> {
    if let Some(number) = parse_word(text, 'O') {
        return Some(Ok(BreakEvent::Program(number)));
    }
    let (filter, block) = match text.rsplit_once(':') {
        None => (main_file(files), text),
        Some((program, block)) => match parse_filter(program, files) {
            Ok(filter) => (filter, block),
            Err(message) => return Some(Err(message)),
        },
    };
    if let Some(number) = parse_word(block, 'N') {
        return Some(Ok(BreakEvent::Sequence(filter, number)));
    }
    let line = block.parse().ok().filter(|line| *line > 0);
    match line {
        Some(line) => Some(Ok(BreakEvent::Line(filter, line))),
        None => text.contains(':').then(|| Err(say::debug_line_wrong(text))),
    }
}

/// The programs of the main file; every program if no file is known.
fn main_file(files: &ProgramSources) -> ProgramFilter {
    let main = files.files().first();
    main.map_or(ProgramFilter::Any, |file| {
        ProgramFilter::Listed(file.programs.clone())
    })
}

fn parse_filter(text: &str, files: &ProgramSources) -> Result<ProgramFilter, Message> {
    if text.is_empty() {
        return Ok(main_file(files));
    }
    if let Some(file) = files.find(text) {
        return Ok(ProgramFilter::Listed(file.programs.clone()));
    }
    if let Some(number) = parse_word(text, 'O') {
        return Ok(ProgramFilter::Number(number));
    }
    let known: Vec<&str> = files
        .files()
        .iter()
        .map(|file| file.path.as_str())
        .collect();
    Err(say::debug_file_unknown(text, known.join(", ")))
}

/// The number in a word such as `O12` or `N50`; `None` for another form.
fn parse_word<T: core::str::FromStr>(text: &str, letter: char) -> Option<T> {
    let rest = text.strip_prefix([letter, letter.to_ascii_lowercase()])?;
    rest.parse().ok()
}

fn parse_value(text: &str) -> Result<BreakEvent, Message> {
    let found = RELATIONS.iter().filter_map(|(sign, relation)| {
        let at = text.find(sign)?;
        Some((at, *sign, *relation))
    });
    // At one position the longer sign is first in the list.
    let Some((at, sign, relation)) = found.min_by_key(|(at, ..)| *at) else {
        let target = WatchTarget::parse(text);
        return target.map(BreakEvent::Change).map_err(|error| {
            let is_name = text.chars().all(char::is_alphabetic);
            if is_name {
                say::debug_location_unknown(text)
            } else {
                error
            }
        });
    };
    let (name, value) = (&text[..at], &text[at + sign.len()..]);
    let target = WatchTarget::parse(name)?;
    if target.is_text() {
        return Err(say::debug_text_compared(text, target.name()));
    }
    let value = value
        .trim()
        .parse()
        .ok()
        .filter(|value: &f64| value.is_finite());
    let value = value.ok_or_else(|| say::debug_number_wrong(text))?;
    Ok(BreakEvent::Comparison(target, relation, value))
}

#[cfg(test)]
mod tests {
    use gsk_messages::Language;

    use super::*;
    use crate::source_files::ProgramSource;

    fn files() -> ProgramSources {
        let file = |path: &str, programs: &[ProgramId]| ProgramSource {
            path: path.to_owned(),
            programs: programs.to_vec(),
        };
        ProgramSources::new(vec![
            file("a/shaft.CNC", &[ProgramId::External]),
            file("a/sub.CNC", &[ProgramId::Stored(12)]),
        ])
    }

    fn event(text: &str) -> BreakEvent {
        BreakLocation::parse(text, &files()).expect(text).event
    }

    #[test]
    fn each_form_is_read() {
        let main = || ProgramFilter::Listed(vec![ProgramId::External]);
        let sub = || ProgramFilter::Listed(vec![ProgramId::Stored(12)]);
        assert_eq!(event("12"), BreakEvent::Line(main(), 12));
        assert_eq!(event("sub.CNC:3"), BreakEvent::Line(sub(), 3));
        assert_eq!(
            event("O12:3"),
            BreakEvent::Line(ProgramFilter::Number(12), 3)
        );
        assert_eq!(event("n50"), BreakEvent::Sequence(main(), 50));
        assert_eq!(event("sub.CNC:N50"), BreakEvent::Sequence(sub(), 50));
        assert_eq!(event("O0012"), BreakEvent::Program(12));
        assert_eq!(event("alarm"), BreakEvent::Alarm(None));
        assert_eq!(event("alarm 11"), BreakEvent::Alarm(Some(11)));
        assert_eq!(event("message 1003"), BreakEvent::Message(Some(1003)));
        assert_eq!(event("collision"), BreakEvent::Collision);
        assert_eq!(event("tick 5000"), BreakEvent::Tick(5000));
        assert!(matches!(event("Y1.2"), BreakEvent::Change(_)));
        assert!(matches!(
            event("X <= 20.5"),
            BreakEvent::Comparison(_, ValueRelation::LessOrEqual, 20.5)
        ));
        let with_condition = BreakLocation::parse("N50 if #100 GT 5", &files()).expect("if");
        assert!(
            with_condition
                .condition
                .is_some_and(|it| it.is_comparison())
        );
    }

    #[test]
    fn wrong_texts_are_quoted_with_their_rule() {
        for (text, rule) in [
            (
                "other.CNC:3",
                "other.CNC is none of the program files: a/shaft.CNC, a/sub.CNC",
            ),
            ("sub.CNC:x", "sub.CNC:x: after the colon"),
            ("0", "0"),
            ("alarm x", "alarm x: the number"),
            ("X<wide", "X<wide: the number"),
            ("G=1", "G is a text"),
            ("whenever", "whenever is no location"),
            ("N50 if #100 > 5", "#100 > 5, column 6"),
        ] {
            let message = BreakLocation::parse(text, &files()).expect_err(text);
            let message = message.text(Language::En);
            assert!(message.contains(rule), "{text}: {message}");
        }
    }
}
