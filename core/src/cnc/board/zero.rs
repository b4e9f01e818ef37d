//! The return to the machine zero on a board that sees its switches itself (manual
//! III-7): the same stages, but the edge of a switch stops the axes in the board,
//! and the next stage begins where the board says it stopped them.
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
//!  Without such a switch the limit switch takes its place: back off it, and a little
//!  farther.
//! ```

use crate::alarm::{Alarm, number};
use crate::board::BoardDrives;
use crate::cnc::Cnc;
use crate::motion::JogRate;
use crate::operation::{Direction, Return};
use crate::units::{Axis, PerAxis, Point};
use gsk_link::{AwaitedInput, Input, InputCondition};
use gsk_messages::say;

impl Cnc {
    /// Begins the return of an axis with a switch at the board.
    pub(crate) fn seek_with_board(&mut self, axis: Axis, board: &BoardDrives) -> Result<(), Alarm> {
        let outgrown = board
            .checked
            .and_then(|checked| checked.alarm(&self.memory.parameters));
        if let Some(alarm) = outgrown {
            return Err(alarm);
        }
        let Some(wiring) = board.zero.map(|zero| *zero.get(axis)) else {
            self.check_other_switch(axis, board)?;
            self.board_makes_return(axis);
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
        if !(wiring.switch || wiring.limit) {
            return Err(
                Alarm::new(number::BOARD_ZERO_RETURN).because(say::zero_switch_not_wired(name))
            );
        }
        if wiring.switch && !wiring.signal && !self.memory.parameters.one_zero_switch(axis) {
            return Err(Alarm::new(number::BOARD_ZERO_RETURN)
                .because(say::zero_signal_not_wired(bit, name)));
        }
        if wiring.switch && self.on_zero_switch(axis) {
            return Err(self.begins_on_switch(axis));
        }
        let rate = self.memory.parameters.zero_approach_rate(axis);
        let pulses = rate / 60.0 * board.pulses_per_mm[axis as usize];
        let most = board.rates.each[axis as usize];
        if pulses > most {
            return Err(
                Alarm::new(number::BOARD_CANNOT).because(say::zero_approach_too_fast(
                    pulses,
                    format!("{axis:?}"),
                    most,
                )),
            );
        }
        let leaves = !wiring.switch && wiring.on_limit;
        // Stopped dead by its switch, a fast stepper may slip.
        *self.coordinates.referenced.get_mut(axis) = false;
        *self.coordinates.at_reference.get_mut(axis) = None;
        *self.coordinates.returns.get_mut(axis) = Some(if leaves {
            Return::Leave
        } else {
            Return::Approach
        });
        Ok(())
    }

    /// A board that seeks all switches with one order seeks one that is not there to the
    /// end of the axis.
    fn check_other_switch(&self, axis: Axis, board: &BoardDrives) -> Result<(), Alarm> {
        let (other, bit) = match axis {
            Axis::X => (Axis::Z, 1),
            Axis::Z => (Axis::X, 0),
        };
        if board.alone || self.memory.parameters.has_zero_switch(other) {
            return Ok(());
        }
        Err(Alarm::new(number::BOARD_ZERO_RETURN)
            .because(say::zero_switch_of_other_axis(bit, format!("{other:?}"))))
    }

    /// Whether returns to a switch are under way that the board must not stop other
    /// motion for.
    pub(crate) fn board_seeks(&self) -> bool {
        let seeks = |stage: Option<Return>| stage.is_some_and(|stage| stage != Return::Straight);
        self.drives.board.is_some_and(|board| board.zero.is_some())
            && (seeks(self.coordinates.returns.x) || seeks(self.coordinates.returns.z))
    }

    /// Whether the board makes the return by itself.
    pub(crate) fn board_homes(&self) -> bool {
        self.drives.board.is_some_and(|board| board.zero.is_none())
    }

    /// What the return of an axis waits for at the board.
    pub(crate) fn board_awaits(&self, axis: Axis) -> Option<AwaitedInput> {
        let board = self.drives.board?;
        let wiring = *board.zero?.get(axis);
        let stage = (*self.coordinates.returns.get(axis))?;
        if [self.coordinates.returns.x, self.coordinates.returns.z]
            .contains(&Some(Return::Straight))
        {
            // A rapid to a known place is not stopped dead.
            return None;
        }
        let [switch, signal, limit] = match axis {
            Axis::X => [Input::DecelerationX, Input::ZeroX, Input::LimitX],
            Axis::Z => [Input::DecelerationZ, Input::ZeroZ, Input::LimitZ],
        };
        let reference = if wiring.switch { switch } else { limit };
        let low = self.memory.parameters.zero_low_rate();
        let (input, until, rate) = match stage {
            Return::Approach => {
                let rate = self.memory.parameters.zero_approach_rate(axis);
                (reference, InputCondition::Operated, rate)
            }
            Return::OnSwitch => (switch, InputCondition::Free, low),
            Return::Leave => (limit, InputCondition::Free, low),
            Return::Search => (signal, InputCondition::Changed, low),
            Return::Back => (switch, InputCondition::Operated, low),
            Return::Straight
            | Return::Turning
            | Return::Past(_)
            | Return::Board
            | Return::Rest { .. } => return None,
        };
        Some(AwaitedInput {
            input,
            until,
            rate: rate / 60.0 * board.pulses_per_mm[axis as usize],
        })
    }

    /// Whether the board looks at the switch that the return of an axis waits for.
    pub(crate) fn board_lets_return(&self, axis: Axis) -> bool {
        self.drives.board.is_none_or(|board| {
            board.zero.is_none()
                || (board.armed.get(axis).is_some()
                    && *board.armed.get(axis) == self.board_awaits(axis)
                    && board.prepared
                    && board.takes_motion)
        })
    }

    /// The board has stopped the axes at a switch: the control waits for where.
    pub(crate) fn pause_for_board(&mut self) {
        self.drives.interpolator.stop_now();
        self.hand.jog = PerAxis::default();
    }

    /// An axis stands where its switch was met.
    pub(crate) fn board_reached(&mut self, axis: Axis) {
        let Some(wiring) = self.drives.board.and_then(|board| board.zero) else {
            return;
        };
        let wiring = *wiring.get(axis);
        let toward = if self.memory.parameters.zero_is_negative(axis) {
            -1.0
        } else {
            1.0
        };
        let here = self.position().get(axis);
        let past = |way: f64| Return::Past(libm::round((here + way * wiring.off) * 1000.0) as i64);
        let next = match *self.coordinates.returns.get(axis) {
            Some(Return::Approach) if !wiring.switch => Return::Leave,
            Some(Return::Approach) => Return::OnSwitch,
            Some(Return::OnSwitch) if self.memory.parameters.one_zero_switch(axis) => past(toward),
            Some(Return::OnSwitch) => Return::Search,
            Some(Return::Leave) => past(-toward),
            Some(Return::Search | Return::Back) => {
                let count = *self.pulses().get(axis);
                return self.meet_zero(axis, Some(count));
            }
            _ => return,
        };
        *self.coordinates.returns.get_mut(axis) = Some(next);
    }

    /// A tick of a return at the board; whether there is nothing more to do for it.
    pub(crate) fn return_with_board(&mut self, axis: Axis, stage: Return) -> bool {
        let Some(board) = self.drives.board else {
            return false;
        };
        let (Some(zero), false) = (board.zero, stage == Return::Straight) else {
            return false;
        };
        if let Return::Past(target) = stage {
            let target = target as f64 / 1000.0;
            let way = Direction::of(target - self.position().get(axis));
            let waits = self.return_held(axis) || !(board.prepared && board.takes_motion);
            match way {
                None if zero.get(axis).switch => {
                    self.drives.interpolator.release(axis);
                    *self.coordinates.returns.get_mut(axis) = Some(Return::Back);
                }
                None => {
                    let mut place = Point::default();
                    *place.get_mut(axis) = zero.get(axis).at;
                    let axes = PerAxis::new(axis == Axis::X, axis == Axis::Z);
                    self.board_returned(axes, place);
                }
                Some(way) if waits || !self.may_go(axis, way) => {
                    self.drives.interpolator.release(axis);
                }
                Some(_) if !self.drives.interpolator.stepping(axis) => {
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
