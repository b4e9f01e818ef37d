//! Why cycle start or an axis key has no effect now: conditions of the control and signals
//! of the ladder. The messages are for the line beside the panel; the LCD shows only what
//! the manual specifies.

use crate::cnc::Cnc;
use crate::mode::OperatingMode;
use crate::operation::{AxisDirection, RunState, jog_rate};
use crate::units::Axis;
use gsk_messages::{Message, say};

impl Cnc {
    /// Message that explains why cycle start would have no effect now. `None` if it would act, or
    /// would raise an alarm (no program, a board that refuses).
    pub fn start_refusal(&self) -> Option<Message> {
        if let Some(alarm) = self.blocking_alarm(say::key_cycle_start()) {
            return Some(alarm);
        }
        let mdi = self.run.mode == OperatingMode::Mdi;
        let why = match self.run.automatic.state {
            _ if !self.run.mode.runs_programs() => say::start_in_other_mode(),
            _ if self.is_resetting() => say::start_in_reset(),
            RunState::Run => say::start_runs_already(),
            _ if self.plc.signals.feed_hold => say::start_in_feed_hold(),
            _ if self.is_board_stopping() || self.is_still_moving() => say::start_waits_for_axes(),
            _ if self.is_off_hold() => say::retrace_return_first(),
            RunState::Hold
                if !mdi && !self.run.automatic.is_mdi && !self.belongs_to_mode(self.run.mode) =>
            {
                say::start_held_in_other_mode()
            }
            RunState::Hold | RunState::Stop if !mdi => return None,
            _ if mdi && self.run.mdi.is_empty() && !self.is_running_mdi() => {
                say::start_without_block()
            }
            _ if mdi && self.run.handshake.is_busy() => say::start_waits_for_function(),
            _ => return None,
        };
        Some(why)
    }

    /// Message that names the active alarm or ladder message that blocks the key named by `key`;
    /// `None` without one.
    fn blocking_alarm(&self, key: Message) -> Option<Message> {
        let message = self.active_message();
        let number = match (self.alarms().first(), &message) {
            (Some(alarm), _) | (None, Some(alarm)) => alarm.number,
            (None, None) => return None,
        };
        Some(say::key_waits_for_alarm(key, number))
    }

    /// Whether the axes still move, so that a program cannot take them over.
    fn is_still_moving(&self) -> bool {
        let is_held =
            self.run.automatic.state == RunState::Hold && self.run.automatic.current.is_some();
        (!is_held || self.run.held_motion.is_some()) && self.drives.interpolator.is_moving()
    }

    fn is_running_mdi(&self) -> bool {
        self.run.automatic.is_mdi && self.run.automatic.is_operating()
    }

    /// Message that explains why a held axis key does not move its axis; `None` if nothing blocks
    /// it. Call it only after the ladder has had time to read the key.
    pub fn axis_key_refusal(&self, axis: Axis) -> Option<Message> {
        let why = match self.run.mode.motion_mode() {
            OperatingMode::Handwheel => say::axis_key_in_handwheel_mode(),
            mode if !mode.is_manual() => say::axis_key_in_other_mode(),
            _ if self.emergency_stop || self.is_not_ready() => {
                return self.blocking_alarm(say::key_of_axis());
            }
            _ if self.is_resetting() => say::axis_key_in_reset(),
            _ if self.run.automatic.state == RunState::Run => say::axis_key_in_thread(),
            _ if *self.hand.jog_blocked.get(axis) => say::axis_key_of_mode_before(),
            _ => return self.direction_refusal(axis),
        };
        Some(why)
    }

    /// Returns the message about the cause that blocks motion of an axis in the direction that the
    /// ladder requests; `None` if motion is possible.
    fn direction_refusal(&self, axis: Axis) -> Option<Message> {
        let g = &self.plc.signals;
        let direction = match (*g.jog_plus.get(axis), *g.jog_minus.get(axis)) {
            (true, false) => AxisDirection::Plus,
            (false, true) => AxisDirection::Minus,
            _ => return Some(say::axis_key_held_by_ladder()),
        };
        if let Some(lock) = self.axis_lock_message(axis) {
            return Some(say::axis_locked(axis, lock));
        }
        if self.is_direction_locked(axis, direction) {
            return Some(say::axis_locked_this_way(axis));
        }
        match self.run.mode.motion_mode() {
            OperatingMode::MachineZero => self.return_refusal(axis),
            OperatingMode::ProgramZero => None,
            OperatingMode::Step => {
                (self.step_distance(axis) == 0.0).then(say::key_large_steps_locked)
            }
            _ => self.rate_refusal(axis),
        }
    }

    fn axis_lock_message(&self, axis: Axis) -> Option<Message> {
        let g = &self.plc.signals;
        if g.interlock {
            Some(say::axis_lock_of_all())
        } else if *g.axis_interlock.get(axis) {
            Some(say::axis_lock_of_axis())
        } else if self.has_brake_interlock() {
            Some(say::axis_lock_of_brake())
        } else {
            None
        }
    }

    fn return_refusal(&self, axis: Axis) -> Option<Message> {
        if !self.memory.parameters.has_zero_switch(axis)
            || self.coordinates.returns.get(axis).is_some()
        {
            return None;
        }
        if *self.plc.signals.machine_lock.get(axis) {
            return Some(say::axis_under_machine_lock(axis));
        }
        let at_reference = self.coordinates.at_reference.get(axis).is_some();
        at_reference.then(|| say::axis_at_machine_zero(axis))
    }

    fn rate_refusal(&self, axis: Axis) -> Option<Message> {
        let rapid_allowed = *self.coordinates.referenced.get(axis)
            || self.memory.parameters.can_rapid_without_reference();
        if self.plc.signals.rapid && !rapid_allowed {
            return Some(say::axis_without_reference(axis));
        }
        let is_rate_zero = !self.plc.signals.rapid && jog_rate(self.plc.signals.jog_code) == 0.0;
        is_rate_zero.then(say::axis_feed_override_zero)
    }
}
