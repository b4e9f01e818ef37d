//! Writes a report as text for the user.

use gsk_core::command::ProgramId;
use gsk_messages::{Language, Message, say};

use super::{AlarmReport, Bounds, End, PathReport, Place, Report};
use crate::words::{beginning, clock};

impl AlarmReport {
    /// The alarm with its block: `P/S 011 … in line 3: N30 G01 X50;`. The detail, and in class
    /// PLC cause and remedy, follow on indented lines.
    pub fn sentence(&self, language: Option<Language>) -> String {
        let words = language.unwrap_or(Language::En);
        let mut out = format!("{} {}", self.shown, self.text);
        // A block of a subprogram is in a separate program.
        if let Some(ProgramId::Stored(number)) = self.program {
            out.push_str(&format!(", O{number:04}"));
        }
        if let Some(line) = self.line {
            out.push_str(&say::report_line(line).text(words));
        }
        if let Some(block) = &self.block {
            out.push_str(&format!(": {}", beginning(block)));
        }
        if let Some(detail) = &self.detail {
            out.push_str(&format!("\n  {detail}"));
        }
        // The block alone does not show what the machine waits for.
        if self.class == "PLC" {
            let cause = self.cause.map(say::report_cause);
            let way_out = self.way_out.map(say::report_way_out);
            for said in cause.into_iter().chain(way_out) {
                out.push_str(&format!("\n  {}", said.text(words)));
            }
        }
        out
    }
}

impl Report {
    /// The report as indented lines of text for the user.
    pub fn words(&self, language: Option<Language>) -> String {
        let words = language.unwrap_or(Language::En);
        let mut lines = vec![format!(
            "{}: {}",
            self.file,
            self.how_it_ended().text(words)
        )];
        if let Some(alarm) = &self.alarm {
            lines.push(alarm.sentence(language));
        }
        if let Some(path) = &self.path {
            lines.extend(path.further(language));
        }
        match (&self.waits_for, self.end) {
            (Some(why), End::Refused) => lines.push(why.clone()),
            (Some(what), _) => lines.push(say::report_waits_for(what).text(words)),
            (None, _) => {}
        }
        lines.push(self.counts(words));
        for warning in &self.warnings {
            lines.push(say::report_warning(&warning.sentence).text(words));
        }
        if let Some(path) = &self.path {
            lines.extend(path.words(words));
        }
        if let Some(part) = &self.part {
            lines.extend(part.words(words));
        }
        let modal = self.modal.join(" ");
        let at_end = match &self.position.abs {
            Place::Lathe(x, z) => say::report_at_end(x, z, &self.t, modal),
            Place::Mill(place) => {
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

    pub(super) fn how_it_ended(&self) -> Message {
        match self.end {
            End::Alarm => say::report_alarm(),
            End::Refused => say::report_refused(),
            End::Stop => say::report_stopped(),
            End::Asked => say::report_asked(),
            End::Collision => say::report_ended_by_collision(),
            End::Limit => say::report_given_up(say::report_limit()),
            End::M30 | End::M02 | End::M99 | End::Text => say::report_ended(self.end.name()),
        }
    }

    fn counts(&self, words: Language) -> String {
        let (time, cutting) = (clock(self.time_s), clock(self.cutting_s));
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
    /// The further alarms, a line each.
    fn further(&self, language: Option<Language>) -> Vec<String> {
        let words = language.unwrap_or(Language::En);
        let alarms = self.more_alarms.iter();
        let mut lines: Vec<String> = alarms
            .map(|alarm| say::report_also(alarm.sentence(language)).text(words))
            .collect();
        let unchecked = self.unchecked_behind.map(say::report_unchecked);
        lines.extend(unchecked.map(|said| said.text(words)));
        lines
    }

    /// The range of the further axes of a mill.
    fn further_bounds(&self) -> String {
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

    fn words(&self, words: Language) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(Bounds { x, y, z, .. }) = &self.bounds {
            let path = match y {
                None => say::report_path(x.0, x.1, z.0, z.1),
                Some(y) => say::report_mill_path(x.0, x.1, y.0, y.1, z.0, z.1),
            };
            lines.push(path.text(words) + &self.further_bounds());
        }
        let lengths: Vec<String> = self
            .lengths
            .iter()
            .filter(|(_, length)| **length > 0.0)
            .map(|(kind, length)| format!("{} {length:.3} mm", kind_in_words(kind).text(words)))
            .collect();
        if !lengths.is_empty() {
            lines.push(say::report_lengths(lengths.join(", ")).text(words));
        }
        if !self.tools.is_empty() {
            let tools: Vec<String> = self.tools.iter().map(|tool| format!("T{tool}")).collect();
            lines.push(say::report_tools(tools.join(" ")).text(words));
        }
        lines.extend(self.time_words(words));
        lines
    }
}

impl PathReport {
    /// The machine time: a line for the kinds, and one for each tool.
    fn time_words(&self, words: Language) -> Vec<String> {
        let kinds = self.times.kinds();
        let times: Vec<String> = kinds
            .map(|(what, seconds)| format!("{} {}", what.words().text(words), clock(seconds)))
            .collect();
        if times.is_empty() {
            return Vec::new();
        }
        let tools = self.tool_times.iter().map(|row| {
            let (time, cutting) = (clock(row.seconds.whole()), clock(row.seconds.cutting()));
            say::report_tool_time(&row.tool, time, cutting).text(words)
        });
        let times = say::report_times(times.join(", ")).text(words);
        core::iter::once(times).chain(tools).collect()
    }
}

/// The name of a kind of move.
fn kind_in_words(kind: &str) -> Message {
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
