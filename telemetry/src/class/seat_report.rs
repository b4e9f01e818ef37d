//! The state of a seat.

use gsk_messages::{Language, Message};
use serde::{Deserialize, Serialize};

/// Longest text of a report, characters: what the network sends is not longer.
const MAX_TEXT: usize = 200;

/// A text in both languages.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct SeatText {
    /// English.
    pub en: String,
    /// Chinese.
    pub zh: String,
}

impl SeatText {
    /// A message in both languages.
    pub fn new(message: &Message) -> Self {
        Self {
            en: message.text(Language::En),
            zh: message.text(Language::Zh),
        }
    }

    /// The text in a language.
    pub fn text(&self, language: Language) -> &str {
        match language {
            Language::En => &self.en,
            Language::Zh => &self.zh,
        }
    }

    fn limit(&mut self) {
        limit_text(&mut self.en);
        limit_text(&mut self.zh);
    }
}

/// What has stopped a seat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeatTroubleKind {
    /// Emergency stop.
    Emergency,
    /// The tool has collided.
    Crash,
    /// Another alarm.
    Alarm,
}

/// What has stopped a seat, in words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SeatTrouble {
    /// What it is.
    pub kind: SeatTroubleKind,
    /// Alarm with its number, or what has collided.
    pub text: SeatText,
}

/// The lesson or exercise of a seat.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct SeatTask {
    /// Name of the lesson or exercise.
    pub id: String,
    /// Title; empty for a lesson, which has only its name.
    pub title: SeatText,
    /// Step of a lesson, from 1; `None` in an exercise.
    pub step: Option<usize>,
    /// Whole minutes until an exercise is handed in; `None` in a lesson.
    pub remaining_min: Option<u64>,
    /// Whether the exercise is part of an exam.
    pub is_exam: bool,
    /// Whether it was handed in.
    pub is_handed_in: bool,
}

/// The state of a seat.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct SeatReport {
    /// The name that the learner has entered.
    pub name: String,
    /// Whether the seat is connected; the last will says no.
    pub is_online: bool,
    /// Operating mode.
    pub mode: SeatText,
    /// Whether a program runs or is held.
    pub is_running: bool,
    /// Name of the selected program; `None` without one.
    pub program: Option<String>,
    /// Line in execution; `None` without one.
    pub line: Option<u32>,
    /// What has stopped the seat; `None` if nothing has.
    pub trouble: Option<SeatTrouble>,
    /// The lesson or exercise; `None` at the learner's own machine.
    pub task: Option<SeatTask>,
    /// Sum of the best points of all exercises.
    pub points: u32,
    /// Whether the learner asks for help.
    pub asks_help: bool,
    /// Whole minutes since the last key.
    pub idle_min: u32,
    /// Whether a board moves real slides: the seat refuses tasks and faults.
    pub has_board: bool,
    /// Whether the learner allows faults.
    pub allows_faults: bool,
}

impl SeatReport {
    /// Parses a report; `None` for malformed bytes. Long texts are cut, control characters
    /// removed.
    pub fn parse(payload: &[u8]) -> Option<Self> {
        let mut report: Self = serde_json::from_slice(payload).ok()?;
        limit_text(&mut report.name);
        report.mode.limit();
        if let Some(program) = &mut report.program {
            limit_text(program);
        }
        if let Some(trouble) = &mut report.trouble {
            trouble.text.limit();
        }
        if let Some(task) = &mut report.task {
            limit_text(&mut task.id);
            task.title.limit();
        }
        Some(report)
    }

    /// The report as JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

fn limit_text(text: &mut String) {
    if text.chars().any(char::is_control) || text.chars().nth(MAX_TEXT).is_some() {
        let kept = text.chars().filter(|it| !it.is_control());
        *text = kept.take(MAX_TEXT).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_survive_the_network_and_are_limited() {
        let report = SeatReport {
            name: "李 Ann".to_owned(),
            is_online: true,
            line: Some(7),
            task: Some(SeatTask {
                id: "first-steps".to_owned(),
                step: Some(2),
                ..SeatTask::default()
            }),
            ..SeatReport::default()
        };
        assert_eq!(SeatReport::parse(report.to_json().as_bytes()), Some(report));
        let long = SeatReport {
            name: "a\u{1b}[31m".repeat(500),
            ..SeatReport::default()
        };
        let read = SeatReport::parse(long.to_json().as_bytes()).expect("a report");
        assert!(read.name.chars().count() == MAX_TEXT && !read.name.contains('\u{1b}'));
        for malformed in [&b""[..], b"{\"points\":-1}", b"{\"name\":7}", b"\xff"] {
            assert_eq!(SeatReport::parse(malformed), None);
        }
        // A later version may add members.
        let read = SeatReport::parse(br#"{"name":"x","new":1}"#).expect("a report");
        assert_eq!(read.name, "x");
    }
}
