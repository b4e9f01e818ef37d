//! Manual motion: jog and manual rapid (manual III-4.1).

use super::automatic::RunState;
use super::mode::Mode;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
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

/// Which way a jog key drives an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Plus,
    Minus,
}

impl Cnc {
    /// One tick of manual motion.
    pub(crate) fn manual_tick(&mut self) {
        // A key held from before a mode change must be released first.
        let plus = self.from_plc.jog_plus;
        let minus = self.from_plc.jog_minus;
        self.jog_blocked.x &= plus.x || minus.x;
        self.jog_blocked.z &= plus.z || minus.z;
        let allowed = self.mode == Mode::Jog && !self.emergency_stop && !self.resetting();
        if allowed && (plus.x || plus.z || minus.x || minus.z) {
            self.set_aside_held_motion();
        }
        if !self.manual_possible() {
            return;
        }
        for axis in [Axis::X, Axis::Z] {
            let way = match (*plus.get(axis), *minus.get(axis)) {
                (true, false) => Some(Way::Plus),
                (false, true) => Some(Way::Minus),
                _ => None,
            };
            let free = allowed && !*self.jog_blocked.get(axis) && !self.interlocked(axis);
            let way = way.filter(|way| free && !self.direction_locked(axis, *way));
            let command = way.map(|way| (way == Way::Plus, self.jog_speed()));
            if *self.jog_command.get(axis) != command {
                *self.jog_command.get_mut(axis) = command;
                self.interpolator.set_jog(axis, command);
            }
        }
    }

    /// Manual motion needs the path of the program at rest and out of the way.
    fn manual_possible(&self) -> bool {
        match self.automatic.state {
            RunState::Run => false,
            RunState::Hold => self.held.is_some() || self.automatic.current.is_none(),
            RunState::Reset | RunState::Stop => self.interpolator.finished(),
        }
    }

    /// Lays the rest of a held block aside, once the axes stand, so that they can
    /// be moved by hand.
    pub(super) fn set_aside_held_motion(&mut self) {
        let at_rest = self.automatic.state == RunState::Hold
            && self.held.is_none()
            && !self.automatic.protected()
            && !self.interpolator.is_moving();
        if at_rest {
            self.held = Some(self.interpolator.clone());
            self.interpolator.cancel();
        }
    }

    /// Cycle start after manual motion: the interrupted block goes its remaining
    /// distance from where the axes stand now; the next block goes to the
    /// programmed coordinates.
    pub(crate) fn absorb_manual_motion(&mut self) {
        let Some(mut held) = self.held.take() else {
            return;
        };
        held.translate(self.interpolator.position() - held.position());
        self.interpolator = held;
    }

    fn jog_speed(&self) -> JogRate {
        // Without a reference, manual rapid needs 012.0 ISOT.
        let referenced = self.referenced.x && self.referenced.z;
        if self.from_plc.rapid && (referenced || self.parameters.rapid_without_reference()) {
            JogRate::Rapid
        } else {
            JogRate::Feed(jog_rate(self.from_plc.jog_code))
        }
    }

    /// Software travel limits 045–048 (manual III-2.5.2): effective with 172.4
    /// MOT = 0 and for axes with a reference.
    pub(crate) fn watch_travel(&mut self) {
        if self.parameters.soft_limits_masked()
            || self.machine_locked()
            || !self.interpolator.is_moving()
        {
            return;
        }
        let overrun =
            self.soft_limits
                .overrun(self.slide(), self.stopping_point(), self.referenced);
        let Some(number) = overrun else {
            return;
        };
        let alarm = Alarm::new(number);
        let source = self
            .automatic
            .current
            .as_ref()
            .map(|current| current.command.source);
        self.raise(source.map_or(alarm.clone(), |source| alarm.at(source)));
    }

    /// A mode change: what moved by hand stops, and keys that are down count
    /// only after they were released.
    pub(crate) fn manual_mode_left(&mut self) {
        for axis in [Axis::X, Axis::Z] {
            *self.jog_command.get_mut(axis) = None;
            self.interpolator.set_jog(axis, None);
        }
        self.jog_blocked = PerAxis::new(true, true);
    }

    /// The commanded position of the slides, machine coordinates.
    pub(crate) fn position(&self) -> Point {
        self.interpolator.position()
    }
}

/// The overtravel alarm of an axis and a direction.
pub(crate) const fn travel_alarm(axis: Axis, way: Way) -> u16 {
    match (axis, way) {
        (Axis::X, Way::Plus) => 201,
        (Axis::X, Way::Minus) => 202,
        (Axis::Z, Way::Plus) => 203,
        (Axis::Z, Way::Minus) => 204,
    }
}
