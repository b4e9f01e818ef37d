//! Additional rules of the control when a pulse board with real drives makes its motion.
//!
//! The board lags the control by the motion it holds. Whatever needs the slides at a
//! standstill (M, S, T, dwell, a stop between blocks) waits until the board has executed
//! all of it.

mod pass;
mod preflight;
mod rate_preflight;
mod rates;
mod reports;
mod spindle;
mod tap;
mod zero;

use crate::alarm::{Alarm, AlarmClass, number};
use crate::board::spindle_required_message;
use crate::cnc::Cnc;
use crate::command::{Action, SpindleCommand};
use crate::motion::ThreadMove;
use crate::operation::{RunState, ZeroReturnStage};
use crate::units::{Axis, Feed, PerAxis, Point, Pulses};
use gsk_link::{TapCapability, ThreadCapability};
use gsk_messages::{Message, say};
use gsk_plc::address::BitAddress;

/// Message that explains why the board cannot do constant surface speed (G96); `timed`: its outputs
/// can switch during motion.
fn surface_speed_refusal(timed: bool) -> Message {
    if timed {
        say::cannot_surface_unwired()
    } else {
        say::cannot_surface_at_rest()
    }
}

/// Whether an action must wait for a standstill of the slides, on a board whose spindle
/// and coolant switch during motion.
const fn needs_standstill(action: &Action) -> bool {
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
    /// Whether the board holds commanded motion that it has not executed yet.
    pub(crate) fn is_board_lagging(&self) -> bool {
        self.drives
            .board
            .is_some_and(|board| board.has_pending_motion)
    }

    /// Whether blocks that act on the machine are read only at a standstill of the slides.
    /// With a board whose outputs switch during motion,
    /// [`board_delays_command`](Self::board_delays_command) decides for each command.
    pub(crate) fn board_delays_reading(&self) -> bool {
        self.drives
            .board
            .is_some_and(|board| board.has_pending_motion && !board.has_timed_outputs)
    }

    /// Whether a command must not begin yet because of the board. If the board switches outputs
    /// only at a standstill, a motion waits for the M and S of its block. If the board switches
    /// them during motion, spindle and coolant do not wait, and other functions wait for the
    /// slides.
    pub(crate) fn board_delays_command(&mut self, action: &Action) -> bool {
        let delays = self.drives.board.is_some_and(|board| {
            if action.is_motion() {
                let is_switching = board.outputs_switching || self.run.handshake.is_busy();
                return !board.is_prepared || (is_switching && !board.has_timed_outputs);
            }
            board.has_timed_outputs && board.has_pending_motion && needs_standstill(action)
        });
        delays || self.board_spindle_delays(action)
    }

    /// Whether the board accepts manual motion now; true without a board.
    pub(crate) fn can_board_move(&self) -> bool {
        self.drives.board.is_none_or(|board| {
            board.takes_motion && (board.is_prepared || self.drives.interpolator.is_moving())
        })
    }

    /// Whether the board is stopping the slides, whose final position is then not known
    /// yet.
    pub(crate) fn is_board_stopping(&self) -> bool {
        self.drives
            .board
            .is_some_and(|board| board.position_known && !board.takes_motion)
    }

    /// Returns the alarm that prevents the start of a program on the board; `None` if it may start.
    /// With `mdi` (MDI or DNC) the program text is not checked.
    pub(crate) fn board_start_alarm(&mut self, mdi: bool) -> Option<Alarm> {
        let board = self.drives.board?;
        let changed_parameter = board
            .checked_parameters
            .and_then(|checked| checked.to_alarm(&self.memory.parameters));
        if changed_parameter.is_some() {
            return changed_parameter;
        }
        if !(board.position_known && self.coordinates.referenced.x && self.coordinates.referenced.z)
        {
            return Some(
                Alarm::new(number::NO_REFERENCE).with_detail(say::reference_return_needed()),
            );
        }
        self.rapid_rate_alarm(&board).or_else(|| {
            // A resumed program was checked when it began.
            let is_new_run = !mdi && self.run.automatic.state == RunState::Reset;
            let program = self.memory.programs.selected().filter(|_| is_new_run)?;
            self.scan_program_for_board(program)
                .or_else(|| self.check_rates_for_board(&board, program))
        })
    }

    /// Checks, when an action begins, whether the board can do it, and returns an alarm as error if
    /// not. This check also covers macros and texts that the scan before the start does not
    /// understand.
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
            .map_or(self.spindle.control.actual_rpm(), |measured| measured.rpm);
        if let Some(alarm) = self.pulse_rate_alarm(&board, action, from, Some(rpm)) {
            return Err(alarm);
        }
        if let (Action::Thread { .. } | Action::ThreadCycle { .. }, ThreadCapability::None(lacks)) =
            (action, board.threads)
        {
            return Err(Alarm::new(number::BOARD_CANNOT)
                .with_detail(say::board_cannot_thread(lacks.text())));
        }
        if self.is_cutting_by_board() {
            if let Action::ThreadCycle {
                per_revolution,
                extra_feature: beyond,
            } = action
            {
                self.check_passes(*per_revolution, *beyond)?;
            } else if let Some(thread) = ThreadMove::from_action(action) {
                self.check_pass(&thread)?;
            }
        }
        let tapping = match action {
            Action::Tap { .. } if board.taps == TapCapability::Followed => {
                return self.check_board_spindle(action);
            }
            Action::Tap { .. } => true,
            Action::Spindle(SpindleCommand::Surface(_)) if !board.speed_follows_motion => {
                return Err(Alarm::new(number::BOARD_CANNOT)
                    .with_detail(surface_speed_refusal(board.has_timed_outputs)));
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
        Err(Alarm::new(number::BOARD_CANNOT).with_detail(spindle_required_message(&board, tapping)))
    }

    /// Marks an axis as being homed by the board; the next orders to the board request it.
    pub(crate) const fn start_board_homing(&mut self, axis: Axis) {
        *self.coordinates.referenced.get_mut(axis) = false;
        *self.coordinates.at_reference.get_mut(axis) = None;
        *self.coordinates.returns.get_mut(axis) = Some(ZeroReturnStage::BoardHoming);
    }

    /// Axes that the board is homing or must home.
    pub(crate) fn board_homing_axes(&self) -> PerAxis<bool> {
        let is_homing =
            |axis| *self.coordinates.returns.get(axis) == Some(ZeroReturnStage::BoardHoming);
        PerAxis::new(is_homing(Axis::X), is_homing(Axis::Z))
    }

    /// Ends the homing of the axes that are `true` by the board: their machine coordinates are now
    /// those in `at`, mm.
    pub(crate) fn finish_board_homing(&mut self, axes: PerAxis<bool>, at: Point) {
        self.settle_coordinates();
        self.forget_made_path();
        for axis in [Axis::X, Axis::Z] {
            if *axes.get(axis) {
                let mut shift = Point::default();
                *shift.get_mut(axis) = at.get(axis) - self.position().get(axis);
                self.drives.interpolator.translate(shift);
                self.drives.axis_chain.preset(axis, at.get(axis));
                self.shift_frame(shift);
                self.finish_return(axis, true);
            }
        }
    }

    /// Marks the position of the slides as unknown: no axis has a reference.
    pub(crate) fn drop_reference(&mut self) {
        self.coordinates.referenced = PerAxis::default();
        self.coordinates.at_reference = PerAxis::default();
    }

    /// Clears the bits of `outputs` in the ladder: the board has switched these outputs off without
    /// an order. The ladder continues from that state, and the displayed M code changes to match
    /// it.
    pub(crate) fn clear_dropped_outputs(&mut self, outputs: &[BitAddress]) {
        let memory = self.plc.engine.memory_mut();
        let mut any_cleared = false;
        for &output in outputs {
            any_cleared |= memory.bit(output);
            memory.set_bit(output, false);
        }
        if any_cleared {
            self.run.interpreter.record_machine_stop();
            self.run.modal.m = self.run.interpreter.modal().m;
        }
    }

    /// Ends all motion at the current position, including reference returns.
    pub(crate) fn end_motion_for_board(&mut self) {
        self.abandon_returns();
        self.forget_made_path();
        self.drives.interpolator.stop_now();
        self.hand.jog = PerAxis::default();
        self.hand.jog_blocked = PerAxis::new(true, true);
    }

    /// Ends all motion and the program run. Another report of the board raises the alarm that names
    /// the reason.
    pub(crate) fn stop_run_for_board(&mut self) {
        if self.run.automatic.is_operating() {
            self.stop_run(RunState::Stop);
        }
        self.end_motion_for_board();
    }

    /// Sets the position of the control to `pulses`, the pulse count at which the slides stopped.
    /// An axis whose count is unchanged keeps its coordinate exactly.
    pub(crate) fn set_count(&mut self, pulses: PerAxis<Pulses>) {
        let mut shift = Point::default();
        for axis in [Axis::X, Axis::Z] {
            let count = *pulses.get(axis);
            if count != *self.pulses().get(axis) {
                let coordinate = self.drives.axis_chain.set_count(axis, count);
                *shift.get_mut(axis) = coordinate - self.position().get(axis);
            }
        }
        if shift != Point::default() {
            self.forget_made_path();
        }
        self.drives.interpolator.translate(shift);
        let frame = self.coordinates.frame;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.set_frame(frame, &world);
    }

    /// Whether an alarm of the board or of its link is active.
    pub(crate) fn has_board_alarm(&self) -> bool {
        let mut active = self.alarms.list().iter();
        active.any(|alarm| alarm.class() == AlarmClass::Link)
    }
}
