//! The result of a program as one JSON object, and in words.
//!
//! With a language all texts are in it. Without one the texts are English, except for the
//! alarm texts of the screen, which are Chinese.

pub mod annotations;
mod break_report;
pub mod lint_levels;
mod load_report;
mod part_report;
mod program_check;
mod report_text;
mod run_end;
mod time_report;
mod tool_life_report;

use std::collections::BTreeMap;

use gsk_core::alarm::{Alarm, AlarmClass};
use gsk_core::command::ProgramId;
use gsk_core::interpreter::ModalState;
use gsk_core::memory::ControlParameters;
use gsk_core::model::ProgramNaming;
use gsk_core::preview::{Caution, Lint};
use gsk_core::program::ProgramMemory;
use gsk_core::units::Point;
use gsk_messages::{Language, Message};
use serde::{Serialize, Serializer};

pub use break_report::BreakReport;
pub use load_report::{BlockLoadReport, LoadReport};
pub use part_report::{CollisionReport, PartReport, feature_message};
pub use program_check::check_program;
pub use run_end::RunEnd;
pub use time_report::{TimeReport, ToolTimeReport};
pub use tool_life_report::ToolLifeLimit;

use self::lint_levels::{LintLevel, LintLevels};
use crate::move_output::diameter_z;
use crate::text_format::shorten_line;

/// An alarm as a report contains it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlarmReport {
    /// Class of the alarm: PS, SYS, OT, ESTOP, SERVO, LINK or PLC.
    pub class: &'static str,
    /// Number of the alarm in the class.
    pub number: u16,
    /// Class and number as the control writes them: `P/S 010`, on the NC-B08 `E010`. Not part
    /// of the JSON.
    #[serde(skip)]
    pub shown: String,
    /// The alarm text as on the screen, or its meaning in English.
    pub text: String,
    /// Line of the block that raised the alarm, from 1; `None` if the alarm has no block.
    pub line: Option<u32>,
    /// Column of the fault in the line, in characters from 1; `None` if it is unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
    /// Sequence number of the block; `None` without an N word. Not part of the JSON.
    #[serde(skip)]
    pub sequence: Option<u32>,
    /// The program that contains the block; `None` without a block. Not part of the JSON.
    #[serde(skip)]
    pub program: Option<ProgramId>,
    /// How the control model names programs. Not part of the JSON.
    #[serde(skip)]
    pub naming: ProgramNaming,
    /// The text of the block that raised the alarm; `None` without a block.
    pub block: Option<String>,
    /// Text that names the cause of the alarm more precisely; `None` without one.
    pub detail: Option<String>,
    /// The cause of the alarm, from the alarm table; `None` if the table has no cause.
    pub cause: Option<&'static str>,
    /// Text that explains how to remove the alarm: the parameter, the word or the key; `None`
    /// without one.
    pub way_out: Option<&'static str>,
}

/// A probable mistake that raises no alarm. The JSON contains only `sentence`.
#[derive(Clone, Debug, PartialEq)]
pub struct WarningReport {
    /// The kind of mistake.
    pub lint: Lint,
    /// Whether the caller has made this kind of mistake an error.
    pub is_denied: bool,
    /// The program that contains the block.
    pub program: ProgramId,
    /// Line of the block with the mistake in its program, from 1.
    pub line: u32,
    /// First and last column of the mistake, in characters from 1; `None` if unknown.
    pub columns: Option<(u32, u32)>,
    /// The message about the mistake, without its line.
    pub text: String,
    /// The message about the mistake, with its line.
    pub sentence: String,
}

impl WarningReport {
    /// Creates the warning for a probable mistake in a mill program.
    pub(crate) fn from_mill_caution(
        caution: &gsk_milling::MillCaution,
        language: Option<Language>,
    ) -> Self {
        Self {
            lint: caution.slip.lint(),
            is_denied: false,
            program: caution.source.program,
            line: caution.source.line,
            columns: None,
            text: message_text(&caution.slip.message(), language),
            sentence: message_text(&caution.sentence(), language),
        }
    }

    fn new(caution: &Caution, language: Option<Language>) -> Self {
        Self {
            lint: caution.kind.lint(),
            is_denied: false,
            program: caution.source.program,
            line: caution.source.line,
            columns: caution.columns(),
            text: message_text(&caution.kind.message(), language),
            sentence: message_text(&caution.message_with_line(), language),
        }
    }
}

impl Serialize for WarningReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.sentence)
    }
}

/// A position of the tool in a report. The JSON is a list of numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ReportPosition {
    /// Position of a lathe: X as a diameter and Z, mm.
    Lathe(f64, f64),
    /// Position of a mill: X, Y, Z and further axes.
    Mill(MillReportPosition),
}

/// A position of a mill: X, Y, Z, and the further axes (the fourth and fifth) of the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct MillReportPosition {
    /// X, Y and Z of the position, mm.
    pub basic: [f64; 3],
    /// Letter and value of each further axis: mm, or degrees for a rotary axis.
    pub further: Vec<(char, f64)>,
}

impl Serialize for MillReportPosition {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let further = self.further.iter().map(|(_, value)| *value);
        serializer.collect_seq(self.basic.into_iter().chain(further))
    }
}

impl From<(f64, f64)> for ReportPosition {
    fn from((x, z): (f64, f64)) -> Self {
        Self::Lathe(x, z)
    }
}

/// Positions at the end of the program; X of a lathe is a diameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FinalPositions {
    /// Final position in absolute coordinates.
    pub abs: ReportPosition,
    /// Final position in machine coordinates.
    pub machine: ReportPosition,
    /// Final position in relative coordinates; `None` for a mill.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rel: Option<ReportPosition>,
}

impl FinalPositions {
    /// Creates the final positions from points of the control, whose X is a radius.
    pub fn new(absolute: Point, machine: Point, relative: Point) -> Self {
        Self {
            abs: diameter_z(absolute).into(),
            machine: diameter_z(machine).into(),
            rel: Some(diameter_z(relative).into()),
        }
    }
}

/// The result of the commands `run` and `check`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramReport {
    /// How the control model names programs. Not part of the JSON.
    #[serde(skip)]
    pub naming: ProgramNaming,
    /// Name of the program file.
    pub file: String,
    /// The reason for which the program ended.
    pub end: RunEnd,
    /// The alarm, or the message of the ladder, that ended the program; `None` after any other
    /// end.
    pub alarm: Option<AlarmReport>,
    /// The reason why cycle start was refused, or the condition for which the program waited at the
    /// limit or at a stop; `None` after any other end.
    pub waits_for: Option<String>,
    /// Machine time of the program, s.
    pub time_s: f64,
    /// Part of the machine time with a cutting feed, s.
    pub cutting_s: f64,
    /// Number of blocks that were executed.
    pub blocks: u64,
    /// Number of moves that were executed.
    pub moves: u64,
    /// Number of parts that the program counted.
    pub parts: u32,
    /// Number of program stops that cycle start continued.
    pub stops: u32,
    /// Positions at the end of the program.
    #[serde(rename = "final")]
    pub position: FinalPositions,
    /// G codes in force at the end of the program.
    pub modal: Vec<String>,
    /// F word in force at the end: the feed in the unit of the G code in force.
    pub f: f64,
    /// Value of S at the end of the program: r/min, or m/min under G96.
    pub s: f64,
    /// Tool and offset in force at the end, as the digits of a T word.
    pub t: String,
    /// State of the spindle at the end of the program: cw, ccw or stop.
    pub spindle: &'static str,
    /// Whether the coolant is on at the end of the program.
    pub coolant: bool,
    /// Parameters that the program changed: key is the three-digit number, value the new
    /// value.
    pub parameters_changed: BTreeMap<String, i32>,
    /// Probable mistakes that raise no alarm.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<WarningReport>,
    /// The name of the kind of each warning, in the same order; empty from `run`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warning_kinds: Vec<&'static str>,
    /// The locations of `--break` and `--until` that the run reached, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub breaks: Vec<BreakReport>,
    /// Path lengths, bounds, tools and further alarms, which only the command `check` finds;
    /// `None` from `run`.
    #[serde(flatten)]
    pub path: Option<PathReport>,
    /// The machined part; `None` if the program did not run on a part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<PartReport>,
    /// The load of the cuts; `None` if it was not requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<LoadReport>,
}

/// Lengths, tools and bounds of the path, from `check_program`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PathReport {
    /// The alarms that the check found after the first alarm.
    pub more_alarms: Vec<AlarmReport>,
    /// Line after which the check for further alarms stopped, from 1; `None` if it reached the
    /// end.
    #[serde(rename = "unchecked_behind")]
    pub unchecked_after: Option<u32>,
    /// Path length of each kind of move, mm; the key names the kind.
    pub lengths: BTreeMap<&'static str, f64>,
    /// The programs that executed a block, in the order of first use; the checked one first.
    #[serde(skip)]
    pub programs: Vec<ProgramId>,
    /// The tools that the program selects, as digits of T words.
    pub tools: Vec<String>,
    /// Bounds of the path; `None` for a program without a path.
    #[serde(rename = "box")]
    pub bounds: Option<ReportBounds>,
    /// Machine time of the program, by kind of motion.
    pub times: TimeReport,
    /// Machine time of each tool, in the order of their use.
    pub tool_times: Vec<ToolTimeReport>,
}

/// Bounds of a path; X of a lathe counts as a diameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportBounds {
    /// Least and greatest X, mm.
    pub x: (f64, f64),
    /// Least and greatest Y, mm; `None` for a lathe.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<(f64, f64)>,
    /// Least and greatest Z, mm.
    pub z: (f64, f64),
    /// Least and greatest value of each further axis (the fourth and fifth) of a mill, by its
    /// letter.
    #[serde(flatten)]
    pub further: BTreeMap<&'static str, (f64, f64)>,
    /// Letters of the further axes whose values are in degrees.
    #[serde(skip)]
    pub turning: Vec<&'static str>,
}

/// Converts a message to text in `language`; in English for `None`.
pub fn message_text(message: &Message, language: Option<Language>) -> String {
    message.text(language.unwrap_or(Language::En))
}

/// Returns the short name of an alarm class, as in reports: `PS`, for example.
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
    /// Creates the report of an alarm, with the text of its block from `programs` and the
    /// texts in `language`.
    pub fn new(alarm: &Alarm, programs: &ProgramMemory, language: Option<Language>) -> Self {
        let block = alarm.source.and_then(|source| {
            programs
                .get(source.program)
                .map(|program| shorten_line(program.line(source.line).trim()).into_owned())
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
            column: own_column(alarm),
            sequence: alarm
                .source
                .and_then(|source| source.sequence.map(u32::from)),
            program: alarm.source.map(|source| source.program),
            naming: alarm.naming,
            block,
            detail: (alarm.further_detail())
                .map(|detail| detail.text(language.unwrap_or(Language::En))),
            cause: match language {
                Some(Language::Zh) => alarm.advice().map(|advice| advice.cause_zh),
                Some(Language::En) | None => alarm.row().map(|row| row.cause_en),
            },
            way_out: alarm.advice().map(|advice| match language {
                Some(Language::Zh) => advice.remedy_zh,
                Some(Language::En) | None => advice.remedy_en,
            }),
        }
    }
}

/// The column of an alarm in the line of its block; `None` if unknown. In the profile of a
/// cycle the column belongs to another line and is not used.
fn own_column(alarm: &Alarm) -> Option<u32> {
    let detail = alarm.detail.as_ref()?;
    let own = detail.id() == gsk_messages::Id::AtColumn;
    own.then(|| detail.plain_value("column")?.parse().ok())?
}

impl ProgramReport {
    /// Whether the program ended with an alarm, a refusal or another failure instead of normally.
    pub const fn has_failed(&self) -> bool {
        !self.end.is_expected_end()
    }

    /// Whether the part report lists a collision or a cut that has broken something.
    pub fn has_collision(&self) -> bool {
        let has_any = |part: &PartReport| !part.collisions.is_empty() || !part.overloads.is_empty();
        self.part.as_ref().is_some_and(has_any)
    }

    /// Removes the warnings of kinds that `levels` allows, and marks those of kinds that it
    /// denies.
    pub fn apply_levels(&mut self, levels: &LintLevels) {
        let allowed = |it: &WarningReport| levels.level(it.lint) == LintLevel::Allow;
        self.warnings.retain(|it| !allowed(it));
        for warning in &mut self.warnings {
            warning.is_denied = levels.level(warning.lint) == LintLevel::Deny;
        }
        self.warning_kinds = self.warnings.iter().map(|it| it.lint.id()).collect();
    }

    /// Whether the report has a warning that the caller has made an error.
    pub fn has_denied_warning(&self) -> bool {
        self.warnings.iter().any(|it| it.is_denied)
    }

    /// The report as one JSON object on a line.
    ///
    /// # Errors
    /// The report cannot be serialized.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string(self)? + "\n")
    }
}

/// Returns the names of the G codes in force, one of each group.
pub fn modal_codes(modal: &ModalState) -> Vec<String> {
    vec![
        format!("G{:02}", modal.motion.number()),
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

/// Returns the digits of the T word for a tool number and an offset number.
pub fn tool_word((tool, offset): (u8, u8)) -> String {
    format!("{tool:02}{offset:02}")
}

/// Returns the parameters that differ: the key is the three-digit number, the value that in
/// `after`.
pub fn changed_parameters(
    before: &ControlParameters,
    after: &ControlParameters,
) -> BTreeMap<String, i32> {
    (0..1000)
        .filter(|number| before.value(*number) != after.value(*number))
        .map(|number| (format!("{number:03}"), after.value(number)))
        .collect()
}
