//! Stops of a line board and the position after them.

use gsk_messages::{Message, say};
use gsk_units::alarm;

use core::time::Duration;

use super::{ANSWER_TIME, LineLink, MODES};
use crate::line::FirmwareFamily;
use crate::line::family::StopCause;
use crate::line::realtime::{FEED_HOLD, SOFT_RESET};
use crate::line::response::BoardState;
use crate::{HostTime, LinkEvent, LinkState, Pins, Stop, Uncertainty};

/// Time after which an unanswered status query means that the board is lost.
const SILENCE: Duration = Duration::from_millis(500);
/// Time after which an unanswered line counts as lost, and an unanswered Ctrl-X means that the
/// board is lost.
const ANSWER_WAIT: Duration = Duration::from_secs(2);
/// Time limit from a feed hold to the standstill of the axes.
const HOLD_WAIT: Duration = Duration::from_secs(1);
/// Time limit for all answers of a board at standstill after the host was suspended.
const ABSENCE_ANSWERS: Duration = Duration::from_millis(300);
/// Interval at which Ctrl-X is repeated until the banner arrives.
const RESET_AGAIN: Duration = Duration::from_millis(100);

/// The progress of stopping the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Halt {
    None,
    /// The link waits, since this time, until the board has answered all lines.
    Draining(HostTime),
    /// `!` was sent at this time; the link waits for the standstill.
    Braking(HostTime),
    /// Ctrl-X was sent; the link waits for the banner.
    Restarting(Restart),
    /// The host was suspended for longer than the lookahead. The link sends nothing before
    /// the board has reported its position.
    Waking(Waking),
}

/// How the link resumes after the host was suspended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Waking {
    since: HostTime,
    /// Whether the next status report answers a query that was sent before the host was suspended.
    stale: bool,
    /// Whether bytes for the board were dropped: the board may hold the beginning of a line.
    cut_off: bool,
    /// Whether the alarm for the suspended host was raised. It waits for a report, because a lost
    /// board gets another alarm.
    raised: bool,
}

/// The progress of a restart of the board by Ctrl-X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Restart {
    since: HostTime,
    /// Host time at which Ctrl-X was last sent; the link repeats Ctrl-X because one may be lost.
    sent: HostTime,
    /// Host time until which banners in answer to repeated Ctrl-X may arrive; `None` before the
    /// first banner.
    quiet_at: Option<HostTime>,
}

/// The progress of a stop or restart of the board, and its consequences for the position and the
/// limit switches.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineStop {
    pub(super) halt: Halt,
    /// Whether the motors may have lost steps, because the stop was too sudden.
    pub(super) too_sudden: bool,
    /// The directions in which X and Z moved before a limit alarm, 1 or -1, 0 if unknown; an axis
    /// whose switch was operated before has `None`. Kept until the next report names the switch;
    /// otherwise `None`.
    pub(super) limit: Option<[Option<i64>; 2]>,
}

impl LineStop {
    /// Creates the state without a stop.
    pub(super) const fn none() -> Self {
        Self {
            halt: Halt::None,
            too_sudden: false,
            limit: None,
        }
    }

    /// Whether no stop or restart is in progress.
    pub(super) fn is_none(&self) -> bool {
        self.halt == Halt::None
    }

    /// Whether the link is restarting the board.
    pub(super) const fn restarts(&self) -> bool {
        matches!(self.halt, Halt::Restarting(_))
    }

    /// Extends the time limits by `gap`, the time during which the host was suspended.
    pub(super) fn skip_absence(&mut self, gap: Duration) {
        match &mut self.halt {
            Halt::None => {}
            Halt::Draining(since) | Halt::Braking(since) => *since += gap,
            Halt::Waking(waking) => waking.since += gap,
            Halt::Restarting(restart) => {
                restart.since += gap;
                restart.sent += gap;
            }
        }
    }
}

impl LineLink {
    pub(super) fn watch_silence(&mut self) {
        let silent = !self.stopping.restarts()
            && self.reports.queried_at.is_some_and(|queried_at| {
                self.session.since(queried_at) >= self.thread.report_timeout(SILENCE)
            });
        let unanswered = self
            .wire
            .oldest()
            .is_some_and(|line| self.session.since(line.sent) >= ANSWER_WAIT);
        if silent {
            self.lose_board(say::board_not_answering(
                self.thread.report_timeout(SILENCE).as_millis(),
            ));
        } else if self.thread.is_cutting() {
            // `watch_pass` checks the time limit of a pass.
        } else if unanswered && self.stopping.is_none() && self.homing.is_none() && self.is_open() {
            self.protocol_error(say::line_never_answered());
        } else if self.stopping.is_none() && self.motion.is_late(self.session.now) {
            self.protocol_error(say::segment_takes_too_long());
        }
    }

    pub(super) fn watch_halt(&mut self) {
        match self.stopping.halt {
            Halt::Braking(since) if self.session.since(since) >= HOLD_WAIT => {
                self.session.lose_position(Uncertainty::StoppedDead);
                self.session
                    .alarm(alarm::BOARD_FAULT, say::board_does_not_stop());
                self.restart();
                self.enter(LinkState::Fault);
            }
            Halt::Draining(since) => self.watch_draining(since),
            Halt::Restarting(restart) => self.watch_restart(restart),
            Halt::Waking(waking) => self.watch_waking(waking),
            _ => {}
        }
    }

    fn watch_restart(&mut self, restart: Restart) {
        let passed = |since| self.session.since(since);
        if let Some(at) = restart.quiet_at {
            if self.session.now >= at {
                self.restarted();
            }
        } else if passed(restart.since) >= ANSWER_WAIT {
            self.lose_board(say::board_gone_in_reset());
        } else if passed(restart.sent) >= RESET_AGAIN {
            self.wire.send_realtime(SOFT_RESET);
            self.stopping.halt = Halt::Restarting(Restart {
                sent: self.session.now,
                ..restart
            });
        }
    }

    /// Handles a host that was suspended for longer than the lookahead. The board has run
    /// out of motion, and waiting motion would move it again. The board finishes its queue
    /// and reports its position; the control continues from there.
    pub(super) fn wake(&mut self) {
        if self.session.state != LinkState::Moving
            || !self.stopping.is_none()
            || self.thread.is_cutting()
        {
            return;
        }
        self.stopping.halt = Halt::Waking(Waking {
            since: self.session.now,
            stale: self.reports.queried_at.is_some(),
            cut_off: self.wire.withdraw(),
            raised: false,
        });
        self.reports.queried_at = None;
        self.reports.hurry();
        self.motion.drop_unsent();
        self.session
            .events
            .push(LinkEvent::Halting { reached: false });
    }

    /// Whether a received status report answers a query from before the host was suspended; then
    /// the link repeats the query. The first newer report raises the alarm for the suspended host.
    pub(super) fn is_stale_report(&mut self) -> bool {
        let Halt::Waking(waking) = &mut self.stopping.halt else {
            return false;
        };
        let stale = core::mem::take(&mut waking.stale);
        if stale {
            self.reports.queried_at = None;
            self.reports.hurry();
        } else if !core::mem::replace(&mut waking.raised, true) {
            self.session
                .alarm(alarm::STEPS_TOO_LATE, say::computer_busy());
        }
        stale
    }

    /// Handles a report of standstill after the host was suspended: ends the wait, or resets a
    /// board that may hold part of a line.
    pub(super) fn stands_after_absence(&mut self) {
        let Halt::Waking(waking) = self.stopping.halt else {
            return;
        };
        if !waking.cut_off && self.wire.is_answered() {
            self.stopping.halt = Halt::None;
            self.drop_motion();
            self.enter(LinkState::Verify);
        } else if waking.cut_off || self.session.since(waking.since) >= ABSENCE_ANSWERS {
            // The board holds part of a line, or a line was lost.
            self.forget_motion();
            self.restart();
        }
    }

    fn watch_waking(&mut self, waking: Waking) {
        if self.session.state != LinkState::Moving {
            self.stopping.halt = Halt::None;
        } else if self.session.since(waking.since) >= HOLD_WAIT {
            self.session
                .alarm(alarm::STEPS_TOO_LATE, say::computer_busy());
            self.forget_motion();
            self.brake();
        }
    }

    /// Stops the board with `!`, and with Ctrl-X at standstill: the queue is dropped and the
    /// position kept.
    pub(super) fn flush(&mut self) {
        if self.thread.is_cutting() {
            return self.abandon_pass();
        }
        if self.stopping.is_none() {
            self.stopping.too_sudden =
                self.motion.fastest() > f64::from(self.config.flush_keep_speed);
            if self.opening.family == FirmwareFamily::FluidNc && !self.wire.is_answered() {
                self.stopping.halt = Halt::Draining(self.session.now);
                // Keep the unanswered lines: the link waits for their answers.
                self.drop_motion();
                return;
            }
            self.brake();
        }
        self.forget_motion();
    }

    fn brake(&mut self) {
        self.wire.send_realtime(FEED_HOLD);
        self.stopping.halt = Halt::Braking(self.session.now);
        self.reports.queried_at = None;
        self.reports.hurry();
    }

    /// Sends the feed hold when FluidNC has answered all lines. A line that FluidNC has read
    /// but not begun at the hold would be executed after the reset.
    fn watch_draining(&mut self, since: HostTime) {
        if self.wire.is_answered() {
            self.brake();
        } else if self.session.since(since) >= ANSWER_TIME {
            // A reset during motion locks the board, and a locked board executes nothing.
            self.session.lose_position(Uncertainty::StoppedDead);
            self.forget_motion();
            self.restart();
        }
    }

    pub(super) fn restart(&mut self) {
        self.wire.send_realtime(SOFT_RESET);
        self.stopping.halt = Halt::Restarting(Restart {
            since: self.session.now,
            sent: self.session.now,
            quiet_at: None,
        });
        self.reports.invalidate();
        self.homing = None;
        self.wire.drop_partial_line();
    }

    /// Handles an expected banner. After repeated Ctrl-X more banners may follow, no later
    /// after the last Ctrl-X than the first banner after the first Ctrl-X.
    pub(super) fn banner_came(&mut self) {
        let now = self.session.now;
        if let Halt::Restarting(restart) = &mut self.stopping.halt
            && restart.sent > restart.since
        {
            let longest = now.saturating_sub(restart.since);
            restart.quiet_at.get_or_insert(now + longest);
        } else {
            self.restarted();
        }
    }

    /// Completes a restart of the board by Ctrl-X: forgets motion, reports and outputs, and unlocks
    /// the board if that was requested.
    fn restarted(&mut self) {
        self.stopping.halt = Halt::None;
        self.forget_motion();
        self.reports.forget();
        self.reports.hurry();
        self.outputs.reset_to_off();
        if core::mem::take(&mut self.startup.unlocks) {
            self.send("$X", false);
        }
        if self.session.state == LinkState::Moving {
            for modes in MODES {
                self.send(modes, false);
            }
            self.enter(LinkState::Verify);
        }
    }

    /// Drops all motion and all lines that the board has not answered.
    pub(super) fn forget_motion(&mut self) {
        self.wire.forget_unanswered();
        self.drop_motion();
    }

    fn drop_motion(&mut self) {
        self.motion.forget();
        self.thread.forget();
    }

    /// Handles an unexpected restart of the board, by power or its reset input.
    pub(super) fn board_restarted(&mut self) {
        self.forget_motion();
        self.session.lose_position(Uncertainty::Reset);
        self.reports.freeze_count();
        self.startup.has_restarted();
        self.stopping.halt = Halt::None;
        self.homing = None;
        // The board does not answer earlier queries.
        self.reports.invalidate();
        self.outputs.reset_to_off();
        self.session.alarm(alarm::BOARD_RESET, say::board_reset());
        self.enter(LinkState::Fault);
    }

    pub(super) fn protocol_error(&mut self, cause: Message) {
        self.session.alarm(alarm::LINK_PROTOCOL, cause);
        self.session.lose_position(Uncertainty::Misunderstood);
        self.flush();
        self.enter(LinkState::Fault);
    }

    pub(super) fn board_alarm(&mut self, number: u16) {
        let family = self.opening.family;
        // During a restart by the link or by the board.
        let coming_back = self.stopping.restarts() || self.startup.is_restarted();
        if coming_back && family.excuses(number) {
            return;
        }
        let [x, z] = self.motion.ways(self.session.now);
        self.forget_motion();
        self.session.lose_position(Uncertainty::StoppedDead);
        match family.cause(number) {
            StopCause::Limit => {
                let Pins {
                    x: on_x, z: on_z, ..
                } = self.reports.pins;
                self.stopping.limit = Some([(!on_x).then_some(x), (!on_z).then_some(z)]);
                // The board accepts a reset only. FluidNC takes a second for it and answers
                // meanwhile.
                self.restart();
                self.enter(LinkState::Tripped);
            }
            StopCause::Reset => {
                self.startup.has_restarted();
                self.session
                    .alarm(alarm::BOARD_RESET, say::board_reset_in_motion());
                self.enter(LinkState::Fault);
            }
            StopCause::Homing => {
                self.homing = None;
                if family == FirmwareFamily::FluidNc {
                    // Until a reset it plans from the position before homing.
                    self.restart();
                }
                self.startup.excuse(self.session.now);
                self.session
                    .alarm(alarm::BOARD_ZERO_RETURN, say::board_alarm(number));
                self.enter(LinkState::Locked);
            }
            StopCause::EmergencyStop => {
                self.session
                    .alarm(alarm::EMERGENCY_STOP, say::board_emergency_input());
                if family == FirmwareFamily::FluidNc {
                    // Without a reset an unlock has no effect.
                    self.restart();
                }
                self.enter(LinkState::Tripped);
            }
            StopCause::Spindle => {
                self.session
                    .alarm(alarm::THREAD_SPEED, say::thread_spindle_does_not_turn());
                // Without a reset the board waits forever to begin the motion.
                self.restart();
                self.enter(LinkState::Fault);
            }
            StopCause::Motor => {
                for (number, axis) in [(alarm::X_DRIVE_ALARM, 'X'), (alarm::Z_DRIVE_ALARM, 'Z')] {
                    self.session.alarm(number, say::board_motor_fault(axis));
                }
                self.restart();
                self.enter(LinkState::Tripped);
            }
            StopCause::Order => {
                self.session
                    .alarm(alarm::LINK_PROTOCOL, say::board_alarm(number));
                // After an unlock the board must not execute its queue.
                self.restart();
                self.enter(LinkState::Fault);
            }
            StopCause::Locked => {
                self.session.alarm(alarm::BOARD_FAULT, say::board_locked());
                self.restart();
                self.enter(LinkState::Fault);
            }
        }
    }

    /// Raises the alarm of each limit switch that is operated, or of both if none is operated any
    /// more. `ways` are the directions in which X and Z moved before, 1 or -1, 0 if unknown; `None`
    /// for an axis whose switch was operated before.
    pub(super) fn name_limits(&mut self, pins: Pins, ways: [Option<i64>; 2]) {
        for (axis, operated) in [pins.x, pins.z].into_iter().enumerate() {
            if let (true, Some(way)) = (operated, ways[axis]) {
                self.limits.hit(axis, way);
            }
        }
        for (operated, number, axis) in [
            (pins.x, alarm::X_BOARD_LIMIT, 'X'),
            (pins.z, alarm::Z_BOARD_LIMIT, 'Z'),
        ] {
            if operated || !(pins.x || pins.z) {
                self.session.alarm(number, say::board_limit_input(axis));
            }
        }
    }

    /// Handles a failed port or a silent board: raises an alarm and enters
    /// [`LinkState::Lost`].
    pub(super) fn lose_board(&mut self, cause: Message) {
        if self.session.is_closed() {
            return;
        }
        self.forget_motion();
        self.session.lose_position(Uncertainty::Unheard);
        self.reports.status = None;
        let never_received = self.session.state == LinkState::Opening;
        self.session.alarm(
            if never_received {
                alarm::BOARD_SILENT
            } else {
                alarm::LINK_LOST
            },
            cause,
        );
        self.enter(LinkState::Lost);
    }

    /// Stops the board immediately, in the way that `stop` selects.
    pub(super) fn stop_at_once(&mut self, stop: Stop) {
        if !self.opening.is_done() || self.session.is_closed() {
            return;
        }
        match stop {
            Stop::Flush => self.flush(),
            Stop::Kill => {
                let moves = self.session.state == LinkState::Moving;
                self.session
                    .lose_position(Uncertainty::killed(moves, Uncertainty::StoppedDead));
                self.forget_motion();
                self.restart();
                self.enter(LinkState::Locked);
            }
        }
    }

    /// Handles RESET of the control: clears faults, unlocks the board, and stops motion or homing.
    pub(super) fn reset_faults(&mut self) {
        self.limits.confirm_position_checked();
        match self.session.state {
            LinkState::Fault if self.startup.is_restarted() || !self.opening.is_done() => {
                self.open_again();
            }
            LinkState::Tripped | LinkState::Fault if self.opening.is_done() => {
                self.forget_motion();
                if self.stopping.restarts() {
                    // The board discards lines before its banner.
                    self.startup.unlocks = true;
                } else {
                    self.send("$X", false);
                }
                self.enter(LinkState::Locked);
            }
            // FluidNC may be locked in a way that only a reset and an unlock clear.
            LinkState::Locked
                if self.opening.family == FirmwareFamily::FluidNc
                    && (self.board_is_locked() || self.reports.status.is_none()) =>
            {
                self.startup.unlocks = true;
                self.restart();
            }
            LinkState::Locked if self.board_is_locked() => self.send("$X", false),
            LinkState::Locked if self.reports.status.is_none() => self.startup.unlocks = true,
            LinkState::Moving => self.flush(),
            LinkState::Homing => self.give_up_homing(None),
            _ => {}
        }
    }

    fn board_is_locked(&self) -> bool {
        self.reports.state() == Some(BoardState::Alarm)
    }
}
