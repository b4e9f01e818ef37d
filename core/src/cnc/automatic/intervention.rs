//! Moving by hand in the middle of a run, and going on after it (manual III-5.1.5,
//! I-3.2.6).
//!
//! ```text
//!   block held at H, moved by hand to H':      cycle stopped at the end of a move:
//!
//!   A ------- H ~ ~ ~ > B                      the rest of its path is shifted by
//!             |                                the way moved by hand
//!             H'------> B'  then the next
//!                           block to its point
//! ```

use crate::cnc::Cnc;
use crate::command::Action;
use crate::operation::RunState;

impl Cnc {
    /// Lays the rest of a held motion aside, once the axes stand, so that they can
    /// be moved by hand.
    pub(crate) fn set_aside_held_motion(&mut self) {
        let seeking = matches!(self.run.automatic.action(), Some(Action::ZeroReturn { .. }));
        if seeking
            && self.run.automatic.state == RunState::Hold
            && !self.drives.interpolator.is_moving()
        {
            // What is left of a search for the reference point cannot be kept.
            return self.stop_run(RunState::Stop);
        }
        let at_rest = self.run.automatic.state == RunState::Hold
            && self.run.held.is_none()
            && !self.drives.interpolator.finished()
            && !self.run.automatic.protected()
            && !self.drives.interpolator.is_moving();
        if !at_rest {
            return;
        }
        self.run.held = Some(self.drives.interpolator.clone());
        self.drives.interpolator.cancel();
    }

    /// Cycle start after manual motion: the interrupted block goes its remaining
    /// distance from where the axes stand now; the next block goes to the
    /// programmed coordinates.
    pub(crate) fn absorb_manual_motion(&mut self) {
        let Some(mut held) = self.run.held.take() else {
            return;
        };
        held.translate(self.drives.interpolator.position() - held.position());
        self.drives.interpolator = held;
    }

    /// Cycle start at the end of a move of a cycle: the rest goes on from where the
    /// axes stand now.
    pub(crate) fn shift_cycle(&mut self) {
        let now = self.position();
        let shift = &mut self.run.automatic.cycle_shift;
        if let Some(before) = shift.ended_at.take() {
            shift.by = shift.by + now - before;
        }
    }
}
