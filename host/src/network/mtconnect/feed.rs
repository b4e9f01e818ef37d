//! Passes the state of the machine from the thread that ticks to the agent's thread.

use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use crossbeam::queue::ArrayQueue;
use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_mtconnect::{AgentAssets, MachineLoad, MachineReading, MachineSource, program_name};
use gsk_runner::machining::CutLoad;
use gsk_workpiece::job::Job;

use crate::preview::setup::make_preview_setup;

/// Ticks of 1 ms between two recorded machine states.
const FEED_TICKS: u64 = 20;
/// Number of recorded states between two checks whether job or program has changed.
const ASSET_CHECK_FEEDS: u64 = 25;
/// Capacity of the queue, in machine states.
const QUEUE_CAPACITY: usize = 256;

/// The state of the machine at one moment.
#[derive(Debug)]
pub(crate) struct FeedItem {
    /// Moment of the state, ms since 1970.
    pub(crate) time_ms: u64,
    pub(crate) reading: MachineReading,
    /// Job and program, if one of them has changed.
    pub(crate) change: Option<Box<FeedChange>>,
}

/// The new job and program after a change.
#[derive(Debug)]
pub(crate) struct FeedChange {
    pub(crate) assets: AgentAssets,
    /// For a preview of the program.
    pub(super) setup: Setup,
}

/// The queue between the two threads.
pub(crate) type FeedQueue = Arc<ArrayQueue<FeedItem>>;

/// Measures the machine time of the current run.
#[derive(Clone, Copy, Debug, Default)]
struct RunClock {
    is_running: bool,
    /// Counted time of cycle start at the start of the run, ms.
    start_ms: u64,
    run_ms: u64,
}

impl RunClock {
    const fn update(&mut self, state: RunState, started_ms: u64) {
        let is_running = !matches!(state, RunState::Reset);
        if is_running && !self.is_running {
            self.start_ms = started_ms;
        }
        self.is_running = is_running;
        if is_running {
            self.run_ms = started_ms.saturating_sub(self.start_ms);
        }
    }
}

/// Reads control and lathe after each tick. It belongs to the thread that ticks, and never waits.
#[derive(Debug)]
pub struct AgentFeed {
    queue: FeedQueue,
    ticks: u64,
    run_clock: RunClock,
    /// The job last passed on; `None` before the first one.
    last_job: Option<Option<Job>>,
    /// Name and text of the program that was passed to the agent last; `None` without one.
    last_program: Option<(String, Program)>,
}

impl AgentFeed {
    /// Creates a feed and the queue that it fills.
    pub(crate) fn new() -> (Self, FeedQueue) {
        let queue = Arc::new(ArrayQueue::new(QUEUE_CAPACITY));
        let feed = Self {
            queue: Arc::clone(&queue),
            ticks: 0,
            run_clock: RunClock::default(),
            last_job: None,
            last_program: None,
        };
        (feed, queue)
    }

    /// Passes the state on after every twentieth tick. `job` is the job of the program, `load` that
    /// of the current cut.
    pub fn follow_tick(
        &mut self,
        simulation: &Simulation,
        job: Option<&Job>,
        load: Option<CutLoad>,
    ) {
        let is_due = self.ticks.is_multiple_of(FEED_TICKS);
        let checks_assets = self.ticks.is_multiple_of(FEED_TICKS * ASSET_CHECK_FEEDS);
        self.ticks += 1;
        if !is_due {
            return;
        }
        let cnc = &simulation.cnc;
        self.run_clock
            .update(cnc.run_state(), cnc.counters().started_ms);
        let source = MachineSource {
            cnc,
            lathe: &simulation.lathe,
            job,
            load: load.map(|load| machine_load(simulation, &load)),
            run_ms: self.run_clock.run_ms,
        };
        let change = checks_assets
            .then(|| self.find_change(simulation, job))
            .flatten();
        let dropped = self.queue.force_push(FeedItem {
            time_ms: wall_clock_ms(),
            reading: MachineReading::new(&source),
            change,
        });
        if dropped.is_some_and(|item| item.change.is_some()) {
            // A full queue has lost job and program: the next check passes them on again.
            self.last_job = None;
        }
    }

    /// The job and the program, if one of them differs from the last ones.
    fn find_change(
        &mut self,
        simulation: &Simulation,
        job: Option<&Job>,
    ) -> Option<Box<FeedChange>> {
        let cnc = &simulation.cnc;
        let selected = cnc.programs().selected();
        // The window of a DNC program changes all the time: it is no file.
        let selected = selected.filter(|id| *id != ProgramId::Dnc);
        let program = selected.and_then(|id| Some((id, cnc.programs().get(id)?)));
        let is_same_program = match (&self.last_program, program) {
            (None, None) => true,
            (Some((name, last)), Some((id, program))) => {
                // The last program keeps its text alive: no other one has its address.
                core::ptr::eq(last.text(), program.text()) && *name == program_name(cnc, id)
            }
            _ => false,
        };
        let is_same_job = self
            .last_job
            .as_ref()
            .is_some_and(|last| last.as_ref() == job);
        if is_same_program && is_same_job {
            return None;
        }
        self.last_job = Some(job.cloned());
        self.last_program = program.map(|(id, program)| (program_name(cnc, id), program.clone()));
        Some(Box::new(FeedChange {
            assets: AgentAssets {
                job: job.cloned(),
                program: self.last_program.clone(),
            },
            setup: make_preview_setup(simulation),
        }))
    }
}

/// The load of a cut as a share of what the lathe bears.
fn machine_load(simulation: &Simulation, load: &CutLoad) -> MachineLoad {
    let limits = &simulation.lathe.config().load;
    MachineLoad {
        spindle: limits.spindle_load_percent(load.torque_nm, load.rpm),
        x: limits.axis_load_percent(load.radial_force_n),
        z: limits.axis_load_percent(load.axial_force_n),
    }
}

/// The time of the wall clock, ms since 1970; 0 for a clock before 1970.
pub(super) fn wall_clock_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_millis() as u64)
}
