//! Everything that stops the board, and what is known afterwards.

use super::super::super::{BoardOutputs, Doubt, HostTime, LinkState, Pins};
use super::super::Family;
use super::super::family::Cause;
use super::{
    ANSWER_WAIT, EXCUSED, HEARD, HOLD_WAIT, Halt, LATE, LineLink, MODES, RESET, RESET_AGAIN,
    Restart, SILENCE,
};

impl LineLink {
    pub(super) fn watch_silence(&mut self) {
        let restarts = matches!(self.halt, Halt::Restarting(_));
        let silent = !restarts
            && self
                .asked
                .is_some_and(|asked| self.now.saturating_sub(asked) >= self.patience(SILENCE));
        let unanswered = self
            .unanswered
            .front()
            .is_some_and(|line| self.now.saturating_sub(line.sent) >= ANSWER_WAIT);
        if silent {
            self.lost(&format!(
                "the board has not answered for {} ms",
                self.patience(SILENCE).as_millis()
            ));
        } else if self.is_cutting() {
            // A pass has a patience of its own.
        } else if unanswered && self.halt == Halt::None && self.homing.is_none() && self.is_open() {
            self.protocol_error("a line was never answered");
        } else if self.halt == Halt::None
            && self.queued.front().is_some_and(|segment| {
                self.now.saturating_sub(self.progressed) >= segment.duration + LATE
            })
        {
            self.protocol_error("a segment takes much longer than it was given");
        }
    }

    pub(super) fn watch_halt(&mut self) {
        match self.halt {
            Halt::Braking(since) if self.now.saturating_sub(since) >= HOLD_WAIT => {
                self.lose_position(Doubt::StoppedDead);
                self.alarm(607, "the board did not stand within 1 s");
                self.restart();
                self.enter(LinkState::Fault);
            }
            Halt::Draining(since) => self.watch_draining(since),
            Halt::Restarting(restart) => self.watch_restart(restart),
            _ => {}
        }
    }

    fn watch_restart(&mut self, restart: Restart) {
        let passed = |since| self.now.saturating_sub(since);
        if let Some(at) = restart.quiet_at {
            if self.now >= at {
                self.restarted();
            }
        } else if passed(restart.since) >= ANSWER_WAIT {
            self.lost("the board did not come back after a reset");
        } else if passed(restart.sent) >= RESET_AGAIN {
            self.outgoing.push(RESET);
            self.halt = Halt::Restarting(Restart {
                sent: self.now,
                ..restart
            });
        }
    }

    /// `!`, standstill, Ctrl-X: nothing queued is left, the position is kept.
    pub(super) fn flush(&mut self) {
        if self.is_cutting() {
            return self.abandon_pass();
        }
        if self.halt == Halt::None {
            self.slipped = self.fastest() > f64::from(self.config.flush_keep_speed);
            if self.opening.family == Family::FluidNc && !self.unanswered.is_empty() {
                self.halt = Halt::Draining(self.now);
                let unread = core::mem::take(&mut self.unanswered);
                self.forget_motion();
                self.unanswered = unread;
                return;
            }
            self.brake();
        }
        self.forget_motion();
    }

    fn brake(&mut self) {
        self.outgoing.push(b'!');
        self.halt = Halt::Braking(self.now);
        self.asked = None;
        self.last_asked = HostTime::ZERO;
    }

    /// A line that FluidNC has taken and not begun when it is held is carried out behind
    /// the reset: it is held when it has answered all.
    fn watch_draining(&mut self, since: HostTime) {
        if self.unanswered.is_empty() {
            self.brake();
        } else if self.now.saturating_sub(since) >= HEARD {
            // While it moves a reset locks it, and a locked board carries nothing out.
            self.lose_position(Doubt::StoppedDead);
            self.forget_motion();
            self.restart();
        }
    }

    pub(super) fn restart(&mut self) {
        self.outgoing.push(RESET);
        self.halt = Halt::Restarting(Restart {
            since: self.now,
            sent: self.now,
            quiet_at: None,
        });
        self.asked = None;
        self.status = None;
        self.homing = None;
        self.line.clear();
    }

    /// Nobody knows where the slides stand.
    pub(super) fn lose_position(&mut self, doubt: Doubt) {
        if core::mem::take(&mut self.position_known) {
            self.doubt = doubt;
        }
        self.released = false;
    }

    /// A banner that was asked for. Behind a Ctrl-X that was sent again another may come,
    /// no later after the last of them than this one after the first.
    pub(super) fn banner_came(&mut self) {
        if let Halt::Restarting(restart) = &mut self.halt
            && restart.sent > restart.since
        {
            let longest = self.now.saturating_sub(restart.since);
            restart.quiet_at.get_or_insert(self.now + longest);
        } else {
            self.restarted();
        }
    }

    /// The board is there again.
    fn restarted(&mut self) {
        self.halt = Halt::None;
        self.forget_motion();
        self.asked = None;
        self.last_asked = HostTime::ZERO;
        self.still_since = None;
        self.status = None;
        self.switched = BoardOutputs::default();
        if core::mem::take(&mut self.unlocks) {
            self.send("$X", false);
        }
        if self.state == LinkState::Moving {
            for modes in MODES {
                self.send(modes, false);
            }
            self.enter(LinkState::Verify);
        }
    }

    pub(super) fn forget_motion(&mut self) {
        self.unanswered.clear();
        self.backlog.clear();
        self.queued.clear();
        self.handed.clear();
        self.past.clear();
        self.cutting = None;
        self.resumes = false;
        self.segments.begin(self.commanded, self.executed);
    }

    /// The board started by itself: power or its reset line.
    pub(super) fn board_restarted(&mut self) {
        self.forget_motion();
        self.lose_position(Doubt::Reset);
        self.counts = false;
        self.restarted = true;
        self.halt = Halt::None;
        self.homing = None;
        self.status = None;
        // What was asked before is never answered.
        self.asked = None;
        self.switched = BoardOutputs::default();
        self.alarm(606, "the board was reset");
        self.enter(LinkState::Fault);
    }

    pub(super) fn protocol_error(&mut self, cause: &str) {
        self.alarm(608, cause);
        self.lose_position(Doubt::Misunderstood);
        self.flush();
        self.enter(LinkState::Fault);
    }

    pub(super) fn board_alarm(&mut self, number: u16) {
        let family = self.opening.family;
        // On the way back from a reset, our own or that of the board.
        let coming_back = matches!(self.halt, Halt::Restarting(_)) || self.restarted;
        if coming_back && family.excuses(number) {
            return;
        }
        let ways = self.ways();
        self.forget_motion();
        self.lose_position(Doubt::StoppedDead);
        match family.cause(number) {
            Cause::Limit => {
                let [x, z] = ways;
                self.limit_hit = Some([(!self.pins.x).then_some(x), (!self.pins.z).then_some(z)]);
                // Nothing but a reset is heard by the board now; FluidNC needs a second for
                // it, and answers meanwhile.
                self.restart();
                self.enter(LinkState::Tripped);
            }
            Cause::Reset => {
                self.restarted = true;
                self.alarm(606, "the board was reset while it moved");
                self.enter(LinkState::Fault);
            }
            Cause::Homing => {
                self.homing = None;
                if family == Family::FluidNc {
                    // It plans from the place before the return until it is reset.
                    self.restart();
                }
                self.excused_until = self.now + EXCUSED;
                self.alarm(609, &format!("ALARM:{number} of the board"));
                self.enter(LinkState::Locked);
            }
            Cause::EmergencyStop => {
                self.alarm(207, "emergency stop input of the board");
                if family == Family::FluidNc {
                    // Without it an unlock would do nothing.
                    self.restart();
                }
                self.enter(LinkState::Tripped);
            }
            Cause::Spindle => {
                self.alarm(94, "the spindle did not turn twice within 5 s (ALARM:14)");
                // It waits for ever for the motion it has not begun.
                self.restart();
                self.enter(LinkState::Fault);
            }
            Cause::Motor => {
                for (number, axis) in [(221, 'X'), (222, 'Z')] {
                    let text = format!("ALARM:17 of the board: motor fault, perhaps of {axis}");
                    self.alarm(number, &text);
                }
                self.restart();
                self.enter(LinkState::Tripped);
            }
            Cause::Order => {
                self.alarm(608, &format!("ALARM:{number} of the board"));
                // Whatever it still holds it shall not carry out after an unlock.
                self.restart();
                self.enter(LinkState::Fault);
            }
            Cause::Locked => {
                self.alarm(607, "the board is locked");
                self.restart();
                self.enter(LinkState::Fault);
            }
        }
    }

    /// Which limit stopped the board; both when neither is operated any more.
    pub(super) fn name_limits(&mut self, pins: Pins, ways: [Option<i64>; 2]) {
        for (axis, operated) in [pins.x, pins.z].into_iter().enumerate() {
            if let (true, Some(way)) = (operated, ways[axis]) {
                self.limits.hit(axis, way);
            }
        }
        for (operated, number, axis) in [(pins.x, 621, 'X'), (pins.z, 622, 'Z')] {
            if operated || !(pins.x || pins.z) {
                self.alarm(number, &format!("limit input of {axis} at the board"));
            }
        }
    }
}
