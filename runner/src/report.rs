//! The result of a program as one JSON object, and in words.
//!
//! With a language all texts are in it. Without one the words are English, and the
//! texts of alarms those of the screen, which are Chinese.

pub mod annotations;
mod checked;
mod end;
mod part;
mod spent;
mod words;

use std::collections::BTreeMap;

use gsk_core::alarm::{Alarm, AlarmClass};
use gsk_core::command::ProgramId;
use gsk_core::interpreter::Modal;
use gsk_core::memory::Parameters;
use gsk_core::preview::Caution;
use gsk_core::program::ProgramMemory;
use gsk_core::units::Point;
use gsk_messages::{Language, Message};
use serde::{Serialize, Serializer};

pub use checked::check;
pub use end::End;
pub use part::{CollisionReport, PartReport, in_words};
pub use spent::{Seconds, ToolSeconds};

use crate::moves::diameter_z;
use crate::words::beginning;

/// An alarm in a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlarmReport {
    /// PS, SYS, OT, ESTOP, SERVO, LINK or PLC.
    pub class: &'static str,
    /// Number.
    pub number: u16,
    /// Class and number as the control writes them: `P/S 010`, on the NC-B08 `E010`; not
    /// part of the JSON.
    #[serde(skip)]
    pub shown: String,
    /// The text of the screen, or its meaning in English.
    pub text: String,
    /// Line of the block, from 1.
    pub line: Option<u32>,
    /// Column in the line, in characters from 1, where the text of the block is at fault.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
    /// Its sequence number; not part of the JSON.
    #[serde(skip)]
    pub sequence: Option<u32>,
    /// The program it stands in; not part of the JSON.
    #[serde(skip)]
    pub program: Option<ProgramId>,
    /// The block.
    pub block: Option<String>,
    /// The rule that was broken.
    pub detail: Option<String>,
    /// What raises it, where the table says so.
    pub cause: Option<&'static str>,
    /// What helps: the parameter, the word or the key.
    pub way_out: Option<&'static str>,
}

/// What is no alarm and yet likely a slip; in JSON its sentence.
#[derive(Clone, Debug, PartialEq)]
pub struct WarningReport {
    /// Its name: `spindle-stands`.
    pub rule: &'static str,
    /// The program it stands in.
    pub program: ProgramId,
    /// Line of its block, from 1.
    pub line: u32,
    /// First and last column of what it is about, in characters from 1.
    pub columns: Option<(u32, u32)>,
    /// In words.
    pub text: String,
    /// In words, with the line.
    pub sentence: String,
}

impl WarningReport {
    /// What a mill takes without an alarm.
    pub(crate) fn of_mill(caution: &gsk_milling::MillCaution, language: Option<Language>) -> Self {
        Self {
            rule: caution.slip.id(),
            program: caution.source.program,
            line: caution.source.line,
            columns: None,
            text: said(&caution.slip.message(), language),
            sentence: said(&caution.sentence(), language),
        }
    }

    fn new(caution: &Caution, language: Option<Language>) -> Self {
        Self {
            rule: caution.slip.id(),
            program: caution.source.program,
            line: caution.source.line,
            columns: caution.columns(),
            text: said(&caution.slip.message(), language),
            sentence: said(&caution.sentence(), language),
        }
    }
}

impl Serialize for WarningReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.sentence)
    }
}

/// A position: in JSON a list of its numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Place {
    /// X as a diameter, Z.
    Lathe(f64, f64),
    /// X, Y, Z and further axes.
    Mill(MillPlace),
}

/// A position of a mill: X, Y, Z, and the further axes that it has, with their letters.
#[derive(Clone, Debug, PartialEq)]
pub struct MillPlace {
    /// mm.
    pub basic: [f64; 3],
    /// mm, or degrees of an axis that turns.
    pub further: Vec<(char, f64)>,
}

impl Serialize for MillPlace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let further = self.further.iter().map(|(_, value)| *value);
        serializer.collect_seq(self.basic.into_iter().chain(further))
    }
}

impl From<(f64, f64)> for Place {
    fn from((x, z): (f64, f64)) -> Self {
        Self::Lathe(x, z)
    }
}

/// Positions at the end: X of a lathe as a diameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Final {
    /// Absolute coordinates.
    pub abs: Place,
    /// Machine coordinates.
    pub machine: Place,
    /// Relative coordinates; a mill has none here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rel: Option<Place>,
}

impl Final {
    /// From points as the control holds them.
    pub fn new(absolute: Point, machine: Point, relative: Point) -> Self {
        Self {
            abs: diameter_z(absolute).into(),
            machine: diameter_z(machine).into(),
            rel: Some(diameter_z(relative).into()),
        }
    }
}

/// The result of `run` and `check`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The file.
    pub file: String,
    /// How it ended.
    pub end: End,
    /// The alarm or the message of the ladder that ended it.
    pub alarm: Option<AlarmReport>,
    /// Why cycle start was refused, or what the program waited for at the limit or at a
    /// stop.
    pub waits_for: Option<String>,
    /// Machine time, s.
    pub time_s: f64,
    /// Of that, with a cutting feed, s.
    pub cutting_s: f64,
    /// Blocks executed.
    pub blocks: u64,
    /// Moves executed.
    pub moves: u64,
    /// Parts counted.
    pub parts: u32,
    /// M00 answered with cycle start.
    pub stops: u32,
    /// Where everything stands.
    #[serde(rename = "final")]
    pub position: Final,
    /// G codes in force.
    pub modal: Vec<String>,
    /// F word in force.
    pub f: f64,
    /// S word in force.
    pub s: f64,
    /// Tool and offset in force.
    pub t: String,
    /// cw, ccw or stop.
    pub spindle: &'static str,
    /// Whether the coolant runs.
    pub coolant: bool,
    /// Parameters that the program changed, with their values now.
    pub parameters_changed: BTreeMap<String, i32>,
    /// What is no alarm and yet likely a slip, with its line.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<WarningReport>,
    /// What `check` knows besides.
    #[serde(flatten)]
    pub path: Option<PathReport>,
    /// What became of the part, if it was carried out on one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<PartReport>,
}

/// Lengths, tools and the box around the path.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PathReport {
    /// Alarms behind the first one.
    pub more_alarms: Vec<AlarmReport>,
    /// What comes behind this line was not checked for further alarms.
    pub unchecked_behind: Option<u32>,
    /// Path length of each kind of move, mm.
    pub lengths: BTreeMap<&'static str, f64>,
    /// Tools called, as T words.
    pub tools: Vec<String>,
    /// Smallest and largest X (diameter) and Z of the path.
    #[serde(rename = "box")]
    pub bounds: Option<Bounds>,
    /// Where the machine time goes.
    pub times: Seconds,
    /// The same for each tool, in the order in which they work.
    pub tool_times: Vec<ToolSeconds>,
}

/// A box; X of a lathe as diameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// From, to.
    pub x: (f64, f64),
    /// From, to; of a mill.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<(f64, f64)>,
    /// From, to.
    pub z: (f64, f64),
    /// From, to, of the further axes of a mill by their letters.
    #[serde(flatten)]
    pub further: BTreeMap<&'static str, (f64, f64)>,
    /// Which of them count in degrees.
    #[serde(skip)]
    pub turning: Vec<&'static str>,
}

/// A message in the language that was chosen.
pub fn said(message: &Message, language: Option<Language>) -> String {
    message.text(language.unwrap_or(Language::En))
}

/// The short name of a class of alarms.
pub const fn class_name(class: AlarmClass) -> &'static str {
    match class {
        AlarmClass::Ps => "PS",
        AlarmClass::System => "SYS",
        AlarmClass::Overtravel => "OT",
        AlarmClass::EmergencyStop => "ESTOP",
        AlarmClass::Servo => "SERVO",
        AlarmClass::Link => "LINK",
        AlarmClass::Plc => "PLC",
    }
}

impl AlarmReport {
    /// An alarm with the block that raised it.
    pub fn new(alarm: &Alarm, programs: &ProgramMemory, language: Option<Language>) -> Self {
        let block = alarm.source.and_then(|source| {
            programs
                .get(source.program)
                .map(|program| beginning(program.line(source.line).trim()).into_owned())
        });
        Self {
            class: class_name(alarm.class()),
            number: alarm.number,
            shown: match (alarm.letter, class_name(alarm.class())) {
                (Some(_), "PS" | "SYS") => alarm.number_text(),
                (_, "PS") => format!("P/S {}", alarm.number_text()),
                (_, class) => format!("{class} {}", alarm.number_text()),
            },
            text: alarm.text(language.unwrap_or(Language::Zh)),
            line: alarm.source.map(|source| source.line),
            column: column_of(alarm),
            sequence: alarm
                .source
                .and_then(|source| source.sequence.map(u32::from)),
            program: alarm.source.map(|source| source.program),
            block,
            detail: (alarm.further_detail())
                .map(|detail| detail.text(language.unwrap_or(Language::En))),
            cause: match language {
                Some(Language::Zh) => alarm.advice().map(|advice| advice.cause_zh),
                Some(Language::En) | None => alarm.row().map(|row| row.cause_en),
            },
            way_out: alarm.advice().map(|advice| match language {
                Some(Language::Zh) => advice.way_out_zh,
                Some(Language::En) | None => advice.way_out_en,
            }),
        }
    }
}

/// The column of an alarm in its own line; in the profile of a cycle it is one of another
/// line.
fn column_of(alarm: &Alarm) -> Option<u32> {
    let detail = alarm.detail.as_ref()?;
    let own = detail.id() == gsk_messages::Id::AtColumn;
    own.then(|| detail.plain_value("column")?.parse().ok())?
}

impl Report {
    /// Whether the program did not come to its own end.
    pub const fn failed(&self) -> bool {
        !self.end.is_own()
    }

    /// Whether a tool hit something.
    pub fn collided(&self) -> bool {
        self.part
            .as_ref()
            .is_some_and(|part| !part.collisions.is_empty())
    }

    /// As one JSON object on a line of its own.
    ///
    /// # Errors
    /// It cannot be told as JSON.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string(self)? + "\n")
    }
}

/// The G codes in force, one of each group.
pub(crate) fn modal_codes(modal: &Modal) -> Vec<String> {
    vec![
        format!("G{:02}", modal.motion),
        if modal.surface_speed { "G96" } else { "G97" }.to_owned(),
        if modal.feed_per_revolution {
            "G99"
        } else {
            "G98"
        }
        .to_owned(),
        format!("G{:02}", modal.nose_compensation),
    ]
}

/// The T word of a tool and an offset.
pub(crate) fn tool_word((tool, offset): (u8, u8)) -> String {
    format!("{tool:02}{offset:02}")
}

/// The parameters that differ, by their three-digit numbers.
pub fn changed(before: &Parameters, after: &Parameters) -> BTreeMap<String, i32> {
    (0..1000)
        .filter(|number| before.value(*number) != after.value(*number))
        .map(|number| (format!("{number:03}"), after.value(number)))
        .collect()
}
