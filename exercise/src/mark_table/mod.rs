//! Writes marks as text, CSV, JSON and HTML.

mod xapi;

use gsk_messages::{Language, Message, say};
use serde_json::{Value, json};

use crate::criterion::ExerciseCriterion;
use crate::drawing::escape_markup;
use crate::mark::ResultMark;
use crate::report::{CriterionVerdict, MarkEvidence};
use crate::task::ExerciseTask;
use xapi::statements;

/// The file format of a table of marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MarkFormat {
    /// Text with aligned columns.
    #[default]
    Text,
    /// Comma-separated values.
    Csv,
    /// JSON with every criterion of every result.
    Json,
    /// HTML page with every criterion of every result.
    Html,
    /// xAPI statements for a learning record store.
    Xapi,
}

/// The marks of several results, with their tasks and the language of the table.
#[derive(Clone, Copy, Debug)]
pub struct MarkTable<'a> {
    /// The marks, in the order of the table.
    pub marks: &'a [ResultMark],
    /// The tasks, from which the sentences about the criteria are taken.
    pub tasks: &'a [ExerciseTask],
    /// Language of the table.
    pub language: Language,
}

const COLUMNS: usize = 8;

impl MarkTable<'_> {
    /// Returns the table as text in a format.
    pub fn write(&self, format: MarkFormat) -> String {
        match format {
            MarkFormat::Text => self.text(),
            MarkFormat::Csv => self.csv(),
            MarkFormat::Json => format!("{:#}\n", self.json()),
            MarkFormat::Html => self.html(),
            MarkFormat::Xapi => {
                format!("{:#}\n", statements(self.marks, self.tasks, self.language))
            }
        }
    }

    fn say(&self, message: &Message) -> String {
        message.text(self.language)
    }

    fn headings(&self) -> [String; COLUMNS] {
        [
            say::exercise_column_file(),
            say::exercise_column_learner(),
            say::exercise_column_task(),
            say::exercise_column_points(),
            say::exercise_column_max(),
            say::exercise_column_time(),
            say::exercise_column_key(),
            say::exercise_column_state(),
        ]
        .map(|message| self.say(&message))
    }

    fn cells(&self, mark: &ResultMark) -> [String; COLUMNS] {
        let duration = mark.report.as_ref().map(|report| report.duration_ms);
        [
            mark.file.clone(),
            mark.learner.clone(),
            mark.task.clone(),
            mark.points().to_string(),
            mark.max_points().to_string(),
            duration.map_or_else(String::new, |ms| format!("{:.1}", seconds(ms))),
            mark.key.map_or_else(String::new, |key| key.to_string()),
            self.state(mark),
        ]
    }

    fn state(&self, mark: &ResultMark) -> String {
        let mut states: Vec<String> = mark.flags.iter().map(|flag| self.say(flag)).collect();
        if states.is_empty() {
            states.push(self.say(&say::exercise_state_valid()));
        }
        states.extend(mark.exam.map(|exam| self.say(&exam.message())));
        let refused = mark.report.as_ref().and_then(|it| it.refused.as_ref());
        states.extend(refused.map(|refused| self.say(&refused.message())));
        states.join("; ")
    }

    fn text(&self) -> String {
        let mut rows = vec![self.headings()];
        rows.extend(self.marks.iter().map(|mark| self.cells(mark)));
        let mut widths = [0; COLUMNS];
        for row in &rows {
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = cell_width(cell).max(*width);
            }
        }
        let mut out = String::new();
        for row in rows {
            let mut line = String::new();
            for (cell, width) in row.iter().zip(widths) {
                let blanks = " ".repeat(width - cell_width(cell) + 2);
                line.push_str(cell);
                line.push_str(&blanks);
            }
            out.push_str(line.trim_end());
            out.push('\n');
        }
        out
    }

    fn csv(&self) -> String {
        let mut rows = vec![self.headings()];
        rows.extend(self.marks.iter().map(|mark| self.cells(mark)));
        let lines = rows.iter().map(|row| {
            let cells: Vec<String> = row.iter().map(|cell| csv_cell(cell)).collect();
            cells.join(",") + "\r\n"
        });
        lines.collect()
    }

    fn json(&self) -> Value {
        let marks = self.marks.iter().map(|mark| {
            let flags: Vec<String> = mark.flags.iter().map(|flag| self.say(flag)).collect();
            let verdicts = mark.report.iter().flat_map(|report| &report.verdicts);
            let criteria: Vec<Value> = verdicts
                .map(|verdict| {
                    json!({
                        "id": verdict.id,
                        "points": verdict.points,
                        "max": verdict.max_points,
                        "met": verdict.is_met,
                        "sentence": self.sentence(mark, verdict),
                        "time_s": verdict.evidence.tick.map(seconds),
                        "block": verdict.evidence.block,
                        "measured": verdict.evidence.measured,
                        "found": verdict.evidence.found.as_ref().map(|it| self.say(it)),
                    })
                })
                .collect();
            let refused = mark.report.as_ref().and_then(|it| it.refused.as_ref());
            json!({
                "file": mark.file,
                "learner": mark.learner,
                "task": mark.task,
                "points": mark.points(),
                "max": mark.max_points(),
                "claimed": mark.claimed_points,
                "hint_cost": mark.hint_cost,
                "duration_s": mark.report.as_ref().map(|report| seconds(report.duration_ms)),
                "key": mark.key.map(|key| key.to_string()),
                "exam": mark.exam,
                "valid": mark.flags.is_empty(),
                "flags": flags,
                "refused": refused.map(|refused| refused.count),
                "criteria": criteria,
            })
        });
        Value::Array(marks.collect())
    }

    /// Returns the sentence of the task about the verdict on a criterion; `None` if the task is
    /// unknown.
    fn sentence(&self, mark: &ResultMark, verdict: &CriterionVerdict) -> Option<String> {
        let task = self.tasks.iter().find(|task| task.id == mark.task)?;
        let mut criteria = task.criteria.iter();
        let criterion = criteria.find(|criterion| criterion.id == verdict.id)?;
        Some(verdict_sentence(criterion, verdict, self.language))
    }

    fn html(&self) -> String {
        let title = self.say(&say::exercise_marks());
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
             <style>\nbody {{ font-family: sans-serif; margin: 2em; }}\n\
             table {{ border-collapse: collapse; }}\n\
             th, td {{ border: 1px solid #999; padding: 0.3em 0.6em; text-align: left; }}\n\
             .flagged {{ background: #fdd; }}\n.met::before {{ content: \"\\2713 \"; }}\n\
             .unmet::before {{ content: \"\\2717 \"; }}\n</style>\n</head>\n<body>\n<h1>{title}</h1>\n<table>\n<tr>",
            match self.language {
                Language::En => "en",
                Language::Zh => "zh",
            }
        );
        for heading in self.headings() {
            out.push_str(&format!("<th>{}</th>", escape_markup(&heading)));
        }
        out.push_str("</tr>\n");
        for mark in self.marks {
            let class = match mark.flags.is_empty() {
                true => "",
                false => " class=\"flagged\"",
            };
            out.push_str(&format!("<tr{class}>"));
            for cell in self.cells(mark) {
                out.push_str(&format!("<td>{}</td>", escape_markup(&cell)));
            }
            out.push_str("</tr>\n");
        }
        out.push_str("</table>\n");
        for mark in self.marks.iter().filter(|mark| mark.report.is_some()) {
            self.write_criteria(mark, &mut out);
        }
        out.push_str("</body>\n</html>\n");
        out
    }

    fn write_criteria(&self, mark: &ResultMark, out: &mut String) {
        let head = format!("{} · {} · {}", mark.learner, mark.task, mark.file);
        out.push_str(&format!("<h2>{}</h2>\n<ul>\n", escape_markup(&head)));
        for verdict in mark.report.iter().flat_map(|report| &report.verdicts) {
            let class = if verdict.is_met { "met" } else { "unmet" };
            let sentence = self.sentence(mark, verdict);
            let sentence = sentence.unwrap_or_else(|| verdict.id.clone());
            let line = format!(
                "{sentence} ({}/{}) {}",
                verdict.points,
                verdict.max_points,
                describe_evidence(&verdict.evidence, self.language)
            );
            let line = escape_markup(line.trim_end());
            out.push_str(&format!("<li class=\"{class}\">{line}</li>\n"));
        }
        out.push_str("</ul>\n");
    }
}

/// Returns the sentence of the task about a criterion; for a learner who did nothing no claim about
/// what was avoided, such as a collision.
pub fn verdict_sentence(
    criterion: &ExerciseCriterion,
    verdict: &CriterionVerdict,
    language: Language,
) -> String {
    let text = match verdict.is_met {
        true => &criterion.yes,
        false if verdict.evidence.found == Some(say::exercise_nothing_done()) => {
            return say::exercise_not_counted(criterion.yes.in_language(language)).text(language);
        }
        false => &criterion.no,
    };
    text.in_language(language).into_owned()
}

/// Returns what decided a criterion, in brackets, as `[12.3 s, O0001:12, 39.700]`; an empty text if
/// nothing did.
pub fn describe_evidence(evidence: &MarkEvidence, language: Language) -> String {
    let mut parts = Vec::new();
    parts.extend(evidence.tick.map(|tick| format!("{:.1} s", seconds(tick))));
    parts.extend(evidence.block.clone());
    parts.extend(evidence.measured.map(|value| format!("{value:.3}")));
    parts.extend(evidence.found.as_ref().map(|found| found.text(language)));
    let comma = match language {
        Language::Zh => "，",
        Language::En => ", ",
    };
    match parts.is_empty() {
        true => String::new(),
        false => format!("[{}]", parts.join(comma)),
    }
}

fn seconds(ms: u64) -> f64 {
    ms as f64 / 1000.0
}

/// Returns the width of a table cell on a terminal, columns: a Chinese character takes two.
fn cell_width(text: &str) -> usize {
    text.chars()
        .map(|c| if c < '\u{1100}' { 1 } else { 2 })
        .sum()
}

/// Formats a CSV cell, in quotation marks if necessary. An apostrophe precedes a cell that a
/// spreadsheet would read as a formula.
fn csv_cell(text: &str) -> String {
    let text = match text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        true => format!("'{text}"),
        false => text.to_owned(),
    };
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text,
    }
}
