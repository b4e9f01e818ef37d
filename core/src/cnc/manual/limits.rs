//! Software travel limits, 045–048 (manual III-3.5.2). The limits of the ladder are among
//! its interlocks; the hard limits open the emergency-stop loop.

use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::machine::{Inputs, OverLimit};
use crate::operation::{Direction, travel_alarm};
use crate::units::{Axis, PerAxis, Point, TICK_S};
use gsk_messages::{Message, say};

/// Both directions of both axes.
const SIDES: [(Axis, Direction); 4] = [
    (Axis::X, Direction::Plus),
    (Axis::X, Direction::Minus),
    (Axis::Z, Direction::Plus),
    (Axis::Z, Direction::Minus),
];

impl Cnc {
    /// Whether an axis may be moved manually in this direction. Beyond a limit only the
    /// opposite direction is permitted, until the axis is inside again and the alarm is
    /// cleared.
    pub(crate) fn may_go(&mut self, axis: Axis, way: Direction) -> bool {
        if self.direction_locked(axis, way) {
            return false;
        }
        let beyond = !self.machine_locked() && self.is_outside(axis, way);
        if beyond {
            // The limit has been moved inside the axis position: only the way back is
            // permitted.
            self.raise(Alarm::new(travel_alarm(axis, way)));
        }
        !beyond
    }

    /// Whether the slide is beyond a software limit that is checked.
    fn is_outside(&self, axis: Axis, way: Direction) -> bool {
        let place = self.slide().get(axis);
        *self.watched().get(axis)
            && self
                .drives
                .soft_limits
                .is_beyond(axis, way == Direction::Plus, place)
    }

    /// The overtravel alarms that RESET cannot clear yet: the axis must first be moved back
    /// manually (manual III-3.5.3), or off the limit of the ladder.
    pub(crate) fn still_outside(&self) -> [Option<u16>; 4] {
        SIDES.map(|(axis, way)| {
            let outside = self.limit_reached(axis, way) || self.is_outside(axis, way);
            outside.then(|| travel_alarm(axis, way))
        })
    }

    /// Axes whose software limits are checked: with 172.4 MOT = 0, those whose machine
    /// coordinates are valid.
    fn watched(&self) -> PerAxis<bool> {
        if self.memory.parameters.soft_limits_masked() {
            return PerAxis::default();
        }
        let known = |axis| {
            *self.coordinates.referenced.get(axis) || !self.memory.parameters.has_zero_switch(axis)
        };
        PerAxis::new(known(Axis::X), known(Axis::Z))
    }

    /// Checks the software travel limits; once per tick.
    pub(crate) fn watch_travel(&mut self) {
        let drives = &self.drives;
        // The most frequent case, and cheap to check.
        if let Some(way) = drives.interpolator.stops_within(&drives.limits) {
            let (slide, commanded) = (self.slide(), drives.interpolator.commanded());
            let far = |point, way| drives.soft_limits.are_far(point, way);
            if far(commanded, way) && (slide == commanded || far(slide, 0.0)) {
                return;
            }
        }
        if self.machine_locked() || !drives.interpolator.is_moving() {
            return;
        }
        let watched = self.watched();
        if !watched.x && !watched.z {
            return;
        }
        let over = self.overrun_soon(watched);
        if over.into_iter().any(|over| over) {
            for ((axis, way), over) in SIDES.into_iter().zip(over) {
                if over {
                    self.raise_travel(axis, way);
                }
            }
        }
    }

    /// The limits that the axes overrun, or would overrun if they braked one tick later.
    fn overrun_soon(&self, watched: PerAxis<bool>) -> [bool; 4] {
        let drives = &self.drives;
        let (slide, stop) = (self.slide(), self.stopping_point());
        let overrun = |stop| drives.soft_limits.overrun(slide, stop, watched);
        // While the axes accelerate they stop up to two ticks of motion farther.
        let farthest = stop + drives.interpolator.velocity() * (2.0 * TICK_S);
        let now = overrun(stop);
        if now.contains(&true) || !overrun(farthest).contains(&true) {
            return now;
        }
        let mut later = drives.interpolator.clone();
        later.tick(&drives.limits, &self.motion_inputs());
        overrun(later.stopping_point(&drives.limits))
    }

    /// Checks that a cut which the control cannot stop ends within the limits.
    pub(crate) fn check_pass_end(&self, to: Point) -> Result<(), Alarm> {
        let over = self
            .drives
            .soft_limits
            .overrun(self.slide(), to, self.watched());
        let found = SIDES.into_iter().zip(over).find(|(_, over)| *over);
        match found {
            Some(((axis, way), _)) => Err(Alarm::new(travel_alarm(axis, way))),
            None => Ok(()),
        }
    }

    /// Names the limit switches that opened the emergency-stop loop: axis, side, and the
    /// direction off the switch.
    pub(crate) fn over_limit_detail(&self, inputs: &Inputs) -> Option<Message> {
        let mut said = Vec::new();
        for axis in [Axis::X, Axis::Z] {
            let told = (*inputs.over_limit.get(axis)).or_else(|| self.wired_limit(axis));
            let Some(tripped) = told else {
                continue;
            };
            let (at, back) = match tripped {
                OverLimit::Minus => ('-', '+'),
                OverLimit::Plus => ('+', '-'),
                OverLimit::Stuck => {
                    said.push(say::limit_switch_stuck(axis));
                    continue;
                }
            };
            said.push(say::limit_switch_tripped(
                format_args!("{axis}{at}"),
                format_args!("{axis}{back}"),
            ));
            said.extend(self.unmet_switch(axis));
        }
        (!said.is_empty()).then(|| say::several(said))
    }

    /// Raises the alarm of a limit, with the block that caused it.
    pub(crate) fn raise_travel(&mut self, axis: Axis, way: Direction) {
        let alarm = Alarm::new(travel_alarm(axis, way));
        let source = self
            .run
            .automatic
            .current
            .as_ref()
            .map(|current| current.command.source);
        self.raise(source.map_or(alarm.clone(), |source| alarm.at(source)));
    }
}
