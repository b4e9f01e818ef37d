//! Return to the machine zero and to the program zero (manual III-7, II-2.8.3).
//!
//! ```text
//!  A  (014 ZRS = 0)         ───────── rapid ─────────────────► coordinate 0
//!
//!  B  (ZRS = 1, 007 ZC = 0)
//!     speed  113 ───────────╮
//!            033            ╰────────────┬───┐
//!     switch ___________/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\____
//!     zero signal                            ▲  stop: machine zero
//!
//!  C  (ZRS = 1, ZC = 1)
//!     speed  113 ───────────╮
//!            033            ╰────────────╮
//!              0                         │   back at 033
//!     switch ___________/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\__/  stop: machine zero
//! ```
//!
//! X approaches at half of 113; the rapid override acts on the approach only. The zero
//! input latches the pulse count at which its signal changes, and the axis stops on that
//! pulse: the distance that the tick went too far is taken back. If this takes up backlash,
//! the axis first waits for its motor: a motor that still moves would stop on the other
//! flank of the screw.

use crate::alarm::{Alarm, number};
use crate::cnc::{Cnc, Event};
use crate::command::Action;
use crate::machine::Inputs;
use crate::mode::Mode;
use crate::motion::{JogRate, RapidOverride};
use crate::operation::{Return, RunState};
use crate::units::{Axis, PerAxis, Point, Pulses};
use gsk_messages::{Message, say};

/// Wait for a motor, ms. Of the following error of a servo with a gain of 20/s or more,
/// less than 0.1 % is left.
const REST_TICKS: u16 = 400;

/// Deceleration switches, X0.3 and X1.3.
const SWITCH_MASK: u8 = 1 << 3;

impl Cnc {
    /// Handles the keys of one axis in the zero modes: either key starts the return, and
    /// its release stops it. With 011.2 ZNIK one press is enough, because the ladder keeps
    /// the signal.
    pub(crate) fn return_keys(&mut self, axis: Axis, held: bool, pressed: bool) {
        if pressed && self.coordinates.returns.get(axis).is_none() {
            if let Err(alarm) = self.begin_return(axis) {
                self.raise(alarm);
            }
        } else if !held
            && !matches!(
                self.coordinates.returns.get(axis),
                None | Some(Return::Board)
            )
        {
            let stage = self.coordinates.returns.get_mut(axis).take();
            self.command_axis(axis, None);
            self.drives.interpolator.release(axis);
            self.advise_to_hold(axis, stage);
        }
    }

    /// Advises the operator when a return ended because its key was released. With 011.2
    /// ZNIK = 1 a key was pressed to stop it. Past the switch, a second try would find no
    /// switch and run to the end of the travel.
    fn advise_to_hold(&mut self, axis: Axis, stage: Option<Return>) {
        if *self.hand.axis_keys.get(axis) || self.memory.parameters.zero_keys_latch() {
            return;
        }
        let advice = match stage {
            Some(Return::Approach | Return::Straight) => say::return_broken_off(axis),
            _ => say::return_broken_off_late(axis, self.way_off_switch(axis)),
        };
        self.events.push(Event::Advised(advice));
    }

    fn begin_return(&mut self, axis: Axis) -> Result<(), Alarm> {
        if self.run.mode == Mode::ProgramZero {
            let zero = self.coordinates.program_zero.ok_or_else(|| {
                Alarm::new(number::ZERO_UNDEFINED).because(say::zero_of_program_never_set())
            })?;
            self.drives
                .interpolator
                .go_to(axis, zero.get(axis), JogRate::Rapid);
            *self.coordinates.returns.get_mut(axis) = Some(Return::Straight);
            return Ok(());
        }
        self.seek_reference(axis)
    }

    /// Starts the return of an axis to its machine zero.
    fn seek_reference(&mut self, axis: Axis) -> Result<(), Alarm> {
        if let Some(board) = self.drives.board
            && self.memory.parameters.has_zero_switch(axis)
        {
            return self.seek_with_board(axis, &board);
        }
        if self.board_seeks() {
            // The switch of the other axis would stop this one dead.
            return Ok(());
        }
        let stage = if !self.memory.parameters.has_zero_switch(axis) {
            if !*self.coordinates.referenced.get(axis) {
                return Err(Alarm::new(number::ZERO_UNDEFINED).because(say::zero_never_set()));
            }
            self.drives.interpolator.go_to(axis, 0.0, JogRate::Rapid);
            Return::Straight
        } else if self.coordinates.at_reference.get(axis).is_some()
            || *self.plc.signals.machine_lock.get(axis)
        {
            return Ok(());
        } else if self.on_zero_switch(axis) {
            return Err(self.begins_on_switch(axis));
        } else {
            Return::Approach
        };
        *self.coordinates.returns.get_mut(axis) = Some(stage);
        Ok(())
    }

    /// The alarm for a return that begins on its switch; it names the direction off it.
    pub(crate) fn begins_on_switch(&self, axis: Axis) -> Alarm {
        let way = self.way_off_switch(axis);
        Alarm::new(number::ZERO_RETURN).because(say::return_on_switch(axis, way))
    }

    /// The direction away from the machine zero, such as `X-`.
    fn way_off_switch(&self, axis: Axis) -> String {
        let negative = self.memory.parameters.zero_is_negative(axis);
        format!("{axis}{}", if negative { '+' } else { '-' })
    }

    /// The reason of a stop during an approach: the switch was not reached.
    pub(crate) fn unmet_switch(&self, axis: Axis) -> Option<Message> {
        let approaches = *self.coordinates.returns.get(axis) == Some(Return::Approach);
        approaches.then(|| say::return_before_switch(axis))
    }

    /// G28: starts the search for the reference points of axes without one. Axes that have
    /// one are already there.
    pub(crate) fn begin_zero_return(&mut self, x: bool, z: bool) -> Result<(), Alarm> {
        let mut axes = [(Axis::X, x), (Axis::Z, z)];
        // Axes without a switch first.
        axes.sort_by_key(|(axis, _)| self.memory.parameters.has_zero_switch(*axis));
        for (axis, taken) in axes {
            if taken && *self.coordinates.referenced.get(axis) {
                self.stand_on_reference(axis);
            } else if taken {
                self.seek_reference(axis)?;
            }
        }
        Ok(())
    }

    /// Whether a return of any axis is under way.
    pub(crate) const fn returning(&self) -> bool {
        self.coordinates.returns.x.is_some() || self.coordinates.returns.z.is_some()
    }

    /// Abandons the returns under way and stops their axes.
    pub(crate) fn abandon_returns(&mut self) {
        for axis in [Axis::X, Axis::Z] {
            if self.coordinates.returns.get_mut(axis).take().is_some() {
                *self.hand.jog.get_mut(axis) = None;
                self.drives.interpolator.release(axis);
            }
        }
    }

    /// Advances the returns under way by one tick.
    pub(crate) fn return_tick(&mut self, inputs: &Inputs) {
        if !self.returning() {
            return;
        }
        if self.emergency_stop || self.resetting() || self.is_not_ready() {
            return self.abandon_returns();
        }
        for axis in [Axis::X, Axis::Z] {
            if let Some(stage) = *self.coordinates.returns.get(axis) {
                self.go_on(axis, stage, *inputs.index_latch.get(axis));
            }
        }
    }

    fn go_on(&mut self, axis: Axis, stage: Return, latch: Option<Pulses>) {
        if let Return::Rest { ticks, shifted } = stage {
            return self.rest(axis, ticks, shifted);
        }
        if self.return_with_board(axis, stage) {
            return;
        }
        let low = self.memory.parameters.zero_low_rate();
        // The deceleration switch may be too short to brake on: the signal counts only at
        // the low rate.
        let slow = self.drives.interpolator.manual_speed(axis) <= low * 1.001;
        let next = match stage {
            Return::Straight => return self.go_straight(axis),
            Return::Board | Return::Leave | Return::Past(_) | Return::Rest { .. } => return,
            Return::Approach if self.on_zero_switch(axis) => Return::OnSwitch,
            Return::OnSwitch if !self.on_zero_switch(axis) => {
                if self.memory.parameters.one_zero_switch(axis) {
                    Return::Turning
                } else {
                    Return::Search
                }
            }
            Return::Turning if self.drives.interpolator.manual_speed(axis) <= 0.0 => Return::Back,
            Return::Search | Return::Back if slow && latch.is_some() => {
                return self.meet_zero(axis, latch);
            }
            stage => stage,
        };
        *self.coordinates.returns.get_mut(axis) = Some(next);
        self.drive_return(axis, next);
    }

    fn go_straight(&mut self, axis: Axis) {
        if self.drives.interpolator.stepping(axis) {
            return self.guide_step(axis, JogRate::Rapid);
        }
        let zero = match self.run.mode {
            Mode::ProgramZero => self.coordinates.program_zero.map(|zero| zero.get(axis)),
            _ => Some(0.0),
        };
        if zero == Some(self.position().get(axis)) {
            self.arrive(axis, false);
        } else {
            // A limit has stopped the axis.
            *self.coordinates.returns.get_mut(axis) = None;
        }
    }

    /// Sets speed and direction of a return, as far as the interlocks permit.
    pub(crate) fn drive_return(&mut self, axis: Axis, stage: Return) {
        let back = matches!(stage, Return::Back | Return::Leave);
        let negative = self.memory.parameters.zero_is_negative(axis) != back;
        let way = if negative {
            crate::operation::Direction::Minus
        } else {
            crate::operation::Direction::Plus
        };
        let held = self.return_held(axis) || !self.board_lets_return(axis);
        let rate = match stage {
            Return::Approach => self.approach_rate(axis),
            _ => self.memory.parameters.zero_low_rate(),
        };
        let stands = stage == Return::Turning || held || !self.may_go(axis, way);
        let command = (!stands).then_some((!negative, JogRate::Approach(rate)));
        self.command_axis(axis, command);
    }

    /// Whether something prevents a return from continuing.
    pub(crate) fn return_held(&self, axis: Axis) -> bool {
        let by_program = self.run.automatic.state == RunState::Run && self.plc.signals.start_lock;
        by_program || self.run.automatic.state == RunState::Hold || self.interlocked(axis)
    }

    fn approach_rate(&self, axis: Axis) -> f64 {
        let rate = self.memory.parameters.zero_approach_rate(axis);
        match RapidOverride::from_percent(self.plc.signals.rapid_override) {
            RapidOverride::F0 => self.memory.parameters.rapid_lowest().min(rate),
            RapidOverride::Percent(percent) => rate * f64::from(percent.min(100)) / 100.0,
        }
    }

    /// Whether the deceleration switch is pressed (004.5 DECI).
    pub(crate) fn on_zero_switch(&self, axis: Axis) -> bool {
        let byte = match axis {
            Axis::X => 0,
            Axis::Z => 1,
        };
        let closed = self.plc.filter.accepted()[byte] & SWITCH_MASK != 0;
        closed == self.memory.parameters.closed_means_deceleration()
    }

    /// Makes the position of the zero signal's pulse the machine zero.
    pub(crate) fn meet_zero(&mut self, axis: Axis, latch: Option<Pulses>) {
        let Some(count) = latch else { return };
        let here = self.drives.chain.zero_at(axis, count);
        let mut shift = Point::default();
        *shift.get_mut(axis) = here - self.position().get(axis);
        self.drives.interpolator.translate(shift);
        self.command_axis(axis, None);
        self.shift_frame(shift);
        let shifted = shift.get(axis).abs() > 1e-9;
        let turns_round = here.abs() > 1e-9 && self.memory.parameters.backlash(axis) != 0.0;
        if turns_round {
            self.drives.interpolator.stop_on(axis, here);
            let ticks = REST_TICKS;
            *self.coordinates.returns.get_mut(axis) = Some(Return::Rest { ticks, shifted });
            return;
        }
        self.drives.interpolator.stop_on(axis, 0.0);
        self.arrive(axis, shifted);
    }

    /// Waits until the motor has stopped, then moves back to the pulse of the zero signal.
    fn rest(&mut self, axis: Axis, ticks: u16, shifted: bool) {
        if let Some(left) = ticks.checked_sub(1) {
            let ticks = left;
            *self.coordinates.returns.get_mut(axis) = Some(Return::Rest { ticks, shifted });
            return;
        }
        self.drives.interpolator.stop_on(axis, 0.0);
        self.arrive(axis, shifted);
    }

    /// Whether an axis waits for its motor within a return.
    pub(crate) const fn rests(&self) -> bool {
        matches!(self.coordinates.returns.x, Some(Return::Rest { .. }))
            || matches!(self.coordinates.returns.z, Some(Return::Rest { .. }))
    }

    /// Ends a return; `shifted`: the machine coordinates have changed.
    pub(crate) fn arrive(&mut self, axis: Axis, shifted: bool) {
        *self.coordinates.returns.get_mut(axis) = None;
        let before = self.coordinates.frame;
        if self.run.mode == Mode::ProgramZero {
            *self.coordinates.frame.offset.get_mut(axis) = 0.0;
            *self.coordinates.program_zero_ended.get_mut(axis) = false;
            self.tell_frame();
        } else {
            self.stand_on_reference(axis);
        }
        let by_program = matches!(self.run.automatic.action(), Some(Action::ZeroReturn { .. }));
        if !by_program && (shifted || before != self.coordinates.frame) {
            // The rest of a stopped program was read for the old coordinates.
            self.forget_stopped_program();
        }
        if !by_program {
            let (interpreter, world) = self.interpreter_and_world(true);
            interpreter.cancel_offset(axis, &world);
            if self.run.interpreter.modal().offset == 0 {
                self.run.tool.1 = 0;
            }
        }
    }

    /// Sets the state of an axis at its reference point: lamp, coordinates of 049 and 050
    /// (012.7 APRS), end of the tool offset.
    fn stand_on_reference(&mut self, axis: Axis) {
        let at = self.position().get(axis);
        *self.coordinates.referenced.get_mut(axis) = true;
        *self.coordinates.at_reference.get_mut(axis) = Some(at);
        *self.coordinates.frame.offset.get_mut(axis) = 0.0;
        if self.memory.parameters.reference_sets_coordinates() {
            let shown = self.coordinates.frame.program(self.position()).get(axis);
            let coordinate = self.memory.parameters.reference_coordinate(axis);
            *self.coordinates.frame.zero.get_mut(axis) = at - coordinate;
            self.coordinates.frame.zero_offset.clear(axis);
            let relative = self.coordinates.relative_zero.get_mut(axis);
            if self.memory.parameters.g50_sets_relative() {
                *relative = 0.0;
            } else {
                *relative += coordinate - shown;
            }
        }
        self.tell_frame();
    }

    /// Method A: makes the present position of an axis its machine zero (取消 and the letter
    /// of the axis on the page of all positions). Axes with a zero switch are not changed.
    pub(crate) fn set_machine_zero(&mut self, axis: Axis) {
        let at_rest = !self.is_moving() && !self.run.automatic.operating();
        if self.memory.parameters.has_zero_switch(axis) || !at_rest {
            return;
        }
        self.forget_stopped_program();
        self.settle_coordinates();
        let mut shift = Point::default();
        *shift.get_mut(axis) = -self.position().get(axis);
        self.drives.interpolator.translate(shift);
        self.drives.chain.preset(axis, 0.0);
        self.shift_frame(shift);
        *self.coordinates.referenced.get_mut(axis) = true;
        self.tell_frame();
    }

    /// Axes that keep their reference when pulses were lost: those of method A.
    pub fn reference_without_switch(&self) -> PerAxis<bool> {
        let kept = |axis| {
            *self.coordinates.referenced.get(axis) && !self.memory.parameters.has_zero_switch(axis)
        };
        PerAxis::new(kept(Axis::X), kept(Axis::Z))
    }

    /// Shifts the machine coordinates; the program coordinates stay.
    pub(crate) fn shift_frame(&mut self, shift: Point) {
        self.coordinates.frame.zero = self.coordinates.frame.zero + shift;
        if let Some(zero) = &mut self.coordinates.program_zero {
            *zero = *zero + shift;
        }
    }

    fn tell_frame(&mut self) {
        let frame = self.coordinates.frame;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.set_frame(frame, &world);
    }

    fn forget_stopped_program(&mut self) {
        if self.run.automatic.state == RunState::Reset {
            return;
        }
        self.abandon_current();
        self.run.held = None;
        if let Some(last) = self.run.automatic.last {
            self.run.cursor_line = last.line;
        }
        self.run.automatic.clear();
    }
}
