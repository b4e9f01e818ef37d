//! The thread that analyses programs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crossbeam::channel::{Receiver, Sender, unbounded};
use gsk_core::command::ProgramId;
use gsk_core::preview::{End, WorkBudget};
use gsk_core::program::Program;
use gsk_language::{
    Analysis, LineTimes, ProgramFinding, Severity, Structure, TextDocument, analyse, analyse_mill,
};
use gsk_messages::{Language, Message, say};
use lsp_types::Uri;

use super::Control;
use crate::files::subprograms::{Calls, Found};
use crate::loading;
use crate::work_limit::WorkLimit;

/// Work budget of one analysis.
const BUDGET: WorkBudget = WorkBudget::interactive(20_000_000);

/// A text to be analysed.
pub struct Job {
    pub uri: Uri,
    /// Version of the document.
    pub version: i32,
    /// `None` if the document was never saved.
    pub path: Option<PathBuf>,
    pub text: Arc<TextDocument>,
    /// Called programs of other files.
    pub found: Arc<Vec<Found>>,
    /// False cancels the job.
    pub wanted: Arc<AtomicBool>,
}

/// The result of a job.
pub struct Looked {
    pub uri: Uri,
    /// Version of the document that was analysed.
    pub version: i32,
    pub structure: Arc<Structure>,
    /// The findings; if the program cannot be loaded, the reason is the only one.
    pub analysis: Arc<Analysis>,
}

/// Starts the thread. It takes jobs from the sender, returns results through the receiver,
/// and ends when the sender is dropped.
pub fn start(control: Control, language: Language) -> (Sender<Job>, Receiver<Looked>) {
    let (jobs, from_server) = unbounded::<Job>();
    let (to_server, looked) = unbounded();
    thread::spawn(move || {
        for job in from_server {
            if !job.wanted.load(Ordering::Relaxed) {
                continue;
            }
            // Structure and analysis are independent: both take long for a long text.
            let (structure, analysis) = thread::scope(|side_by_side| {
                let structure = side_by_side.spawn(|| Structure::read(&job.text));
                let analysis = look(&control, &job, language);
                let read_anew = |_| Structure::read(&job.text);
                (structure.join().unwrap_or_else(read_anew), analysis)
            });
            // The server may have ended.
            if job.wanted.load(Ordering::Relaxed) {
                let _ = to_server.send(Looked {
                    uri: job.uri,
                    version: job.version,
                    structure: Arc::new(structure),
                    analysis: Arc::new(analysis),
                });
            }
        }
    });
    (jobs, looked)
}

fn look(control: &Control, job: &Job, language: Language) -> Analysis {
    let mut setup = control.setup.clone();
    let unsaved = || PathBuf::from(job.uri.as_str());
    let path = job.path.clone().unwrap_or_else(unsaved);
    let found = |_: Calls, loaded: &BTreeSet<u16>| {
        let new = |it: &&Found| !loaded.contains(&it.number);
        job.found.iter().filter(new).cloned().collect()
    };
    let text = job.text.as_str().to_owned();
    let opened = loading::open_text(&mut setup, &path, text, found);
    let notices = match opened {
        Ok(notices) => notices.0,
        Err(error) => return not_loaded(&error.message(), language),
    };
    let limit = WorkLimit::new(BUDGET);
    let mut goes_on = |progress: &_| limit.allows(progress) && job.wanted.load(Ordering::Relaxed);
    let mut analysis = match &control.mill {
        Some(mill) => {
            let programs = &setup.memory.programs;
            analyse_mill(mill, programs, language, &mut goes_on)
        }
        None => analyse(&setup, language, &mut goes_on),
    };
    let external = setup.memory.programs.external();
    let full_width = external.and_then(Program::full_width_line);
    let full_width = full_width.map(|line| say::file_full_width(short(&path), line));
    let notices = notices.into_iter().chain(full_width);
    analysis
        .findings
        .extend(notices.map(|notice| ProgramFinding {
            program: ProgramId::External,
            at: None,
            severity: Severity::Warning,
            code: notice.id().name().to_owned(),
            text: notice.text(language),
        }));
    analysis
}

fn short(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// The analysis of a program that cannot be loaded.
fn not_loaded(message: &Message, language: Language) -> Analysis {
    Analysis {
        findings: vec![ProgramFinding {
            program: ProgramId::External,
            at: None,
            severity: Severity::Error,
            code: message.id().name().to_owned(),
            text: message.text(language),
        }],
        end: End::Alarm,
        time_s: 0.0,
        cutting_s: 0.0,
        extents: None,
        tools: Vec::new(),
        line_times: LineTimes::default(),
    }
}
