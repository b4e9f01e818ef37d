//! Canned cycles: makers of moves, one move at a time.
//!
//! ```text
//!   block --plan--> Maker --make--> Move, Move, …    each with a Note: which pass
//!                     |                              it belongs to and why
//!                     +-- plain data: start, end, step counters
//! ```
//!
//! A cycle with ten thousand passes takes no more memory than one with two.

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{Action, BeyondPass};
use crate::interpreter::context::emission::Emission;
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::Move;
use crate::interpreter::context::state::State;
use crate::interpreter::cycles::pattern::Pattern;
use crate::interpreter::cycles::pecking::Pecking;
use crate::interpreter::cycles::roughing::Roughing;
use crate::interpreter::cycles::stepped::Stepped;
use crate::interpreter::threads::compound_thread::CompoundThread;
use crate::interpreter::threads::counted_thread::CountedThread;
use crate::interpreter::threads::single_pass::SinglePass;
use crate::interpreter::threads::tapping::Tapping;
use crate::interpreter::threads::thread_cycle::ThreadCycle;
use crate::units::Point;

/// What makes the moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Maker {
    /// G33 with several starts; G84 and G85 of the Huaxing lathes.
    Tapping(Tapping),
    /// G92.
    Thread(ThreadCycle),
    /// G76.
    CompoundThread(CompoundThread),
    /// G71, G72.
    Roughing(Roughing),
    /// G73.
    Pattern(Pattern),
    /// G74, G75, G83 of the Huaxing lathes.
    Pecking(Pecking),
    /// G81, G82 of the Huaxing lathes.
    Stepped(Stepped),
    /// G33, G34 of the Huaxing lathes.
    SinglePass(SinglePass),
    /// G86, G87.
    CountedThread(CountedThread),
}

impl Maker {
    fn make(&mut self) -> Option<Move> {
        match self {
            Self::Tapping(cycle) => cycle.make(),
            Self::Thread(cycle) => cycle.make(),
            Self::CompoundThread(cycle) => cycle.make(),
            Self::Roughing(cycle) => cycle.make(),
            Self::Pattern(cycle) => cycle.make(),
            Self::Pecking(cycle) => cycle.make(),
            Self::Stepped(cycle) => cycle.make(),
            Self::SinglePass(cycle) => cycle.make(),
            Self::CountedThread(cycle) => cycle.make(),
        }
    }
}

/// A cycle under way. It is one move ahead, so that it knows its last one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cycle {
    maker: Maker,
    ahead: Option<Move>,
    /// Where the move ahead ends.
    at: Point,
    /// What the move taken last belongs to.
    taken: Option<Note>,
}

impl Cycle {
    /// Begins a cycle where the tool stands.
    pub(crate) fn begin(state: &State, maker: Maker) -> Result<Self, Alarm> {
        let mut cycle = Self {
            maker,
            ahead: None,
            at: state.machine(state.position).point(),
            taken: None,
        };
        cycle.look_ahead();
        if cycle.ahead.is_none() {
            return Err(Alarm::new(number::CYCLE_DATA).because(say::cycle_without_pass()));
        }
        Ok(cycle)
    }

    /// The next move that goes anywhere.
    fn look_ahead(&mut self) {
        loop {
            self.ahead = self.maker.make();
            let Some(made) = &self.ahead else {
                return;
            };
            let to = match made.action {
                Action::Rapid { to } | Action::Line { to, .. } if to == self.at => continue,
                Action::Rapid { to }
                | Action::Line { to, .. }
                | Action::Arc { to, .. }
                | Action::Thread { to, .. } => to,
                _ => return,
            };
            self.at = to;
            return;
        }
    }

    pub(crate) fn next(&mut self) -> Option<Emission> {
        let Move {
            action,
            stops,
            note,
        } = self.ahead.take()?;
        self.taken = Some(note);
        self.look_ahead();
        Some(Emission { action, stops })
    }

    pub(crate) const fn is_done(&self) -> bool {
        self.ahead.is_none()
    }

    /// Of a cycle of threads: how far each axis goes a revolution in its cuts, mm;
    /// the run-out counts when it is tied to the spindle (107 = 0).
    pub(crate) fn thread_per_revolution(&self, tied: bool) -> Option<Point> {
        match &self.maker {
            Maker::Thread(cycle) => Some(cycle.per_revolution(tied)),
            Maker::CompoundThread(cycle) => Some(cycle.per_revolution(tied)),
            Maker::SinglePass(cycle) => Some(cycle.per_revolution()),
            Maker::CountedThread(cycle) => Some(cycle.per_revolution(tied)),
            _ => None,
        }
    }

    /// What makes a cut of a cycle of threads more than one straight pass.
    pub(crate) fn beyond_pass(&self) -> Option<BeyondPass> {
        match &self.maker {
            Maker::Thread(cycle) => cycle.beyond_pass(),
            Maker::CompoundThread(cycle) => cycle.beyond_pass(),
            Maker::CountedThread(cycle) => cycle.beyond_pass(),
            _ => None,
        }
    }

    /// Why the move taken last is where it is.
    pub(crate) const fn note(&self) -> Option<Note> {
        self.taken
    }
}
