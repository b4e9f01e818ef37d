//! The thread that analyses programs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crossbeam::channel::{Receiver, Sender, unbounded};
use gsk_core::command::ProgramId;
use gsk_core::preview::{PreviewEnd, WorkBudget};
use gsk_core::program::Program;
use gsk_host::files::subprograms::{FoundSubprogram, SubprogramCalls};
use gsk_host::loading;
use gsk_host::preview::work_limit::WorkLimit;
use gsk_language::{
    Analysis, LineSpan, LineTimes, Position, ProgramFinding, QuickFix, Severity, Structure,
    TextChange, TextDocument, analyse, analyse_mill,
};
use gsk_messages::{Language, Message, say};
use gsk_port::{PortOptions, guess_dialect, port_program};
use lsp_types::Uri;

use super::CheckedControl;

/// Name of the finding that a text is written for another control.
const FOREIGN_PROGRAM: &str = "foreign-program";
/// Limit of the work of one analysis.
const BUDGET: WorkBudget = WorkBudget::interactive(20_000_000);

/// A program text to be analysed by the checker thread.
pub struct AnalysisJob {
    pub uri: Uri,
    /// Version of the document, as numbered by the editor.
    pub version: i32,
    /// Path of the document's file; `None` if it was never saved.
    pub path: Option<PathBuf>,
    pub text: Arc<TextDocument>,
    /// The programs in other files that the text calls.
    pub called_programs: Arc<Vec<FoundSubprogram>>,
    /// Set to false by the server to cancel the job.
    pub is_wanted: Arc<AtomicBool>,
}

/// The result of an [`AnalysisJob`].
pub struct AnalysisResult {
    pub uri: Uri,
    /// Version of the document that was analysed, as numbered by the editor.
    pub version: i32,
    pub structure: Arc<Structure>,
    /// What the check found; if the program cannot be loaded, the reason is the only finding.
    pub analysis: Arc<Analysis>,
}

/// Starts the checker thread: it takes jobs from the sender, returns results through the
/// receiver, and ends when the sender is dropped.
pub fn start_checker(
    control: CheckedControl,
    language: Language,
) -> (Sender<AnalysisJob>, Receiver<AnalysisResult>) {
    let (jobs, from_server) = unbounded::<AnalysisJob>();
    let (to_server, results) = unbounded();
    thread::spawn(move || {
        for job in from_server {
            if !job.is_wanted.load(Ordering::Relaxed) {
                continue;
            }
            // Structure and analysis are independent: both take long for a long text.
            let (structure, analysis) = thread::scope(|side_by_side| {
                let structure = side_by_side.spawn(|| Structure::read(&job.text));
                let analysis = analyse_job(&control, &job, language);
                let read_anew = |_| Structure::read(&job.text);
                (structure.join().unwrap_or_else(read_anew), analysis)
            });
            // The server may have ended.
            if job.is_wanted.load(Ordering::Relaxed) {
                let _ = to_server.send(AnalysisResult {
                    uri: job.uri,
                    version: job.version,
                    structure: Arc::new(structure),
                    analysis: Arc::new(analysis),
                });
            }
        }
    });
    (jobs, results)
}

fn analyse_job(control: &CheckedControl, job: &AnalysisJob, language: Language) -> Analysis {
    let mut setup = control.setup.clone();
    let unsaved = || PathBuf::from(job.uri.as_str());
    let path = job.path.clone().unwrap_or_else(unsaved);
    let find_programs = |_: SubprogramCalls, loaded: &BTreeSet<u16>| {
        let new = |it: &&FoundSubprogram| !loaded.contains(&it.number);
        job.called_programs.iter().filter(new).cloned().collect()
    };
    let text = job.text.as_str().to_owned();
    let opened = loading::open_text(&mut setup, &path, text, find_programs);
    let notices = match opened {
        Ok(notices) => notices.0,
        Err(error) => return load_error_analysis(&error.message(), language),
    };
    let foreign = control
        .mill
        .is_none()
        .then(|| foreign_finding(&job.text, language));
    let limit = WorkLimit::new(BUDGET);
    let mut should_continue =
        |progress: &_| limit.allows(progress) && job.is_wanted.load(Ordering::Relaxed);
    let mut analysis = match &control.mill {
        Some(mill) => {
            let programs = &setup.memory.programs;
            analyse_mill(mill, programs, language, &mut should_continue)
        }
        None => analyse(&setup, language, &mut should_continue),
    };
    let external = setup.memory.programs.external();
    let full_width = external.and_then(Program::full_width_line);
    let full_width = full_width.map(|line| say::file_full_width(short_name(&path), line));
    let notices = notices.into_iter().chain(full_width);
    analysis.findings.extend(foreign.flatten());
    analysis
        .findings
        .extend(notices.map(|notice| ProgramFinding {
            program: ProgramId::External,
            at: None,
            severity: Severity::Warning,
            code: notice.id().name().to_owned(),
            text: notice.text(language),
            fixes: Vec::new(),
        }));
    analysis
}

/// The finding that a text is written for another control, with the ported text as its fix;
/// `None` if all words exist here.
fn foreign_finding(text: &TextDocument, language: Language) -> Option<ProgramFinding> {
    let guess = guess_dialect(text.as_str())?;
    let ported = port_program(text.as_str(), guess.dialect, PortOptions::default());
    let dialect = guess.dialect.name();
    let offer = say::port_offer(guess.line, &guess.word, dialect);
    let last = text.line_count().saturating_sub(1);
    let whole = TextChange {
        from: Position::default(),
        to: Position {
            line: last,
            byte: text.line(last).len() as u32,
        },
        text: ported.text,
    };
    let line = text.line(guess.line.saturating_sub(1));
    let indent = line.len() - line.trim_start().len();
    Some(ProgramFinding {
        program: ProgramId::External,
        at: Some(LineSpan {
            line: guess.line,
            bytes: indent..line.trim_end().len().max(indent),
        }),
        severity: Severity::Warning,
        code: FOREIGN_PROGRAM.to_owned(),
        text: offer.text(language),
        fixes: vec![QuickFix {
            title: say::lsp_port_title(dialect).text(language),
            changes: vec![whole],
        }],
    })
}

fn short_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// Creates the analysis of a program that cannot be loaded: `message` is its only finding.
fn load_error_analysis(message: &Message, language: Language) -> Analysis {
    Analysis {
        findings: vec![ProgramFinding {
            program: ProgramId::External,
            at: None,
            severity: Severity::Error,
            code: message.id().name().to_owned(),
            text: message.text(language),
            fixes: Vec::new(),
        }],
        end: PreviewEnd::Alarm,
        time_s: 0.0,
        cutting_s: 0.0,
        extents: None,
        tools: Vec::new(),
        line_times: LineTimes::default(),
    }
}
