//! What the control minds when real drives behind a pulse board make its motion.
//!
//! The board is behind the control by what it holds: whatever must meet the slides
//! at rest (M, S, T, dwell, a stop between blocks) waits until it has made all of it.

mod pass;
mod preflight;
mod rates;
mod reports;
mod spindle;
mod walk;
mod zero;

use crate::alarm::{Alarm, AlarmClass, number};
use crate::board::needs_spindle;
use crate::cnc::Cnc;
use crate::command::{Action, SpindleCommand};
use crate::motion::ThreadMove;
use crate::operation::{Return, RunState};
use crate::units::{Axis, Feed, PerAxis, Point, Pulses};
use gsk_link::ThreadCapability;
use gsk_messages::{Message, say};
use gsk_plc::address::BitAddress;

/// Why constant surface speed is refused.
fn without_surface(timed: bool) -> Message {
    if timed {
        say::cannot_surface_unwired()
    } else {
        say::cannot_surface_at_rest()
    }
}

/// Whether an action must find the slides at rest, whose spindle and coolant switch
/// with the motion.
const fn needs_rest(action: &Action) -> bool {
    match action {
        // M03, M04, M05, M08, M09.
        Action::Miscellaneous { code } => !matches!(*code, 3..=5 | 8 | 9),
        Action::Spindle(command) => matches!(command, SpindleCommand::Step(_)),
        Action::Tool { .. }
        | Action::Dwell { .. }
        | Action::ProgramStop
        | Action::End { .. }
        | Action::ZeroReturn { .. }
        | Action::Macro => true,
        _ => false,
    }
}

impl Cnc {
    /// Whether the slides are still on their way to where the control stands.
    pub(crate) fn is_board_behind(&self) -> bool {
        self.drives.board.is_some_and(|board| board.behind)
    }

    /// Whether blocks that act on the machine are read only when the slides stand. A
    /// board whose outputs switch with the motion lets each command see to that itself.
    pub(crate) fn board_holds_reading(&self) -> bool {
        self.drives
            .board
            .is_some_and(|board| board.behind && !board.timed)
    }

    /// Whether a command must not begin yet. Where the board switches only at rest, M
    /// and S that start together with a motion are over before it; where it switches
    /// with the motion, spindle and coolant wait for nothing, all else for the slides.
    pub(crate) fn board_delays(&mut self, action: &Action) -> bool {
        let delays = self.drives.board.is_some_and(|board| {
            if action.is_motion() {
                let switches = board.switching || self.run.handshake.busy();
                return !board.prepared || (switches && !board.timed);
            }
            board.timed && board.behind && needs_rest(action)
        });
        delays || self.board_spindle_delays(action)
    }

    /// Whether an axis may be moved by hand.
    pub(crate) fn board_takes_motion(&self) -> bool {
        self.drives.board.is_none_or(|board| {
            board.takes_motion && (board.prepared || self.drives.interpolator.is_moving())
        })
    }

    /// Whether the slides are being stopped: where from is not known yet.
    pub(crate) fn board_is_stopping(&self) -> bool {
        self.drives
            .board
            .is_some_and(|board| board.known && !board.takes_motion)
    }

    /// Why a program must not be started.
    pub(crate) fn board_refuses_start(&mut self, mdi: bool) -> Option<Alarm> {
        let board = self.drives.board?;
        let outgrown = board
            .checked
            .and_then(|checked| checked.alarm(&self.memory.parameters));
        if outgrown.is_some() {
            return outgrown;
        }
        if !(board.known && self.coordinates.referenced.x && self.coordinates.referenced.z) {
            return Some(Alarm::new(number::NO_REFERENCE).because(say::reference_return_needed()));
        }
        self.rapids_too_fast(&board).or_else(|| {
            // What goes on was looked through when it began.
            let begins = !mdi && self.run.automatic.state == RunState::Reset;
            let program = self.memory.programs.current().filter(|_| begins)?;
            self.scan_for_board(program)
                .or_else(|| self.walk_for_board(&board, program))
        })
    }

    /// What the board cannot do, once more when it is to be done: macros and texts
    /// that no scan understands end here.
    pub(crate) fn check_for_board(&self, action: &Action) -> Result<(), Alarm> {
        let Some(board) = self.drives.board else {
            return Ok(());
        };
        if self.dry_run().is_some() {
            return Ok(());
        }
        let from = self.drives.interpolator.commanded();
        let rpm = board
            .spindle
            .map_or(self.spindle.control.actual_rpm(), |real| real.rpm);
        if let Some(alarm) = self.too_fast_for_board(&board, action, from, Some(rpm)) {
            return Err(alarm);
        }
        if let (Action::Thread { .. } | Action::ThreadCycle { .. }, ThreadCapability::None(lacks)) =
            (action, board.threads)
        {
            return Err(
                Alarm::new(number::BOARD_CANNOT).because(say::board_cannot_thread(lacks.text()))
            );
        }
        if self.board_cuts() {
            if let Action::ThreadCycle {
                per_revolution,
                beyond,
            } = action
            {
                self.check_passes(*per_revolution, *beyond)?;
            } else if let Some(thread) = ThreadMove::of(action) {
                self.check_pass(&thread)?;
            }
        }
        let tapping = match action {
            Action::Tap { .. } => true,
            Action::Spindle(SpindleCommand::Surface(_)) if !board.surface => {
                return Err(Alarm::new(number::BOARD_CANNOT).because(without_surface(board.timed)));
            }
            Action::Line {
                feed: Feed::PerRevolution(_),
                ..
            }
            | Action::Arc {
                feed: Feed::PerRevolution(_),
                ..
            } if board.spindle.is_none() => false,
            _ => return self.check_board_spindle(action),
        };
        Err(Alarm::new(number::BOARD_CANNOT).because(needs_spindle(&board, tapping)))
    }

    /// The board makes the return of this axis.
    pub(crate) const fn board_makes_return(&mut self, axis: Axis) {
        *self.coordinates.referenced.get_mut(axis) = false;
        *self.coordinates.at_reference.get_mut(axis) = None;
        *self.coordinates.returns.get_mut(axis) = Some(Return::Board);
    }

    /// Axes whose return the board is asked to make, or makes.
    pub(crate) fn board_returns(&self) -> PerAxis<bool> {
        let by_board = |axis| *self.coordinates.returns.get(axis) == Some(Return::Board);
        PerAxis::new(by_board(Axis::X), by_board(Axis::Z))
    }

    /// The board stands off the switches of these axes: machine coordinates `at`.
    pub(crate) fn board_returned(&mut self, axes: PerAxis<bool>, at: Point) {
        self.settle_coordinates();
        for axis in [Axis::X, Axis::Z] {
            if *axes.get(axis) {
                let mut shift = Point::default();
                *shift.get_mut(axis) = at.get(axis) - self.position().get(axis);
                self.drives.interpolator.translate(shift);
                self.drives.chain.preset(axis, at.get(axis));
                self.shift_frame(shift);
                self.arrive(axis, true);
            }
        }
    }

    /// Nobody knows any more where the slides stand.
    pub(crate) fn drop_reference(&mut self) {
        self.coordinates.referenced = PerAxis::default();
        self.coordinates.at_reference = PerAxis::default();
    }

    /// The board has dropped these outputs of the ladder by itself: they fall here as those
    /// of an output module do that was reset, and the ladder goes on from there. The M
    /// code shown is the one for what is.
    pub(crate) fn drop_outputs(&mut self, outputs: &[BitAddress]) {
        let memory = self.plc.engine.memory_mut();
        let mut fell = false;
        for &output in outputs {
            fell |= memory.bit(output);
            memory.set_bit(output, false);
        }
        if fell {
            self.run.interpreter.machine_stopped();
            self.run.modal.m = self.run.interpreter.modal().m;
        }
    }

    /// All motion ends here and now; what goes on is nothing.
    pub(crate) fn halt_for_board(&mut self) {
        self.abandon_returns();
        self.drives.interpolator.stop_now();
        self.hand.jog = PerAxis::default();
        self.hand.jog_blocked = PerAxis::new(true, true);
    }

    /// The same, and a program ends there, too; which alarm says so comes later.
    pub(crate) fn stop_for_board(&mut self) {
        if self.run.automatic.operating() {
            self.stop_run(RunState::Stop);
        }
        self.halt_for_board();
    }

    /// The slides came to stand at this count, which is not where the control was. An
    /// axis that stood keeps its coordinate to the increment.
    pub(crate) fn stand_at(&mut self, pulses: PerAxis<Pulses>) {
        let mut shift = Point::default();
        for axis in [Axis::X, Axis::Z] {
            let count = *pulses.get(axis);
            if count != *self.pulses().get(axis) {
                let place = self.drives.chain.stand_at(axis, count);
                *shift.get_mut(axis) = place - self.position().get(axis);
            }
        }
        self.drives.interpolator.translate(shift);
        let frame = self.coordinates.frame;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.set_frame(frame, &world);
    }

    /// Whether an alarm of the board waits for RESET.
    pub(crate) fn has_board_alarm(&self) -> bool {
        let mut standing = self.alarms.list().iter();
        standing.any(|alarm| alarm.class() == AlarmClass::Link)
    }
}
