//! Manual motion: jog, manual rapid and steps (manual III-4.1, III-6.1), and the parts that
//! all manual motion shares.

mod handwheel;
mod limits;
mod zero_return;

use crate::axis::least_increment;
use crate::cnc::Cnc;
use crate::machine::Inputs;
use crate::mode::Mode;
use crate::motion::JogRate;
use crate::operation::{Direction, RunState, jog_rate};
use crate::units::{Axis, PerAxis, Point};

impl Cnc {
    /// Advances manual motion by one tick.
    pub(crate) fn manual_tick(&mut self, inputs: &Inputs) {
        let counts = self.hand.wheel.counts(inputs.handwheel);
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
        let allowed = self.run.mode.is_manual()
            && !self.emergency_stop
            && !self.resetting()
            && !self.is_not_ready();
        let asked = match self.run.mode.motion() {
            Mode::Handwheel => counts != 0 && self.plc.signals.wheel_axis.is_some(),
            _ => down.x || down.z,
        };
        if allowed && asked {
            self.set_aside_held_motion();
        }
        if !self.manual_possible() {
            return;
        }
        for axis in [Axis::X, Axis::Z] {
            let key = match (*plus.get(axis), *minus.get(axis)) {
                (true, false) => Some(Direction::Plus),
                (false, true) => Some(Direction::Minus),
                _ => None,
            };
            let key = key.filter(|_| allowed && !*self.hand.jog_blocked.get(axis));
            let pressed = key.filter(|_| !*before.get(axis));
            let by_hand = self.board_takes_motion();
            match self.run.mode.motion() {
                Mode::Step => self.step(axis, pressed.filter(|_| by_hand)),
                Mode::Handwheel => {
                    self.follow_wheel(axis, if allowed && by_hand { counts } else { 0 });
                }
                Mode::MachineZero => {
                    // A board that homes on its own starts when it is ready.
                    let begins = by_hand || self.board_seeks() || self.board_homes();
                    self.return_keys(axis, key.is_some(), pressed.is_some() && begins);
                }
                Mode::ProgramZero => {
                    self.return_keys(axis, key.is_some(), pressed.is_some() && by_hand);
                }
                _ => self.jog(axis, key.filter(|_| by_hand)),
            }
        }
    }

    /// Jog: moves the axis while its key is held.
    fn jog(&mut self, axis: Axis, key: Option<Direction>) {
        let way = key.filter(|way| !self.interlocked(axis) && self.may_go(axis, *way));
        let command = way.map(|way| (way == Direction::Plus, self.manual_rate(axis)));
        self.command_axis(axis, command);
    }

    /// Commands a jog of an axis, or a standstill.
    pub(crate) fn command_axis(&mut self, axis: Axis, command: Option<(bool, JogRate)>) {
        if *self.hand.jog.get(axis) != command {
            *self.hand.jog.get_mut(axis) = command;
            self.drives.interpolator.set_jog(axis, command);
        }
    }

    /// Step: each press moves the axis by one increment, to its end even when the key is
    /// released (manual III-6.1).
    fn step(&mut self, axis: Axis, pressed: Option<Direction>) {
        if let Some(way) = pressed
            && !self.drives.interpolator.stepping(axis)
            && !self.interlocked(axis)
            && self.may_go(axis, way)
        {
            let distance = way.signed(self.step_distance(axis));
            let rate = self.manual_rate(axis);
            self.drives.interpolator.start_step(axis, distance, rate);
        }
        let rate = self.manual_rate(axis);
        self.guide_step(axis, rate);
    }

    /// Applies the rate, the interlocks and the limits to a step under way.
    pub(crate) fn guide_step(&mut self, axis: Axis, rate: JogRate) {
        let Some(way) = self
            .drives
            .interpolator
            .step_rest(axis)
            .and_then(Direction::of)
        else {
            return;
        };
        if !self.may_go(axis, way) {
            self.drives.interpolator.release(axis);
        } else if self.interlocked(axis) {
            self.drives
                .interpolator
                .set_step_rate(axis, JogRate::Feed(0.0));
        } else {
            self.drives.interpolator.set_step_rate(axis, rate);
        }
    }

    /// One step, or one graduation of the handwheel, mm of the slide: X counts on the
    /// diameter. 173.1 SINC = 1 permits only the small ones.
    pub(crate) fn step_distance(&self, axis: Axis) -> f64 {
        let increments = self.plc.signals.step_increments;
        if increments >= 100 && self.memory.parameters.small_steps_only() {
            return 0.0;
        }
        f64::from(increments) * least_increment(axis, &self.memory.parameters)
    }

    /// Whether manual motion is possible: the program's motion is at rest or suspended.
    fn manual_possible(&self) -> bool {
        match self.run.automatic.state {
            RunState::Run => false,
            RunState::Hold | RunState::Reset | RunState::Stop => {
                self.drives.interpolator.finished()
            }
        }
    }

    /// Jog rate, or rapid with 快速 on; without a reference the rapid needs 012.0 ISOT.
    pub(crate) fn manual_rate(&self, axis: Axis) -> JogRate {
        let referenced = *self.coordinates.referenced.get(axis);
        let rapid = self.plc.signals.rapid
            && (referenced || self.memory.parameters.rapid_without_reference());
        let rate = if rapid {
            JogRate::Rapid
        } else {
            JogRate::Feed(jog_rate(self.plc.signals.jog_code))
        };
        self.board_slows(axis, rate)
    }

    /// Handles a mode change: manual motion stops, and keys that are down count only after
    /// their release.
    pub(crate) fn manual_mode_left(&mut self) {
        self.abandon_returns();
        for axis in [Axis::X, Axis::Z] {
            *self.hand.jog.get_mut(axis) = None;
            self.drives.interpolator.release(axis);
        }
        self.hand.jog_blocked = PerAxis::new(true, true);
    }

    /// The commanded position of the slides, machine coordinates.
    pub(crate) fn position(&self) -> Point {
        self.drives.interpolator.position()
    }
}
