//! Carries the selected program out beside the window: its path, its times, and the job
//! of its part. It looks again when the program, an offset or a parameter has changed.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, unbounded};
use crossbeam::queue::ArrayQueue;
use egui::Context;
use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_core::memory::{Offsets, Parameters};
use gsk_core::preview::{End, WorkBudget, preview_explained, preview_while};
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_messages::Message;
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::ideal::{self, Compared};
use gsk_runner::machining::{Machining, guess};
use gsk_runner::times::Times;
use gsk_workpiece::job::Job;
use web_time::{Duration, Instant};

use super::path::{Block, Builder, Path};
use super::xray;
use crate::job::{self, Chosen};
use crate::kernel::{Command, Console};
use crate::platform;
use crate::window::samples;
use crate::work_limit::WorkLimit;

/// How often the control is asked whether something has changed.
const LOOKS: Duration = Duration::from_millis(100);
/// How soon a path that grows is handed over first, and how often then.
const FIRST_NEWS: Duration = Duration::from_millis(30);
const NEWS: Duration = Duration::from_millis(200);
/// Work of carrying a program out.
const BUDGET: WorkBudget = WorkBudget::interactive(5_000_000);

/// What came of a program.
#[derive(Clone, Debug, Default)]
pub struct Made {
    /// Its path.
    pub path: Arc<Path>,
    /// Where its time goes.
    pub times: Times,
    /// The alarm that ends it.
    pub alarm: Option<Alarm>,
    /// The block of a profile that breaks a rule of its cycle; the path is then that of
    /// the profile, without the cycle.
    pub fault: Option<Block>,
    /// It is another text than the control's.
    pub tried: bool,
    /// No program says what is cut: the job is one to learn on.
    pub practice: bool,
    /// What is wrong with its job file.
    pub trouble: Option<Message>,
    /// The file of the program.
    pub file: Option<PathBuf>,
    /// The tool post is behind the spindle.
    pub rear: bool,
    /// Counts programs: with another one the picture is fitted again.
    pub serial: u64,
}

/// What the window says to the worker.
#[derive(Debug)]
pub struct Shared {
    /// A program runs: what it writes makes no other path.
    pub running: AtomicBool,
    /// What is in work is old.
    pub newer: AtomicU64,
}

/// What the window asks of the worker.
enum Request {
    /// A program was opened from a file.
    Opened(ProgramId, PathBuf),
    /// The part that is meant, beside the one that comes of the program.
    Compare(Arc<Job>),
    /// Stock and tools that a person changed.
    Clamp(Box<Job>),
    /// Another text for a program, which the control does not have; none: its own.
    Try(Option<(ProgramId, Program)>),
}

/// The worker's end in the window; it ends with it.
pub struct Worker {
    requests: Sender<Request>,
    results: Arc<ArrayQueue<Made>>,
    compared: Arc<ArrayQueue<Arc<Compared>>>,
    /// What the window says to it.
    pub shared: Arc<Shared>,
}

impl Worker {
    /// Starts it.
    pub fn start(console: &Console, context: &Context, changed: &Changed) -> Self {
        let (requests, from_view) = unbounded();
        let results = Arc::new(ArrayQueue::new(1));
        let compared = Arc::new(ArrayQueue::new(1));
        let shared = Arc::new(Shared {
            running: AtomicBool::new(false),
            newer: AtomicU64::new(0),
        });
        let mut work = Work {
            console: console.clone(),
            context: context.clone(),
            requests: from_view,
            results: Arc::clone(&results),
            compared: Arc::clone(&compared),
            shared: Arc::clone(&shared),
            file: None,
            tried: None,
            changed: Arc::clone(changed),
            last: None,
            serial: 0,
        };
        // Without a thread for it there is no path to be seen, and no more is wrong.
        let _ = platform::turn("lathe view", move || work.turn());
        Self {
            requests,
            results,
            compared,
            shared,
        }
    }

    /// A program was opened from a file.
    pub fn opened(&self, program: ProgramId, file: PathBuf) {
        self.shared.newer.fetch_add(1, Ordering::Relaxed);
        let _ = self.requests.send(Request::Opened(program, file));
    }

    /// Compares what is meant with what comes of it.
    pub fn compare(&self, job: Arc<Job>) {
        let _ = self.requests.send(Request::Compare(job));
    }

    /// Clamps other stock and mounts other tools; they belong to the program from now on.
    pub fn clamp(&self, job: Job) {
        let _ = self.requests.send(Request::Clamp(Box::new(job)));
    }

    /// Carries out another text of a program than the control has.
    pub fn try_out(&self, text: Option<(ProgramId, Program)>) {
        self.shared.newer.fetch_add(1, Ordering::Relaxed);
        let _ = self.requests.send(Request::Try(text));
    }

    /// The newest comparison.
    pub fn compared(&self) -> Option<Arc<Compared>> {
        self.compared.pop()
    }

    /// The newest result.
    pub fn result(&self) -> Option<Made> {
        self.results.pop()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.shared.newer.fetch_add(1, Ordering::Relaxed);
    }
}

/// What a path depends on.
#[derive(Clone, Debug, PartialEq)]
struct Basis {
    program: Option<(ProgramId, Program)>,
    tried: Option<(ProgramId, Program)>,
    /// The job as a person changed it.
    changed: Option<Job>,
    file: Option<PathBuf>,
    offsets: Offsets,
    parameters: Parameters,
}

struct Work {
    console: Console,
    context: Context,
    requests: Receiver<Request>,
    results: Arc<ArrayQueue<Made>>,
    compared: Arc<ArrayQueue<Arc<Compared>>>,
    shared: Arc<Shared>,
    /// The file that was opened last, and the program made of it.
    file: Option<(ProgramId, PathBuf)>,
    /// The text that is tried out, and the program it is another one of.
    tried: Option<(ProgramId, Program)>,
    /// Jobs that a person changed, by their programs.
    changed: Changed,
    last: Option<Basis>,
    serial: u64,
}

/// Whose job it is: a program, and its file.
type Owner = (Option<ProgramId>, Option<PathBuf>);

/// Jobs that a person changed; they outlast the worker.
pub type Changed = Arc<Mutex<Vec<(Owner, Chosen)>>>;

impl Work {
    /// Looks once and waits for the next request; `false` when none can come any more.
    fn turn(&mut self) -> bool {
        if !self.shared.running.load(Ordering::Relaxed)
            && let Some(setup) = self.console.setup()
        {
            self.look(setup);
        }
        match platform::receive(&self.requests, Some(Instant::now() + LOOKS)) {
            Ok(request) => self.answer(request),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        // What came meanwhile counts before the next look.
        while let Ok(request) = self.requests.try_recv() {
            self.answer(request);
        }
        true
    }

    fn answer(&mut self, request: Request) {
        match request {
            Request::Opened(program, file) => self.file = Some((program, file)),
            Request::Compare(job) => self.compare(&job),
            Request::Try(tried) => self.tried = tried,
            Request::Clamp(job) => self.clamp(*job),
        }
    }

    fn look(&mut self, mut setup: Setup) {
        let programs = &setup.memory.programs;
        let program = programs
            .current()
            .and_then(|id| Some((id, programs.get(id)?.clone())));
        let file = self.file.as_ref().filter(|(id, _)| {
            let current = program.as_ref();
            current.is_some_and(|(current, _)| current == id)
        });
        let file = file.map(|(_, path)| path.clone());
        let owner = (program.as_ref().map(|(id, _)| *id), file.clone());
        let basis = Basis {
            program,
            tried: self.tried.clone(),
            changed: self.job_of(&owner),
            file,
            offsets: setup.memory.offsets.clone(),
            parameters: setup.memory.parameters.clone(),
        };
        if self.last.as_ref() == Some(&basis) {
            return;
        }
        let last = self.last.as_ref();
        let another =
            last.is_none_or(|last| last.program != basis.program || last.file != basis.file);
        if another {
            self.serial += 1;
        }
        self.put_in(&mut setup);
        if self.carry_out(&setup, &basis, another) {
            self.last = Some(basis);
        }
    }

    /// Carries a program out; `false` when it was overtaken.
    fn carry_out(&self, setup: &Setup, basis: &Basis, another: bool) -> bool {
        let begun = self.shared.newer.load(Ordering::Relaxed);
        let is_newest = || self.shared.newer.load(Ordering::Relaxed) == begun;
        let (read, trouble) = read_job(basis);
        let changed = basis.changed.clone().map(|job| changed_job(job, basis));
        let mut chosen = changed.or(read);
        let machining = chosen.as_ref().map(Chosen::machining);
        if another && let Some(chosen) = &chosen {
            self.send(Some(chosen.clone()));
        }
        let rates = RapidRates::of(&setup.memory);
        let limit = WorkLimit::new(BUDGET);
        let (mut news, mut pause) = (Instant::now(), FIRST_NEWS);
        let tried = basis.tried.as_ref().is_some_and(|(id, tried)| {
            let own = basis.program.as_ref().filter(|(own, _)| own == id);
            own.is_some_and(|(_, own)| own.text() != tried.text())
        });
        let mut made = Made {
            tried,
            trouble,
            file: basis.file.clone(),
            rear: setup.lathe.rear_tool_post,
            serial: self.serial,
            ..Made::default()
        };
        let programs = &setup.memory.programs;
        let (mut builder, mut first) = (Builder::default(), Vec::new());
        let mut times = Times::default();
        let preview = preview_explained(
            setup,
            programs,
            &mut |executed, why| {
                builder.explain(executed, why);
                builder.push(executed, shift(machining.as_ref(), executed), rates);
                times.push(executed);
                if chosen.is_none() && first.len() < guess::MOST_MOVES {
                    first.push(*executed);
                }
                if news.elapsed() > pause {
                    (news, pause) = (Instant::now(), NEWS);
                    made.path = Arc::new(builder.path(programs, true));
                    made.times = times.clone();
                    self.results.force_push(made.clone());
                    self.context.request_repaint();
                }
            },
            &mut |progress| limit.allows(progress) && is_newest(),
        );
        if !is_newest() {
            return false;
        }
        times.end(preview.time_s);
        let partial = preview.end == End::Limit;
        made.path = Arc::new(builder.path(programs, partial));
        made.times = times;
        // Without a program there is nothing to be wrong.
        made.practice = basis.program.is_none();
        made.alarm = preview.alarm.filter(|_| !made.practice);
        made.practice |= first.is_empty() && chosen.is_none() && made.alarm.is_none();
        let practice = made.practice;
        let fault = made.alarm.as_ref().and_then(|alarm| {
            let program = alarm.source?.program;
            let line = xray::line_in_profile(alarm, programs.get(program)?)?;
            Some(Block { program, line })
        });
        if let Some(fault) = fault {
            made.path = Arc::new(profile(setup, fault.program, machining.as_ref(), rates));
            made.fault = Some(fault);
        }
        self.results.force_push(made);
        self.context.request_repaint();
        if another && chosen.is_none() {
            let job = match practice {
                true => Some(guess::practice()),
                false => guess::guess(&first, &setup.memory.offsets, rates),
            };
            chosen = job.map(|job| Chosen { job, file: None });
            self.send(chosen);
        }
        true
    }

    fn job_of(&self, owner: &Owner) -> Option<Job> {
        let all = self.changed.lock().unwrap_or_else(PoisonError::into_inner);
        let found = all.iter().find(|(of, _)| of == owner);
        found.map(|(_, chosen)| chosen.job.clone())
    }

    fn clamp(&mut self, job: Job) {
        let Some(last) = &self.last else { return };
        let owner: Owner = (last.program.as_ref().map(|(id, _)| *id), last.file.clone());
        let chosen = changed_job(job, last);
        let mut all = self.changed.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|(of, _)| *of != owner);
        all.push((owner, chosen.clone()));
        drop(all);
        self.send(Some(chosen));
    }

    /// Puts the text that is tried out in the place of the program's.
    fn put_in(&self, setup: &mut Setup) {
        if let Some((id, text)) = &self.tried {
            put_in(&mut setup.memory.programs, *id, text);
        }
    }

    fn compare(&self, job: &Job) {
        let Some(mut setup) = self.console.setup() else {
            return;
        };
        self.put_in(&mut setup);
        let begun = self.shared.newer.load(Ordering::Relaxed);
        let limit = WorkLimit::new(BUDGET);
        let rates = RapidRates::of(&setup.memory);
        let compared = ideal::compare(&setup, job, rates, &mut |progress| {
            limit.allows(progress) && self.shared.newer.load(Ordering::Relaxed) == begun
        });
        if let Some(compared) = compared {
            self.compared.force_push(Arc::new(compared));
            self.context.request_repaint();
        }
    }

    fn send(&self, chosen: Option<Chosen>) {
        // Who closed the view has said that there is no job.
        self.console.send(Command::Job(chosen.map(Box::new)));
    }
}

/// The path of a program whose cycle finds a rule of its profile broken.
fn profile(
    setup: &Setup,
    program: ProgramId,
    machining: Option<&Machining>,
    rates: RapidRates,
) -> Path {
    let mut setup = setup.clone();
    let programs = &mut setup.memory.programs;
    if let Some(text) = programs.get(program).map(xray::without_profile_cycles) {
        put_in(programs, program, &text);
    }
    let limit = WorkLimit::new(BUDGET);
    let mut builder = Builder::default();
    preview_while(
        &setup,
        &setup.memory.programs,
        &mut |executed| builder.push(executed, shift(machining, executed), rates),
        &mut |progress| limit.allows(progress),
    );
    builder.path(&setup.memory.programs, false)
}

/// Puts another text in the place of the selected program's.
fn put_in(programs: &mut ProgramMemory, id: ProgramId, text: &Program) {
    if programs.current() != Some(id) {
        return;
    }
    match id {
        ProgramId::Stored(number) => {
            let before = programs.clone();
            // Under another number it would be another program.
            if programs.store(text.text()).ok() != Some(number) {
                *programs = before;
            }
        }
        ProgramId::External => programs.open_external(text.clone()),
        ProgramId::Mdi | ProgramId::Dnc => {}
    }
    programs.select(id);
}

/// A job that a person changed; it is of a file as soon as there is one.
fn changed_job(job: Job, basis: &Basis) -> Chosen {
    let file = basis.file.as_deref().map(job::beside);
    Chosen {
        job,
        file: file.filter(|path| path.exists()),
    }
}

/// The job of the file beside the program, and what is wrong with it.
fn read_job(basis: &Basis) -> (Option<Chosen>, Option<Message>) {
    let beside = basis.file.as_deref().map(job::beside);
    let Some(path) = beside.filter(|path| path.exists()) else {
        let program = basis.program.as_ref();
        return (
            program.and_then(|(_, program)| samples::job_of(program)),
            None,
        );
    };
    match job::read(&path) {
        Ok(job) => {
            let file = Some(path);
            (Some(Chosen { job, file }), None)
        }
        Err(error) => (None, Some(error.message())),
    }
}

/// From program to part coordinates: nothing, unless the job knows where the part is.
fn shift(machining: Option<&Machining>, executed: &gsk_core::command::ExecutedMove) -> Point {
    let Some(machining) = machining else {
        return Point::default();
    };
    let conditions = &executed.conditions;
    let zero = machining
        .mounting()
        .zero_of(conditions.tool, &conditions.frame);
    conditions.frame.machine(Point::default()) - zero
}
