//! Writes a report as text for the user.

use gsk_core::command::ProgramId;
use gsk_messages::{Language, Message, say};

use super::{AlarmReport, PathReport, ProgramReport, ReportBounds, ReportPosition, RunEnd};
use crate::text_format::{format_time, shorten_line};

impl AlarmReport {
    /// The alarm with its block as text: `P/S 011 … in line 3: N30 G01 X50;`. The detail, and
    /// in class PLC cause and remedy, follow on indented lines. English if `language` is
    /// `None`.
    pub fn sentence(&self, language: Option<Language>) -> String {
        let words = language.unwrap_or(Language::En);
        let (comma, colon) = match words {
            Language::Zh => ("，", "："),
            Language::En => (", ", ": "),
        };
        // The clause about the line continues the text, which the control may end with a mark.
        let text = match words {
            Language::Zh if self.line.is_some() => self.text.trim_end_matches(['!', '.', '。']),
            _ => self.text.as_str(),
        };
        let mut out = format!("{} {text}", self.shown);
        // A block of a subprogram is in a separate program.
        if let Some(ProgramId::Stored(number)) = self.program {
            out.push_str(&format!("{comma}{}", self.naming.name(number)));
        }
        if let Some(line) = self.line {
            out.push_str(&say::report_line(line).text(words));
        }
        if let Some(block) = &self.block {
            out.push_str(&format!("{colon}{}", shorten_line(block)));
        }
        if let Some(detail) = &self.detail {
            out.push_str(&format!("\n  {detail}"));
        }
        // The block alone does not show what the machine waits for.
        if self.class == "PLC" {
            let cause = self.cause.map(say::report_cause);
            let way_out = self.way_out.map(say::report_way_out);
            for message in cause.into_iter().chain(way_out) {
                out.push_str(&format!("\n  {}", message.text(words)));
            }
        }
        out
    }
}

impl ProgramReport {
    /// The report as indented lines of text for the user; English if `language` is `None`.
    pub fn to_text(&self, language: Option<Language>) -> String {
        let words = language.unwrap_or(Language::En);
        let mut lines = vec![format!("{}: {}", self.file, self.end_message().text(words))];
        if let Some(alarm) = &self.alarm {
            lines.push(alarm.sentence(language));
        }
        if let Some(path) = &self.path {
            lines.extend(path.further_lines(language));
        }
        match (&self.waits_for, self.end) {
            (Some(why), RunEnd::Refused) => lines.push(why.clone()),
            (Some(what), _) => lines.push(say::report_waits_for(what).text(words)),
            (None, _) => {}
        }
        lines.push(self.counts_text(words));
        for warning in &self.warnings {
            let code = warning.lint.code();
            let message = match warning.is_denied {
                true => say::report_denied_warning(code, &warning.sentence),
                false => say::report_warning(code, &warning.sentence),
            };
            lines.push(message.text(words));
        }
        if let Some(path) = &self.path {
            lines.extend(path.path_lines(words));
        }
        if let Some(part) = &self.part {
            lines.extend(part.text_lines(words));
        }
        if let Some(load) = &self.load {
            lines.extend(load.text_lines(words, self.naming));
        }
        let modal = self.modal.join(" ");
        let at_end = match &self.position.abs {
            ReportPosition::Lathe(x, z) => say::report_at_end(x, z, &self.t, modal),
            ReportPosition::Mill(place) => {
                let [x, y, z] = place.basic;
                let further = place.further.iter();
                let further = further.map(|(letter, value)| format!(" {letter}{value}"));
                let z = format!("{z}{}", further.collect::<String>());
                say::report_mill_at_end(x, y, z, &self.t, modal)
            }
        };
        lines.push(at_end.text(words));
        lines.join("\n  ") + "\n"
    }

    pub(super) fn end_message(&self) -> Message {
        match self.end {
            RunEnd::Alarm => say::report_alarm(),
            RunEnd::Refused => say::report_refused(),
            RunEnd::Stop => say::report_stopped(),
            RunEnd::Requested => say::report_ended_by_signal(),
            RunEnd::Collision => say::report_ended_by_collision(),
            RunEnd::Overload => say::report_ended_by_overload(),
            RunEnd::Location => say::report_ended_until(),
            RunEnd::Limit => say::report_given_up(say::report_limit()),
            RunEnd::M30 | RunEnd::M02 | RunEnd::M99 | RunEnd::Text => {
                say::report_ended(self.end.name())
            }
        }
    }

    fn counts_text(&self, words: Language) -> String {
        let (time, cutting) = (format_time(self.time_s), format_time(self.cutting_s));
        let (blocks, moves, parts, stops) = (self.blocks, self.moves, self.parts, self.stops);
        let counts = say::report_counts(time, cutting, blocks, moves, parts);
        let mut out = counts.text(words);
        if stops > 0 {
            out.push_str(&say::report_stops(stops).text(words));
        }
        out
    }
}

impl PathReport {
    /// The alarms after the first one as lines of text, and where the check for them stopped.
    fn further_lines(&self, language: Option<Language>) -> Vec<String> {
        let words = language.unwrap_or(Language::En);
        let alarms = self.more_alarms.iter();
        let mut lines: Vec<String> = alarms
            .map(|alarm| say::report_also(alarm.sentence(language)).text(words))
            .collect();
        let unchecked = self.unchecked_after.map(say::report_unchecked);
        lines.extend(unchecked.map(|message| message.text(words)));
        lines
    }

    /// The range of each further axis (the fourth and fifth) of a mill, as text.
    fn further_bounds_text(&self) -> String {
        let Some(bounds) = &self.bounds else {
            return String::new();
        };
        let further = bounds.further.iter().map(|(name, (least, greatest))| {
            let unit = match bounds.turning.contains(name) {
                true => "°",
                false => " mm",
            };
            let name = name.to_ascii_uppercase();
            format!(", {name} {least} … {greatest}{unit}")
        });
        further.collect()
    }

    fn path_lines(&self, words: Language) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(ReportBounds { x, y, z, .. }) = &self.bounds {
            let path = match y {
                None => say::report_path(x.0, x.1, z.0, z.1),
                Some(y) => say::report_mill_path(x.0, x.1, y.0, y.1, z.0, z.1),
            };
            lines.push(path.text(words) + &self.further_bounds_text());
        }
        let lengths: Vec<String> = self
            .lengths
            .iter()
            .filter(|(_, length)| **length > 0.0)
            .map(|(kind, length)| format!("{} {length:.3} mm", kind_message(kind).text(words)))
            .collect();
        if !lengths.is_empty() {
            lines.push(say::report_lengths(lengths.join(", ")).text(words));
        }
        if !self.tools.is_empty() {
            let tools: Vec<String> = self.tools.iter().map(|tool| format!("T{tool}")).collect();
            lines.push(say::report_tools(tools.join(" ")).text(words));
        }
        lines.extend(self.time_lines(words));
        lines
    }
}

impl PathReport {
    /// The machine time as lines of text: one for the kinds of motion, and one for each tool.
    fn time_lines(&self, words: Language) -> Vec<String> {
        let kinds = self.times.nonzero_kinds();
        let times: Vec<String> = kinds
            .map(|(what, seconds)| {
                format!("{} {}", what.message().text(words), format_time(seconds))
            })
            .collect();
        if times.is_empty() {
            return Vec::new();
        }
        let tools = self.tool_times.iter().map(|row| {
            let (time, cutting) = (
                format_time(row.seconds.total_s()),
                format_time(row.seconds.cutting_s()),
            );
            say::report_tool_time(&row.tool, time, cutting).text(words)
        });
        let times = say::report_times(times.join(", ")).text(words);
        core::iter::once(times).chain(tools).collect()
    }
}

/// The name of a kind of move for the user; `kind` is its key in the JSON.
fn kind_message(kind: &str) -> Message {
    match kind {
        "rapid" => say::report_kind_rapid(),
        "feed" => say::report_kind_feed(),
        "cw" => say::report_kind_clockwise(),
        "ccw" => say::report_kind_counter_clockwise(),
        "thread" => say::report_kind_thread(),
        "tap" => say::report_kind_tap(),
        other => say::as_written(other),
    }
}
