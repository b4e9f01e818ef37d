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
use crate::command::{Action, ThreadPassFeature};
use crate::interpreter::cycles::pattern::PatternCycle;
use crate::interpreter::cycles::pecking::PeckingCycle;
use crate::interpreter::cycles::roughing::RoughingCycle;
use crate::interpreter::cycles::stepped::SteppedCycle;
use crate::interpreter::moves::Move;
use crate::interpreter::moves::explanation::PassNote;
use crate::interpreter::moves::planned_action::PlannedAction;
use crate::interpreter::state::State;
use crate::interpreter::threads::compound_thread::CompoundThread;
use crate::interpreter::threads::counted_thread::CountedThread;
use crate::interpreter::threads::single_pass::SinglePass;
use crate::interpreter::threads::tapping::Tapping;
use crate::interpreter::threads::thread_cycle::ThreadCycle;
use crate::units::Point;

/// The generator that makes the moves of a cycle, one on each request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum CycleGenerator {
    /// Tapping by G33, or by G84 and G85 of the Huaxing lathes.
    Tapping(Tapping),
    /// Moves of a thread cycle G92.
    Thread(ThreadCycle),
    /// Moves of a compound thread cycle G76.
    CompoundThread(CompoundThread),
    /// G71 and G72, roughing along Z and along X.
    Roughing(RoughingCycle),
    /// Moves of a pattern repeating cycle G73.
    Pattern(PatternCycle),
    /// Pecking by G74 and G75, or by G83 of the Huaxing lathes.
    Pecking(PeckingCycle),
    /// G81 and G82 of the Huaxing lathes, turning and facing in steps.
    Stepped(SteppedCycle),
    /// G33 and G34 of the Huaxing lathes, one pass of a thread.
    SinglePass(SinglePass),
    /// G86 and G87 of the Huaxing lathes, a thread in L passes.
    CountedThread(CountedThread),
}

impl CycleGenerator {
    fn next_move(&mut self) -> Option<Move> {
        match self {
            Self::Tapping(cycle) => cycle.next_move(),
            Self::Thread(cycle) => cycle.next_move(),
            Self::CompoundThread(cycle) => cycle.next_move(),
            Self::Roughing(cycle) => cycle.next_move(),
            Self::Pattern(cycle) => cycle.next_move(),
            Self::Pecking(cycle) => cycle.next_move(),
            Self::Stepped(cycle) => cycle.next_move(),
            Self::SinglePass(cycle) => cycle.next_move(),
            Self::CountedThread(cycle) => cycle.next_move(),
        }
    }
}

/// A running cycle. The cycle generates one move ahead, to know which move is the last.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cycle {
    #[serde(rename = "maker")]
    generator: CycleGenerator,
    #[serde(rename = "ahead")]
    move_ahead: Option<Move>,
    /// End of the move ahead, machine coordinates in mm, X as a radius.
    #[serde(rename = "at")]
    ahead_end: Point,
    /// The explanation data of the move taken last; `None` before the first move.
    #[serde(rename = "taken")]
    taken_note: Option<PassNote>,
    /// Whether the move before the one ahead is a thread. Not stored otherwise, so that hashes in
    /// earlier recordings of other cycles stay right.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    is_after_thread: bool,
}

impl Cycle {
    /// Starts a cycle at the current position of the tool.
    ///
    /// # Errors
    /// 062 if the cycle makes no move.
    pub(crate) fn begin(state: &State, generator: CycleGenerator) -> Result<Self, Alarm> {
        let mut cycle = Self {
            generator,
            move_ahead: None,
            ahead_end: state.to_machine(state.position).to_point(),
            taken_note: None,
            is_after_thread: false,
        };
        cycle.generate_ahead();
        if cycle.move_ahead.is_none() {
            return Err(Alarm::new(number::CYCLE_DATA).with_detail(say::cycle_without_pass()));
        }
        Ok(cycle)
    }

    /// Generates the next move of the cycle and stores it as the move ahead. Skips moves of
    /// zero length, except the retract after a thread, at whose end feed hold acts: it has no
    /// length where the run-out ends at the start.
    fn generate_ahead(&mut self) {
        loop {
            self.move_ahead = self.generator.next_move();
            let Some(generated) = &mut self.move_ahead else {
                return;
            };
            let is_after_thread = self.is_after_thread;
            let is_thread = matches!(generated.action, Action::Thread { .. });
            // A single pass ends with its thread.
            self.is_after_thread =
                is_thread && !matches!(self.generator, CycleGenerator::SinglePass(_));
            let to = match generated.action {
                Action::Rapid { to } if to == self.ahead_end && is_after_thread => {
                    // Single block has stopped after the thread.
                    generated.stops = false;
                    return;
                }
                Action::Rapid { to } | Action::Line { to, .. } if to == self.ahead_end => continue,
                Action::Rapid { to }
                | Action::Line { to, .. }
                | Action::Arc { to, .. }
                | Action::Thread { to, .. } => to,
                _ => return,
            };
            self.ahead_end = to;
            return;
        }
    }

    pub(crate) fn next_action(&mut self) -> Option<PlannedAction> {
        let Move {
            action,
            stops,
            note,
        } = self.move_ahead.take()?;
        self.taken_note = Some(note);
        self.generate_ahead();
        Some(PlannedAction {
            action,
            is_stop: stops,
        })
    }

    pub(crate) const fn is_done(&self) -> bool {
        self.move_ahead.is_none()
    }

    /// Greatest travel of each axis per spindle revolution in the cuts of a thread cycle, mm;
    /// `None` for other cycles. The run-out is included if the spindle drives it
    /// (`is_run_out_tied`, 107 = 0).
    pub(crate) fn thread_travel_per_revolution(&self, is_run_out_tied: bool) -> Option<Point> {
        match &self.generator {
            CycleGenerator::Thread(cycle) => Some(cycle.travel_per_revolution(is_run_out_tied)),
            CycleGenerator::CompoundThread(cycle) => {
                Some(cycle.travel_per_revolution(is_run_out_tied))
            }
            CycleGenerator::SinglePass(cycle) => Some(cycle.travel_per_revolution()),
            CycleGenerator::CountedThread(cycle) => {
                Some(cycle.travel_per_revolution(is_run_out_tied))
            }
            _ => None,
        }
    }

    /// Returns the feature that the cuts of a thread cycle have in addition to a straight pass: a
    /// run-out or several starts; `None` if they have neither.
    pub(crate) fn beyond_pass(&self) -> Option<ThreadPassFeature> {
        match &self.generator {
            CycleGenerator::Thread(cycle) => cycle.beyond_pass(),
            CycleGenerator::CompoundThread(cycle) => cycle.beyond_pass(),
            CycleGenerator::CountedThread(cycle) => cycle.beyond_pass(),
            _ => None,
        }
    }

    /// The explanation data of the move taken last; `None` before the first move.
    pub(crate) const fn pass_note(&self) -> Option<PassNote> {
        self.taken_note
    }
}
