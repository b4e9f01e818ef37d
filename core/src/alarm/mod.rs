//! Alarms: their numbers, the table of their texts, and the block that raised one.
//!
//! The table is `assets/tables/alarms.tsv` (manual, appendix 3). Pages, command line and
//! help read it through this module only.

pub mod groups;

use core::fmt;
use std::sync::LazyLock;

use gsk_messages::{HelpColumns, Language, Message, say};
use serde::{Deserialize, Serialize};

use crate::command::SourcePosition;
use crate::model::{ModelRecord, ProgramNaming};

/// Alarm numbers as constants, generated from the `id` column of the table.
pub use gsk_units::alarm as number;

const TABLE: &str = include_str!("../../../assets/tables/alarms.tsv");

/// The class of an alarm: it determines what raises the alarm, where it is shown and what it stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AlarmClass {
    /// Errors of program and operation: `P/S 000` to `P/S 199`, and `P/S 5nn` of G65 H99.
    Ps,
    /// Alarms raised by the control itself (020, 101).
    System,
    /// Alarms of the soft travel limits, 201–206.
    Overtravel,
    /// Alarm of the emergency stop or a travel limit switch, 207.
    EmergencyStop,
    /// Alarms raised by the drives, 211–252.
    Servo,
    /// Raised by the link to the pulse board, 601–699.
    Link,
    /// Messages of the machine's PLC ladder, from 1000.
    Plc,
}

/// One row of the alarm table: number, class and texts of an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlarmRow {
    /// The class; it decides the prefix on the screen and which stop the alarm causes.
    pub class: AlarmClass,
    /// Alarm number; for a range of alarms, its first number.
    pub number: u16,
    /// The last number of a range (500–599); otherwise equal to `number`.
    pub last: u16,
    /// Chinese text of the LCD; empty for user alarms, which show a number only.
    pub text_zh: &'static str,
    /// Meaning of the alarm in English.
    pub meaning_en: &'static str,
    /// Cause of the alarm, in English.
    pub cause_en: &'static str,
    /// Action that clears the alarm, in English.
    pub cleared_by_en: &'static str,
    /// Cause and remedy for the operator; `None` for alarms that hardly ever occur.
    pub advice: Option<Advice>,
    /// Help texts about the alarm in both languages.
    pub help: HelpColumns,
}

/// Help for the operator beside the text on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// Cause of the alarm, in Chinese.
    pub cause_zh: &'static str,
    /// Remedy of the operator, in Chinese.
    pub remedy_zh: &'static str,
    /// Remedy of the operator, in English.
    pub remedy_en: &'static str,
}

/// All rows of the alarm table, by ascending number.
pub fn rows() -> &'static [AlarmRow] {
    static ROWS: LazyLock<Vec<AlarmRow>> = LazyLock::new(|| {
        let mut rows: Vec<AlarmRow> = TABLE.lines().skip(1).filter_map(parse_row).collect();
        rows.sort_by_key(|row| row.number);
        rows
    });
    &ROWS
}

/// The table row of an alarm number; `None` if the manual does not list it.
pub fn row(number: u16) -> Option<&'static AlarmRow> {
    let table = rows();
    let after = table.partition_point(|row| row.number <= number);
    let row = table.get(after.checked_sub(1)?)?;
    (number <= row.last).then_some(row)
}

fn parse_row(line: &'static str) -> Option<AlarmRow> {
    let mut fields = line.split('\t');
    let class = match fields.next()? {
        "PS" => AlarmClass::Ps,
        "SYS" => AlarmClass::System,
        "OT" => AlarmClass::Overtravel,
        "ESTOP" => AlarmClass::EmergencyStop,
        "SERVO" => AlarmClass::Servo,
        "LINK" => AlarmClass::Link,
        "PLC" => AlarmClass::Plc,
        _ => return None,
    };
    let numbers = fields.next()?;
    let (first, last) = numbers.split_once("..").unwrap_or((numbers, numbers));
    let number = first.parse().ok()?;
    let _id = fields.next()?;
    let text = fields.next()?;
    Some(AlarmRow {
        class,
        number,
        last: last.parse().ok()?,
        text_zh: if shows_number_only(number) { "" } else { text },
        meaning_en: fields.next()?,
        cause_en: fields.next()?,
        cleared_by_en: fields.next()?,
        advice: parse_advice(&mut fields)?,
        help: HelpColumns::read(&mut fields)?,
    })
}

/// Parses the three columns of the advice. The outer `None` if one is missing, the inner if
/// the first of them is `-`.
fn parse_advice(fields: &mut core::str::Split<'static, char>) -> Option<Option<Advice>> {
    let [cause_zh, remedy_zh, remedy_en] = [fields.next()?, fields.next()?, fields.next()?];
    let advice = Advice {
        cause_zh,
        remedy_zh,
        remedy_en,
    };
    Some((cause_zh != "-").then_some(advice))
}

const fn shows_number_only(number: u16) -> bool {
    matches!(number, number::USER_ALARM..=number::USER_ALARM_LAST) || is_named_by_program(number)
}

/// Whether the alarm text comes from the program that raised the alarm (`#3000`).
const fn is_named_by_program(number: u16) -> bool {
    matches!(number, number::MACRO_ALARM..=number::MACRO_ALARM_LAST)
}

/// An alarm that has been raised, with the block that raised it and the reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Alarm {
    /// Number of the alarm in the manual's alarm list.
    pub number: u16,
    /// The block that raised the alarm; `None` if no block did.
    pub source: Option<SourcePosition>,
    /// The reason in one sentence, which names the position and the broken rule; `None`:
    /// the table text is all.
    pub detail: Option<Message>,
    /// Letter that the control model writes before the number (`E` on the NC-B08); `None`
    /// on other models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub letter: Option<char>,
    /// How the control model writes the names of programs.
    #[serde(default, skip_serializing_if = "ProgramNaming::is_letter")]
    pub naming: ProgramNaming,
}

impl Alarm {
    /// Creates an alarm without source block and reason.
    pub const fn new(number: u16) -> Self {
        Self {
            number,
            source: None,
            detail: None,
            letter: None,
            naming: ProgramNaming::Letter,
        }
    }

    /// Creates an alarm from a message of the ladder. A text that differs from the table's
    /// becomes the detail, and the alarm then has no table row.
    pub fn from_ladder_message(number: u16, text: &str) -> Self {
        let message = Self::new(number);
        if message.text(Language::Zh) == text {
            message
        } else {
            message.with_detail(say::as_written(text))
        }
    }

    /// Sets the source block, unless the alarm already has one.
    #[must_use]
    pub fn with_source(mut self, source: SourcePosition) -> Self {
        self.source.get_or_insert(source);
        self
    }

    /// Sets the letter that the control model writes before alarm numbers, and how it names
    /// programs.
    #[must_use]
    pub(crate) fn with_model(mut self, record: &ModelRecord) -> Self {
        self.letter = record.alarm_letter;
        self.naming = record.program_naming();
        self
    }

    /// The number as the control writes it: `010`, on the NC-B08 `E010`.
    pub fn number_text(&self) -> String {
        let letter = self.letter.map_or_else(String::new, String::from);
        format!("{letter}{:03}", self.number)
    }

    /// Sets the detail, which gives the reason of the alarm.
    #[must_use]
    pub fn with_detail(mut self, detail: impl Into<Message>) -> Self {
        self.detail = Some(detail.into());
        self
    }

    /// The reason of the alarm in one sentence: its detail, or a message with its number.
    pub fn reason(&self) -> Message {
        let detail = self.detail.clone();
        detail.unwrap_or_else(|| say::alarm_of_number(self.number))
    }

    /// The detail in a language; empty if the alarm has no detail.
    pub(crate) fn detail_text(&self, language: Language) -> String {
        let detail = self.detail.as_ref();
        detail.map_or_else(String::new, |detail| detail.text(language))
    }

    /// The detail in English; empty if the alarm has no detail.
    pub fn detail_en(&self) -> String {
        self.detail_text(Language::En)
    }

    /// The table row of this alarm. `None` if the manual does not list the number, or if
    /// the ladder sent a text that differs from the table's.
    pub fn row(&self) -> Option<&'static AlarmRow> {
        let has_ladder_text =
            |row: &&AlarmRow| row.class == AlarmClass::Plc && self.detail.is_some();
        row(self.number).filter(|row| !has_ladder_text(row))
    }

    /// The class of the alarm. Numbers outside the table take the class of their range.
    pub fn class(&self) -> AlarmClass {
        if let Some(row) = self.row() {
            return row.class;
        }
        match self.number {
            201..=206 => AlarmClass::Overtravel,
            207 => AlarmClass::EmergencyStop,
            208..=299 => AlarmClass::Servo,
            600..=699 => AlarmClass::Link,
            1000.. => AlarmClass::Plc,
            _ => AlarmClass::Ps,
        }
    }

    /// The alarm text: from the program that raised the alarm (`#3000`), otherwise the
    /// screen text in Chinese or the meaning in English. Empty if the alarm has no text.
    pub fn text(&self, language: Language) -> String {
        if let Some(detail) = self
            .detail
            .as_ref()
            .filter(|_| is_named_by_program(self.number))
        {
            return detail.text(language);
        }
        let text = self.row().map_or("", |row| match language {
            Language::Zh => row.text_zh,
            Language::En => row.meaning_en,
        });
        text.to_owned()
    }

    /// The detail, unless [`text`](Self::text) already shows it; `None` without one.
    pub fn further_detail(&self) -> Option<&Message> {
        let detail = self.detail.as_ref();
        detail.filter(|_| !is_named_by_program(self.number))
    }

    /// Cause and remedy from the table; `None` if the table has none.
    pub fn advice(&self) -> Option<&'static Advice> {
        self.row()?.advice.as_ref()
    }

    /// The line of the alarm page in Chinese: `P/S 011: …`, `207: …`, `P/S 515`.
    pub fn line_text(&self) -> String {
        self.format_line(&self.text(Language::Zh))
    }

    /// The line of the alarm page with the English text.
    pub fn line_text_en(&self) -> String {
        self.format_line(&self.text(Language::En))
    }

    fn format_line(&self, text: &str) -> String {
        let prefix = match self.class() {
            AlarmClass::Ps | AlarmClass::System if self.letter.is_none() => "P/S ",
            _ => "",
        };
        let colon = if text.is_empty() { "" } else { ": " };
        format!("{prefix}{}{colon}{text}", self.number_text())
    }
}

/// Writes the line of the alarm page with the reason. `{:#}` adds cause and remedy in both
/// languages.
impl fmt::Display for Alarm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.line_text())?;
        if let Some(detail) = self.further_detail() {
            write!(f, " ({detail})")?;
        }
        let Some(row) = self.row().filter(|_| f.alternate()) else {
            return Ok(());
        };
        if let Some(advice) = row.advice {
            write!(f, "\n原因: {}", advice.cause_zh)?;
            write!(f, "\n处理: {}", advice.remedy_zh)?;
        }
        write!(f, "\ncause: {}", row.cause_en)?;
        if let Some(advice) = row.advice {
            write!(f, "\nremedy: {}", advice.remedy_en)?;
        }
        write!(f, "\ncleared by: {}", row.cleared_by_en)
    }
}

impl core::error::Error for Alarm {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_table_is_a_row() {
        assert_eq!(rows().len(), TABLE.lines().count() - 1);
        for pair in rows().windows(2) {
            assert!(
                pair[0].last < pair[1].number,
                "{:?} and {:?}",
                pair[0],
                pair[1]
            );
        }
        for row in rows() {
            assert_eq!(row.text_zh.is_empty(), shows_number_only(row.number));
            for text in [row.meaning_en, row.cause_en, row.cleared_by_en] {
                assert!(!text.is_empty() && text == text.trim(), "{row:?}");
            }
        }
        for line in TABLE.lines() {
            assert_eq!(line.split('\t').count(), 15, "{line}");
        }
    }

    #[test]
    fn common_alarms_have_advice() {
        let numbers = [0, 2, 5, 6, 7, 18, 19, 23, 24, 25, 43, 207, 221, 222, 515];
        let ranges = [
            9..=16,
            29..=32,
            46..=68,
            72..=78,
            90..=128,
            201..=204,
            601..=622,
            1000..=1015,
        ];
        let mut advised_count = 0;
        for number in ranges.into_iter().flatten().chain(numbers) {
            let Some(row) = row(number) else { continue };
            let Some(advice) = row.advice else {
                panic!("{number} without advice");
            };
            advised_count += 1;
            for text in [advice.cause_zh, advice.remedy_zh, advice.remedy_en] {
                assert!(!text.is_empty() && text == text.trim(), "{row:?}");
            }
        }
        assert!(advised_count > 95, "{advised_count}");
        let alarm = Alarm::new(112).with_detail(say::as_written("H05 of 1 and 0"));
        assert_eq!(
            format!("{alarm:#}"),
            "P/S 112: 除零错误 (H05 of 1 and 0)\n\
             原因: G65 中除数为零(包括 tan 90°)\n\
             处理: 运算前先判断除数\n\
             cause: G65 divides by zero, tan 90 degrees included\n\
             remedy: test the divisor before dividing\n\
             cleared by: the cause is corrected, then RESET"
        );
        assert_eq!(Alarm::new(20).advice(), None);
    }

    #[test]
    fn lines_of_the_alarm_page() {
        assert_eq!(Alarm::new(13).line_text(), "P/S 013: 圆弧数据有错误!");
        assert_eq!(Alarm::new(207).line_text(), "207: 超程或急停开关报警");
        assert_eq!(Alarm::new(1000).line_text(), "1000: 换刀时间过长");
        assert_eq!(Alarm::new(515).line_text(), "P/S 515");
        assert_eq!(Alarm::new(515).class(), AlarmClass::Ps);
        assert_eq!(Alarm::new(3).line_text(), "P/S 003");
        assert_eq!(Alarm::new(101).class(), AlarmClass::System);
    }

    #[test]
    fn the_first_source_is_kept() {
        let source = |line| SourcePosition {
            program: crate::command::ProgramId::External,
            line,
            sequence: None,
        };
        let alarm = Alarm::new(11)
            .with_detail(say::as_written("no F"))
            .with_source(source(3))
            .with_source(source(9));
        assert_eq!(alarm.source, Some(source(3)));
        assert_eq!(
            alarm.to_string(),
            format!("{} (no F)", Alarm::new(11).line_text())
        );
    }
}
