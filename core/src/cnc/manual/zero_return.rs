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
use crate::machine::MachineInputs;
use crate::mode::OperatingMode;
use crate::motion::{JogRate, RapidOverride};
use crate::operation::{RunState, ZeroReturnStage};
use crate::units::{Axis, PerAxis, Point, Pulses};
use gsk_messages::{Message, say};

/// Time to wait until a motor has stopped, ticks of 1 ms. Less than 0.1 % of the following error
/// then remains for a servo with a gain of 20/s or more.
const MOTOR_WAIT_TICKS: u16 = 400;

/// Mask of the bit of the deceleration switches X0.3 and X1.3 in their bytes.
const SWITCH_MASK: u8 = 1 << 3;

impl Cnc {
    /// Handles the keys of one axis in the zero return modes: either key starts the return, and its
    /// release stops it. `held` and `pressed` tell whether a key is down and whether it went down
    /// in this tick. With 011.2 ZNIK one press is enough, because the ladder keeps the signal.
    pub(crate) fn handle_return_keys(&mut self, axis: Axis, held: bool, pressed: bool) {
        if pressed && self.coordinates.returns.get(axis).is_none() {
            if let Err(alarm) = self.start_return(axis) {
                self.raise(alarm);
            }
        } else if !held
            && !matches!(
                self.coordinates.returns.get(axis),
                None | Some(ZeroReturnStage::BoardHoming)
            )
        {
            let stage = self.coordinates.returns.get_mut(axis).take();
            self.command_axis(axis, None);
            self.drives.interpolator.release_axis(axis);
            self.advise_on_released_key(axis, stage);
        }
    }

    /// Advises the operator when a return ended at `stage` because its key was released. No
    /// advice with 011.2 ZNIK = 1, when a key was pressed to stop the return. Past the
    /// switch, a second try would not find the switch and would run to the end of the
    /// travel.
    fn advise_on_released_key(&mut self, axis: Axis, stage: Option<ZeroReturnStage>) {
        if *self.hand.axis_keys.get(axis) || self.memory.parameters.are_zero_keys_latched() {
            return;
        }
        let advice = match stage {
            Some(ZeroReturnStage::Approach | ZeroReturnStage::Straight) => {
                say::return_broken_off(axis)
            }
            _ => say::return_broken_off_late(axis, self.direction_off_switch(axis)),
        };
        self.events.push(Event::Advised(advice));
    }

    fn start_return(&mut self, axis: Axis) -> Result<(), Alarm> {
        if self.run.mode == OperatingMode::ProgramZero {
            let zero = self.coordinates.program_zero.ok_or_else(|| {
                Alarm::new(number::ZERO_UNDEFINED).with_detail(say::zero_of_program_never_set())
            })?;
            self.drives
                .interpolator
                .go_to(axis, zero.get(axis), JogRate::Rapid);
            *self.coordinates.returns.get_mut(axis) = Some(ZeroReturnStage::Straight);
            return Ok(());
        }
        self.start_reference_return(axis)
    }

    /// Starts the return of an axis to its machine zero, with or without a board.
    ///
    /// # Errors
    /// The alarm for a machine zero that was never set, or for an axis that is already on its
    /// switch.
    fn start_reference_return(&mut self, axis: Axis) -> Result<(), Alarm> {
        if let Some(board) = self.drives.board
            && self.memory.parameters.has_zero_switch(axis)
        {
            return self.start_return_with_board(axis, &board);
        }
        if self.is_board_seeking() {
            // The switch of the other axis would stop this one dead.
            return Ok(());
        }
        let stage = if !self.memory.parameters.has_zero_switch(axis) {
            if !*self.coordinates.referenced.get(axis) {
                return Err(Alarm::new(number::ZERO_UNDEFINED).with_detail(say::zero_never_set()));
            }
            self.drives.interpolator.go_to(axis, 0.0, JogRate::Rapid);
            ZeroReturnStage::Straight
        } else if self.coordinates.at_reference.get(axis).is_some()
            || *self.plc.signals.machine_lock.get(axis)
        {
            return Ok(());
        } else if self.is_on_zero_switch(axis) {
            return Err(self.on_switch_alarm(axis));
        } else {
            ZeroReturnStage::Approach
        };
        *self.coordinates.returns.get_mut(axis) = Some(stage);
        Ok(())
    }

    /// The alarm for a return that would begin on its switch; its detail names the
    /// direction off the switch.
    pub(crate) fn on_switch_alarm(&self, axis: Axis) -> Alarm {
        let direction = self.direction_off_switch(axis);
        Alarm::new(number::ZERO_RETURN).with_detail(say::return_on_switch(axis, direction))
    }

    /// Axis and direction away from the machine zero as a text, such as `X-`.
    fn direction_off_switch(&self, axis: Axis) -> String {
        let negative = self.memory.parameters.is_zero_negative(axis);
        format!("{axis}{}", if negative { '+' } else { '-' })
    }

    /// Message for the operator that the return of an axis was stopped before it reached its
    /// switch; `None` if the axis is not approaching its switch.
    pub(crate) fn missed_switch_message(&self, axis: Axis) -> Option<Message> {
        let is_approaching = *self.coordinates.returns.get(axis) == Some(ZeroReturnStage::Approach);
        is_approaching.then(|| say::return_before_switch(axis))
    }

    /// Starts G28 for the axes that are `true`: axes without a reference point search for it; the
    /// others are already at theirs. Returns the alarm of a return that cannot start as error.
    pub(crate) fn start_zero_return(&mut self, x: bool, z: bool) -> Result<(), Alarm> {
        let mut axes = [(Axis::X, x), (Axis::Z, z)];
        // Axes without a switch first.
        axes.sort_by_key(|(axis, _)| self.memory.parameters.has_zero_switch(*axis));
        for (axis, takes_part) in axes {
            if takes_part && *self.coordinates.referenced.get(axis) {
                self.set_at_reference(axis);
            } else if takes_part {
                self.start_reference_return(axis)?;
            }
        }
        Ok(())
    }

    /// Whether a zero return of any axis is in progress.
    pub(crate) const fn is_returning(&self) -> bool {
        self.coordinates.returns.x.is_some() || self.coordinates.returns.z.is_some()
    }

    /// Abandons the zero returns in progress and stops their axes.
    pub(crate) fn abandon_returns(&mut self) {
        for axis in [Axis::X, Axis::Z] {
            if self.coordinates.returns.get_mut(axis).take().is_some() {
                *self.hand.jog.get_mut(axis) = None;
                self.drives.interpolator.release_axis(axis);
            }
        }
    }

    /// Advances the zero returns in progress by one tick, or abandons them at an emergency stop or
    /// RESET.
    pub(crate) fn advance_returns(&mut self, inputs: &MachineInputs) {
        if !self.is_returning() {
            return;
        }
        if self.emergency_stop || self.is_resetting() || self.is_not_ready() {
            return self.abandon_returns();
        }
        for axis in [Axis::X, Axis::Z] {
            if let Some(stage) = *self.coordinates.returns.get(axis) {
                self.advance_return(axis, stage, *inputs.index_latch.get(axis));
            }
        }
    }

    fn advance_return(&mut self, axis: Axis, stage: ZeroReturnStage, latch: Option<Pulses>) {
        if let ZeroReturnStage::MotorWait { ticks, shifted } = stage {
            return self.wait_for_motor(axis, ticks, shifted);
        }
        if self.advance_board_return(axis, stage) {
            return;
        }
        let low = self.memory.parameters.zero_low_rate();
        // The deceleration switch may be too short to brake on: the signal counts only at
        // the low rate.
        let is_slow = self.drives.interpolator.manual_speed(axis) <= low * 1.001;
        let next = match stage {
            ZeroReturnStage::Straight => return self.advance_straight(axis),
            ZeroReturnStage::BoardHoming
            | ZeroReturnStage::LeaveLimit
            | ZeroReturnStage::PastEdge(_)
            | ZeroReturnStage::MotorWait { .. } => return,
            ZeroReturnStage::Approach if self.is_on_zero_switch(axis) => ZeroReturnStage::OnSwitch,
            ZeroReturnStage::OnSwitch if !self.is_on_zero_switch(axis) => {
                if self.memory.parameters.has_one_zero_switch(axis) {
                    ZeroReturnStage::Stopping
                } else {
                    ZeroReturnStage::Search
                }
            }
            ZeroReturnStage::Stopping if self.drives.interpolator.manual_speed(axis) <= 0.0 => {
                ZeroReturnStage::Back
            }
            ZeroReturnStage::Search | ZeroReturnStage::Back if is_slow && latch.is_some() => {
                return self.set_machine_zero_at(axis, latch);
            }
            stage => stage,
        };
        *self.coordinates.returns.get_mut(axis) = Some(next);
        self.drive_return(axis, next);
    }

    fn advance_straight(&mut self, axis: Axis) {
        if self.drives.interpolator.is_stepping(axis) {
            return self.control_step(axis, JogRate::Rapid);
        }
        let zero = match self.run.mode {
            OperatingMode::ProgramZero => self.coordinates.program_zero.map(|zero| zero.get(axis)),
            _ => Some(0.0),
        };
        if zero == Some(self.position().get(axis)) {
            self.finish_return(axis, false);
        } else {
            // A limit has stopped the axis.
            *self.coordinates.returns.get_mut(axis) = None;
        }
    }

    /// Commands speed and direction for a stage of a return, if no interlock or limit
    /// prevents it.
    pub(crate) fn drive_return(&mut self, axis: Axis, stage: ZeroReturnStage) {
        let back = matches!(stage, ZeroReturnStage::Back | ZeroReturnStage::LeaveLimit);
        let negative = self.memory.parameters.is_zero_negative(axis) != back;
        let direction = if negative {
            crate::operation::AxisDirection::Minus
        } else {
            crate::operation::AxisDirection::Plus
        };
        let is_held = self.is_return_held(axis) || !self.is_board_armed(axis);
        let rate = match stage {
            ZeroReturnStage::Approach => self.approach_rate(axis),
            _ => self.memory.parameters.zero_low_rate(),
        };
        let is_stopped =
            stage == ZeroReturnStage::Stopping || is_held || !self.can_move(axis, direction);
        let command = (!is_stopped).then_some((!negative, JogRate::Approach(rate)));
        self.command_axis(axis, command);
    }

    /// Whether a start lock, a feed hold or an interlock prevents the zero return of an axis from
    /// continuing.
    pub(crate) fn is_return_held(&self, axis: Axis) -> bool {
        let by_program = self.run.automatic.state == RunState::Run && self.plc.signals.start_lock;
        by_program || self.run.automatic.state == RunState::Hold || self.is_interlocked(axis)
    }

    fn approach_rate(&self, axis: Axis) -> f64 {
        let rate = self.memory.parameters.zero_approach_rate(axis);
        match RapidOverride::from_percent(self.plc.signals.rapid_override) {
            RapidOverride::F0 => self.memory.parameters.lowest_rapid_rate().min(rate),
            RapidOverride::Percent(percent) => rate * f64::from(percent.min(100)) / 100.0,
        }
    }

    /// Whether the deceleration switch of an axis is pressed (004.5 DECI).
    pub(crate) fn is_on_zero_switch(&self, axis: Axis) -> bool {
        let byte = match axis {
            Axis::X => 0,
            Axis::Z => 1,
        };
        let closed = self.plc.filter.accepted()[byte] & SWITCH_MASK != 0;
        closed == self.memory.parameters.is_deceleration_closed()
    }

    /// Sets the machine zero of an axis to the position of the zero signal. `latch` is the pulse
    /// count there; with `None` nothing happens.
    pub(crate) fn set_machine_zero_at(&mut self, axis: Axis, latch: Option<Pulses>) {
        let Some(count) = latch else { return };
        let here = self.drives.axis_chain.set_zero_at(axis, count);
        let mut shift = Point::default();
        *shift.get_mut(axis) = here - self.position().get(axis);
        self.drives.interpolator.translate(shift);
        self.command_axis(axis, None);
        self.shift_frame(shift);
        let shifted = shift.get(axis).abs() > 1e-9;
        let reverses = here.abs() > 1e-9 && self.memory.parameters.backlash(axis) != 0.0;
        if reverses {
            self.drives.interpolator.stop_at(axis, here);
            let ticks = MOTOR_WAIT_TICKS;
            *self.coordinates.returns.get_mut(axis) =
                Some(ZeroReturnStage::MotorWait { ticks, shifted });
            return;
        }
        self.drives.interpolator.stop_at(axis, 0.0);
        self.finish_return(axis, shifted);
    }

    /// Waits until the motor has stopped, then moves the axis back to the position of the
    /// zero signal.
    fn wait_for_motor(&mut self, axis: Axis, ticks: u16, shifted: bool) {
        if let Some(left) = ticks.checked_sub(1) {
            let ticks = left;
            *self.coordinates.returns.get_mut(axis) =
                Some(ZeroReturnStage::MotorWait { ticks, shifted });
            return;
        }
        self.drives.interpolator.stop_at(axis, 0.0);
        self.finish_return(axis, shifted);
    }

    /// Whether the return of any axis waits until its motor has stopped.
    pub(crate) const fn is_waiting_for_motor(&self) -> bool {
        matches!(
            self.coordinates.returns.x,
            Some(ZeroReturnStage::MotorWait { .. })
        ) || matches!(
            self.coordinates.returns.z,
            Some(ZeroReturnStage::MotorWait { .. })
        )
    }

    /// Ends the return of an axis; `shifted`: its machine coordinates have changed.
    pub(crate) fn finish_return(&mut self, axis: Axis, shifted: bool) {
        *self.coordinates.returns.get_mut(axis) = None;
        let before = self.coordinates.frame;
        if self.run.mode == OperatingMode::ProgramZero {
            *self.coordinates.frame.offset.get_mut(axis) = 0.0;
            *self.coordinates.program_zero_ended.get_mut(axis) = false;
            self.send_frame();
        } else {
            self.set_at_reference(axis);
        }
        let by_program = matches!(
            self.run.automatic.current_action(),
            Some(Action::ZeroReturn { .. })
        );
        if !by_program && (shifted || before != self.coordinates.frame) {
            // The rest of a stopped program was read for the old coordinates.
            self.drop_stopped_program();
        }
        if !by_program {
            let (interpreter, world) = self.interpreter_and_world(true);
            interpreter.cancel_offset(axis, &world);
            if self.run.interpreter.modal().offset == 0 {
                self.run.tool.1 = 0;
            }
        }
    }

    /// Sets the state of an axis at its reference point: zero lamp on, coordinates of 049
    /// and 050 (012.7 APRS), tool offset cancelled.
    fn set_at_reference(&mut self, axis: Axis) {
        let at = self.position().get(axis);
        *self.coordinates.referenced.get_mut(axis) = true;
        *self.coordinates.at_reference.get_mut(axis) = Some(at);
        *self.coordinates.frame.offset.get_mut(axis) = 0.0;
        if self.memory.parameters.reference_sets_coordinates() {
            let shown = self.coordinates.frame.to_program(self.position()).get(axis);
            let coordinate = self.memory.parameters.reference_coordinate(axis);
            *self.coordinates.frame.zero.get_mut(axis) = at - coordinate;
            self.coordinates.frame.zero_offset.clear_axis(axis);
            let relative = self.coordinates.relative_zero.get_mut(axis);
            if self.memory.parameters.g50_sets_relative() {
                *relative = 0.0;
            } else {
                *relative += coordinate - shown;
            }
        }
        self.send_frame();
    }

    /// Sets the machine zero of an axis to its current position (method A: 取消 and the letter of the
    /// axis on the page of all positions). Has no effect on an axis with a zero switch, or while
    /// axes move or a program runs.
    pub(crate) fn set_machine_zero(&mut self, axis: Axis) {
        let at_rest = !self.is_moving() && !self.run.automatic.is_operating();
        if self.memory.parameters.has_zero_switch(axis) || !at_rest {
            return;
        }
        self.drop_stopped_program();
        self.settle_coordinates();
        let mut shift = Point::default();
        *shift.get_mut(axis) = -self.position().get(axis);
        self.drives.interpolator.translate(shift);
        self.drives.axis_chain.preset(axis, 0.0);
        self.shift_frame(shift);
        *self.coordinates.referenced.get_mut(axis) = true;
        self.send_frame();
    }

    /// Axes whose reference remains valid when pulses were lost: those without a zero
    /// switch (method A).
    pub fn reference_without_switch(&self) -> PerAxis<bool> {
        let is_kept = |axis| {
            *self.coordinates.referenced.get(axis) && !self.memory.parameters.has_zero_switch(axis)
        };
        PerAxis::new(is_kept(Axis::X), is_kept(Axis::Z))
    }

    /// Adds `shift` (mm) to the machine coordinates of the work zero and the program zero,
    /// after the machine coordinates were shifted. The program coordinates stay the same.
    pub(crate) fn shift_frame(&mut self, shift: Point) {
        self.coordinates.frame.zero = self.coordinates.frame.zero + shift;
        if let Some(zero) = &mut self.coordinates.program_zero {
            *zero = *zero + shift;
        }
    }

    /// Gives the frame to the interpreter, which keeps it over RESET.
    pub(crate) fn send_frame(&mut self) {
        let frame = self.coordinates.frame;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.set_frame(frame, &world);
    }

    fn drop_stopped_program(&mut self) {
        if self.run.automatic.state == RunState::Reset {
            return;
        }
        self.abandon_current();
        self.run.held_motion = None;
        if let Some(last) = self.run.automatic.last_source {
            self.run.cursor_line = last.line;
        }
        self.run.automatic.clear();
    }
}
