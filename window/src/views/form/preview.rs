//! Cuts the part of a form in a background thread, with the check of `check --part`.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, unbounded};
use crossbeam::queue::ArrayQueue;
use egui::Context;
use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::memory::{Offsets, ToolOffset};
use gsk_core::preview::WorkBudget;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_forms::{FormValues, form_job, nose_offset, whole_program};
use gsk_host::kernel::Console;
use gsk_host::platform;
use gsk_host::preview::work_limit::WorkLimit;
use gsk_messages::Language;
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_runner::report::{PartReport, ProgramReport, check_program};

use crate::views::machine::path::PathBuilder;
use crate::views::machine::still_picture::StillPicture;

/// Limit of the work of one preview.
const WORK_BUDGET: WorkBudget = WorkBudget::interactive(200_000);
/// The number of the program in which the section is checked.
const PROGRAM_NUMBER: u16 = 1;

/// A section to preview.
#[derive(Clone)]
pub struct PreviewOrder {
    /// Incremented by each change of the form.
    pub revision: u64,
    pub values: FormValues,
    pub section: String,
    pub language: Language,
}

/// The part of a form and what the check has found.
pub struct FormPreview {
    pub revision: u64,
    pub picture: StillPicture,
    /// Whether the tool post is on the far side of the spindle.
    pub rear: bool,
    /// Alarms, collisions and warnings, in the language of the order.
    pub findings: Vec<String>,
    /// Machine time of the section, s.
    pub time_s: f64,
}

/// The window's handle of the thread, which ends when the handle is dropped.
pub struct FormPreviewer {
    orders: Sender<(PreviewOrder, Context)>,
    newest: Arc<AtomicU64>,
    results: Arc<ArrayQueue<FormPreview>>,
}

impl FormPreviewer {
    /// Starts the thread.
    pub fn new(console: &Console) -> Self {
        let (orders, from_view) = unbounded();
        let newest = Arc::new(AtomicU64::new(0));
        let results = Arc::new(ArrayQueue::new(1));
        let worker = FormWorker {
            console: console.clone(),
            orders: from_view,
            newest: Arc::clone(&newest),
            results: Arc::clone(&results),
        };
        // Without a thread there is no picture. The text is written all the same.
        let _ = platform::start_task("form", move || worker.run_once());
        Self {
            orders,
            newest,
            results,
        }
    }

    /// Requests the preview of a section; an older one is cancelled.
    pub fn request(&self, order: PreviewOrder, context: &Context) {
        self.newest.store(order.revision, Ordering::Relaxed);
        // The thread exists as long as this end of its channel.
        let _ = self.orders.send((order, context.clone()));
    }

    /// Removes and returns the newest preview; `None` without a new one.
    pub fn take_result(&self) -> Option<FormPreview> {
        self.results.pop()
    }
}

struct FormWorker {
    console: Console,
    orders: Receiver<(PreviewOrder, Context)>,
    newest: Arc<AtomicU64>,
    results: Arc<ArrayQueue<FormPreview>>,
}

impl FormWorker {
    /// Waits for an order and carries out the newest one. Returns `false` when the window's end
    /// of the channel is gone.
    fn run_once(&self) -> bool {
        let first = match platform::receive(&self.orders, None) {
            Ok(order) => order,
            Err(none) => return none == RecvTimeoutError::Timeout,
        };
        let (order, context) = self.orders.try_iter().last().unwrap_or(first);
        let is_newest = || self.newest.load(Ordering::Relaxed) == order.revision;
        let live = self.console.setup().unwrap_or_default();
        let preview = preview(&order, &live, &is_newest);
        if is_newest() {
            self.results.force_push(preview);
            context.request_repaint();
        }
        true
    }
}

/// Checks and cuts a section on its stock, with the parameters of the control `live`. Offsets
/// are zero but for R and T of G41 and G42, and the tool starts far from the part.
fn preview(order: &PreviewOrder, live: &Setup, is_newest: &dyn Fn() -> bool) -> FormPreview {
    let mut setup = Setup::default().with_chuck();
    setup.memory = live.memory.clone();
    setup.memory.offsets = Offsets::default();
    if let Some(nose) = nose_offset(&order.values) {
        let offset = ToolOffset {
            r: nose.radius,
            t: nose.tip,
            ..ToolOffset::default()
        };
        // A number that the table lacks is an alarm of the program.
        let _ = setup.memory.offsets.set(nose.number, offset);
    }
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(whole_program(PROGRAM_NUMBER, &order.section)));
    programs.select(ProgramId::External);
    setup.memory.programs = programs;
    let mut machining = Machining::new(form_job(&order.values));
    let rates = RapidRates::from_memory(&setup.memory);
    let mut builder = PathBuilder::default();
    let mut add_move = |executed: &ExecutedMove| {
        machining.execute_move(executed, rates);
        builder.add_move(executed, Point::default(), rates);
    };
    let limit = WorkLimit::new(WORK_BUDGET);
    let language = order.language;
    let report = check_program("", &setup, Some(language), &mut add_move, &mut |progress| {
        limit.allows(progress) && is_newest()
    });
    let part = PartReport::new(&machining, None, false, Some(language));
    FormPreview {
        revision: order.revision,
        picture: StillPicture::new(
            builder.build(&setup.memory.programs, false),
            machining.scene().part().section(),
        ),
        rear: live.lathe.rear_tool_post,
        findings: findings(&report, &part, language),
        time_s: report.time_s,
    }
}

fn findings(report: &ProgramReport, part: &PartReport, language: Language) -> Vec<String> {
    let further = report.path.iter().flat_map(|path| &path.more_alarms);
    let alarms = report.alarm.iter().chain(further);
    let alarms = alarms.map(|alarm| alarm.sentence(Some(language)));
    let collisions = part.collisions.iter().map(|it| it.text.clone());
    let warnings = report.warnings.iter().map(|warning| warning.text.clone());
    alarms.chain(collisions).chain(warnings).collect()
}
