//! Signals of the ladder that keep axes from moving (manual PLC-II 3.3, 3.5):
//! interlocks wait, limits stop with an alarm.

use super::automatic::RunState;
use super::limits::travel_alarm;
use super::manual::Way;
use crate::cnc::Cnc;
use crate::units::{Axis, Point};

impl Cnc {
    /// Whether the motion of a running program has to wait: start lock, a locked
    /// axis or direction that is commanded, the spindle brake (011.4 ZDIL = 0), a
    /// gear change, or a spindle that is not up to speed.
    pub(crate) fn run_interlocked(&self) -> bool {
        if self.automatic.state != RunState::Run {
            return false;
        }
        let g = &self.from_plc;
        if g.start_lock
            || g.interlock
            || self.brake_interlock()
            || self.spindle.changing_gear()
            || self.automatic.arrival.awaited(g.speed_arrival)
        {
            return true;
        }
        let commanded = self.interpolator.distance_to_go();
        [Axis::X, Axis::Z]
            .into_iter()
            .any(|axis| self.commanded_and_locked(axis, commanded))
    }

    fn commanded_and_locked(&self, axis: Axis, commanded: Point) -> bool {
        let g = &self.from_plc;
        let way = commanded.get(axis);
        way != 0.0 && *g.axis_interlock.get(axis)
            || way > 0.0 && *g.plus_interlock.get(axis)
            || way < 0.0 && *g.minus_interlock.get(axis)
    }

    /// While the brake output is on, axes stand unless 011.4 ZDIL = 1.
    fn brake_interlock(&self) -> bool {
        self.brake_output() && !self.parameters.bit(11, 4)
    }

    /// Whether an axis must not be moved by hand.
    pub(crate) fn interlocked(&self, axis: Axis) -> bool {
        self.from_plc.interlock || *self.from_plc.axis_interlock.get(axis) || self.brake_interlock()
    }

    /// Whether a direction is locked by a limit, by its alarm or by ±MIT.
    pub(crate) fn direction_locked(&self, axis: Axis, way: Way) -> bool {
        let g = &self.from_plc;
        let (limit, locked) = match way {
            Way::Plus => (&g.limit_plus, &g.plus_interlock),
            Way::Minus => (&g.limit_minus, &g.minus_interlock),
        };
        *limit.get(axis) || *locked.get(axis) || self.alarms.contains(travel_alarm(axis, way))
    }

    /// The limit signals *+L and *-L of the ladder: an axis that moves into one
    /// stops with the alarm of its side, in automatic all of them.
    pub(crate) fn watch_limit_signals(&mut self) {
        let velocity = self.interpolator.velocity();
        for axis in [Axis::X, Axis::Z] {
            let speed = velocity.get(axis);
            let (way, reached) = if speed > 0.0 {
                (Way::Plus, self.from_plc.limit_plus)
            } else {
                (Way::Minus, self.from_plc.limit_minus)
            };
            if speed == 0.0 || !*reached.get(axis) {
                continue;
            }
            self.raise_travel(axis, way);
        }
    }
}
