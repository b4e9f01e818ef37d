//! Background work of a page, which has one thread. Every task takes a short turn at each
//! tick of a timer, and once more before each frame; a single job runs between two turns.

use std::cell::{Cell, RefCell};
use std::io;
use std::rc::Rc;

use crossbeam::channel::{Receiver, RecvTimeoutError, TryRecvError};
use gsk_core::preview::WorkBudget;
use web_time::{Duration, Instant};

use super::disk;

/// Limit of a preview. A preview blocks the page; this limit is reached in a second or two.
pub const LARGEST_PREVIEW: WorkBudget = WorkBudget {
    moves: 500_000,
    work: 2_000_000,
    motionless: 500_000,
};
/// Name of the task that gets a turn when another task waits for an answer.
const KERNEL: &str = "kernel";

/// Function that takes one turn of a task; returns `false` after its last one.
type TaskTurn = Box<dyn FnMut() -> bool>;
/// A function that runs once in the background.
type OneTimeJob = Box<dyn FnOnce()>;

/// A task that takes turns at the ticks of the timer.
struct TurnTask {
    name: String,
    start_task: RefCell<TaskTurn>,
    has_ended: Cell<bool>,
    /// Time until which the task waits for work; `None` if it gets its turn at the next tick.
    waits_until: Cell<Option<Instant>>,
}

thread_local! {
    static ACTORS: RefCell<Vec<Rc<TurnTask>>> = const { RefCell::new(Vec::new()) };
    static JOBS: RefCell<Vec<OneTimeJob>> = const { RefCell::new(Vec::new()) };
    /// The tasks that are taking a turn now, the innermost last.
    static ACTIVE: RefCell<Vec<Rc<TurnTask>>> = const { RefCell::new(Vec::new()) };
}

/// Handle of a task that runs in turns on the thread of the page.
pub struct TaskHandle(Rc<TurnTask>);

impl core::fmt::Debug for TaskHandle {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Turning").field(&self.0.name).finish()
    }
}

impl TaskHandle {
    /// Returns whether the task has not finished yet.
    pub fn is_running(&self) -> bool {
        !self.0.has_ended.get()
    }

    /// Gives the task its remaining turns; returns true if it has ended.
    pub fn finish(self) -> bool {
        /// Limit of the remaining turns; no task ever needs this number.
        const MOST: u32 = 10_000;
        for _ in 0..MOST {
            if self.0.has_ended.get() {
                return true;
            }
            self.0.take_turn();
        }
        false
    }
}

impl TurnTask {
    fn take_turn(self: &Rc<Self>) {
        // A task that waits for an answer within its turn gets no second turn.
        let Ok(mut start_task) = self.start_task.try_borrow_mut() else {
            return;
        };
        self.waits_until.set(None);
        ACTIVE.with_borrow_mut(|active| active.push(Rc::clone(self)));
        let has_more_turns = start_task();
        ACTIVE.with_borrow_mut(Vec::pop);
        self.has_ended.set(!has_more_turns);
    }

    fn is_due(&self) -> bool {
        let until = self.waits_until.get();
        until.is_none_or(|until| Instant::now() >= until)
    }
}

/// Starts a task: each tick of the timer calls `take_turn` until it returns `false`.
///
/// # Errors
/// Never.
pub fn start_task(name: &str, take_turn: impl FnMut() -> bool + 'static) -> io::Result<TaskHandle> {
    let actor = Rc::new(TurnTask {
        name: name.to_owned(),
        start_task: RefCell::new(Box::new(take_turn)),
        has_ended: Cell::new(false),
        waits_until: Cell::new(None),
    });
    ACTORS.with_borrow_mut(|actors| actors.push(Rc::clone(&actor)));
    Ok(TaskHandle(actor))
}

/// Runs a job once, at one of the next ticks of the timer.
///
/// # Errors
/// Never.
pub fn run_in_background(_name: &str, job: impl FnOnce() + 'static) -> io::Result<()> {
    JOBS.with_borrow_mut(|jobs| jobs.push(Box::new(job)));
    Ok(())
}

/// Returns the next item, if there is one; without one the task gets its next turn at `until`,
/// or at the next tick of the timer if `until` is `None`.
///
/// # Errors
/// No item has arrived, or every sender is gone.
pub fn receive<T>(from: &Receiver<T>, until: Option<Instant>) -> Result<T, RecvTimeoutError> {
    from.try_recv().map_err(|error| match error {
        TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
        TryRecvError::Empty => {
            ACTIVE.with_borrow(|active| {
                if let Some(actor) = active.last() {
                    actor.waits_until.set(until);
                }
            });
            RecvTimeoutError::Timeout
        }
    })
}

/// Ends a turn: the next one is at a later tick of the timer.
pub const fn pause(_time: Duration) {}

/// Gives the kernel a turn and returns its answer; `None` if it does not answer in that turn.
pub fn wait_for_answer<T>(from: &Receiver<T>, _timeout: Duration) -> Option<T> {
    for actor in actors().iter().filter(|actor| actor.name == KERNEL) {
        actor.take_turn();
    }
    from.try_recv().ok()
}

/// Handles a tick of the timer: gives each task that is due a turn, and runs one job.
pub fn run_due_tasks() {
    disk::maintain_lock();
    for actor in actors() {
        if actor.is_due() {
            actor.take_turn();
        }
    }
    ACTORS.with_borrow_mut(|actors| actors.retain(|actor| !actor.has_ended.get()));
    let job = JOBS.with_borrow_mut(|jobs| (!jobs.is_empty()).then(|| jobs.remove(0)));
    if let Some(job) = job {
        job();
    }
}

fn actors() -> Vec<Rc<TurnTask>> {
    ACTORS.with_borrow(Vec::clone)
}
