//! The link with a board of timed steps, from the first byte to the last.

mod backend;
mod group;
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
use group::Group;
use gsk_messages::{Message, say};
use gsk_units::{PerAxis, Pulses, alarm};
use motion::StepMotion;
use opening::Opening;
use periodic::Periodic;
use spindle::Spindle;
use stops::Stopping;
use wire::Wire;

/// No step is sent that would be made sooner than this.
const LATEST: Duration = Duration::from_millis(20);
/// A slower line is not waited for.
const SLOWEST: Duration = Duration::from_millis(200);
/// A host that looks at its port so late has done something else.
const AWAY: Duration = Duration::from_millis(10);
/// A question is asked again after this, and given up after that.
const ASK_AGAIN: Duration = Duration::from_millis(100);
const GIVE_UP: Duration = Duration::from_millis(600);

/// What the position of the axes is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum QueryPurpose {
    /// The dialogue begins.
    Opening,
    /// All motion is made: does the count agree?
    Verify,
    /// Does it still agree? Told when somebody wants to know.
    Look { requested: bool },
    /// The axes were stopped.
    Stopped,
}

/// The position of the axes, asked and not answered.
#[derive(Clone, Copy, Debug)]
struct PositionQuery {
    purpose: QueryPurpose,
    since: HostTime,
    queried_at: HostTime,
    got: [Option<u32>; 2],
}

/// Where the axes stand, as the board is asked.
#[derive(Clone, Copy, Debug, Default)]
struct PositionQueries {
    pending: Option<PositionQuery>,
    /// When the position of standing axes is looked at again.
    look_due: HostTime,
}

/// A link to one board.
#[derive(Clone, Debug)]
pub struct StepLink {
    config: LinkConfig,
    pulses_per_mm: [f64; 2],
    session: LinkSession,
    opening: Opening,
    wiring: Option<Wiring>,
    wire: Wire,
    clock: ClockSync,
    motion: StepMotion,
    group: Group,
    stopping: Option<Stopping>,
    query: PositionQueries,
    periodic: Periodic,
    spindle: Spindle,
}

impl StepLink {
    /// A link whose port has just been opened.
    pub fn open(config: LinkConfig, drives: &Drives, now: HostTime) -> Self {
        let mut link = Self {
            config,
            pulses_per_mm: drives.pulses_per_mm(),
            session: LinkSession::new(now),
            opening: Opening::new(now),
            wiring: None,
            wire: Wire::new(),
            clock: ClockSync::new(1.0),
            motion: StepMotion::new(drives.pulses_per_mm()),
            group: Group::default(),
            stopping: None,
            query: PositionQueries::default(),
            periodic: Periodic::default(),
            spindle: Spindle::new(1.0),
        };
        link.begin();
        link
    }

    /// Where the slides stand, as far as that is certain.
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

    /// A board that counts its blocks anew may say why.
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

    /// The port failed, or the board answers no more.
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

    /// Stops the board at once.
    pub(super) fn stop_at_once(&mut self, stop: Stop) {
        if !self.is_running() || self.session.state == LinkState::Lost {
            return;
        }
        match stop {
            Stop::Flush => self.flush(),
            // Its own contact: the stop group does it, and a board that is not shut down
            // tells when it is released.
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
            }
        }
    }

    /// The operator pressed RESET.
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

    /// Nothing that is sent now is sure to arrive before this clock.
    fn earliest(&self) -> u64 {
        // Of the last trip all but what is known to belong to the way back.
        let there = self.wire.send_queue.last_slow_trip();
        let there = there.map_or(Duration::ZERO, |trip| {
            trip.saturating_sub(self.clock.report_delay()) + LATEST / 2
        });
        self.clock.at(self.session.now + self.margin().max(there))
    }

    fn margin(&self) -> Duration {
        LATEST + (self.clock.round_trip() / 2).min(SLOWEST)
    }

    /// How far ahead the motion is that is handed over now: the lookahead, and on a
    /// line that has become slow what it takes longer, there and to send it again.
    fn ahead(&self) -> Duration {
        self.config.lookahead() + 2 * self.wire.send_queue.slowness_now(self.session.now)
    }

    /// A question is asked again after this.
    fn query_timeout(&self) -> Duration {
        ASK_AGAIN + 2 * self.wire.send_queue.slowness_now(self.session.now)
    }

    /// A clock for things that are to happen soon, and surely not too late.
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
        // Steps too late and orders without sense it meets when it reads them.
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
    }

    /// The board started by itself: power or its reset line.
    fn board_restarted(&mut self) {
        if self.opening.is_shut_down() && !self.session.knows_position() {
            // It was to be reset anyway.
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
