//! Signals of the ladder that forbid axis motion (manual PLC-II 3.3, 3.5): interlocks make
//! it wait, limits stop it with an alarm.

use crate::cnc::Cnc;
use crate::operation::{Direction, RunState, travel_alarm};
use crate::units::{Axis, Point};

impl Cnc {
    /// Whether the motion of a running program must wait: start lock, a locked axis or
    /// direction that is commanded, the spindle brake (011.4 ZDIL = 0), a gear change, or a
    /// spindle below its speed.
    pub(crate) fn run_interlocked(&self) -> bool {
        if self.run.automatic.state != RunState::Run {
            return false;
        }
        let g = &self.plc.signals;
        if g.start_lock
            || g.interlock
            || self.brake_interlock()
            || self.spindle.control.changing_gear()
            || self.run.automatic.arrival.awaited(g.speed_arrival)
        {
            return true;
        }
        let locks = [g.axis_interlock, g.plus_interlock, g.minus_interlock];
        locks.iter().any(|lock| lock.x | lock.z) && self.goes_where_locked()
    }

    /// Whether the motion under way has a component along a locked axis or direction.
    #[cold]
    fn goes_where_locked(&self) -> bool {
        let commanded = self.drives.interpolator.distance_to_go();
        [Axis::X, Axis::Z]
            .into_iter()
            .any(|axis| self.commanded_and_locked(axis, commanded))
    }

    pub(crate) fn commanded_and_locked(&self, axis: Axis, commanded: Point) -> bool {
        let g = &self.plc.signals;
        let way = commanded.get(axis);
        way != 0.0 && *g.axis_interlock.get(axis)
            || way > 0.0 && *g.plus_interlock.get(axis)
            || way < 0.0 && *g.minus_interlock.get(axis)
    }

    /// Whether the brake output forbids axis motion (011.4 ZDIL = 0).
    pub(crate) fn brake_interlock(&self) -> bool {
        self.brake_output() && !self.memory.parameters.moves_under_brake()
    }

    /// Whether manual motion of an axis is forbidden.
    pub(crate) fn interlocked(&self, axis: Axis) -> bool {
        self.plc.signals.interlock
            || *self.plc.signals.axis_interlock.get(axis)
            || self.brake_interlock()
    }

    /// Whether a direction is locked by a limit, by its alarm or by ±MIT.
    pub(crate) fn direction_locked(&self, axis: Axis, way: Direction) -> bool {
        let locked = match way {
            Direction::Plus => &self.plc.signals.plus_interlock,
            Direction::Minus => &self.plc.signals.minus_interlock,
        };
        self.limit_reached(axis, way)
            || *locked.get(axis)
            || self.alarms.contains(travel_alarm(axis, way))
    }

    /// Whether the limit signal *+L or *-L of the ladder is active for a direction.
    pub(crate) const fn limit_reached(&self, axis: Axis, way: Direction) -> bool {
        match way {
            Direction::Plus => *self.plc.signals.limit_plus.get(axis),
            Direction::Minus => *self.plc.signals.limit_minus.get(axis),
        }
    }

    /// Checks the limit signals *+L and *-L of the ladder: an axis that moves into one
    /// stops with the alarm of its side; in automatic operation all axes stop.
    pub(crate) fn watch_limit_signals(&mut self) {
        let (plus, minus) = (self.plc.signals.limit_plus, self.plc.signals.limit_minus);
        if !(plus.x | plus.z | minus.x | minus.z) {
            return;
        }
        let velocity = self.drives.interpolator.velocity();
        for axis in [Axis::X, Axis::Z] {
            if let Some(way) = Direction::of(velocity.get(axis))
                && self.limit_reached(axis, way)
            {
                self.raise_travel(axis, way);
            }
        }
    }
}
