//! Canned cycles: generators that make one move at a time.
//!
//! ```text
//!   block --plan--> CycleGenerator --next_move--> Move, Move, …
//!                      |                           each with a PassNote: its pass and why
//!                      +-- plain data: start, end, step counters
//! ```
//!
//! So a cycle of ten thousand passes takes no more memory than one of two.

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

/// The generator of a cycle's moves.
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

/// A running cycle. It generates one move ahead and so knows which move is its last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cycle {
    #[serde(rename = "maker")]
    maker: Maker,
    #[serde(rename = "ahead")]
    ahead: Option<Move>,
    /// Where the move ahead ends, machine coordinates.
    #[serde(rename = "at")]
    at: Point,
    /// The note of the move taken last.
    #[serde(rename = "taken")]
    taken: Option<Note>,
}

impl Cycle {
    /// Starts a cycle at the current position of the tool.
    ///
    /// # Errors
    /// 062 if the cycle makes no move.
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

    /// Generates the next move, without those of zero length.
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

    /// Greatest travel of each axis per spindle revolution in the cuts of a thread cycle, mm;
    /// `None` for other cycles. The run-out counts if it is tied to the spindle (`tied`, 107 =
    /// 0).
    pub(crate) fn thread_per_revolution(&self, tied: bool) -> Option<Point> {
        match &self.maker {
            Maker::Thread(cycle) => Some(cycle.per_revolution(tied)),
            Maker::CompoundThread(cycle) => Some(cycle.per_revolution(tied)),
            Maker::SinglePass(cycle) => Some(cycle.per_revolution()),
            Maker::CountedThread(cycle) => Some(cycle.per_revolution(tied)),
            _ => None,
        }
    }

    /// Whether a cut of a thread cycle has a run-out or several starts; `None` for a single
    /// straight pass.
    pub(crate) fn beyond_pass(&self) -> Option<BeyondPass> {
        match &self.maker {
            Maker::Thread(cycle) => cycle.beyond_pass(),
            Maker::CompoundThread(cycle) => cycle.beyond_pass(),
            Maker::CountedThread(cycle) => cycle.beyond_pass(),
            _ => None,
        }
    }

    /// The explanation data of the move taken last.
    pub(crate) const fn note(&self) -> Option<Note> {
        self.taken
    }
}
