//! Manual motion: jog, manual rapid and steps (manual III-4.1, III-6.1); what all
//! ways to move an axis by hand have in common.

use super::automatic::RunState;
use super::mode::Mode;
use crate::axis::least_increment;
use crate::cnc::Cnc;
use crate::machine::Inputs;
use crate::motion::JogRate;
use crate::units::{Axis, PerAxis, Point};

/// Jog rates in mm/min by override step, 0 %…150 % (manual III-4.1.3).
const JOG_RATES: [f64; 16] = [
    0.0, 2.0, 3.2, 5.0, 7.9, 12.6, 20.0, 32.0, 50.0, 79.0, 126.0, 200.0, 320.0, 500.0, 790.0,
    1260.0,
];

/// Highest jog rate, mm/min: the dry-run rate of cuts with 快速 on.
pub(crate) const JOG_RATE_MAX: f64 = JOG_RATES[15];

/// The jog rate for a code of G10 (0 = 150 % … 15 = 0 %), mm/min. X moves at it
/// in radius.
pub fn jog_rate(code: u8) -> f64 {
    JOG_RATES[usize::from(15 - code.min(15))]
}

/// Which way a key drives an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Plus,
    Minus,
}

impl Way {
    /// The way of a signed distance; none for zero.
    pub(super) fn of(distance: f64) -> Option<Self> {
        match distance {
            d if d > 0.0 => Some(Self::Plus),
            d if d < 0.0 => Some(Self::Minus),
            _ => None,
        }
    }

    /// A distance this way, with its sign.
    pub(super) const fn signed(self, distance: f64) -> f64 {
        match self {
            Self::Plus => distance,
            Self::Minus => -distance,
        }
    }
}

impl Cnc {
    /// One tick of manual motion.
    pub(crate) fn manual_tick(&mut self, inputs: &Inputs) {
        let counts = self.wheel.counts(inputs.handwheel);
        // A key held from before a mode change must be released first.
        let plus = self.from_plc.jog_plus;
        let minus = self.from_plc.jog_minus;
        let down = PerAxis::new(plus.x || minus.x, plus.z || minus.z);
        self.jog_blocked.x &= down.x;
        self.jog_blocked.z &= down.z;
        let before = core::mem::replace(&mut self.axis_keys, down);
        if self.automatic.state == RunState::Run {
            return;
        }
        let allowed = self.mode.is_manual()
            && !self.emergency_stop
            && !self.resetting()
            && !self.is_not_ready();
        let asked = match self.mode {
            Mode::Handwheel => counts != 0 && self.from_plc.wheel_axis.is_some(),
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
                (true, false) => Some(Way::Plus),
                (false, true) => Some(Way::Minus),
                _ => None,
            };
            let key = key.filter(|_| allowed && !*self.jog_blocked.get(axis));
            let pressed = key.filter(|_| !*before.get(axis));
            let by_hand = self.board_takes_motion();
            match self.mode {
                Mode::Step => self.step(axis, pressed.filter(|_| by_hand)),
                Mode::Handwheel => {
                    self.follow_wheel(axis, if allowed && by_hand { counts } else { 0 });
                }
                Mode::MachineZero => {
                    // One that returns by itself is asked once it can.
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

    /// Jog: the axis moves while its key is held.
    fn jog(&mut self, axis: Axis, key: Option<Way>) {
        let way = key.filter(|way| !self.interlocked(axis) && self.may_go(axis, *way));
        let command = way.map(|way| (way == Way::Plus, self.manual_rate(axis)));
        self.command_axis(axis, command);
    }

    /// Asks an axis for a jog, or for standstill.
    pub(super) fn command_axis(&mut self, axis: Axis, command: Option<(bool, JogRate)>) {
        if *self.jog_command.get(axis) != command {
            *self.jog_command.get_mut(axis) = command;
            self.interpolator.set_jog(axis, command);
        }
    }

    /// Step: each press moves the axis by one increment, to its end even when the
    /// key comes up (manual III-6.1).
    fn step(&mut self, axis: Axis, pressed: Option<Way>) {
        if let Some(way) = pressed
            && !self.interpolator.stepping(axis)
            && !self.interlocked(axis)
            && self.may_go(axis, way)
        {
            let distance = way.signed(self.step_distance(axis));
            let rate = self.manual_rate(axis);
            self.interpolator.start_step(axis, distance, rate);
        }
        let rate = self.manual_rate(axis);
        self.guide_step(axis, rate);
    }

    /// A step under way keeps to its rate, to the interlocks and to the limits.
    pub(super) fn guide_step(&mut self, axis: Axis, rate: JogRate) {
        let Some(way) = self.interpolator.step_rest(axis).and_then(Way::of) else {
            return;
        };
        if !self.may_go(axis, way) {
            self.interpolator.release(axis);
        } else if self.interlocked(axis) {
            self.interpolator.set_step_rate(axis, JogRate::Feed(0.0));
        } else {
            self.interpolator.set_step_rate(axis, rate);
        }
    }

    /// One step, or one graduation of the handwheel, mm of the slide: X counts on
    /// the diameter. 173.1 SINC = 1 leaves the small ones only.
    pub(super) fn step_distance(&self, axis: Axis) -> f64 {
        let increments = self.from_plc.step_increments;
        if increments >= 100 && self.parameters.small_steps_only() {
            return 0.0;
        }
        f64::from(increments) * least_increment(axis, &self.parameters)
    }

    /// Manual motion needs the path of the program at rest and out of the way.
    fn manual_possible(&self) -> bool {
        match self.automatic.state {
            RunState::Run => false,
            RunState::Hold | RunState::Reset | RunState::Stop => self.interpolator.finished(),
        }
    }

    /// Jog rate, or rapid with 快速 on; without a reference that needs 012.0 ISOT.
    fn manual_rate(&self, axis: Axis) -> JogRate {
        let referenced = *self.referenced.get(axis);
        let rapid =
            self.from_plc.rapid && (referenced || self.parameters.rapid_without_reference());
        let rate = if rapid {
            JogRate::Rapid
        } else {
            JogRate::Feed(jog_rate(self.from_plc.jog_code))
        };
        self.board_slows(axis, rate)
    }

    /// A mode change: what moved by hand stops, and keys that are down count
    /// only after they were released.
    pub(crate) fn manual_mode_left(&mut self) {
        self.abandon_returns();
        for axis in [Axis::X, Axis::Z] {
            *self.jog_command.get_mut(axis) = None;
            self.interpolator.release(axis);
        }
        self.jog_blocked = PerAxis::new(true, true);
    }

    /// The commanded position of the slides, machine coordinates.
    pub(crate) fn position(&self) -> Point {
        self.interpolator.position()
    }
}
