//! The link to a line board.

mod backend;
mod homing;
mod motion;
mod outputs;
mod pass;
mod received;
mod reports;
mod samples;
mod startup;
mod stops;
mod wire;

use core::time::Duration;

use super::opening::LineOpening;
use super::required::RequiredSettings;
use super::response::{BoardState, StatusReport};
use super::segments::Segments;
use crate::drives::Drives;
use crate::limits::Limits;
use crate::session::LinkSession;
use crate::{HostTime, LinkConfig, LinkState};
use homing::Homing;
use motion::LineMotion;
use outputs::LineOutputs;
use pass::PassTracker;
use reports::Reports;
use startup::Startup;
use stops::{Halt, LineStop};
use wire::LineWire;

/// Time after which the answer of the board to a query or a line is overdue.
const ANSWER_TIME: Duration = Duration::from_millis(100);
/// Lines with the modal words that the board needs before motion. G1 needs an F word even without
/// motion.
const MODES: [&str; 2] = ["G21G18G90", "G1G94F60"];

/// A link to one line board.
#[derive(Clone, Debug)]
pub struct LineLink {
    config: LinkConfig,
    required: RequiredSettings,
    session: LinkSession,
    opening: LineOpening,
    wire: LineWire,
    reports: Reports,
    motion: LineMotion,
    limits: Limits,
    stopping: LineStop,
    startup: Startup,
    homing: Option<Homing>,
    thread: PassTracker,
    outputs: LineOutputs,
}

impl LineLink {
    /// Creates the link to a board whose port was opened at the host time `now`. The function
    /// `tick` then identifies and configures the board.
    pub fn open(config: LinkConfig, drives: &Drives, now: HostTime) -> Self {
        let required = RequiredSettings::new(drives, &config);
        let pulses_per_mm = required.pulses_per_mm;
        let period = Duration::from_millis(config.line.period_ms.into());
        let segments = Segments::new(period, config.line.max_rate, pulses_per_mm);
        Self {
            config,
            required,
            session: LinkSession::new(now),
            opening: LineOpening::new(now),
            wire: LineWire::default(),
            reports: Reports::new(now),
            motion: LineMotion::new(segments, pulses_per_mm, now),
            limits: Limits::new(pulses_per_mm),
            stopping: LineStop::none(),
            startup: Startup::default(),
            homing: None,
            thread: PassTracker::default(),
            outputs: LineOutputs::default(),
        }
    }

    /// Returns the settings that the board must have.
    pub const fn required(&self) -> &RequiredSettings {
        &self.required
    }

    /// Returns the last status report; `None` before the first one and after a reset.
    pub const fn status(&self) -> Option<StatusReport> {
        self.reports.status
    }

    /// Whether the board answers queries and commands in the current state of the link.
    const fn is_open(&self) -> bool {
        matches!(
            self.session.state,
            LinkState::Locked | LinkState::Ready | LinkState::Moving | LinkState::Verify
        )
    }

    /// Whether the board reports one of these states and has answered all lines, while the link is
    /// ready or locked and stops nothing.
    fn stands_in(&self, states: &[BoardState]) -> bool {
        self.stopping.is_none()
            && self.wire.is_answered()
            && matches!(self.session.state, LinkState::Ready | LinkState::Locked)
            && self
                .reports
                .state()
                .is_some_and(|state| states.contains(&state))
    }

    fn enter(&mut self, state: LinkState) {
        if state == LinkState::Moving && self.session.state != state {
            // Earlier reports do not describe this motion.
            self.reports.forget_standstill();
        }
        self.session.enter(state);
    }

    fn send(&mut self, line: &str, is_segment: bool) {
        self.wire.send(line, is_segment, self.session.now);
    }

    /// Moves the answered segments except the newest `held` from the board's queue to its pulse
    /// timer.
    fn retire(&mut self, held: u16) {
        self.motion
            .retire(held.into(), self.opening.prepared, self.session.now);
    }
}
