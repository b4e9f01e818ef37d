//! Why cycle start or an axis key does nothing at this moment: what the control and
//! the signals of the ladder say against it. Words for the line beside the panel; the
//! LCD says what the manual lets it say.

use crate::cnc::Cnc;
use crate::mode::Mode;
use crate::operation::{Direction, RunState, jog_rate};
use crate::units::Axis;

impl Cnc {
    /// Why a cycle start given now would do nothing. What raises an alarm of its own
    /// (no program, a board that refuses) is not told here.
    pub fn refuses_start(&self) -> Option<String> {
        if let Some(stands) = self.alarm_against("cycle start") {
            return Some(stands);
        }
        let mdi = self.run.mode == Mode::Mdi;
        let why = match self.run.automatic.state {
            _ if !self.run.mode.runs_programs() => {
                "cycle start acts in AUTO and MDI: press [自动] or [录入] first"
            }
            _ if self.resetting() => "cycle start does not act while RESET acts",
            RunState::Run => "cycle start: the program runs already",
            _ if self.plc.signals.feed_hold => {
                "cycle start does not act while *SP (G8.5) is 0: the key [暂停], the pin X1.5 or \
                 the ladder holds"
            }
            _ if self.board_is_stopping() || self.still_moves() => {
                "cycle start waits until the axes stand: press it again then"
            }
            RunState::Hold if !mdi && !self.run.automatic.mdi && !self.runs_in(self.run.mode) => {
                "the held block goes on in the mode that it was begun in (AUTO or DNC): select \
                 that, or press [复位]"
            }
            RunState::Hold | RunState::Stop if !mdi => return None,
            _ if mdi && self.run.mdi.is_empty() && !self.goes_on_in_mdi() => {
                "no MDI block is keyed in: page [程序], MDI, word by word with [输入]"
            }
            _ if mdi && self.run.handshake.busy() => {
                "cycle start waits for the M, S or T function under way"
            }
            _ => return None,
        };
        Some(why.to_owned())
    }

    /// An alarm or a message that stands: it is told by itself, too.
    fn alarm_against(&self, what: &str) -> Option<String> {
        let standing = self.standing_message();
        let number = match (self.alarms().first(), &standing) {
            (Some(alarm), _) | (None, Some(alarm)) => alarm.number,
            (None, None) => return None,
        };
        Some(format!(
            "{what} does not act while alarm {number:03} stands: remove its cause, then [复位]"
        ))
    }

    /// Axes that a program may not take over yet.
    fn still_moves(&self) -> bool {
        let held =
            self.run.automatic.state == RunState::Hold && self.run.automatic.current.is_some();
        (!held || self.run.held.is_some()) && self.drives.interpolator.is_moving()
    }

    fn goes_on_in_mdi(&self) -> bool {
        self.run.automatic.mdi && self.run.automatic.operating()
    }

    /// Why the key of an axis, which is down and which the ladder has had time to pass
    /// on, does not move it.
    pub fn refuses_axis(&self, axis: Axis) -> Option<String> {
        let why = match self.run.mode.motion() {
            Mode::Handwheel => {
                "handwheel mode (001.3 = 1): choose the axis with [X手轮] or [Z手轮] and turn the \
                 wheel, the axis keys do nothing"
            }
            mode if !mode.is_manual() => {
                "the axis keys act in the modes [手动], [单步], [机械零点] and [程序零点]"
            }
            _ if self.emergency_stop || self.is_not_ready() => {
                return self.alarm_against("the axis key");
            }
            _ if self.resetting() => "the axis keys do not act while RESET acts",
            _ if self.run.automatic.state == RunState::Run => {
                "a thread is being finished: the axis keys act behind it"
            }
            _ if *self.hand.jog_blocked.get(axis) => {
                "the axis key was down when the mode changed: let it go and press it again"
            }
            _ => return self.refuses_direction(axis),
        };
        Some(why.to_owned())
    }

    /// What stands against the direction that the ladder asks for.
    fn refuses_direction(&self, axis: Axis) -> Option<String> {
        let g = &self.plc.signals;
        let way = match (*g.jog_plus.get(axis), *g.jog_minus.get(axis)) {
            (true, false) => Direction::Plus,
            (false, true) => Direction::Minus,
            _ => {
                return Some(
                    "the ladder does not pass the axis key on (G100, G102): let go of every axis \
                     key, then press one"
                        .to_owned(),
                );
            }
        };
        if let Some(lock) = self.axis_lock(axis) {
            return Some(format!("{axis:?} does not move: {lock}"));
        }
        if self.direction_locked(axis, way) {
            return Some(format!(
                "{axis:?} does not move this way: overtravel, a limit signal (G114, G116) or \
                 ±MIT (G132, G134); the other way is free"
            ));
        }
        match self.run.mode.motion() {
            Mode::MachineZero => self.refuses_return(axis),
            Mode::ProgramZero => None,
            Mode::Step => (self.step_distance(axis) == 0.0)
                .then(|| "steps above 0.01 are locked by 173.1 = 1: press [0.01]".to_owned()),
            _ => self.refuses_rate(axis),
        }
    }

    fn axis_lock(&self, axis: Axis) -> Option<&'static str> {
        let g = &self.plc.signals;
        if g.interlock {
            Some("the interlock *IT (G8.0) is 0")
        } else if *g.axis_interlock.get(axis) {
            Some("its interlock IT (G130) is 1")
        } else if self.brake_interlock() {
            Some("the output of the spindle brake is on (011.4 = 0)")
        } else {
            None
        }
    }

    fn refuses_return(&self, axis: Axis) -> Option<String> {
        if !self.memory.parameters.has_zero_switch(axis)
            || self.coordinates.returns.get(axis).is_some()
        {
            return None;
        }
        if *self.plc.signals.machine_lock.get(axis) {
            return Some(format!(
                "{axis:?} makes no machine zero return under machine lock: press [机床锁]"
            ));
        }
        let stands = self.coordinates.at_reference.get(axis).is_some();
        stands.then(|| format!("{axis:?} stands at its machine zero already"))
    }

    fn refuses_rate(&self, axis: Axis) -> Option<String> {
        let rapid_allowed = *self.coordinates.referenced.get(axis)
            || self.memory.parameters.rapid_without_reference();
        if self.plc.signals.rapid && !rapid_allowed {
            return Some(format!(
                "{axis:?} has no reference: it moves at the jog rate, rapid needs the machine \
                 zero return first (012.0 = 0)"
            ));
        }
        let stands = !self.plc.signals.rapid && jog_rate(self.plc.signals.jog_code) == 0.0;
        stands.then(|| "the feed override is 0 %: raise it with [进给倍率↑]".to_owned())
    }
}
