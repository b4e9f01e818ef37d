//! Lists the faults of programs for tools that show them in the program text: GitHub
//! annotations, and a SARIF 2.1.0 log.

use core::fmt::Write as _;

use gsk_core::command::ProgramId;
use gsk_core::model::ProgramNaming;
use gsk_core::preview::Lint;
use gsk_messages::Language;
use serde_json::{Value, json};

use super::{AlarmReport, ProgramReport, message_text};

/// Version of the SARIF format that is written.
const SARIF_VERSION: &str = "2.1.0";
const SARIF_SCHEMA: &str = "https://json.schemastore.org/sarif-2.1.0.json";

/// Whether an annotation is an error or a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnnotationLevel {
    /// The program does not run to its end, or a tool collides: an alarm, a collision, a
    /// limit.
    Error,
    /// The program runs, but probably not as intended.
    Warning,
}

impl AnnotationLevel {
    /// Returns the name of the level in GitHub commands and in SARIF.
    const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// A fault of a program, with its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Annotation {
    /// Name of the program file.
    pub file: String,
    /// Whether the fault is an error or a warning.
    pub level: AnnotationLevel,
    /// Identifier of the rule that the program breaks: `PS010`, `collision`, `spindle-stands`.
    pub rule: String,
    /// Line of the file, from 1; `None` if the fault has no line there.
    pub line: Option<u32>,
    /// First column of the fault in the line, in characters from 1, and the last one if it is
    /// known; `None` if no column is known.
    pub columns: Option<(u32, Option<u32>)>,
    /// The text of the fault for the user.
    pub text: String,
}

/// Returns the faults of a program in the order of its report: alarms, collisions, the reason that
/// prevents its end, probable mistakes. Their texts are English if `language` is `None`.
pub fn collect_annotations(report: &ProgramReport, language: Option<Language>) -> Vec<Annotation> {
    let annotation = |level, rule: &str, line: Option<u32>, text| Annotation {
        file: report.file.clone(),
        level,
        rule: rule.to_owned(),
        line,
        columns: None,
        text,
    };
    let with_columns = |columns: Option<(u32, Option<u32>)>, annotation: Annotation| Annotation {
        columns: columns.filter(|_| annotation.line.is_some()),
        ..annotation
    };
    let more = report.path.iter().flat_map(|path| &path.more_alarms);
    let alarms = report.alarm.iter().chain(more).map(|alarm| {
        let rule = format!("{}{:03}", alarm.class, alarm.number);
        let line = line_in_file(alarm.program, alarm.line);
        let column = alarm.column.map(|column| (column, None));
        with_columns(
            column,
            annotation(
                AnnotationLevel::Error,
                &rule,
                line,
                alarm_text(alarm, language),
            ),
        )
    });
    let mut all: Vec<Annotation> = alarms.collect();
    let collisions = report.part.iter().flat_map(|part| &part.collisions);
    all.extend(collisions.map(|it| {
        let line = line_in_file(it.program, it.line);
        let text = with_program(
            report.naming,
            it.program,
            message_text(&it.message(), language),
        );
        annotation(AnnotationLevel::Error, "collision", line, text)
    }));
    // The alarm explains why it ended. Without an alarm no block is the cause.
    if report.has_failed() && report.alarm.is_none() {
        let ending = message_text(&report.end_message(), language);
        all.push(annotation(
            AnnotationLevel::Error,
            report.end.name(),
            None,
            ending,
        ));
    }
    all.extend(report.warnings.iter().map(|it| {
        let line = line_in_file(Some(it.program), Some(it.line));
        let text = match line {
            Some(_) => it.text.clone(),
            None => with_program(report.naming, Some(it.program), it.sentence.clone()),
        };
        let columns = it.columns.map(|(first, last)| (first, Some(last)));
        let level = match it.is_denied {
            true => AnnotationLevel::Error,
            false => AnnotationLevel::Warning,
        };
        with_columns(columns, annotation(level, it.lint.id(), line, text))
    }));
    all
}

/// The line in the checked file, from 1; `None` for a block of a subprogram, which is in
/// another program.
const fn line_in_file(program: Option<ProgramId>, line: Option<u32>) -> Option<u32> {
    match program {
        Some(ProgramId::Stored(_)) => None,
        _ => line,
    }
}

/// Puts the name of the program before a sentence if its line is in a subprogram.
fn with_program(naming: ProgramNaming, program: Option<ProgramId>, sentence: String) -> String {
    match program {
        Some(ProgramId::Stored(number)) => format!("{}, {sentence}", naming.name(number)),
        _ => sentence,
    }
}

/// The text of an alarm for an annotation, with the position of the block if the annotation
/// has none, and with the remedy if there is one.
fn alarm_text(alarm: &AlarmReport, language: Option<Language>) -> String {
    let mut text = match line_in_file(alarm.program, alarm.line) {
        None => alarm.sentence(language),
        Some(_) => {
            let detail = alarm.detail.iter().map(|detail| format!("\n{detail}"));
            format!("{} {}", alarm.shown, alarm.text) + &detail.collect::<String>()
        }
    };
    if let Some(way_out) = alarm.way_out
        && !text.contains(way_out)
    {
        let _ = write!(text, "\n{way_out}");
    }
    text
}

/// Writes a workflow command for each fault: `::error file=…,line=…,title=…::…`. GitHub then
/// shows the fault at its line of the change.
pub fn to_github_commands(annotations: &[Annotation]) -> String {
    let mut out = String::new();
    for it in annotations {
        let file = escape_property(&it.file);
        let mut line = it
            .line
            .map_or(String::new(), |line| format!(",line={line}"));
        if let Some((first, last)) = it.columns {
            let _ = write!(line, ",col={first}");
            if let Some(last) = last {
                let _ = write!(line, ",endColumn={last}");
            }
        }
        let (level, rule, text) = (
            it.level.name(),
            escape_property(&it.rule),
            escape_data(&it.text),
        );
        let _ = writeln!(out, "::{level} file={file}{line},title={rule}::{text}");
    }
    out
}

/// Escapes the text of a workflow command: `%` and line breaks are encoded.
fn escape_data(text: &str) -> String {
    text.replace('%', "%25")
        .replace('\r', "%0D")
        .replace('\n', "%0A")
}

/// Escapes a property of a workflow command: also encodes `:` and `,`, which would end the
/// property.
fn escape_property(text: &str) -> String {
    escape_data(text).replace(':', "%3A").replace(',', "%2C")
}

/// Writes a SARIF log with all faults. `version` is that of this program.
pub fn to_sarif_log(annotations: &[Annotation], version: &str) -> String {
    let mut rules: Vec<&str> = annotations.iter().map(|it| it.rule.as_str()).collect();
    rules.sort_unstable();
    rules.dedup();
    let results: Vec<Value> = annotations.iter().map(sarif_result).collect();
    let rules: Vec<Value> = rules.iter().map(|id| sarif_rule(id)).collect();
    let driver = json!({ "name": "gsk980td", "version": version, "rules": rules });
    let run = json!({
        "tool": { "driver": driver },
        "columnKind": "unicodeCodePoints",
        "results": results,
    });
    let log = json!({ "$schema": SARIF_SCHEMA, "version": SARIF_VERSION, "runs": [run] });
    format!("{log:#}\n")
}

/// A rule of the log; that of a warning with its code as name and one sentence.
fn sarif_rule(id: &str) -> Value {
    match Lint::from_name(id) {
        Some(lint) => json!({
            "id": id,
            "name": lint.code(),
            "shortDescription": { "text": message_text(&lint.summary(), None) },
        }),
        None => json!({ "id": id }),
    }
}

fn sarif_result(it: &Annotation) -> Value {
    let mut location = json!({ "artifactLocation": { "uri": path_to_uri(&it.file) } });
    if let Some(line) = it.line {
        let mut region = json!({ "startLine": line });
        if let Some((first, last)) = it.columns {
            region["startColumn"] = first.into();
            if let Some(last) = last {
                region["endColumn"] = (last + 1).into();
            }
        }
        location["region"] = region;
    }
    json!({
        "ruleId": it.rule,
        "level": it.level.name(),
        "message": { "text": it.text },
        "locations": [{ "physicalLocation": location }],
    })
}

/// Converts a path to a URI reference: with slashes, and with percent-encoded bytes where a
/// URI needs them (RFC 3986). An absolute path becomes a `file:` URI.
fn path_to_uri(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut out = String::new();
    let drive = path.as_bytes().get(1) == Some(&b':');
    match (path.starts_with('/'), drive) {
        (true, _) => out.push_str("file://"),
        (false, true) => out.push_str("file:///"),
        (false, false) => {}
    }
    for (index, byte) in path.bytes().enumerate() {
        let plain = byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
        match plain || (drive && index == 1) {
            true => out.push(char::from(byte)),
            false => {
                let _ = write!(out, "%{byte:02X}");
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error_annotation(file: &str, line: Option<u32>, text: &str) -> Annotation {
        Annotation {
            file: file.to_owned(),
            level: AnnotationLevel::Error,
            rule: "PS010".to_owned(),
            line,
            columns: None,
            text: text.to_owned(),
        }
    }

    #[test]
    fn github_reads_every_part_of_a_line() {
        let commands = to_github_commands(&[error_annotation("a,b:c.nc", Some(3), "100 %\nG97")]);
        let wanted = "::error file=a%2Cb%3Ac.nc,line=3,title=PS010::100 %25%0AG97\n";
        assert_eq!(commands, wanted);
        let commands = to_github_commands(&[error_annotation("a.nc", None, "no end")]);
        assert_eq!(commands, "::error file=a.nc,title=PS010::no end\n");
    }

    #[test]
    fn a_path_is_a_uri() {
        assert_eq!(path_to_uri("parts/轴 1.CNC"), "parts/%E8%BD%B4%201.CNC");
        assert_eq!(path_to_uri("/home/a#b.nc"), "file:///home/a%23b.nc");
        assert_eq!(path_to_uri("C:\\parts\\a.nc"), "file:///C:/parts/a.nc");
    }

    #[test]
    fn a_log_names_each_rule_once() {
        let two = [
            error_annotation("a.nc", Some(1), "x"),
            error_annotation("b.nc", None, "y"),
        ];
        let log: Value = serde_json::from_str(&to_sarif_log(&two, "1")).expect("JSON");
        let run = &log["runs"][0];
        assert_eq!(run["tool"]["driver"]["rules"], json!([{ "id": "PS010" }]));
        let results = run["results"].as_array().expect("results");
        assert_eq!(results.len(), 2);
        let place = &results[0]["locations"][0]["physicalLocation"];
        assert_eq!(place["region"]["startLine"], 1);
        assert_eq!(
            results[1]["locations"][0]["physicalLocation"]["region"],
            Value::Null
        );
    }
}
