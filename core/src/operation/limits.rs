//! Travel limits of the software, 045–048 (manual III-2.5.2). Those of the ladder are
//! among its interlocks; the hard limits open the emergency-stop loop.

use super::manual::Way;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::units::{Axis, PerAxis, Point};

/// Both axes, both ways.
const SIDES: [(Axis, Way); 4] = [
    (Axis::X, Way::Plus),
    (Axis::X, Way::Minus),
    (Axis::Z, Way::Plus),
    (Axis::Z, Way::Minus),
];

/// The overtravel alarm of an axis and a direction.
pub(super) const fn travel_alarm(axis: Axis, way: Way) -> u16 {
    match (axis, way) {
        (Axis::X, Way::Plus) => 201,
        (Axis::X, Way::Minus) => 202,
        (Axis::Z, Way::Plus) => 203,
        (Axis::Z, Way::Minus) => 204,
    }
}

impl Cnc {
    /// Whether an axis may be moved by hand this way: a limit leaves only the way
    /// back, until the alarm is cleared.
    pub(super) fn may_go(&mut self, axis: Axis, way: Way) -> bool {
        if self.direction_locked(axis, way) {
            return false;
        }
        let beyond = *self.watched().get(axis)
            && !self.machine_locked()
            && self
                .soft_limits
                .is_beyond(axis, way == Way::Plus, self.slide().get(axis));
        if beyond {
            // Cleared while still outside: it comes back instead of going further.
            self.raise(Alarm::new(travel_alarm(axis, way)));
        }
        !beyond
    }

    /// Axes whose software limits are watched: with 172.4 MOT = 0, those whose
    /// machine coordinates are true.
    fn watched(&self) -> PerAxis<bool> {
        if self.parameters.soft_limits_masked() {
            return PerAxis::default();
        }
        let known = |axis| *self.referenced.get(axis) || !self.parameters.has_zero_switch(axis);
        PerAxis::new(known(Axis::X), known(Axis::Z))
    }

    /// Software travel limits; once a tick.
    pub(crate) fn watch_travel(&mut self) {
        if self.machine_locked() || !self.interpolator.is_moving() {
            return;
        }
        let watched = self.watched();
        if !watched.x && !watched.z {
            return;
        }
        let over = self
            .soft_limits
            .overrun(self.slide(), self.stopping_point(), watched);
        if over.into_iter().any(|over| over) {
            for ((axis, way), over) in SIDES.into_iter().zip(over) {
                if over {
                    self.raise_travel(axis, way);
                }
            }
        }
    }

    /// Whether a cut that nothing here can stop ends within the limits.
    pub(super) fn check_pass_end(&self, to: Point) -> Result<(), Alarm> {
        let over = self.soft_limits.overrun(self.slide(), to, self.watched());
        let found = SIDES.into_iter().zip(over).find(|(_, over)| *over);
        match found {
            Some(((axis, way), _)) => Err(Alarm::new(travel_alarm(axis, way))),
            None => Ok(()),
        }
    }

    /// Raises the alarm of a limit, with the block that ran into it.
    pub(super) fn raise_travel(&mut self, axis: Axis, way: Way) {
        let alarm = Alarm::new(travel_alarm(axis, way));
        let source = self
            .automatic
            .current
            .as_ref()
            .map(|current| current.command.source);
        self.raise(source.map_or(alarm.clone(), |source| alarm.at(source)));
    }
}
