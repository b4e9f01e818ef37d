//! The link to a board with timed steps.

mod angle;
mod backend;
mod group;
mod lease;
mod motion;
mod opening;
mod outputs;
mod path;
mod periodic;
mod position_query;
mod samples;
mod spindle;
mod stops;
mod switches;
mod wheel;
mod wire;

use crate::Backend;
use crate::position::Positioned;
use core::time::Duration;

use super::clock_sync::{ClockSync, near};
use super::commands::{Command, Reply, ReplyKind};
use super::send_queue::{Mark, SendError, Times};
use super::shutdown;
use super::wiring::Wiring;
use crate::drives::Drives;
use crate::session::LinkSession;
use crate::{HostTime, Input, LinkConfig, LinkState, Stop, Uncertainty};
use angle::AngleDrive;
use group::Group;
use gsk_messages::{Message, say};
use gsk_units::{PerAxis, Pulses, alarm};
use motion::StepMotion;
use opening::StepQueueOpening;
use periodic::Periodic;
use spindle::Spindle;
use stops::StepQueueStop;
use wire::StepQueueWire;

/// Least time by which the link sends a step before its execution, in addition to the transmission
/// time.
const LATEST: Duration = Duration::from_millis(20);
/// Greatest transmission time of a message for which the link plans.
const SLOWEST: Duration = Duration::from_millis(200);
/// Time between two calls of the link from which on the host counts as suspended.
const AWAY: Duration = Duration::from_millis(10);
/// Interval at which an unanswered query is repeated.
const ASK_AGAIN: Duration = Duration::from_millis(100);
/// Time after which an unanswered query means that the board is lost.
const GIVE_UP: Duration = Duration::from_millis(600);

/// The purpose for which the position is queried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum QueryPurpose {
    /// The count of the board is read while the link is being opened.
    Opening,
    /// The counts of board and kernel are compared after all motion is executed.
    Verify,
    /// Compare the counts of board and kernel during a standstill; `requested` tells whether the
    /// kernel gets the position.
    Look { requested: bool },
    /// The position is read at which the axes were stopped.
    Stopped,
    /// Read the count of a board that has shut down and still answers.
    ShutDown,
}

/// A position query that the board has not answered completely.
#[derive(Clone, Copy, Debug)]
struct PositionQuery {
    purpose: QueryPurpose,
    since: HostTime,
    queried_at: HostTime,
    got: [Option<u32>; 2],
}

/// All position queries of a link that are due or not answered.
#[derive(Clone, Copy, Debug, Default)]
struct PositionQueries {
    pending: Option<PositionQuery>,
    /// Host time at which the counts are compared next, at standstill.
    look_due: HostTime,
}

/// A link to one board with timed steps (Klipper).
#[derive(Clone, Debug)]
pub struct StepLink {
    config: LinkConfig,
    pulses_per_mm: [f64; 2],
    session: LinkSession,
    opening: StepQueueOpening,
    wiring: Option<Wiring>,
    wire: StepQueueWire,
    clock: ClockSync,
    motion: StepMotion,
    group: Group,
    stopping: Option<StepQueueStop>,
    query: PositionQueries,
    periodic: Periodic,
    spindle: Spindle,
    angle: AngleDrive,
}

impl StepLink {
    /// Creates the link to a board whose port was opened at the host time `now`, and starts the
    /// opening dialogue.
    pub fn open(config: LinkConfig, drives: &Drives, now: HostTime) -> Self {
        let mut link = Self {
            config,
            pulses_per_mm: drives.pulses_per_mm(),
            session: LinkSession::new(now),
            opening: StepQueueOpening::new(now),
            wiring: None,
            wire: StepQueueWire::new(),
            clock: ClockSync::new(1.0),
            motion: StepMotion::new(drives.pulses_per_mm()),
            group: Group::default(),
            stopping: None,
            query: PositionQueries::default(),
            periodic: Periodic::default(),
            spindle: Spindle::new(1.0),
            angle: AngleDrive::default(),
        };
        link.begin();
        link
    }

    /// Returns the position of the slides, in the kernel's pulses; `None` during motion or if
    /// the position is uncertain.
    pub fn position(&self) -> Option<PerAxis<Pulses>> {
        (self.session.knows_position() && !self.motion.is_under_way())
            .then_some(self.motion.count.commanded)
    }

    fn advance_time(&mut self, now: HostTime) {
        let gap = now.saturating_sub(self.session.now);
        self.session.now += gap;
        if gap >= AWAY {
            self.wire.send_queue.skip_absence(gap);
        }
    }

    /// Handles the content of a block with an impossible sequence number: if it has the reply
    /// `starting`, the board was restarted.
    fn unexpected_sequence(&mut self, content: &[u8]) {
        let replies = self.wire.dictionary.replies(content).unwrap_or_default();
        if self.is_opened()
            && replies
                .iter()
                .any(|reply| reply.kind == ReplyKind::Starting)
        {
            self.board_restarted();
        }
    }

    /// Handles a failed port or a silent board: raises an alarm and enters
    /// [`LinkState::Lost`].
    pub(super) fn lose_board(&mut self, cause: Message) {
        if self.session.is_closed() {
            return;
        }
        self.estimate_position(self.wire.send_queue.progressed());
        self.give_up_motion();
        self.lose_position(Uncertainty::Unheard);
        let number = if self.is_opened() {
            alarm::LINK_LOST
        } else {
            alarm::BOARD_SILENT
        };
        self.session.alarm(number, cause);
        self.session.enter(LinkState::Lost);
    }

    /// Stops the board immediately, in the way that `stop` selects.
    pub(super) fn stop_at_once(&mut self, stop: Stop) {
        if !self.is_running() || self.session.state == LinkState::Lost {
            return;
        }
        match stop {
            Stop::Flush => self.flush(),
            // The board has its own contact: the stop group stops the axes. Unlike a board
            // that was shut down, it reports when the contact is released.
            Stop::Kill if self.input(Input::EmergencyStop) == Some(true) => self.trip(),
            Stop::Kill => {
                self.estimate_position(self.session.now);
                self.give_up_motion();
                let moves = self.session.state == LinkState::Moving;
                self.lose_position(Uncertainty::killed(moves, Uncertainty::ShutDown));
                self.wire.send_urgent(Command::EmergencyStop, &[]);
                self.send();
                self.opening.shut_down();
                self.session.enter(LinkState::Fault);
                self.query_count_in_shutdown();
            }
        }
    }

    /// Handles RESET: stops motion, repeats the opening of a failed link, or locks a link with a
    /// fault whose cause is gone.
    pub(super) fn reset_faults(&mut self) {
        self.motion.limits.confirm_position_checked();
        let still = |input| self.input(input) == Some(true);
        match self.session.state {
            LinkState::Moving => self.flush(),
            LinkState::Fault if !self.is_running() => self.begin(),
            LinkState::Fault if self.is_running() && self.stopping.is_none() => {
                self.session.enter(LinkState::Locked);
            }
            LinkState::Tripped
                if self.stopping.is_none()
                    && !still(Input::EmergencyStop)
                    && !still(Input::DriveAlarm) =>
            {
                self.session.enter(LinkState::Locked);
            }
            _ => {}
        }
    }

    const fn is_running(&self) -> bool {
        self.opening.is_running()
    }

    const fn is_opened(&self) -> bool {
        self.opening.is_opened()
    }

    fn send(&mut self) {
        let times = self.is_opened().then(|| Times {
            now: self.clock.at(self.session.now),
            earliest: self.earliest(),
            again: self.clock.at(self.session.now
                + self.margin()
                + self.wire.send_queue.slowness_now(self.session.now)),
        });
        match self.wire.send_queue.send(self.session.now, times) {
            Ok(()) => {}
            Err(SendError::Silent) => self.lose_board(say::board_not_answering(500)),
            Err(SendError::Restarted) => self.board_restarted(),
            Err(SendError::Late) if self.wire.send_queue.is_rate_limited() => self.too_fine(),
            Err(SendError::Late) => self.late(say::step_too_late()),
        }
    }

    /// Returns the board clock at which a message sent now arrives at the latest, ticks.
    fn earliest(&self) -> u64 {
        // The last slow round trip without the known transmission time of the answer.
        let there = self.wire.send_queue.last_slow_trip();
        let there = there.map_or(Duration::ZERO, |trip| {
            trip.saturating_sub(self.clock.report_delay()) + LATEST / 2
        });
        self.clock.at(self.session.now + self.margin().max(there))
    }

    fn margin(&self) -> Duration {
        LATEST + (self.clock.round_trip() / 2).min(SLOWEST)
    }

    /// Returns the time by which motion is sent before its execution: the lookahead, and on a slow
    /// serial line the additional time for a transmission and a retransmission.
    fn ahead(&self) -> Duration {
        self.config.lookahead() + 2 * self.wire.send_queue.slowness_now(self.session.now)
    }

    /// Returns the time after which an unanswered query is repeated.
    fn query_timeout(&self) -> Duration {
        ASK_AGAIN + 2 * self.wire.send_queue.slowness_now(self.session.now)
    }

    /// Returns the earliest board clock for the execution of a command that must not be late,
    /// ticks.
    fn soon(&self) -> u64 {
        self.clock
            .at(self.session.now + self.ahead() + self.margin())
    }

    fn take(&mut self, reply: &Reply, expects: u64) {
        let numbers = reply.numbers;
        match reply.kind {
            ReplyKind::Identify => self.identify_reply(numbers[0], &reply.data),
            ReplyKind::Config if self.wire.send_queue.answers(Mark::Config, expects) => {
                self.config_reply(numbers);
            }
            ReplyKind::Uptime if self.wire.send_queue.answers(Mark::Uptime, expects) => {
                self.uptime_reply(numbers);
            }
            ReplyKind::Position if self.wire.send_queue.answers(Mark::Position, expects) => {
                self.position_reply(i64::from(numbers[0]), numbers[1]);
            }
            ReplyKind::Group if self.wire.send_queue.answers(Mark::Group, expects) => {
                self.trsync_report(numbers);
            }
            ReplyKind::Endstop => {
                let wiring = self.wiring.as_ref();
                self.periodic
                    .switches
                    .report(wiring, i64::from(numbers[0]), numbers[3]);
                if self.wire.send_queue.answers(Mark::Switch, expects) {
                    self.level_reply(numbers[0].into(), numbers[3].into());
                }
            }
            ReplyKind::Counter => self.counter_report(numbers[2], numbers[3]),
            ReplyKind::Shutdown => {
                let clock = near(numbers[0], self.clock.at(self.session.now));
                self.shut_down(numbers[1], self.clock.moment(clock));
            }
            ReplyKind::IsShutdown => self.shut_down(numbers[0], self.wire.send_queue.progressed()),
            ReplyKind::Encoder => self.encoder_report(numbers),
            ReplyKind::Angle => self.angle_report(numbers),
            ReplyKind::AngleError => self.angle.note_phase_error(numbers[1]),
            ReplyKind::Wheel => self.wheel_report(numbers),
            ReplyKind::LeaseExpired => self.lease_expired(),
            ReplyKind::Starting if self.is_opened() => self.board_restarted(),
            _ => {}
        }
    }

    fn shut_down(&mut self, text: u32, at: HostTime) {
        if self.opening.is_shut_down() || self.shut_down_early(text) {
            return;
        }
        let text = self.wire.dictionary.text(text);
        let known = shutdown::alarm(&text);
        self.opening.shut_down();
        // A board detects late steps and invalid commands when it reads a block.
        let in_last = known.as_ref().is_some_and(|(number, _)| {
            matches!(*number, alarm::LINK_PROTOCOL | alarm::STEPS_TOO_LATE)
        });
        self.estimate_position_sent(at, in_last);
        self.lose_position(Uncertainty::ShutDown);
        self.give_up_motion();
        if let Some((number, help)) = known {
            self.session
                .alarm(number, say::board_shut_down(say::as_written(text), help));
        }
        self.session.enter(LinkState::Fault);
        self.query_count_in_shutdown();
    }

    /// Reads the count of a board that has shut down: our own firmware counts on, and answers.
    fn query_count_in_shutdown(&mut self) {
        if self.wire.dictionary.has(Command::RenewLease) {
            self.query_position(QueryPurpose::ShutDown);
        }
    }

    /// Handles an unexpected restart of the board, by power or its reset input.
    fn board_restarted(&mut self) {
        if self.opening.is_shut_down() && !self.session.knows_position() {
            // The board has to be reset in any case.
            return;
        }
        self.opening.shut_down();
        self.estimate_position(self.wire.send_queue.progressed());
        self.lose_position(Uncertainty::Reset);
        self.give_up_motion();
        self.wire.send_queue.begin();
        self.session.alarm(alarm::BOARD_RESET, say::board_reset());
        self.session.enter(LinkState::Fault);
    }
}
