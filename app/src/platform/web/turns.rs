//! What goes on beside the window: a page has one thread. Everything takes a short turn
//! whenever a clock rings, and once more before each picture; what is done once is done
//! between two turns.

use std::cell::{Cell, RefCell};
use std::io;
use std::rc::Rc;

use crossbeam::channel::{Receiver, RecvTimeoutError, TryRecvError};
use gsk_core::preview::WorkBudget;
use web_time::{Duration, Instant};

use super::disk;

/// The page stands still while a program is looked through: it takes a second or two.
pub const LARGEST_LOOK: WorkBudget = WorkBudget {
    moves: 500_000,
    work: 2_000_000,
    motionless: 500_000,
};
/// The name of what answers all others.
const KERNEL: &str = "kernel";

/// One turn; `false`: it was the last one.
type Turn = Box<dyn FnMut() -> bool>;
/// What is done once.
type Job = Box<dyn FnOnce()>;

/// Somebody who takes turns.
struct Actor {
    name: String,
    turn: RefCell<Turn>,
    over: Cell<bool>,
    /// It waits for work, and no longer than so.
    waits_until: Cell<Option<Instant>>,
}

thread_local! {
    static ACTORS: RefCell<Vec<Rc<Actor>>> = const { RefCell::new(Vec::new()) };
    static JOBS: RefCell<Vec<Job>> = const { RefCell::new(Vec::new()) };
    /// Whose turn it is.
    static ACTIVE: RefCell<Vec<Rc<Actor>>> = const { RefCell::new(Vec::new()) };
}

/// Something that takes its turns until it is over.
pub struct Turning(Rc<Actor>);

impl core::fmt::Debug for Turning {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Turning").field(&self.0.name).finish()
    }
}

impl Turning {
    /// Whether it is not over yet.
    pub fn goes_on(&self) -> bool {
        !self.0.over.get()
    }

    /// Gives it its last turns; whether it came to its end.
    pub fn finish(self) -> bool {
        /// More work than that never waits.
        const MOST: u32 = 10_000;
        for _ in 0..MOST {
            if self.0.over.get() {
                return true;
            }
            self.0.take_turn();
        }
        false
    }
}

impl Actor {
    fn take_turn(self: &Rc<Self>) {
        // Who waits for an answer within his turn has no other one.
        let Ok(mut turn) = self.turn.try_borrow_mut() else {
            return;
        };
        self.waits_until.set(None);
        ACTIVE.with_borrow_mut(|active| active.push(Rc::clone(self)));
        let goes_on = turn();
        ACTIVE.with_borrow_mut(Vec::pop);
        self.over.set(!goes_on);
    }

    fn is_due(&self) -> bool {
        let until = self.waits_until.get();
        until.is_none_or(|until| Instant::now() >= until)
    }
}

/// From now on something takes a turn whenever the clock rings, as long as its turns
/// return `true`.
///
/// # Errors
/// None here.
pub fn turn(name: &str, one: impl FnMut() -> bool + 'static) -> io::Result<Turning> {
    let actor = Rc::new(Actor {
        name: name.to_owned(),
        turn: RefCell::new(Box::new(one)),
        over: Cell::new(false),
        waits_until: Cell::new(None),
    });
    ACTORS.with_borrow_mut(|actors| actors.push(Rc::clone(&actor)));
    Ok(Turning(actor))
}

/// Does something once, soon.
///
/// # Errors
/// None here.
pub fn beside(_name: &str, job: impl FnOnce() + 'static) -> io::Result<()> {
    JOBS.with_borrow_mut(|jobs| jobs.push(Box::new(job)));
    Ok(())
}

/// The next piece of work, if there is one; without one the turn comes again `until`
/// then, or at the next ring.
///
/// # Errors
/// None has come; or none can come any more.
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

/// What the kernel answers in a turn of its own.
pub fn answer<T>(from: &Receiver<T>, _longest: Duration) -> Option<T> {
    for actor in actors().iter().filter(|actor| actor.name == KERNEL) {
        actor.take_turn();
    }
    from.try_recv().ok()
}

/// The clock has rung: whoever is due has a turn, and one job is done.
pub fn ring() {
    disk::keep_lock();
    for actor in actors() {
        if actor.is_due() {
            actor.take_turn();
        }
    }
    ACTORS.with_borrow_mut(|actors| actors.retain(|actor| !actor.over.get()));
    let job = JOBS.with_borrow_mut(|jobs| (!jobs.is_empty()).then(|| jobs.remove(0)));
    if let Some(job) = job {
        job();
    }
}

fn actors() -> Vec<Rc<Actor>> {
    ACTORS.with_borrow(Vec::clone)
}
