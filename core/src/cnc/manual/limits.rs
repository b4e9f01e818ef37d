//! Software travel limits, 045–048 (manual III-3.5.2). The limits of the ladder are among
//! its interlocks; the hard limits open the emergency-stop loop.

use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::machine::{MachineInputs, TrippedLimit};
use crate::operation::{AxisDirection, travel_alarm};
use crate::units::{Axis, PerAxis, Point, TICK_S};
use gsk_messages::{Message, say};

/// Both directions of both axes, in which limit switches can be pressed.
const SIDES: [(Axis, AxisDirection); 4] = [
    (Axis::X, AxisDirection::Plus),
    (Axis::X, AxisDirection::Minus),
    (Axis::Z, AxisDirection::Plus),
    (Axis::Z, AxisDirection::Minus),
];

impl Cnc {
    /// Whether an axis may be moved manually in this direction; raises the overtravel alarm if it
    /// is beyond its software limit. Beyond a limit only the opposite direction is permitted, until
    /// the axis is within the limits and the alarm is cleared.
    pub(crate) fn can_move(&mut self, axis: Axis, direction: AxisDirection) -> bool {
        if self.is_direction_locked(axis, direction) {
            return false;
        }
        let is_beyond = !self.is_machine_locked() && self.is_outside(axis, direction);
        if is_beyond {
            // The limit has been moved inside the axis position: only the way back is
            // permitted.
            self.raise(Alarm::new(travel_alarm(axis, direction)));
        }
        !is_beyond
    }

    /// Whether the slide is beyond the software limit in this direction, if that limit is
    /// checked.
    fn is_outside(&self, axis: Axis, direction: AxisDirection) -> bool {
        let position = self.slide_position().get(axis);
        *self.checked_axes().get(axis)
            && self
                .drives
                .soft_limits
                .is_beyond(axis, direction == AxisDirection::Plus, position)
    }

    /// Numbers of the overtravel alarms (X+, X-, Z+, Z-) that RESET cannot clear yet;
    /// `None` for the others. The axis must first be moved back manually (manual
    /// III-3.5.3), or off the limit of the ladder.
    pub(crate) fn overtravel_alarms(&self) -> [Option<u16>; 4] {
        SIDES.map(|(axis, direction)| {
            let outside =
                self.is_limit_reached(axis, direction) || self.is_outside(axis, direction);
            outside.then(|| travel_alarm(axis, direction))
        })
    }

    /// Axes whose software limits are checked: none with 172.4 MOT = 1, otherwise those
    /// with valid machine coordinates.
    fn checked_axes(&self) -> PerAxis<bool> {
        if self.memory.parameters.are_soft_limits_masked() {
            return PerAxis::default();
        }
        let has_coordinates = |axis| {
            *self.coordinates.referenced.get(axis) || !self.memory.parameters.has_zero_switch(axis)
        };
        PerAxis::new(has_coordinates(Axis::X), has_coordinates(Axis::Z))
    }

    /// Checks the software travel limits once per tick, and raises the alarms.
    pub(crate) fn check_travel(&mut self) {
        let drives = &self.drives;
        // The most frequent case, and cheap to check.
        if let Some(distance) = drives.interpolator.max_stopping_distance(&drives.limits) {
            let (slide, commanded) = (self.slide_position(), drives.interpolator.commanded());
            let is_far = |point, distance| drives.soft_limits.are_farther_than(point, distance);
            if is_far(commanded, distance) && (slide == commanded || is_far(slide, 0.0)) {
                return;
            }
        }
        if self.is_machine_locked() || !drives.interpolator.is_moving() {
            return;
        }
        let checked = self.checked_axes();
        if !checked.x && !checked.z {
            return;
        }
        let overrun = self.overrun_next_tick(checked);
        if overrun.into_iter().any(|over| over) {
            for ((axis, direction), is_overrun) in SIDES.into_iter().zip(overrun) {
                if is_overrun {
                    self.raise_overtravel(axis, direction);
                }
            }
        }
    }

    /// Whether the axes overrun their limits X+, X-, Z+ and Z-, or would if they braked one
    /// tick later.
    fn overrun_next_tick(&self, checked: PerAxis<bool>) -> [bool; 4] {
        let drives = &self.drives;
        let (slide, stop) = (self.slide_position(), self.stopping_point());
        let overrun = |stop| drives.soft_limits.overrun_limits(slide, stop, checked);
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

    /// Checks that a cut which the control cannot stop ends, at `to`, mm, within the limits;
    /// returns the overtravel alarm as error if not.
    pub(crate) fn check_pass_end(&self, to: Point) -> Result<(), Alarm> {
        let overrun =
            self.drives
                .soft_limits
                .overrun_limits(self.slide_position(), to, self.checked_axes());
        let hit = SIDES.into_iter().zip(overrun).find(|(_, over)| *over);
        match hit {
            Some(((axis, direction), _)) => Err(Alarm::new(travel_alarm(axis, direction))),
            None => Ok(()),
        }
    }

    /// Message that names the limit switches that opened the emergency-stop loop: axis,
    /// side, and the direction off the switch. `None` if no limit switch is tripped.
    pub(crate) fn tripped_limit_detail(&self, inputs: &MachineInputs) -> Option<Message> {
        let mut messages = Vec::new();
        for axis in [Axis::X, Axis::Z] {
            let reported =
                (*inputs.over_limit.get(axis)).or_else(|| self.limit_reported_by_input(axis));
            let Some(tripped) = reported else {
                continue;
            };
            let (at, back) = match tripped {
                TrippedLimit::Minus => ('-', '+'),
                TrippedLimit::Plus => ('+', '-'),
                TrippedLimit::Stuck => {
                    messages.push(say::limit_switch_stuck(axis));
                    continue;
                }
            };
            let key = self.parameters().axis_key(axis, back == '+');
            messages.push(say::limit_switch_tripped(
                format_args!("{axis}{at}"),
                format_args!("{axis}{back} [{key}]"),
            ));
            messages.extend(self.missed_switch_message(axis));
        }
        (!messages.is_empty()).then(|| say::several(messages))
    }

    /// Raises the overtravel alarm of an axis and a direction, with the current block as its
    /// position.
    pub(crate) fn raise_overtravel(&mut self, axis: Axis, direction: AxisDirection) {
        let alarm = Alarm::new(travel_alarm(axis, direction));
        let source = self
            .run
            .automatic
            .current
            .as_ref()
            .map(|current| current.command.source);
        self.raise(source.map_or(alarm.clone(), |source| alarm.with_source(source)));
    }
}
