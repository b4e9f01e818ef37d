//! Manual motion: jog, manual rapid and steps (manual III-4.1, III-6.1), and the parts that
//! all manual motion shares.

mod handwheel;
mod limits;
mod zero_return;

use crate::axis::least_increment;
use crate::cnc::Cnc;
use crate::machine::MachineInputs;
use crate::mode::OperatingMode;
use crate::motion::JogRate;
use crate::operation::{AxisDirection, RunState, jog_rate};
use crate::units::{Axis, PerAxis, Point};

impl Cnc {
    /// Advances manual motion by one tick, from the axis keys and the handwheel.
    pub(crate) fn advance_manual_motion(&mut self, inputs: &MachineInputs) {
        let counts = self.hand.wheel.count_tick(inputs.handwheel);
        self.follow_retrace_wheel(counts);
        // A key held since before a mode change must be released first.
        let plus = self.plc.signals.jog_plus;
        let minus = self.plc.signals.jog_minus;
        let down = PerAxis::new(plus.x || minus.x, plus.z || minus.z);
        self.hand.jog_blocked.x &= down.x;
        self.hand.jog_blocked.z &= down.z;
        let before = core::mem::replace(&mut self.hand.axis_keys, down);
        if self.run.automatic.state == RunState::Run {
            return;
        }
        let is_allowed = self.run.mode.is_manual()
            && !self.emergency_stop
            && !self.is_resetting()
            && !self.is_not_ready();
        let is_requested = match self.run.mode.motion_mode() {
            OperatingMode::Handwheel => counts != 0 && self.plc.signals.wheel_axis.is_some(),
            _ => down.x || down.z,
        };
        if is_allowed && is_requested {
            self.suspend_held_motion();
        }
        if !self.is_manual_possible() {
            return;
        }
        for axis in [Axis::X, Axis::Z] {
            let key = match (*plus.get(axis), *minus.get(axis)) {
                (true, false) => Some(AxisDirection::Plus),
                (false, true) => Some(AxisDirection::Minus),
                _ => None,
            };
            let key = key.filter(|_| is_allowed && !*self.hand.jog_blocked.get(axis));
            let pressed = key.filter(|_| !*before.get(axis));
            let can_move = self.can_board_move();
            match self.run.mode.motion_mode() {
                OperatingMode::Step => self.step_axis(axis, pressed.filter(|_| can_move)),
                OperatingMode::Handwheel => {
                    self.follow_wheel(axis, if is_allowed && can_move { counts } else { 0 });
                }
                OperatingMode::MachineZero => {
                    // A board that homes on its own starts when it is ready.
                    let can_start = can_move || self.is_board_seeking() || self.can_board_home();
                    self.handle_return_keys(axis, key.is_some(), pressed.is_some() && can_start);
                }
                OperatingMode::ProgramZero => {
                    self.handle_return_keys(axis, key.is_some(), pressed.is_some() && can_move);
                }
                _ => self.jog_axis(axis, key.filter(|_| can_move)),
            }
        }
    }

    /// Jogs an axis in the direction of its held key; `None`, without a key, stops the jog.
    fn jog_axis(&mut self, axis: Axis, key: Option<AxisDirection>) {
        let direction = key.filter(|way| !self.is_interlocked(axis) && self.can_move(axis, *way));
        let command = direction.map(|way| (way == AxisDirection::Plus, self.manual_rate(axis)));
        self.command_axis(axis, command);
    }

    /// Commands a jog of an axis in a direction (true = positive) at a rate; `None` ends the jog.
    pub(crate) fn command_axis(&mut self, axis: Axis, command: Option<(bool, JogRate)>) {
        if *self.hand.jog.get(axis) != command {
            *self.hand.jog.get_mut(axis) = command;
            self.drives.interpolator.set_jog(axis, command);
        }
    }

    /// Moves an axis by one step when its key is pressed. The axis completes the step even
    /// if the key is released (manual III-6.1).
    fn step_axis(&mut self, axis: Axis, pressed: Option<AxisDirection>) {
        if let Some(direction) = pressed
            && !self.drives.interpolator.is_stepping(axis)
            && !self.is_interlocked(axis)
            && self.can_move(axis, direction)
        {
            let distance = direction.apply_sign(self.step_distance(axis));
            let rate = self.manual_rate(axis);
            self.drives.interpolator.start_step(axis, distance, rate);
        }
        let rate = self.manual_rate(axis);
        self.control_step(axis, rate);
    }

    /// Applies the rate, the interlocks and the limits to the current step of an axis; does nothing
    /// without a step.
    pub(crate) fn control_step(&mut self, axis: Axis, rate: JogRate) {
        let Some(direction) = self
            .drives
            .interpolator
            .step_distance_to_go(axis)
            .and_then(AxisDirection::from_distance)
        else {
            return;
        };
        if !self.can_move(axis, direction) {
            self.drives.interpolator.release_axis(axis);
        } else if self.is_interlocked(axis) {
            self.drives
                .interpolator
                .set_step_rate(axis, JogRate::Feed(0.0));
        } else {
            self.drives.interpolator.set_step_rate(axis, rate);
        }
    }

    /// Length of one step or one graduation of the handwheel, mm of slide travel; for X the
    /// increments are of the diameter. 173.1 SINC = 1 permits only the small steps; others
    /// have length 0.
    pub(crate) fn step_distance(&self, axis: Axis) -> f64 {
        let increments = self.plc.signals.step_increments;
        if increments >= 100 && self.memory.parameters.has_small_steps_only() {
            return 0.0;
        }
        f64::from(increments) * least_increment(axis, &self.memory.parameters)
    }

    /// Whether manual motion is possible: no program runs, and its motion is finished or suspended.
    fn is_manual_possible(&self) -> bool {
        match self.run.automatic.state {
            RunState::Run => false,
            RunState::Hold | RunState::Reset | RunState::Stop => {
                self.drives.interpolator.is_finished()
            }
        }
    }

    /// Rate of manual motion: the jog rate, or rapid with 快速 on. Without a reference, rapid
    /// also needs 012.0 ISOT.
    pub(crate) fn manual_rate(&self, axis: Axis) -> JogRate {
        let referenced = *self.coordinates.referenced.get(axis);
        let rapid = self.plc.signals.rapid
            && (referenced || self.memory.parameters.can_rapid_without_reference());
        let rate = if rapid {
            JogRate::Rapid
        } else {
            JogRate::Feed(jog_rate(self.plc.signals.jog_code))
        };
        self.limit_manual_rate(axis, rate)
    }

    /// Handles a mode change: manual motion stops, and keys that are down count only after
    /// their release.
    pub(crate) fn leave_manual_mode(&mut self) {
        self.abandon_returns();
        for axis in [Axis::X, Axis::Z] {
            *self.hand.jog.get_mut(axis) = None;
            self.drives.interpolator.release_axis(axis);
        }
        self.hand.jog_blocked = PerAxis::new(true, true);
    }

    /// The commanded position of the slides, machine coordinates in mm.
    pub(crate) fn position(&self) -> Point {
        self.drives.interpolator.position()
    }
}
