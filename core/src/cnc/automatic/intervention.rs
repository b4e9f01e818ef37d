//! Manual motion during a held or stopped run, and the resumption of the run after it
//! (manual III-5.1.5, I-3.2.6).
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
    /// Suspends the rest of a held motion when the axes stand still, so that they can be
    /// moved manually.
    pub(crate) fn suspend_held_motion(&mut self) {
        let seeks_reference = matches!(
            self.run.automatic.current_action(),
            Some(Action::ZeroReturn { .. })
        );
        if seeks_reference
            && self.run.automatic.state == RunState::Hold
            && !self.drives.interpolator.is_moving()
        {
            // The rest of a search for the reference point cannot be kept.
            return self.stop_run(RunState::Stop);
        }
        let can_suspend = self.run.automatic.state == RunState::Hold
            && self.run.held_motion.is_none()
            && !self.drives.interpolator.is_finished()
            && !self.run.automatic.is_hold_protected()
            && !self.drives.interpolator.is_moving();
        if !can_suspend {
            return;
        }
        self.run.held_motion = Some(self.drives.interpolator.clone());
        self.drives.interpolator.cancel();
    }

    /// Resumes an interrupted block after manual motion. The block moves its remaining distance
    /// from the current position; the next block moves to its programmed coordinates.
    pub(crate) fn resume_held_motion(&mut self) {
        self.release_retrace();
        let Some(mut held) = self.run.held_motion.take() else {
            return;
        };
        held.translate(self.drives.interpolator.position() - held.position());
        self.drives.interpolator = held;
    }

    /// Whether a program runs or can be resumed. MDI blocks are not programs.
    pub(crate) fn has_resumable_run(&self) -> bool {
        let is_suspended = self.run.automatic.suspended.is_some();
        is_suspended || (self.run.automatic.is_started && !self.run.automatic.is_mdi)
    }

    /// Shifts the rest of a cycle by the distance that the axes were moved manually since
    /// the end of its last move.
    pub(crate) fn shift_cycle(&mut self) {
        let now = self.position();
        let shift = &mut self.run.automatic.cycle_shift;
        if let Some(before) = shift.ended_at.take() {
            shift.shift = shift.shift + now - before;
        }
    }
}
