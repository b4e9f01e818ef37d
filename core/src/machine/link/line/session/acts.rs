//! What the board does by itself: its reference return, spindle and coolant.

use core::fmt::Write;

use super::super::super::{
    BoardOutputs, Doubt, Event, Lacks, LinkState, Refused, SpindleWay, ThreadRights,
};
use super::super::Family;
use super::super::answers::BoardState;
use super::{EXCUSED, HOMING_WAIT, Halt, Homing, LineLink, RESET};
use crate::units::{Axis, PerAxis};

impl LineLink {
    /// Whether questions and orders are answered now.
    pub(super) const fn is_open(&self) -> bool {
        matches!(
            self.state,
            LinkState::Locked | LinkState::Ready | LinkState::Moving | LinkState::Verify
        )
    }

    pub(super) fn stands_in(&self, states: &[BoardState]) -> bool {
        let state = self.status.map(|status| status.state);
        self.halt == Halt::None
            && self.unanswered.is_empty()
            && matches!(self.state, LinkState::Ready | LinkState::Locked)
            && state.is_some_and(|state| states.contains(&state))
    }

    /// Whether the board can seek the switch of one axis alone.
    pub const fn homes_single_axes(&self) -> bool {
        self.opening.alone
    }

    /// Which threads it cuts.
    pub fn threads(&self) -> ThreadRights {
        let sync = self.board().spindle_sync;
        let told = |number| self.opening.setting(number) != 0.0;
        let lacks = Lacks {
            sync: !sync,
            proof: !self.config.line.thread_proved,
            encoder: sync && !told(38),
            gains: sync && [90, 91, 92].into_iter().any(told),
            offset: sync && self.opening.offset,
            index: false,
        };
        if lacks == Lacks::default() {
            return ThreadRights::Passes;
        }
        ThreadRights::None(lacks)
    }

    /// Begins the reference return of these axes. Boards that know only one for all
    /// make that.
    ///
    /// # Errors
    /// The board moves or has not said how it stands.
    pub fn home(&mut self, axes: PerAxis<bool>) -> Result<(), Refused> {
        if !self.stands_in(&[BoardState::Idle, BoardState::Alarm]) || !(axes.x || axes.z) {
            return Err(Refused::NotReady);
        }
        let all = PerAxis::new(true, true);
        let (line, axes) = match (self.homes_single_axes(), axes.x, axes.z) {
            (true, true, false) => ("$HX", axes),
            (true, false, true) => ("$HZ", axes),
            _ => ("$H", all),
        };
        if let Some(axis) = self.stands_beyond(axes) {
            let text = format!(
                "{axis:?} stands upon a limit switch that does not lie where the return goes: \
                 jog off it first"
            );
            self.alarm(609, &text);
            return Err(Refused::TowardLimit(axis));
        }
        self.limits.forget();
        self.went = [[None; 2]; 2];
        self.lose_position(Doubt::Unreferenced);
        // It counts anew from its switches.
        self.counts = false;
        self.stood = None;
        self.status = None;
        self.still_since = None;
        self.asked = None;
        self.homing = Some(Homing {
            since: self.now,
            axes,
            named: PerAxis::default(),
        });
        self.send(line, false);
        self.enter(LinkState::Homing);
        Ok(())
    }

    /// An axis upon the limit switch of its other end: the board would take it for that of
    /// its reference, and go farther when it means to go off it.
    fn stands_beyond(&self, axes: PerAxis<bool>) -> Option<Axis> {
        [
            (Axis::X, self.config.x.home_negative, self.pins.x),
            (Axis::Z, self.config.z.home_negative, self.pins.z),
        ]
        .into_iter()
        .find_map(|(axis, negative, operated)| {
            let away = if negative { 1 } else { -1 };
            let beyond = operated && self.limits.met(axis as usize) == Some(away);
            (*axes.get(axis) && beyond).then_some(axis)
        })
    }

    /// The board has answered its reference return.
    pub(super) fn homed(&mut self, error: Option<u16>) {
        let Some(homing) = self.homing.take() else {
            return;
        };
        // A report that was under way when the return began tells the old place.
        self.status = None;
        self.still_since = None;
        self.asked = None;
        let names = self.opening.family == Family::FluidNc;
        let why = match error {
            Some(number) => format!("the board refuses its reference return with error:{number}"),
            // It answers so whatever came of it.
            None if names && homing.named != homing.axes => {
                "the board does not say that its reference return was made".into()
            }
            None => {
                self.events.push(Event::Homed(homing.axes));
                self.enter(LinkState::Locked);
                self.unlocks = names;
                return;
            }
        };
        if names {
            // It plans from the place before the return until it is reset.
            self.restart();
        }
        self.enter(LinkState::Locked);
        self.alarm(609, &why);
    }

    /// FluidNC names each axis that has come home.
    pub(super) fn board_says(&mut self, text: &str) {
        if let (Some(homing), Some(axes)) = (&mut self.homing, text.strip_prefix("Homed:")) {
            homing.named.x |= axes.contains('X') && homing.axes.x;
            homing.named.z |= axes.contains('Z') && homing.axes.z;
        }
    }

    pub(super) fn watch_homing(&mut self) {
        if let Some(homing) = self.homing
            && self.now.saturating_sub(homing.since) >= HOMING_WAIT
        {
            self.give_up_homing(Some("the reference return takes longer than 120 s"));
        }
    }

    /// Stops a reference return; `why` for one that was not stopped by the operator.
    pub(super) fn give_up_homing(&mut self, why: Option<&str>) {
        if let Some(why) = why {
            self.alarm(609, why);
        }
        self.forget_motion();
        self.restart();
        self.excused_until = self.now + EXCUSED;
        self.enter(LinkState::Locked);
    }

    /// The port is about to be closed: motion, spindle and coolant stop.
    pub fn close(&mut self) {
        self.outgoing.clear();
        if self.opening.is_done() {
            self.outgoing.push(RESET);
        }
        self.lose_position(Doubt::Unheard);
        self.enter(LinkState::Off);
    }

    /// The control forgot where the axes stand (power off): so does the link.
    pub fn forget_position(&mut self) {
        self.doubt_position(Doubt::Unreferenced);
        self.counts = false;
        self.stood = None;
    }

    /// The board's count says no more where the slides stand.
    pub fn doubt_position(&mut self, doubt: Doubt) {
        self.lose_position(doubt);
        match self.state {
            LinkState::Moving => self.flush(),
            LinkState::Ready => self.enter(LinkState::Locked),
            _ => {}
        }
    }

    /// What spindle and coolant are to do; the board is told when it stands.
    pub const fn set_outputs(&mut self, outputs: BoardOutputs) {
        self.wanted = outputs;
    }

    /// What the board has switched; none while an order is under way.
    pub fn switched(&self) -> Option<BoardOutputs> {
        let settled = self.unanswered.iter().all(|line| line.is_segment);
        settled.then_some(self.switched)
    }

    pub(super) fn switch(&mut self) {
        if self.wanted == self.switched || !self.stands_in(&[BoardState::Idle]) {
            return;
        }
        let BoardOutputs {
            spindle,
            millivolts,
            coolant,
        } = self.wanted;
        // A `String` takes everything that is written to it.
        let mut line = String::new();
        let _ = match spindle {
            SpindleWay::Stop => write!(line, "M5"),
            SpindleWay::Forward => write!(line, "M3S{:.1}", f64::from(millivolts) / 10.0),
            SpindleWay::Reverse => write!(line, "M4S{:.1}", f64::from(millivolts) / 10.0),
        };
        line.push_str(if coolant { "M8" } else { "M9" });
        self.send(&line, false);
        self.switched = self.wanted;
    }
}
