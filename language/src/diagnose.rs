//! Analyses a program as `check` does: alarms, warnings, machine time and extents.

use gsk_core::alarm::Alarm;
use gsk_core::command::{ExecutedMove, ProgramId, SourcePosition};
use gsk_core::model::ModelRecord;
use gsk_core::preview::{Caution, PathBounds, PreviewEnd, PreviewProgress, preview_beyond_alarms};
use gsk_core::program::ProgramMemory;
use gsk_core::setup::Setup;
use gsk_messages::{Language, say};
use gsk_milling::{MillMove, MillSetup, MillSlip, preview_while};
use gsk_runner::report::AlarmReport;

use crate::fixes::{QuickFix, alarm_fixes, caution_fix, mill_word_fix};
use crate::line_times::LineTimes;
use crate::locate::{LineSpan, bytes_at_column, locate_alarm, trimmed_range};

/// Whether a finding is an error or a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Error: the program does not run.
    Error,
    /// Warning: the program runs, but probably not as intended.
    Warning,
}

/// An alarm or a warning about a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramFinding {
    /// The program that contains the cause. The analysed text is [`ProgramId::External`].
    pub program: ProgramId,
    /// The word or block that is the cause, with its line from 1 as elsewhere in the control.
    /// `None` if no block is the cause.
    pub at: Option<LineSpan>,
    /// Whether the finding is an error or a warning.
    pub severity: Severity,
    /// The number of the alarm, or the name of the warning.
    pub code: String,
    /// The message for the user, with cause and remedy.
    pub text: String,
    /// Edits of the program that remove the cause; empty if none is certainly right.
    pub fixes: Vec<QuickFix>,
}

/// The bounding box of a toolpath, in work coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extents {
    /// Bounds of a lathe path, mm; X is a radius.
    Lathe(PathBounds),
    /// Bounds of a mill path in X, Y and Z, mm, and the axes of the machine with its further
    /// ones.
    Mill(gsk_milling::MillBounds, gsk_milling::Axes),
}

/// The result of analysing a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// Alarms and warnings in the order of execution.
    pub findings: Vec<ProgramFinding>,
    /// How the preview ended: at the program end, with an alarm, or at a limit.
    pub end: PreviewEnd,
    /// Machine time up to the end of the preview, s.
    pub time_s: f64,
    /// Part of the machine time in which a tool is in the material, s.
    pub cutting_s: f64,
    /// The bounding box of the path; `None` without a path.
    pub extents: Option<Extents>,
    /// Tools that the program calls, as T words such as `T0101`.
    pub tools: Vec<String>,
    /// Machine time by line of the text.
    pub line_times: LineTimes,
}

/// Analyses the selected program of a set-up, including the blocks after an alarm.
/// `keep_going` receives the progress and returns false to stop early.
pub fn analyse(
    setup: &Setup,
    language: Language,
    keep_going: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Analysis {
    let programs = &setup.memory.programs;
    let mut line_times = LineTimes::default();
    let mut take = |executed: &ExecutedMove| {
        line_times.add_move(executed.source, executed.start_s + executed.duration_s);
    };
    let preview = preview_beyond_alarms(setup, programs, &mut take, keep_going);
    line_times.advance_to(preview.time_s);
    let alarms = preview.alarm.iter().chain(&preview.further.alarms);
    let cautions = preview.cautions.iter();
    let warnings = cautions.map(|it| caution_finding(it, programs, language));
    let record = Some(setup.memory.model.record());
    let alarms = alarms.map(|it| alarm_finding(it, programs, record, language));
    Analysis {
        findings: list_findings(alarms, preview.end, warnings, language),
        end: preview.end,
        time_s: preview.time_s,
        cutting_s: preview.cutting_s,
        extents: preview.bounds.map(Extents::Lathe),
        tools: preview
            .tools
            .iter()
            .map(|(tool, offset)| format!("T{tool:02}{offset:02}"))
            .collect(),
        line_times,
    }
}

/// Analyses the selected program of a mill. `keep_going` receives the progress and returns
/// false to stop early.
pub fn analyse_mill(
    setup: &MillSetup,
    programs: &ProgramMemory,
    language: Language,
    keep_going: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Analysis {
    let mut line_times = LineTimes::default();
    let mut take =
        |made: &MillMove| line_times.add_move(made.source, made.start_s + made.duration_s);
    let preview = preview_while(setup, programs, &mut take, keep_going);
    line_times.advance_to(preview.time_s);
    let alarms = preview.alarm.iter().chain(&preview.further);
    let warnings = preview.cautions.iter().map(|it| {
        let text = it.slip.message().text(language);
        let mut found = warning(it.slip.lint().id(), text, it.source, None, programs);
        if let (MillSlip::WordWithoutEffect(letter), Some(program)) =
            (&it.slip, programs.get(it.source.program))
        {
            found.fixes = mill_word_fix(*letter, it.source, program, language);
        }
        found
    });
    let alarms = alarms.map(|it| alarm_finding(it, programs, None, language));
    Analysis {
        findings: list_findings(alarms, preview.end, warnings, language),
        end: preview.end,
        time_s: preview.time_s,
        cutting_s: preview.cutting_s,
        extents: preview
            .bounds
            .map(|bounds| Extents::Mill(bounds, preview.axes)),
        tools: preview
            .tools
            .iter()
            .map(|tool| format!("T{tool:02}"))
            .collect(),
        line_times,
    }
}

/// Returns the findings of a preview in their order: alarms, the limit, warnings.
fn list_findings(
    alarms: impl Iterator<Item = ProgramFinding>,
    end: PreviewEnd,
    warnings: impl Iterator<Item = ProgramFinding>,
    language: Language,
) -> Vec<ProgramFinding> {
    alarms
        .chain(limit_finding(end, language))
        .chain(warnings)
        .collect()
}

/// Returns the warning that the preview reached its limit; `None` if it did not.
fn limit_finding(end: PreviewEnd, language: Language) -> Option<ProgramFinding> {
    (end == PreviewEnd::Limit).then(|| ProgramFinding {
        program: ProgramId::External,
        at: None,
        severity: Severity::Warning,
        code: "limit".to_owned(),
        text: say::report_given_up(say::report_limit()).text(language),
        fixes: Vec::new(),
    })
}

/// Creates the finding of an alarm. `record` describes the lathe for which fixes are searched;
/// `None` for a mill.
fn alarm_finding(
    alarm: &Alarm,
    programs: &ProgramMemory,
    record: Option<&ModelRecord>,
    language: Language,
) -> ProgramFinding {
    let program = alarm
        .source
        .map_or(ProgramId::External, |source| source.program);
    let line_of = |line| programs.get(program).map_or("", |it| it.line(line));
    let report = AlarmReport::new(alarm, programs, Some(language));
    let mut text = format!("{} {}", report.shown, report.text);
    let further = report
        .detail
        .iter()
        .map(String::as_str)
        .chain(report.way_out);
    for more in further {
        text.push('\n');
        text.push_str(more);
    }
    let at = locate_alarm(alarm, line_of);
    let fixes = at
        .as_ref()
        .zip(record)
        .map(|(at, record)| alarm_fixes(alarm, (at.line, line_of(at.line)), record, language));
    ProgramFinding {
        program,
        at,
        severity: Severity::Error,
        code: alarm.number_text(),
        text,
        fixes: fixes.unwrap_or_default(),
    }
}

fn caution_finding(
    caution: &Caution,
    programs: &ProgramMemory,
    language: Language,
) -> ProgramFinding {
    let text = caution.kind.message().text(language);
    let first_column = caution.columns().map(|(first, _)| first);
    let code = caution.kind.lint().id();
    let found = warning(code, text, caution.source, first_column, programs);
    let program = programs.get(caution.source.program);
    let fix = program.and_then(|it| caution_fix(&caution.kind, caution.source, it, language));
    ProgramFinding {
        fixes: fix.into_iter().collect(),
        ..found
    }
}

/// Creates a warning at the block `source`, or at its word in `first_column` (characters from
/// 1).
fn warning(
    code: &str,
    text: String,
    source: SourcePosition,
    first_column: Option<u32>,
    programs: &ProgramMemory,
) -> ProgramFinding {
    let line = programs
        .get(source.program)
        .map_or("", |it| it.line(source.line));
    ProgramFinding {
        program: source.program,
        at: Some(LineSpan {
            line: source.line,
            bytes: match first_column {
                Some(first) => bytes_at_column(line, Some(first as usize)),
                None => trimmed_range(line),
            },
        }),
        severity: Severity::Warning,
        code: code.to_owned(),
        text,
        fixes: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Structure, TextDocument};
    use gsk_core::program::Program;

    fn analysis(text: &str) -> Analysis {
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        setup.memory.programs.select(ProgramId::External);
        analyse(&setup, Language::En, &mut |it| it.moves < 1000)
    }

    fn tool_times(analysis: &Analysis, text: &str) -> Vec<f64> {
        analysis
            .line_times
            .by_tool(&Structure::read(&TextDocument::new(text)))
    }

    #[test]
    fn alarms_and_warnings_are_at_their_words() {
        let analysis = analysis("O0001\nG00 X20 Z2\nG01 Z-5\nX30 Z-9 F100 ?\nG00 X20 Z2\nM30\n");
        let found: Vec<_> = analysis
            .findings
            .iter()
            .map(|it| {
                (
                    it.code.as_str(),
                    it.at.clone().map(|at| (at.line, at.bytes)),
                )
            })
            .collect();
        assert_eq!(found[0], ("011", Some((3, 0..7))), "{found:?}");
        assert_eq!(found[1], ("006", Some((4, 13..14))), "{found:?}");
        assert!(
            analysis.findings[0].text.starts_with("P/S 011 "),
            "{analysis:?}"
        );
    }

    #[test]
    fn an_error_in_a_profile_is_located_there() {
        let analysis = analysis(
            "T0101 M03 S500\nG00 X62 Z2\nG71 U2 R1\nG71 P1 Q2 U1 F100\nN1 G00 X20\nG01 Z-9\n\
             N2 G02 X40 Z-45 R2\nM30\n",
        );
        assert_eq!(analysis.findings[0].at.as_ref().map(|at| at.line), Some(7));
        let analysis = self::analysis(
            "T0101 M03 S500\nG00 X62 Z2\nG71 U2 R1\nG71 P1 Q2 U1 F100\nN1 G00 X20\nN2 Y1 Z-9\nM30\n",
        );
        let at = analysis.findings[0].at.clone();
        assert_eq!(at.map(|at| (at.line, at.bytes)), Some((6, 3..5)));
    }

    #[test]
    fn the_time_is_split_by_tools() {
        let text =
            "M03 S500\nT0101\nG00 X60 Z2\nG01 Z-30 F60\nG00 X100 Z50\nT0202\nG01 Z-30 F60\nM30\n";
        let analysis = analysis(text);
        let times = tool_times(&analysis, text);
        assert!(
            times.len() == 2 && times.iter().all(|it| *it > 30.0),
            "{analysis:?}"
        );
        assert!(times.iter().sum::<f64>() <= analysis.time_s);
        assert_eq!(analysis.tools.len(), 2);
        assert!(analysis.cutting_s > 100.0 && analysis.extents.is_some());
    }

    #[test]
    fn a_mill_program_is_analysed_as_one() {
        let text = "O0001\nT1 M06\nM03 S500\nG90 G00 X0 Y0 Z2\nG01 Z-5 F60\nG70\nY20 A5\nM30\n";
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        setup.memory.programs.select(ProgramId::External);
        let programs = &setup.memory.programs;
        let mill = MillSetup::default();
        let analysis = analyse_mill(&mill, programs, Language::En, &mut |_| true);
        let found: Vec<_> = analysis
            .findings
            .iter()
            .map(|it| (it.code.as_str(), it.at.as_ref().map(|at| at.line)))
            .collect();
        assert_eq!(found, [("010", Some(6)), ("009", Some(7))]);
        assert_eq!(analysis.tools, ["T01"]);
        assert!(
            tool_times(&analysis, text)[0] > 7.0
                && matches!(analysis.extents, Some(Extents::Mill(..)))
        );
    }

    #[test]
    fn an_endless_program_reaches_the_limit() {
        let analysis = analysis("M03 S500 T0101\nN1 G01 U1 F6000\nU-1\nG65 H80 P1\n");
        assert_eq!(analysis.end, PreviewEnd::Limit);
        assert!(
            analysis.findings.iter().any(|it| it.code == "limit"),
            "{analysis:?}"
        );
    }
}
