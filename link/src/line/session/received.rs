//! Handles the lines of the board, and queries its status reports.

use crate::Backend;
use gsk_messages::say;
use gsk_units::alarm;

use core::time::Duration;

use super::{Halt, LineLink};
use crate::line::FirmwareFamily;
use crate::line::opening::{LineOpening, OpeningAction};
use crate::line::realtime::STATUS_QUERY;
use crate::line::response::{BoardState, LineResponse, StatusReport};
use crate::{HostTime, LinkEvent, LinkState, Uncertainty};

/// Interval of status queries while the axes are at standstill.
const STATUS_IDLE: Duration = Duration::from_millis(200);
/// Interval of status queries during motion. A value that was damaged on the wire moves the
/// slides until the next report at most.
const STATUS_MOVING: Duration = Duration::from_millis(20);
/// Time between two calls of the link from which on the host counts as suspended.
const AWAY: Duration = Duration::from_millis(100);

impl LineLink {
    pub(super) fn take(&mut self, answer: &LineResponse) {
        if self.session.is_closed() {
            // Only the operator reopens the link. A banner explains the silence.
            if matches!(answer, LineResponse::Banner(_)) && self.opening.is_done() {
                self.board_restarted();
            }
            return;
        }
        if !self.opening.is_done() {
            let expected = self.opening.expects_banner();
            if matches!(answer, LineResponse::Banner(_)) && !expected {
                self.board_restarted();
                return;
            }
            if matches!(answer, LineResponse::Ok | LineResponse::Error(_)) {
                self.wire.answered();
            }
            let action = self.opening.take(answer, &self.required, self.session.now);
            self.open_further(action);
            return;
        }
        match answer {
            LineResponse::Ok => self.line_done(None),
            LineResponse::Error(number) => self.line_done(Some(*number)),
            LineResponse::Alarm(number) => self.board_alarm(*number),
            LineResponse::Message(text) => self.board_message(text),
            LineResponse::StatusReport(status) => self.report(*status),
            LineResponse::Banner(_) if self.stopping.restarts() => self.banner_came(),
            LineResponse::Banner(_) if !self.startup.expects_banner(self.session.now) => {
                self.board_restarted();
            }
            LineResponse::Starts => {
                self.startup.has_begun();
                self.board_restarted();
            }
            LineResponse::Garbage => {
                self.wire.traffic.garbage += 1;
                if self.session.state == LinkState::Moving {
                    self.protocol_error(say::line_makes_no_sense());
                }
            }
            _ => {}
        }
    }

    fn report(&mut self, status: StatusReport) {
        let now = self.session.now;
        if self.is_stale_report() {
            return;
        }
        if let Some(round_trip) = self.reports.take(status, now) {
            self.wire.traffic.round_trip = Some(round_trip);
        }
        self.wire.traffic.reports += 1;
        self.follow_spindle(&status);
        if let Some(kernel) = self.motion.kernel_count(status) {
            self.reports.count(kernel, now);
        }
        if let Some(ways) = self.stopping.limit.take() {
            self.name_limits(status.pins, ways);
        }
        if self.session.state == LinkState::Moving
            && self.stopping.is_none()
            && let Some(board) = self.motion.board_count(status)
        {
            // Tolerance: single pulses, and three decimals in a report.
            let [x, z] = self.required.pulses_per_mm;
            let off = self.motion.off_path(board);
            if off > 0.002 + 2.0 / x + 2.0 / z {
                self.session.lose_position(Uncertainty::OffPath);
                self.session
                    .alarm(alarm::POSITION_CHECK, say::board_off_path(off));
                // A deceleration would continue towards the wrong position.
                self.forget_motion();
                self.restart();
                self.enter(LinkState::Fault);
                return;
            }
        }
        self.motion.report_received();
        if let Some(free) = status.free_blocks {
            let held = self.board().blocks.saturating_sub(free);
            self.retire(held);
        }
        self.motion.settle(status.state == BoardState::Idle, now);
        self.reports.note_standstill(status.state, now);
        match status.state {
            BoardState::Held if matches!(self.stopping.halt, Halt::Braking(_)) => {
                self.restart();
            }
            BoardState::Held if self.stopping.is_none() && self.session.state.takes_motion() => {
                self.session.alarm(alarm::BOARD_FAULT, say::board_held());
                self.session.lose_position(Uncertainty::Misunderstood);
                self.flush();
                self.enter(LinkState::Fault);
            }
            BoardState::Alarm if self.session.state.takes_motion() => {
                self.board_alarm(0);
            }
            BoardState::Alarm if self.startup.unlocks && self.stopping.is_none() => {
                self.startup.unlocks = false;
                self.send("$X", false);
            }
            BoardState::Idle => {
                self.startup.unlocks = false;
                self.stands_after_absence();
            }
            BoardState::Other if self.session.state.takes_motion() => {
                self.session
                    .alarm(alarm::BOARD_FAULT, say::board_state_unasked());
                self.flush();
                self.enter(LinkState::Fault);
            }
            _ => {}
        }
    }

    /// Queries a status report if one is due.
    pub(super) fn query_status_if_due(&mut self) {
        // A board does not answer while it is homing.
        let restarts = self.stopping.restarts();
        if restarts && self.opening.family == FirmwareFamily::FluidNc {
            // Its restart takes a second, in which it answers most queries.
            self.reports.give_up_question(self.session.now);
        } else if restarts || self.homing.is_some() {
            return;
        }
        let interval = match self.session.state {
            _ if !self.stopping.is_none() => STATUS_MOVING,
            LinkState::Moving => STATUS_MOVING,
            _ => STATUS_IDLE,
        };
        if self.reports.is_due(interval, self.session.now) {
            self.wire.send_realtime(STATUS_QUERY);
            self.reports.note_query(self.session.now);
            self.motion.report_requested(self.session.now);
        }
    }

    /// Repeats the opening dialogue on the open port.
    pub(super) fn open_again(&mut self) {
        self.forget_motion();
        self.restart();
        self.stopping.halt = Halt::None;
        self.stopping.limit = None;
        self.reports.freeze_count();
        self.startup.begin_anew();
        self.opening = LineOpening::again(self.session.now);
        self.enter(LinkState::Opening);
    }

    /// Executes an action that the opening dialogue requests.
    pub(super) fn open_further(&mut self, action: OpeningAction) {
        match action {
            OpeningAction::Waits => {}
            OpeningAction::Send(line) => {
                if line == "$I" {
                    self.enter(LinkState::Identify);
                }
                self.send(&line, false);
            }
            OpeningAction::Configures(line) => {
                self.enter(LinkState::Configure);
                self.send(&line, false);
            }
            OpeningAction::Done => {
                self.wire.forget_unanswered();
                self.enter(LinkState::Locked);
                if core::mem::take(&mut self.startup.unlocks) {
                    // The operator pressed RESET.
                    self.send("$X", false);
                }
            }
            OpeningAction::Differs(differences) => {
                let text = say::board_settings_differ(differences.len());
                self.session
                    .events
                    .extend(differences.into_iter().map(LinkEvent::Differs));
                self.session.alarm(alarm::BOARD_SETTINGS, text);
            }
            OpeningAction::Fails(number, text) => {
                self.session.alarm(number, text);
                self.enter(if number == alarm::BOARD_SILENT {
                    LinkState::Lost
                } else {
                    LinkState::Fault
                });
            }
        }
    }

    /// Advances the host time to `now`. If the host was suspended, extends all time limits by the
    /// duration of the gap.
    pub(super) fn advance_time(&mut self, now: HostTime) {
        let gap = now.saturating_sub(self.session.now);
        self.session.now = self.session.now.max(now);
        if gap < AWAY {
            return;
        }
        self.motion.progressed += gap;
        self.thread.skip_absence(gap);
        self.wire.skip_absence(gap);
        if let Some(queried_at) = &mut self.reports.queried_at {
            *queried_at += gap;
        }
        self.stopping.skip_absence(gap);
        if gap >= self.config.lookahead() {
            self.wake();
        }
    }
}
