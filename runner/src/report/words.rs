//! A report in words.

use super::{AlarmReport, Bounds, End, LIMIT, PathReport, Report, translated};
use crate::language::{Language, say};
use crate::words::{beginning, clock};

impl AlarmReport {
    /// One line: `P/S 011 … in line 3: N30 G01 X50;`.
    pub fn sentence(&self, language: Option<Language>) -> String {
        let words = language.unwrap_or(Language::En);
        let class = if self.class == "PS" {
            "P/S"
        } else {
            self.class
        };
        let mut out = format!("{class} {:03} {}", self.number, self.text);
        if let Some(line) = self.line {
            out.push_str(&match words {
                Language::Zh => format!(", 第 {line} 行"),
                Language::En => format!(", line {line}"),
            });
        }
        if let Some(block) = &self.block {
            out.push_str(&format!(": {}", beginning(block)));
        }
        if let Some(detail) = &self.detail {
            out.push_str(&format!("\n  {detail}"));
        }
        // The block alone does not say what the machine waits for.
        if self.class == "PLC" {
            let (cause, way_out) = (say(words, "原因", "cause"), say(words, "处理", "way out"));
            for (word, text) in [(cause, self.cause), (way_out, self.way_out)] {
                out.extend(text.map(|text| format!("\n  {word}: {text}")));
            }
        }
        out
    }
}

impl Report {
    /// Lines for people.
    pub fn words(&self, language: Option<Language>) -> String {
        let words = language.unwrap_or(Language::En);
        let mut lines = vec![format!("{}: {}", self.file, self.end_in_words(words))];
        if let Some(alarm) = &self.alarm {
            lines.push(alarm.sentence(language));
        }
        if let Some(path) = &self.path {
            lines.extend(path.further(language));
        }
        match (&self.waits_for, self.end) {
            (Some(why), End::Refused) => lines.push(why.clone()),
            (Some(what), _) => lines.push(format!("it waits for {what}")),
            (None, _) => {}
        }
        lines.push(self.counts(words));
        for warning in &self.warnings {
            lines.push(format!("{}: {warning}", say(words, "警告", "warning")));
        }
        if let Some(path) = &self.path {
            lines.extend(path.words(words));
        }
        let (x, z) = self.position.abs;
        let end = say(words, "结束位置", "at the end");
        let modal = self.modal.join(" ");
        lines.push(format!("{end} X{x} Z{z}, T{}, {modal}", self.t));
        lines.join("\n  ") + "\n"
    }

    fn end_in_words(&self, words: Language) -> String {
        match (self.end, words) {
            (End::Alarm, _) => say(words, "报警", "ALARM").to_owned(),
            (End::Refused, _) => say(
                words,
                "未运行到结束: 循环启动被拒绝",
                "NOT RUN TO ITS END: cycle start was refused",
            )
            .to_owned(),
            (End::Stop, _) => say(
                words,
                "未运行到结束: 程序停止, 机床静止",
                "NOT RUN TO ITS END: it was stopped and stands",
            )
            .to_owned(),
            (End::Asked, _) => say(
                words,
                "未运行到结束: 被 Ctrl-C 或信号结束, 驱动板已停止",
                "NOT RUN TO ITS END: ended by Ctrl-C or a signal, the board was stopped",
            )
            .to_owned(),
            (End::Limit, Language::En) => format!("stopped: {LIMIT}"),
            (End::Limit, Language::Zh) => format!("已中止: {}", translated(LIMIT, Some(words))),
            (End::M30 | End::M99 | End::Text, Language::En) => {
                format!("ended normally ({})", self.end.name())
            }
            (End::M30 | End::M99 | End::Text, Language::Zh) => {
                format!("正常结束 ({})", self.end.name())
            }
        }
    }

    fn counts(&self, words: Language) -> String {
        let (time, cutting) = (clock(self.time_s), clock(self.cutting_s));
        let (blocks, moves, parts, stops) = (self.blocks, self.moves, self.parts, self.stops);
        let mut out = match words {
            Language::En => format!(
                "machine time {time}, of that cutting {cutting}; {blocks} blocks, {moves} moves, \
                 {parts} part(s)"
            ),
            Language::Zh => format!(
                "机床时间 {time}, 其中切削 {cutting}; {blocks} 个程序段, {moves} 次移动, \
                 {parts} 个工件"
            ),
        };
        if stops > 0 {
            out.push_str(&match words {
                Language::En => format!(", {stops} stop(s) M00"),
                Language::Zh => format!(", M00 暂停 {stops} 次"),
            });
        }
        out
    }
}

impl PathReport {
    /// What else is wrong, a line each.
    fn further(&self, language: Option<Language>) -> Vec<String> {
        let words = language.unwrap_or(Language::En);
        let also = say(words, "另有", "also");
        let alarms = self.more_alarms.iter();
        let mut lines: Vec<String> = alarms
            .map(|alarm| format!("{also} {}", alarm.sentence(language)))
            .collect();
        lines.extend(self.unchecked_behind.map(|line| match words {
            Language::En => format!("what comes behind line {line} was not checked"),
            Language::Zh => format!("第 {line} 行之后未检查"),
        }));
        lines
    }

    fn words(&self, words: Language) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(Bounds { x, z }) = self.bounds {
            let (x, z) = (
                format!("X {} … {}", x.0, x.1),
                format!("Z {} … {}", z.0, z.1),
            );
            lines.push(match words {
                Language::En => format!("path within {x}, {z} mm"),
                Language::Zh => format!("刀路范围 {x}, {z} mm"),
            });
        }
        let lengths: Vec<String> = self
            .lengths
            .iter()
            .filter(|(_, length)| **length > 0.0)
            .map(|(kind, length)| format!("{} {length:.3} mm", kind_in_words(kind, words)))
            .collect();
        if !lengths.is_empty() {
            let label = say(words, "长度", "length");
            lines.push(format!("{label}: {}", lengths.join(", ")));
        }
        if !self.tools.is_empty() {
            let tools: Vec<String> = self.tools.iter().map(|tool| format!("T{tool}")).collect();
            let label = say(words, "刀具", "tools");
            lines.push(format!("{label}: {}", tools.join(" ")));
        }
        lines
    }
}

/// A kind of move.
fn kind_in_words(kind: &'static str, words: Language) -> &'static str {
    let chinese = match kind {
        "rapid" => "快速",
        "feed" => "切削",
        "cw" => "顺时针圆弧",
        "ccw" => "逆时针圆弧",
        "thread" => "螺纹",
        other => other,
    };
    say(words, chinese, kind)
}
