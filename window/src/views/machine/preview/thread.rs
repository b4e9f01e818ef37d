//! Executes the selected program in a background thread. Runs again when the program, an offset, a
//! parameter or the place of the slides has changed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use crossbeam::channel::{Receiver, RecvTimeoutError};
use egui::Context;
use gsk_core::command::{MoveKind, ProgramId};
use gsk_core::memory::{ControlParameters, Offsets};
use gsk_core::preview::{PreviewEnd, preview_explained};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_host::job::SelectedJob;
use gsk_host::kernel::{Command, Console, PreviewSetup};
use gsk_host::platform;
use gsk_host::preview::work_limit::WorkLimit;
use gsk_messages::Message;
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::{Machining, guess, part_comparison};
use gsk_runner::times::ProgramTimes;
use gsk_workpiece::job::Job;
use web_time::{Duration, Instant};

use super::super::load_curve::LoadCurve;
use super::super::path::{BlockRef, PathBuilder};
use super::super::xray;
use super::changed_jobs::{ChangedJobs, JobOwner, choose_job};
use super::exchange::{PreviewOutputs, PreviewRequest, PreviewResult, WorkerFlags};
use super::placed_path::{
    PathPlace, WORK_BUDGET, build_path, build_profile_path, micrometres, replace_program_text,
    work_zero,
};

/// Interval at which the worker checks the control for changes.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);
/// Time until a growing path is sent for the first time. The constant after it is the interval
/// of the further times.
const FIRST_UPDATE_DELAY: Duration = Duration::from_millis(30);
const UPDATE_INTERVAL: Duration = Duration::from_millis(200);

/// The inputs of an execution. The worker executes the program again when one of them changes.
#[derive(Clone, Debug, PartialEq)]
struct PreviewInputs {
    program: Option<(ProgramId, Program)>,
    tried: Option<(ProgramId, Program)>,
    /// The job that the user has changed; `None` if it is unchanged.
    changed_job: Option<Job>,
    file: Option<PathBuf>,
    offsets: Offsets,
    parameters: ControlParameters,
    /// Machine coordinates of the work zero before the program runs, µm.
    zero: [i64; 2],
    /// Machine coordinates of the slides before the program runs, µm; `None` if the job does not
    /// give the place of part or chuck, so that the path does not depend on them.
    slides: Option<[i64; 2]>,
}

impl PreviewInputs {
    /// Returns the job of the program, and the error in its file.
    fn job(&self) -> (Option<SelectedJob>, Option<Message>) {
        let program = self.program.as_ref().map(|(_, program)| program);
        choose_job(program, self.changed_job.as_ref(), self.file.as_deref())
    }
}

/// The work of the preview thread.
pub(super) struct PreviewThread {
    console: Console,
    context: Context,
    requests: Receiver<PreviewRequest>,
    outputs: PreviewOutputs,
    flags: Arc<WorkerFlags>,
    /// The program that was opened last from a file, and the path of this file; `None` before the
    /// first one.
    file: Option<(ProgramId, PathBuf)>,
    /// The program that is executed with another text than the control's, and this text; `None`
    /// without a trial.
    tried: Option<(ProgramId, Program)>,
    /// Jobs that the user has changed, by their programs.
    changed_jobs: ChangedJobs,
    /// Machine coordinates of the slides at the last check, µm.
    checked_slides: [i64; 2],
    /// The inputs of the path that was sent to the window last; `None` before the first one.
    last_inputs: Option<PreviewInputs>,
    /// The program and the file whose job the kernel has; `None` before the first job.
    job_owner: Option<ProgramAndFile>,
    /// The job that was sent to the kernel last; `None` if the next one is sent in any case.
    sent_job: Option<SelectedJob>,
    /// Whether the kernel's job gives the place of the part, or its chuck is empty.
    is_place_known: bool,
    /// The program and the file whose path the window has; `None` before the first path.
    shown_owner: Option<ProgramAndFile>,
    program_count: u64,
}

/// A program with its text, and the file from which it was opened.
type ProgramAndFile = (Option<(ProgramId, Program)>, Option<PathBuf>);

impl PreviewThread {
    /// Creates the work for a console and the context of its window. `changed_jobs` holds the jobs
    /// that the user has changed.
    pub fn new(
        (console, context): (Console, Context),
        requests: Receiver<PreviewRequest>,
        outputs: PreviewOutputs,
        flags: Arc<WorkerFlags>,
        changed_jobs: ChangedJobs,
    ) -> Self {
        Self {
            console,
            context,
            requests,
            outputs,
            flags,
            file: None,
            tried: None,
            changed_jobs,
            checked_slides: [0; 2],
            last_inputs: None,
            job_owner: None,
            sent_job: None,
            is_place_known: false,
            shown_owner: None,
            program_count: 0,
        }
    }

    /// Executes the program if its inputs have changed, and waits for the next request.
    /// Returns `false` when the window's handle is dropped.
    pub fn run_once(&mut self) -> bool {
        if !self.flags.program_runs.load(Ordering::Relaxed)
            && let Some(setup) = self.console.preview_setup()
        {
            self.preview_if_changed(setup);
        }
        match platform::receive(&self.requests, Some(Instant::now() + CHECK_INTERVAL)) {
            Ok(request) => self.handle_request(request),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        // Requests that arrived in the meantime take effect before the next execution.
        while let Ok(request) = self.requests.try_recv() {
            self.handle_request(request);
        }
        true
    }

    fn handle_request(&mut self, request: PreviewRequest) {
        match request {
            PreviewRequest::Opened(program, file) => {
                self.file = Some((program, file));
                // A text that was opened begins on fresh stock.
                self.sent_job = None;
            }
            PreviewRequest::Compare(job) => self.compare(&job),
            PreviewRequest::ComputeLoad(job) => self.compute_load(&job),
            PreviewRequest::SetTrial(tried) => self.tried = tried,
            PreviewRequest::Clamp(job) => self.clamp(&job),
            PreviewRequest::Reopened(program) => {
                self.file.take_if(|(id, _)| *id == program);
                if self.changed_jobs.forget(&(Some(program), None)) {
                    self.job_owner = None;
                }
            }
        }
    }

    fn preview_if_changed(&mut self, mut current: PreviewSetup) {
        let setup = &current.setup;
        let programs = &setup.memory.programs;
        let program = programs
            .selected()
            .and_then(|id| Some((id, programs.get(id)?.clone())));
        let file = self.file.as_ref().filter(|(id, _)| {
            let current = program.as_ref();
            current.is_some_and(|(current, _)| current == id)
        });
        let file = file.map(|(_, path)| path.clone());
        let owner = (program.as_ref().map(|(id, _)| *id), file.clone());
        let had_none = self
            .last_inputs
            .as_ref()
            .is_some_and(|last| last.program.is_none());
        if had_none && let Some((_, program)) = &program {
            self.changed_jobs.keep_clamped_stock(program, &owner);
        }
        let basis = PreviewInputs {
            program,
            tried: self.tried.clone(),
            changed_job: self.changed_jobs.find(&owner),
            file,
            offsets: setup.memory.offsets.clone(),
            parameters: setup.memory.parameters.clone(),
            zero: match &self.last_inputs {
                Some(last) if current.is_running => last.zero,
                _ => work_zero(setup),
            },
            slides: self.slides_at_rest(&current),
        };
        if self.last_inputs.as_ref() == Some(&basis) {
            return;
        }
        let shown = (basis.program.clone(), basis.file.clone());
        let another = self.shown_owner.as_ref() != Some(&shown);
        // The part of a practice machine belongs to its lesson. The learner's own part keeps its
        // job, its cuts and its collisions.
        let needs_job = !current.is_practice && self.job_owner.as_ref() != Some(&shown);
        let visible = self.flags.visible.load(Ordering::Relaxed);
        if !needs_job && !visible {
            return;
        }
        if another {
            self.program_count += 1;
        }
        self.apply_trial(&mut current.setup);
        if !visible && let (Some(chosen), _) = basis.job() {
            self.send_job_of(&shown, Some(chosen));
            self.job_owner = Some(shown);
        } else if self.run_preview(&current, &basis, needs_job) {
            if needs_job {
                self.job_owner = Some(shown.clone());
            }
            self.shown_owner = Some(shown);
            self.last_inputs = Some(basis);
        }
    }

    /// The slides' position for the path of a program whose job gives the place of part or chuck:
    /// the last one at rest before it runs.
    fn slides_at_rest(&mut self, current: &PreviewSetup) -> Option<[i64; 2]> {
        if !self.is_place_known {
            return None;
        }
        let coordinates = current.setup.start.unwrap_or_default();
        let now = micrometres(coordinates + current.slide_shift);
        let is_at_rest = core::mem::replace(&mut self.checked_slides, now) == now;
        let last = self.last_inputs.as_ref().and_then(|last| last.slides);
        if current.is_running || !is_at_rest {
            last
        } else {
            Some(now)
        }
    }

    /// Executes a program and sends its path to the window; returns `false` if a newer request
    /// has cancelled it.
    fn run_preview(
        &mut self,
        current: &PreviewSetup,
        inputs: &PreviewInputs,
        needs_job: bool,
    ) -> bool {
        let setup = &current.setup;
        let flags = Arc::clone(&self.flags);
        let start_count = flags.cancel_count.load(Ordering::Relaxed);
        let is_newest = || flags.cancel_count.load(Ordering::Relaxed) == start_count;
        let (mut chosen, trouble) = inputs.job();
        let machining = chosen.as_ref().map(SelectedJob::create_machining);
        let shown = (inputs.program.clone(), inputs.file.clone());
        if needs_job && let Some(chosen) = &chosen {
            self.send_job_of(&shown, Some(chosen.clone()));
        }
        let place = PathPlace {
            machining: machining.as_ref(),
            slide_shift: current.slide_shift,
        };
        let rates = RapidRates::from_memory(&setup.memory);
        let limit = WorkLimit::new(WORK_BUDGET);
        let (mut last_update, mut update_interval) = (Instant::now(), FIRST_UPDATE_DELAY);
        let tried = inputs.tried.as_ref().is_some_and(|(id, tried)| {
            let own = inputs.program.as_ref().filter(|(own, _)| own == id);
            own.is_some_and(|(_, own)| own.text() != tried.text())
        });
        let mut result = PreviewResult {
            is_trial: tried,
            job_file_error: trouble,
            program_file: inputs.file.clone(),
            is_practice_machine: current.is_practice,
            is_changed_job: inputs.changed_job.is_some() && !current.is_practice,
            // Jobs of files and of samples have a name.
            is_form_job: inputs.changed_job.is_none()
                && chosen.as_ref().is_some_and(|it| it.file.is_none()),
            rear_tool_post: setup.lathe.rear_tool_post,
            program_count: self.program_count,
            ..PreviewResult::default()
        };
        let programs = &setup.memory.programs;
        let (mut builder, mut first_moves) = (PathBuilder::default(), Vec::new());
        let mut times = ProgramTimes::default();
        let preview = preview_explained(
            setup,
            programs,
            &mut |executed, why| {
                builder.begin_pass(executed, why);
                builder.add_move(executed, place.shift_of(executed), rates);
                times.add_move(executed);
                if chosen.is_none() && first_moves.len() < guess::MAX_GUESS_MOVES {
                    first_moves.push(*executed);
                }
                if last_update.elapsed() > update_interval {
                    (last_update, update_interval) = (Instant::now(), UPDATE_INTERVAL);
                    result.path = Arc::new(builder.build(programs, true));
                    result.times = times.clone();
                    self.outputs.results.force_push(result.clone());
                    self.context.request_repaint();
                }
            },
            &mut |progress| limit.allows(progress) && is_newest(),
        );
        if !is_newest() {
            return false;
        }
        times.end_at(preview.time_s);
        let tools = preview.tools.iter().filter(|(tool, number)| {
            let row = setup.memory.offsets.get(*number);
            *tool > 0 && *number > 0 && row.x == 0.0 && row.z == 0.0
        });
        let tools: BTreeSet<u8> = tools.map(|(tool, _)| *tool).collect();
        result.unset_tools = tools.into_iter().collect();
        let partial = preview.end == PreviewEnd::Limit;
        result.path = Arc::new(builder.build(programs, partial));
        result.times = times;
        // The empty program of a control without one must not report an alarm.
        result.is_practice_job = inputs.program.is_none();
        result.alarm = preview.alarm.filter(|_| !result.is_practice_job);
        result.is_practice_job |=
            first_moves.is_empty() && chosen.is_none() && result.alarm.is_none();
        let practice = result.is_practice_job;
        let fault = result.alarm.as_ref().and_then(|alarm| {
            let program = alarm.source?.program;
            let line = xray::profile_line(alarm, programs.get(program)?)?;
            Some(BlockRef { program, line })
        });
        if let Some(fault) = fault {
            result.path = Arc::new(build_profile_path(setup, fault.program, place, rates));
            result.fault_block = Some(fault);
        }
        let cuts_nothing = chosen.is_none()
            && !practice
            && result.alarm.is_none()
            && first_moves
                .iter()
                .all(|it| matches!(it.kind, MoveKind::Rapid | MoveKind::Dwell));
        if cuts_nothing {
            // The tool moves in front of the empty chuck.
            let lathe = Machining::new(guess::empty_chuck_job(&setup.lathe));
            let in_front = PathPlace {
                machining: Some(&lathe),
                ..place
            };
            result.path = Arc::new(build_path(setup, in_front, rates));
        }
        self.outputs.results.force_push(result);
        self.context.request_repaint();
        if needs_job && chosen.is_none() {
            let job = match practice {
                true => Some(guess::practice_job(&setup.lathe)),
                false => guess::guess_job(&first_moves, &setup.memory.offsets, rates),
            };
            chosen = job.map(|job| SelectedJob { job, file: None });
            self.send_job_of(&shown, chosen);
        }
        true
    }

    fn clamp(&mut self, job: &Job) {
        // Only the open view clamps, and it has been handed a path.
        let Some(last) = &self.last_inputs else {
            return;
        };
        let owner: JobOwner = (last.program.as_ref().map(|(id, _)| *id), last.file.clone());
        let program = last.program.as_ref().map(|(_, program)| program);
        let (chosen, _) = choose_job(program, Some(job), owner.1.as_deref());
        let Some(chosen) = chosen else { return };
        self.changed_jobs.keep(owner, chosen.clone());
        let sent = self.sent_job.as_ref().map(|sent| &sent.job);
        match sent.is_some_and(|sent| has_same_part(sent, &chosen.job)) {
            true => {
                self.sent_job = Some(chosen.clone());
                self.console.send(Command::Tools(Box::new(chosen)));
            }
            false => self.send_job(Some(chosen)),
        }
    }

    /// Replaces the text of the program in the setup with the text of the trial, if there is
    /// one.
    fn apply_trial(&self, setup: &mut Setup) {
        if let Some((id, text)) = &self.tried {
            replace_program_text(&mut setup.memory.programs, *id, text);
        }
    }

    fn compare(&self, job: &Job) {
        let Some(mut setup) = self.console.setup() else {
            return;
        };
        self.apply_trial(&mut setup);
        let start_count = self.flags.cancel_count.load(Ordering::Relaxed);
        let limit = WorkLimit::new(WORK_BUDGET);
        let rates = RapidRates::from_memory(&setup.memory);
        let compared = part_comparison::compare_parts(&setup, job, rates, &mut |progress| {
            limit.allows(progress) && self.flags.cancel_count.load(Ordering::Relaxed) == start_count
        });
        if let Some(compared) = compared {
            self.outputs.compared.force_push(Arc::new(compared));
            self.context.request_repaint();
        }
    }

    fn compute_load(&self, job: &Job) {
        let Some(mut setup) = self.console.setup() else {
            return;
        };
        self.apply_trial(&mut setup);
        let start_count = self.flags.cancel_count.load(Ordering::Relaxed);
        let limit = WorkLimit::new(WORK_BUDGET);
        let curve = LoadCurve::compute(&setup, job, &mut |progress| {
            limit.allows(progress) && self.flags.cancel_count.load(Ordering::Relaxed) == start_count
        });
        if let Some(curve) = curve {
            self.outputs.loads.force_push(Arc::new(curve));
            self.context.request_repaint();
        }
    }

    /// Sends the job of a program to the kernel. A program that was only edited keeps its part if
    /// its stock and tools are the same.
    fn send_job_of(&mut self, owner: &ProgramAndFile, chosen: Option<SelectedJob>) {
        let name =
            |(program, file): &ProgramAndFile| (program.as_ref().map(|(id, _)| *id), file.clone());
        let is_same_program = self.job_owner.as_ref().map(name) == Some(name(owner));
        if !is_same_program || chosen.is_none() || self.sent_job != chosen {
            self.send_job(chosen);
        }
    }

    fn send_job(&mut self, chosen: Option<SelectedJob>) {
        self.is_place_known = chosen.as_ref().is_none_or(|it| it.job.zero.is_some());
        self.sent_job.clone_from(&chosen);
        self.console.send(Command::Job(chosen.map(Box::new)));
    }
}

/// Whether two jobs differ in their tools alone: the part stays in the chuck where it is. A tool
/// that both have is as long in both.
fn has_same_part(one: &Job, other: &Job) -> bool {
    let is_common = |tool: &u8| one.tools.contains_key(tool) && other.tools.contains_key(tool);
    let without_tools = |job: &Job| Job {
        tools: BTreeMap::new(),
        library: BTreeMap::new(),
        rakes: BTreeMap::new(),
        lengths: (job.lengths.iter())
            .filter(|(tool, _)| is_common(tool))
            .map(|(tool, length)| (*tool, *length))
            .collect(),
        ..job.clone()
    };
    without_tools(one) == without_tools(other)
}

#[cfg(test)]
mod tests {
    use gsk_workpiece::stock::Stock;
    use gsk_workpiece::tool::Tool;

    use super::*;

    #[test]
    fn jobs_that_differ_in_tools_have_the_same_part() {
        let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        job.tools.insert(1, Tool::turning());
        job.lengths.insert(1, Default::default());
        let mut more = job.clone();
        more.tools.insert(3, Tool::grooving(3.0));
        more.lengths.insert(3, Default::default());
        assert!(has_same_part(&job, &more) && has_same_part(&more, &job));
        let mut without = job.clone();
        without.tools.clear();
        without.lengths.clear();
        assert!(has_same_part(&job, &without));
        let mut unknown = job.clone();
        unknown.lengths.clear();
        assert!(!has_same_part(&job, &unknown), "another length");
        let mut longer = job.clone();
        longer.stock.length += 1.0;
        assert!(!has_same_part(&job, &longer));
        longer = job.clone();
        longer.zero = Some(Default::default());
        assert!(!has_same_part(&job, &longer));
    }
}
