//! Reference return on a board that reads the switches (manual III-7): the stages are the
//! same, but the edge of a switch stops the axes in the board, and the next stage begins at
//! the position that the board reports.
//!
//! ```text
//!  B    113 ────────╮ dead stop on the switch
//!       033         ╰────────┬──────┤ zero
//!       switch _____/‾‾‾‾‾‾‾‾\_______
//!       zero signal __________________/‾
//!
//!  C    113 ────────╮
//!       033         ╰────────┬───╮
//!       033             zero ├───╯ back
//!       switch _____/‾‾‾‾‾‾‾‾\_____
//!
//! ```
//!
//! Without such a switch the limit switch replaces it: the axis backs off it, and a little
//! farther.

use crate::alarm::{Alarm, number};
use crate::board::BoardDrives;
use crate::cnc::Cnc;
use crate::motion::JogRate;
use crate::operation::{AxisDirection, ZeroReturnStage};
use crate::units::{Axis, PerAxis, Point};
use gsk_link::{AwaitedInput, Input, InputCondition};
use gsk_messages::say;

impl Cnc {
    /// Starts the reference return of an axis whose switches a board reads; a board with its own
    /// homing homes the axis.
    ///
    /// # Errors
    /// The alarm for a switch that is not wired, an axis that is already on its switch, an approach
    /// that is too fast, or a changed parameter.
    pub(crate) fn start_return_with_board(
        &mut self,
        axis: Axis,
        board: &BoardDrives,
    ) -> Result<(), Alarm> {
        let changed_parameter = board
            .checked_parameters
            .and_then(|checked| checked.to_alarm(&self.memory.parameters));
        if let Some(alarm) = changed_parameter {
            return Err(alarm);
        }
        let Some(wiring) = board.zero_wiring.map(|zero| *zero.get(axis)) else {
            self.check_other_switch(axis, board)?;
            self.start_board_homing(axis);
            return Ok(());
        };
        if self.coordinates.at_reference.get(axis).is_some()
            || *self.plc.signals.machine_lock.get(axis)
        {
            return Ok(());
        }
        let (name, bit) = match axis {
            Axis::X => ('x', 0),
            Axis::Z => ('z', 1),
        };
        if !(wiring.has_deceleration_switch || wiring.has_limit_switch) {
            return Err(
                Alarm::new(number::BOARD_ZERO_RETURN).with_detail(say::zero_switch_not_wired(name))
            );
        }
        if wiring.has_deceleration_switch
            && !wiring.has_zero_signal
            && !self.memory.parameters.has_one_zero_switch(axis)
        {
            return Err(Alarm::new(number::BOARD_ZERO_RETURN)
                .with_detail(say::zero_signal_not_wired(bit, name)));
        }
        if wiring.has_deceleration_switch && self.is_on_zero_switch(axis) {
            return Err(self.on_switch_alarm(axis));
        }
        let rate = self.memory.parameters.zero_approach_rate(axis);
        let pulses = rate / 60.0 * board.pulses_per_mm[axis as usize];
        let max_rate = board.rates.each[axis as usize];
        if pulses > max_rate {
            return Err(
                Alarm::new(number::BOARD_CANNOT).with_detail(say::zero_approach_too_fast(
                    pulses,
                    format!("{axis:?}"),
                    max_rate,
                )),
            );
        }
        let is_on_limit = !wiring.has_deceleration_switch && wiring.is_on_limit;
        // A fast stepper may lose steps at the dead stop on its switch.
        *self.coordinates.referenced.get_mut(axis) = false;
        *self.coordinates.at_reference.get_mut(axis) = None;
        *self.coordinates.returns.get_mut(axis) = Some(if is_on_limit {
            ZeroReturnStage::LeaveLimit
        } else {
            ZeroReturnStage::Approach
        });
        Ok(())
    }

    /// Checks that the other axis has a zero switch if the board homes both axes together; returns
    /// an alarm as error if not. The board would seek a missing switch to the end of the axis.
    fn check_other_switch(&self, axis: Axis, board: &BoardDrives) -> Result<(), Alarm> {
        let (other, bit) = match axis {
            Axis::X => (Axis::Z, 1),
            Axis::Z => (Axis::X, 0),
        };
        if board.homes_axes_separately || self.memory.parameters.has_zero_switch(other) {
            return Ok(());
        }
        Err(Alarm::new(number::BOARD_ZERO_RETURN)
            .with_detail(say::zero_switch_of_other_axis(bit, format!("{other:?}"))))
    }

    /// Whether a reference return that the control drives is seeking a switch of the board. Other
    /// motion must not start then, because the switch would stop it, too.
    pub(crate) fn is_board_seeking(&self) -> bool {
        let is_seeking = |stage: Option<ZeroReturnStage>| {
            stage.is_some_and(|stage| stage != ZeroReturnStage::Straight)
        };
        self.drives
            .board
            .is_some_and(|board| board.zero_wiring.is_some())
            && (is_seeking(self.coordinates.returns.x) || is_seeking(self.coordinates.returns.z))
    }

    /// Whether the board can home axes itself.
    pub(crate) fn can_board_home(&self) -> bool {
        self.drives
            .board
            .is_some_and(|board| board.zero_wiring.is_none())
    }

    /// Returns the input of the board for which the reference return of an axis waits now; `None`
    /// without one.
    pub(crate) fn awaited_input(&self, axis: Axis) -> Option<AwaitedInput> {
        let board = self.drives.board?;
        let wiring = *board.zero_wiring?.get(axis);
        let stage = (*self.coordinates.returns.get(axis))?;
        if [self.coordinates.returns.x, self.coordinates.returns.z]
            .contains(&Some(ZeroReturnStage::Straight))
        {
            // A rapid to a known position does not end with a dead stop.
            return None;
        }
        let [switch, signal, limit] = match axis {
            Axis::X => [Input::DecelerationX, Input::ZeroX, Input::LimitX],
            Axis::Z => [Input::DecelerationZ, Input::ZeroZ, Input::LimitZ],
        };
        let reference = if wiring.has_deceleration_switch {
            switch
        } else {
            limit
        };
        let low = self.memory.parameters.zero_low_rate();
        let (input, until, rate) = match stage {
            ZeroReturnStage::Approach => {
                let rate = self.memory.parameters.zero_approach_rate(axis);
                (reference, InputCondition::Operated, rate)
            }
            ZeroReturnStage::OnSwitch => (switch, InputCondition::Free, low),
            ZeroReturnStage::LeaveLimit => (limit, InputCondition::Free, low),
            ZeroReturnStage::Search => (signal, InputCondition::Changed, low),
            ZeroReturnStage::Back => (switch, InputCondition::Operated, low),
            ZeroReturnStage::Straight
            | ZeroReturnStage::Stopping
            | ZeroReturnStage::PastEdge(_)
            | ZeroReturnStage::BoardHoming
            | ZeroReturnStage::MotorWait { .. } => return None,
        };
        Some(AwaitedInput {
            input,
            until,
            rate: rate / 60.0 * board.pulses_per_mm[axis as usize],
        })
    }

    /// Whether the board watches the switch for which the reference return of an axis waits; true
    /// if no board needs to watch one.
    pub(crate) fn is_board_armed(&self, axis: Axis) -> bool {
        self.drives.board.is_none_or(|board| {
            board.zero_wiring.is_none()
                || (board.armed_inputs.get(axis).is_some()
                    && *board.armed_inputs.get(axis) == self.awaited_input(axis)
                    && board.is_prepared
                    && board.takes_motion)
        })
    }

    /// Stops the motion in the control because the board has stopped the axes at a switch. The
    /// report of the position follows.
    pub(crate) fn stop_for_switch(&mut self) {
        self.drives.interpolator.stop_now();
        self.hand.jog = PerAxis::default();
    }

    /// Changes to the next stage of the reference return of an axis that the board has stopped at
    /// its switch.
    pub(crate) fn handle_switch_reached(&mut self, axis: Axis) {
        let Some(wiring) = self.drives.board.and_then(|board| board.zero_wiring) else {
            return;
        };
        let wiring = *wiring.get(axis);
        let towards_zero = if self.memory.parameters.is_zero_negative(axis) {
            -1.0
        } else {
            1.0
        };
        let here = self.position().get(axis);
        let past_position = |direction: f64| {
            ZeroReturnStage::PastEdge(
                libm::round((here + direction * wiring.pull_off_mm) * 1000.0) as i64,
            )
        };
        let next = match *self.coordinates.returns.get(axis) {
            Some(ZeroReturnStage::Approach) if !wiring.has_deceleration_switch => {
                ZeroReturnStage::LeaveLimit
            }
            Some(ZeroReturnStage::Approach) => ZeroReturnStage::OnSwitch,
            Some(ZeroReturnStage::OnSwitch) if self.memory.parameters.has_one_zero_switch(axis) => {
                past_position(towards_zero)
            }
            Some(ZeroReturnStage::OnSwitch) => ZeroReturnStage::Search,
            Some(ZeroReturnStage::LeaveLimit) => past_position(-towards_zero),
            Some(ZeroReturnStage::Search | ZeroReturnStage::Back) => {
                let count = *self.pulses().get(axis);
                return self.set_machine_zero_at(axis, Some(count));
            }
            _ => return,
        };
        *self.coordinates.returns.get_mut(axis) = Some(next);
    }

    /// Advances the reference return of an axis whose switches the board reads, in the stage
    /// `stage`. Returns false if the return without a board applies.
    pub(crate) fn advance_board_return(&mut self, axis: Axis, stage: ZeroReturnStage) -> bool {
        let Some(board) = self.drives.board else {
            return false;
        };
        let (Some(zero), false) = (board.zero_wiring, stage == ZeroReturnStage::Straight) else {
            return false;
        };
        if let ZeroReturnStage::PastEdge(target) = stage {
            let target = target as f64 / 1000.0;
            let direction = AxisDirection::from_distance(target - self.position().get(axis));
            let is_waiting =
                self.is_return_held(axis) || !(board.is_prepared && board.takes_motion);
            match direction {
                None if zero.get(axis).has_deceleration_switch => {
                    self.drives.interpolator.release_axis(axis);
                    *self.coordinates.returns.get_mut(axis) = Some(ZeroReturnStage::Back);
                }
                None => {
                    let mut home = Point::default();
                    *home.get_mut(axis) = zero.get(axis).home_mm;
                    let axes = PerAxis::new(axis == Axis::X, axis == Axis::Z);
                    self.finish_board_homing(axes, home);
                }
                Some(direction) if is_waiting || !self.can_move(axis, direction) => {
                    self.drives.interpolator.release_axis(axis);
                }
                Some(_) if !self.drives.interpolator.is_stepping(axis) => {
                    let rate = JogRate::Approach(self.memory.parameters.zero_low_rate());
                    self.drives.interpolator.go_to(axis, target, rate);
                }
                Some(_) => {}
            }
        } else {
            self.drive_return(axis, stage);
        }
        true
    }
}
