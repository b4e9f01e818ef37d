//! Retraces the path of a held run by the handwheel: back along the points that the slides have
//! made, and forwards to the point of the hold. Only the slides move. Modal codes, block and ladder
//! stay those of the hold.
//!
//! ```text
//!   feed hold ─► [turn back] ─► [turn forwards] ─► at the hold ─► CYCLE START: rest of the block
//!                     │
//!                     └─ RESET: the path is forgotten, the slides stay
//! ```

use crate::cnc::{Cnc, Event};
use crate::command::Action;
use crate::mode::OperatingMode;
use crate::motion::{PathBegin, Retrace};
use crate::operation::RunState;
use gsk_messages::{Message, say};

/// Distance between two positions that count as one, mm: only rounding.
const SAME_POSITION_MM: f64 = 1e-9;

/// Where a path begins that an action ends; `None` for an action that the slides can retrace.
const fn begin_after(action: &Action) -> Option<PathBegin> {
    match action {
        Action::Rapid { .. } | Action::Line { .. } | Action::Arc { .. } | Action::Nothing => None,
        Action::Thread { .. } | Action::ThreadCycle { .. } | Action::Tap { .. } => {
            Some(PathBegin::Thread)
        }
        Action::Frame { .. } | Action::ZeroReturn { .. } | Action::Referenced { .. } => {
            Some(PathBegin::Coordinates)
        }
        _ => Some(PathBegin::Function),
    }
}

fn begin_message(begin: PathBegin) -> Message {
    match begin {
        PathBegin::Recording => say::retrace_begin(),
        PathBegin::Function => say::retrace_begin_function(),
        PathBegin::Thread => say::retrace_begin_thread(),
        PathBegin::Coordinates => say::retrace_begin_coordinates(),
    }
}

impl Cnc {
    /// Switches on or off that the handwheel retraces the path of a held run. While the slides are
    /// off the point of the hold, it stays on.
    pub(in crate::cnc) fn set_retrace(&mut self, on: bool) {
        if on == self.has_retrace() || self.is_off_hold() {
            return;
        }
        let here = self.position();
        self.hand.retrace = on.then(|| Retrace::new(here, PathBegin::Recording));
    }

    /// Whether the handwheel retraces the path of a held run.
    pub const fn has_retrace(&self) -> bool {
        self.hand.retrace.is_some()
    }

    /// Whether the handwheel has moved the slides off the point of the hold: the run cannot
    /// continue.
    pub fn is_off_hold(&self) -> bool {
        let engaged = self.hand.retrace.as_ref().filter(|it| it.is_engaged());
        engaged.is_some_and(|it| (self.position() - it.end()).length() > SAME_POSITION_MM)
    }

    /// Begins another path at the current position.
    pub(in crate::cnc) fn begin_retrace_path(&mut self, begin: PathBegin) {
        let here = self.position();
        if let Some(retrace) = &mut self.hand.retrace {
            *retrace = Retrace::new(here, begin);
        }
    }

    /// Forgets the path: slides or coordinates are no longer those of the run. A motion along it
    /// ends at once.
    pub(in crate::cnc) fn forget_made_path(&mut self) {
        self.begin_retrace_path(PathBegin::Recording);
    }

    /// Ends the path before an action that the handwheel cannot retrace.
    pub(in crate::cnc) fn limit_retrace(&mut self, action: &Action) {
        if let Some(begin) = begin_after(action) {
            self.begin_retrace_path(begin);
        }
    }

    /// Brakes along the path, then forgets it.
    pub(in crate::cnc) fn end_retrace(&mut self) {
        let limits = &self.drives.limits;
        let retrace = self.hand.retrace.as_mut();
        if retrace.is_some_and(|it| it.end_at_standstill(limits)) {
            self.forget_made_path();
        }
    }

    /// Gives the slides, which stand at the point of the hold, back to the run.
    pub(in crate::cnc) fn release_retrace(&mut self) {
        if let Some(retrace) = &mut self.hand.retrace {
            retrace.release();
        }
    }

    /// Drops the turns of the handwheel that the slides have not followed.
    pub(in crate::cnc) fn drop_retrace_turns(&mut self) {
        if let Some(retrace) = &mut self.hand.retrace {
            retrace.drop_turns(&self.drives.limits);
        }
    }

    /// Records the position after a tick of the run.
    pub(in crate::cnc) fn record_made_path(&mut self) {
        // Each tick of every lathe comes here, and most record nothing.
        if self.hand.retrace.is_none() {
            return;
        }
        let here = self.position();
        let automatic = &self.run.automatic;
        let is_run = automatic.is_started
            && !automatic.is_mdi
            && !automatic.is_approaching()
            && self.run.held_motion.is_none()
            && self.run.mode == OperatingMode::Auto
            && !self.has_machine_lock();
        let Some(retrace) = &mut self.hand.retrace else {
            return;
        };
        if retrace.is_engaged() {
            // Slides that were moved off the path by hand keep the point of the hold.
        } else if is_run {
            retrace.record(here);
        } else if here != retrace.end() {
            self.forget_made_path();
        }
    }

    const fn has_machine_lock(&self) -> bool {
        self.plc.signals.machine_lock.x || self.plc.signals.machine_lock.z
    }

    /// Leads the slides by `counts` graduations of the handwheel along the path of the held run.
    pub(in crate::cnc) fn follow_retrace_wheel(&mut self, counts: i32) {
        if !self.has_retrace() {
            return;
        }
        if !self.can_retrace() {
            return self.drop_retrace_turns();
        }
        if counts == 0 {
            return;
        }
        self.suspend_held_motion();
        if self.run.held_motion.is_none() {
            return;
        }
        let Some(retrace) = &mut self.hand.retrace else {
            return;
        };
        if let Some(begin) = retrace.turn(counts) {
            self.events.push(Event::Advised(begin_message(begin)));
        }
    }

    /// Whether the slides may follow the path: the run is held within a move and they are on it.
    fn can_retrace(&self) -> bool {
        let is_held = self.run.automatic.state == RunState::Hold
            && self.run.mode == OperatingMode::Auto
            && !self.run.automatic.is_mdi
            && !self.run.automatic.is_approaching();
        let is_hindered = self.emergency_stop
            || self.is_resetting()
            || self.is_not_ready()
            || self.is_alarm_active()
            || self.plc.signals.feed_hold
            || self.is_run_interlocked()
            || self.has_machine_lock();
        let is_within_move = self.run.held_motion.is_some() || self.is_held_in_path_move();
        let is_on_path = self.hand.retrace.as_ref().is_some_and(|retrace| {
            (self.position() - retrace.position()).length() <= SAME_POSITION_MM
        });
        is_held && !is_hindered && is_within_move && is_on_path && self.can_board_move()
    }

    /// Whether a rapid or a cut is held and the slides stand, at the board too.
    fn is_held_in_path_move(&self) -> bool {
        let action = self.run.automatic.current_action();
        action.is_some_and(|action| begin_after(action).is_none())
            && !self.drives.interpolator.is_finished()
            && !self.drives.interpolator.is_moving()
            && !self.is_board_lagging()
    }

    /// Advances the slides by one tick along the path; returns `false` if they do not follow it.
    pub(in crate::cnc) fn advance_retrace(&mut self) -> bool {
        let limits = &self.drives.limits;
        let moving = self.hand.retrace.as_mut().filter(|it| it.is_moving());
        let Some(retrace) = moving else {
            return false;
        };
        let to = retrace.advance(limits);
        let has_ended = retrace.has_ended();
        self.drives.interpolator.guide(to);
        if has_ended {
            self.forget_made_path();
        }
        true
    }
}
