//! Why cycle start or an axis key has no effect now: conditions of the control and signals
//! of the ladder. The messages are for the line beside the panel; the LCD shows only what
//! the manual specifies.

use crate::cnc::Cnc;
use crate::mode::Mode;
use crate::operation::{Direction, RunState, jog_rate};
use crate::units::Axis;
use gsk_messages::{Message, say};

impl Cnc {
    /// Why cycle start would have no effect now. `None`: it acts, or it raises an alarm (no
    /// program, a board that refuses).
    pub fn refuses_start(&self) -> Option<Message> {
        if let Some(stands) = self.alarm_against(say::key_cycle_start()) {
            return Some(stands);
        }
        let mdi = self.run.mode == Mode::Mdi;
        let why = match self.run.automatic.state {
            _ if !self.run.mode.runs_programs() => say::start_in_other_mode(),
            _ if self.resetting() => say::start_in_reset(),
            RunState::Run => say::start_runs_already(),
            _ if self.plc.signals.feed_hold => say::start_in_feed_hold(),
            _ if self.board_is_stopping() || self.still_moves() => say::start_waits_for_axes(),
            RunState::Hold if !mdi && !self.run.automatic.mdi && !self.runs_in(self.run.mode) => {
                say::start_held_in_other_mode()
            }
            RunState::Hold | RunState::Stop if !mdi => return None,
            _ if mdi && self.run.mdi.is_empty() && !self.goes_on_in_mdi() => {
                say::start_without_block()
            }
            _ if mdi && self.run.handshake.busy() => say::start_waits_for_function(),
            _ => return None,
        };
        Some(why)
    }

    /// The alarm or message in force that blocks a key; it is reported separately too.
    fn alarm_against(&self, key: Message) -> Option<Message> {
        let standing = self.standing_message();
        let number = match (self.alarms().first(), &standing) {
            (Some(alarm), _) | (None, Some(alarm)) => alarm.number,
            (None, None) => return None,
        };
        Some(say::key_waits_for_alarm(key, number))
    }

    /// Whether the axes still move, so that a program cannot take them over.
    fn still_moves(&self) -> bool {
        let held =
            self.run.automatic.state == RunState::Hold && self.run.automatic.current.is_some();
        (!held || self.run.held.is_some()) && self.drives.interpolator.is_moving()
    }

    fn goes_on_in_mdi(&self) -> bool {
        self.run.automatic.mdi && self.run.automatic.operating()
    }

    /// Why a held axis key does not move its axis. Call it when the ladder has had time to
    /// pass the key on.
    pub fn refuses_axis(&self, axis: Axis) -> Option<Message> {
        let why = match self.run.mode.motion() {
            Mode::Handwheel => say::axis_key_in_handwheel_mode(),
            mode if !mode.is_manual() => say::axis_key_in_other_mode(),
            _ if self.emergency_stop || self.is_not_ready() => {
                return self.alarm_against(say::key_of_axis());
            }
            _ if self.resetting() => say::axis_key_in_reset(),
            _ if self.run.automatic.state == RunState::Run => say::axis_key_in_thread(),
            _ if *self.hand.jog_blocked.get(axis) => say::axis_key_of_mode_before(),
            _ => return self.refuses_direction(axis),
        };
        Some(why)
    }

    /// What blocks the direction that the ladder requests.
    fn refuses_direction(&self, axis: Axis) -> Option<Message> {
        let g = &self.plc.signals;
        let way = match (*g.jog_plus.get(axis), *g.jog_minus.get(axis)) {
            (true, false) => Direction::Plus,
            (false, true) => Direction::Minus,
            _ => return Some(say::axis_key_held_by_ladder()),
        };
        if let Some(lock) = self.axis_lock(axis) {
            return Some(say::axis_locked(axis, lock));
        }
        if self.direction_locked(axis, way) {
            return Some(say::axis_locked_this_way(axis));
        }
        match self.run.mode.motion() {
            Mode::MachineZero => self.refuses_return(axis),
            Mode::ProgramZero => None,
            Mode::Step => (self.step_distance(axis) == 0.0).then(say::key_large_steps_locked),
            _ => self.refuses_rate(axis),
        }
    }

    fn axis_lock(&self, axis: Axis) -> Option<Message> {
        let g = &self.plc.signals;
        if g.interlock {
            Some(say::axis_lock_of_all())
        } else if *g.axis_interlock.get(axis) {
            Some(say::axis_lock_of_axis())
        } else if self.brake_interlock() {
            Some(say::axis_lock_of_brake())
        } else {
            None
        }
    }

    fn refuses_return(&self, axis: Axis) -> Option<Message> {
        if !self.memory.parameters.has_zero_switch(axis)
            || self.coordinates.returns.get(axis).is_some()
        {
            return None;
        }
        if *self.plc.signals.machine_lock.get(axis) {
            return Some(say::axis_under_machine_lock(axis));
        }
        let stands = self.coordinates.at_reference.get(axis).is_some();
        stands.then(|| say::axis_at_machine_zero(axis))
    }

    fn refuses_rate(&self, axis: Axis) -> Option<Message> {
        let rapid_allowed = *self.coordinates.referenced.get(axis)
            || self.memory.parameters.rapid_without_reference();
        if self.plc.signals.rapid && !rapid_allowed {
            return Some(say::axis_without_reference(axis));
        }
        let stands = !self.plc.signals.rapid && jog_rate(self.plc.signals.jog_code) == 0.0;
        stands.then(say::axis_feed_override_zero)
    }
}
