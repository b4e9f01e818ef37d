//! Signals of the ladder that forbid axis motion (manual PLC-II 3.3, 3.5): interlocks make
//! it wait, limits stop it with an alarm.

use crate::cnc::Cnc;
use crate::operation::{AxisDirection, RunState, travel_alarm};
use crate::units::{Axis, Point};

impl Cnc {
    /// Whether the motion of a running program must wait: start lock, a locked axis or
    /// direction that is commanded, the spindle brake (011.4 ZDIL = 0), a gear change, or a
    /// spindle below its speed.
    pub(crate) fn is_run_interlocked(&self) -> bool {
        if self.run.automatic.state != RunState::Run {
            return false;
        }
        let g = &self.plc.signals;
        if g.start_lock
            || g.interlock
            || self.has_brake_interlock()
            || self.spindle.control.is_changing_gear()
            || self.run.automatic.arrival.is_waiting(g.speed_arrival)
        {
            return true;
        }
        let locks = [g.axis_interlock, g.plus_interlock, g.minus_interlock];
        locks.iter().any(|lock| lock.x | lock.z) && self.moves_towards_lock()
    }

    /// Whether the current motion has a component along a locked axis or direction.
    #[cold]
    fn moves_towards_lock(&self) -> bool {
        let commanded = self.drives.interpolator.distance_to_go();
        [Axis::X, Axis::Z]
            .into_iter()
            .any(|axis| self.is_commanded_and_locked(axis, commanded))
    }

    pub(crate) fn is_commanded_and_locked(&self, axis: Axis, commanded: Point) -> bool {
        let g = &self.plc.signals;
        let distance = commanded.get(axis);
        distance != 0.0 && *g.axis_interlock.get(axis)
            || distance > 0.0 && *g.plus_interlock.get(axis)
            || distance < 0.0 && *g.minus_interlock.get(axis)
    }

    /// Whether the brake output forbids axis motion (011.4 ZDIL = 0).
    pub(crate) fn has_brake_interlock(&self) -> bool {
        self.is_brake_on() && !self.memory.parameters.can_move_under_brake()
    }

    /// Whether an interlock signal of the ladder or the spindle brake forbids manual motion of an
    /// axis.
    pub(crate) fn is_interlocked(&self, axis: Axis) -> bool {
        self.plc.signals.interlock
            || *self.plc.signals.axis_interlock.get(axis)
            || self.has_brake_interlock()
    }

    /// Whether motion of an axis in `direction` is locked by a limit signal, by an overtravel alarm
    /// or by ±MIT.
    pub(crate) fn is_direction_locked(&self, axis: Axis, direction: AxisDirection) -> bool {
        let interlocks = match direction {
            AxisDirection::Plus => &self.plc.signals.plus_interlock,
            AxisDirection::Minus => &self.plc.signals.minus_interlock,
        };
        self.is_limit_reached(axis, direction)
            || *interlocks.get(axis)
            || self.alarms.contains(travel_alarm(axis, direction))
    }

    /// Whether the limit signal *+L or *-L of the ladder is active for a direction of an
    /// axis.
    pub(crate) const fn is_limit_reached(&self, axis: Axis, direction: AxisDirection) -> bool {
        match direction {
            AxisDirection::Plus => *self.plc.signals.limit_plus.get(axis),
            AxisDirection::Minus => *self.plc.signals.limit_minus.get(axis),
        }
    }

    /// Checks the limit signals *+L and *-L of the ladder, once per tick. An axis that
    /// moves towards an active limit stops with the alarm of its side; in automatic
    /// operation all axes stop.
    pub(crate) fn check_limit_signals(&mut self) {
        let (plus, minus) = (self.plc.signals.limit_plus, self.plc.signals.limit_minus);
        if !(plus.x | plus.z | minus.x | minus.z) {
            return;
        }
        let velocity = self.drives.interpolator.velocity();
        for axis in [Axis::X, Axis::Z] {
            if let Some(direction) = AxisDirection::from_distance(velocity.get(axis))
                && self.is_limit_reached(axis, direction)
            {
                self.raise_overtravel(axis, direction);
            }
        }
    }
}
