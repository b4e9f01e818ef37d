//! Checks the typed text in a background thread: which words raise alarms.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, unbounded};
use crossbeam::queue::ArrayQueue;
use egui::Context;
use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_core::preview::{Caution, PreviewEnd, WorkBudget};
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_host::kernel::Console;
use gsk_host::platform;
use gsk_host::preview::work_limit::WorkLimit;
use gsk_language::locate_alarm;
use gsk_messages::{Language, Message};
use gsk_runner::program_summary::{self, ProgramSummary};
use gsk_runner::report::AlarmReport;

/// Limit of the work of one check.
const WORK_BUDGET: WorkBudget = WorkBudget::interactive(20_000_000);

/// An alarm that a check of the text has found.
#[derive(Clone, Debug, PartialEq)]
pub struct TextFinding {
    /// Line of the alarm in the text, from 0; `None` if the alarm is in another program.
    pub line: Option<usize>,
    /// The range of characters in the line, from 0, that raise the alarm.
    pub columns: Range<usize>,
    /// The report of the alarm in Chinese, then in English.
    reports: [AlarmReport; 2],
}

impl TextFinding {
    /// Returns the report of the alarm in a language.
    pub const fn report(&self, language: Language) -> &AlarmReport {
        match language {
            Language::Zh => &self.reports[0],
            Language::En => &self.reports[1],
        }
    }
}

/// The result of checking a program text.
#[derive(Clone, Debug, PartialEq)]
pub struct TextCheck {
    /// The revision of the text that was checked.
    pub revision: u64,
    /// The alarms in the order of execution.
    pub findings: Vec<TextFinding>,
    /// Texts of likely mistakes that raise no alarm, each with its line.
    pub warnings: Vec<Message>,
    /// The summary of the program: time, tools and bounds.
    pub first_look: ProgramSummary,
    /// The numbers of the programs in the control's memory.
    pub stored_programs: Vec<u16>,
}

impl TextCheck {
    /// Whether the check stopped at its limit before the end of the program.
    pub fn is_incomplete(&self) -> bool {
        self.first_look.end == PreviewEnd::Limit
    }
}

/// A text that waits to be checked.
struct CheckJob {
    revision: u64,
    /// The name that is used for a program without a number.
    name: String,
    text: String,
    context: Context,
}

/// Checks texts in a background thread, only the newest one.
pub struct TextChecker {
    jobs: Sender<CheckJob>,
    newest: Arc<AtomicU64>,
    /// The revision of the text that was sent to the thread last; `None` forces the next one.
    sent_revision: Option<u64>,
    results: Arc<ArrayQueue<TextCheck>>,
}

impl TextChecker {
    /// Starts the checker thread.
    pub fn new(console: &Console) -> Self {
        let (jobs, from_view) = unbounded();
        let newest = Arc::new(AtomicU64::new(0));
        let results = Arc::new(ArrayQueue::new(1));
        let worker = CheckWorker {
            console: console.clone(),
            jobs: from_view,
            newest: Arc::clone(&newest),
            results: Arc::clone(&results),
        };
        // Without a thread nothing is marked in the text. Nothing else depends on it.
        let _ = platform::start_task("program view", move || worker.run_once());
        Self {
            jobs,
            newest,
            sent_revision: None,
            results,
        }
    }

    /// Sends a text to the thread, unless the text of this revision was sent already. `text`
    /// returns the name of the program and its text.
    pub fn request_check(
        &mut self,
        revision: u64,
        context: &Context,
        text: impl FnOnce() -> (String, String),
    ) {
        if self.sent_revision == Some(revision) {
            return;
        }
        self.sent_revision = Some(revision);
        self.newest.store(revision, Ordering::Relaxed);
        let (name, text) = text();
        // The thread exists as long as this end of its channel.
        let _ = self.jobs.send(CheckJob {
            revision,
            name,
            text,
            context: context.clone(),
        });
    }

    /// Makes the next call of [`Self::request_check`] send the text even if its revision is
    /// the same.
    pub const fn force_next_check(&mut self) {
        self.sent_revision = None;
    }

    /// Removes and returns the result of the last check; `None` without a new one.
    pub fn take_result(&self) -> Option<TextCheck> {
        self.results.pop()
    }
}

struct CheckWorker {
    console: Console,
    jobs: Receiver<CheckJob>,
    newest: Arc<AtomicU64>,
    results: Arc<ArrayQueue<TextCheck>>,
}

impl CheckWorker {
    /// Waits for a text and checks it. Returns `false` when the window's end of the channel is
    /// gone.
    fn run_once(&self) -> bool {
        let first = match platform::receive(&self.jobs, None) {
            Ok(job) => job,
            Err(none) => return none == RecvTimeoutError::Timeout,
        };
        let job = self.jobs.try_iter().last().unwrap_or(first);
        let setup = self.console.setup().unwrap_or_default();
        let is_newest = || self.newest.load(Ordering::Relaxed) == job.revision;
        let limit = WorkLimit::new(WORK_BUDGET);
        let checked = check_text(&job, setup, &mut |progress| {
            limit.allows(progress) && is_newest()
        });
        if is_newest() {
            self.results.force_push(checked);
            job.context.request_repaint();
        }
        true
    }
}

fn check_text(
    job: &CheckJob,
    mut setup: Setup,
    may_continue: &mut dyn FnMut(&gsk_core::preview::PreviewProgress) -> bool,
) -> TextCheck {
    let program = Program::new(job.text.as_str());
    let name = program.number();
    let naming = setup.memory.model.record().program_naming();
    let name = name.map_or_else(|| job.name.clone(), |number| naming.name(number));
    let programs = &mut setup.memory.programs;
    let memory = programs.iter().map(|(number, _)| number).collect();
    programs.open_external(program.clone());
    programs.select(ProgramId::External);
    let (look, alarms, cautions) =
        program_summary::summarize_past_alarms(name, &setup, may_continue);
    let programs = &setup.memory.programs;
    TextCheck {
        revision: job.revision,
        findings: alarms
            .iter()
            .map(|alarm| to_finding(alarm, programs, &program))
            .collect(),
        warnings: cautions.iter().map(Caution::message_with_line).collect(),
        first_look: look,
        stored_programs: memory,
    }
}

fn to_finding(alarm: &Alarm, programs: &ProgramMemory, program: &Program) -> TextFinding {
    let reports = [Language::Zh, Language::En]
        .map(|language| AlarmReport::new(alarm, programs, Some(language)));
    let here = alarm
        .source
        .filter(|source| source.program == ProgramId::External);
    let at = here.and_then(|_| locate_alarm(alarm, |line| program.line(line)));
    let columns = at.as_ref().map_or(0..1, |at| {
        let line = program.line(at.line);
        let characters = |byte| line.get(..byte).map_or(0, |before| before.chars().count());
        let from = characters(at.bytes.start);
        from..characters(at.bytes.end).max(from + 1)
    });
    let line = at.map(|at| at.line);
    TextFinding {
        line: line.map(|line| line.saturating_sub(1) as usize),
        columns,
        reports,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_program(text: &str) -> TextCheck {
        let job = CheckJob {
            revision: 7,
            name: "part.CNC".to_owned(),
            text: text.to_owned(),
            context: Context::default(),
        };
        check_text(&job, Setup::default(), &mut |progress| {
            progress.moves < 1000
        })
    }

    #[test]
    fn alarms_are_at_their_words() {
        let checked = check_program("O0001\nG00 X20 Z2\nG01 Z-5\nX30.12345 F100\nM30\n");
        assert_eq!(checked.revision, 7);
        let [first, ..] = &checked.findings[..] else {
            panic!("{checked:?}");
        };
        assert_eq!((first.line, first.columns.clone()), (Some(2), 0..7));
        assert_eq!(first.report(Language::En).number, 11);
        assert!(first.report(Language::Zh).way_out.is_some());
        let profile = check_program(
            "T0101 M03 S500\nG00 X62 Z2\nG71 U2 R1\nG71 P1 Q2 U1 F100\nN1 G00 X20\nG01 Z-9\n\
             N2 G02 X40 Z-45 R2\nM30\n",
        );
        assert_eq!(profile.findings[0].line, Some(6), "{profile:?}");
        let syntax = check_program("G00 X20 ?\nM30\n");
        let [first, ..] = &syntax.findings[..] else {
            panic!("{syntax:?}");
        };
        assert_eq!((first.line, first.columns.clone()), (Some(0), 8..9));
    }

    #[test]
    fn a_right_program_has_none_and_one_without_end_says_so() {
        let right = check_program("G00 X20 Z2\nG01 Z-5 F100\nM30\n");
        assert!(right.findings.is_empty() && !right.is_incomplete());
        assert!(check_program("N1 G01 U1 F6000\nU-1\nG65 H80 P1\n").is_incomplete());
    }
}
