//! Thread passes by a line board: one `G33`, synchronized with the spindle by the board.
//!
//! ```text
//!   drained, spindle steady ─► G33 X Z K ─► two one-turn signals ─► cut ─► ok, Idle
//!                                           (no report, ≤ 5 s)      reports   count compared
//! ```
//!
//! During a pass the board ignores feed hold. Only a reset stops it, and the position is
//! uncertain then.

use crate::Backend;
use core::fmt::Write;
use core::time::Duration;

use super::motion::Queued;
use super::{LineLink, MODES};
use crate::line::response::{BoardState, StatusReport};
use crate::{
    HostTime, LinkState, MissingForThreads, MotionRefused, PassError, RunTime, ThreadCapability,
    ThreadPass, Uncertainty,
};
use gsk_messages::say;
use gsk_units::{Axis, Point, alarm};

/// Time for which the board waits for its one-turn signals; it sends no report meanwhile.
const INDEX_WAIT: Duration = Duration::from_secs(5);
/// Time that is added to the time limits of a pass for other work of the board.
const MARGIN: Duration = Duration::from_secs(2);
/// Greatest time between two status reports before a pass has begun.
const START_TIMEOUT: Duration = INDEX_WAIT.saturating_add(MARGIN);
/// Greatest ratio of the duration of a pass to its duration at the measured spindle speed.
const SLOWER: f64 = 1.5;
/// Least spindle speed, r/min: two turns within [`INDEX_WAIT`] with a margin.
const LEAST_RPM: f64 = 30.0;
/// Greatest relative change of the spindle speed at which it counts as constant.
const STEADY: f64 = 0.01;
/// Time for which the reported spindle speed must have been constant before the link accepts a
/// thread pass.
const STEADY_FOR: Duration = Duration::from_millis(600);
/// Greatest relative deviation of the reported speed along a pass from the expected one; a larger
/// one shows that the board has misread the line of the pass.
const MISREAD: f64 = 0.1;
/// Time by which the speed in a report is ahead of the position in it, s.
const PREPARED: f64 = 0.1;
/// Greatest change of the reported spindle speed at which it counts as constant, r/min; reports are
/// rounded to 1 r/min.
const ROUNDING_RPM: f64 = 1.5;

/// A thread pass that was sent to the board, with its time and speed limits.
#[derive(Clone, Copy, Debug)]
struct Cutting {
    pass: ThreadPass,
    /// Host time by which the pass must have ended.
    until: HostTime,
    /// Expected speed of the axes along the pass, mm/min.
    speed: f64,
    /// Distance from either end of the pass within which the speed is not constant, mm.
    ramps: f64,
    /// Whether the board has reported a position beyond the start.
    begun: bool,
}

/// A reported spindle speed that has been constant, within its tolerance, since the host time
/// `since`.
#[derive(Clone, Copy, Debug)]
struct Turning {
    since: HostTime,
    /// Spindle speed at the time `since`, r/min.
    rpm: f64,
    /// Last reported spindle speed, r/min.
    latest: f64,
}

/// The current thread pass, and the reported spindle speed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PassTracker {
    pass: Option<Cutting>,
    /// Measured speed of the spindle; `None` if the board reports no speed.
    spindle: Option<Turning>,
}

impl PassTracker {
    /// Takes the spindle speed of a status report, r/min; `None` if the report has no speed.
    fn follow(&mut self, reported: Option<f64>, now: HostTime) {
        self.spindle = reported.map(|rpm| match self.spindle {
            Some(turning) if (rpm - turning.rpm).abs() <= ROUNDING_RPM.max(STEADY * rpm) => {
                Turning {
                    latest: rpm,
                    ..turning
                }
            }
            _ => Turning {
                since: now,
                rpm,
                latest: rpm,
            },
        });
    }

    /// Returns the spindle speed, r/min, or why it is not constant or not high enough for a
    /// pass.
    fn steady_rpm(&self, now: HostTime) -> Result<f64, PassError> {
        let turning = self.spindle.ok_or(PassError::Unseen)?;
        if now.saturating_sub(turning.since) < STEADY_FOR {
            return Err(PassError::Unsteady);
        }
        let rpm = turning.latest;
        if rpm < 1.0 {
            return Err(PassError::Standing);
        }
        if rpm < LEAST_RPM {
            return Err(PassError::Slow {
                rpm,
                least: LEAST_RPM,
            });
        }
        Ok(rpm)
    }

    /// Whether a thread pass is in progress.
    pub(super) const fn is_cutting(&self) -> bool {
        self.pass.is_some()
    }

    /// Clears the current pass, if there is one.
    pub(super) const fn forget(&mut self) {
        self.pass = None;
    }

    /// Extends the time limits by `gap`, the time during which the host was suspended.
    pub(super) fn skip_absence(&mut self, gap: Duration) {
        if let Some(cutting) = &mut self.pass {
            cutting.until += gap;
        }
    }

    /// Returns the time after which an unanswered status query means that the board is lost:
    /// `usual`, but longer until the current pass has begun.
    pub(super) const fn report_timeout(&self, usual: Duration) -> Duration {
        match self.pass {
            Some(Cutting { begun: false, .. }) => START_TIMEOUT,
            _ => usual,
        }
    }
}

impl LineLink {
    /// Checks the conditions for a thread pass and sends the pass to the board.
    ///
    /// # Errors
    /// The unmet condition; nothing was sent.
    pub(super) fn begin_pass(&mut self, pass: &ThreadPass) -> Result<(), PassError> {
        let stands = self.stands_in(&[BoardState::Idle])
            && self.session.state == LinkState::Ready
            && self.outputs.are_switched()
            && self.motion.segments.pending() == RunTime::ZERO;
        if !stands || self.thread.pass.is_some() {
            return Err(PassError::NotReady);
        }
        let rpm = self.thread.steady_rpm(self.session.now)?;
        let path = self.motion.between(self.motion.commanded, pass.end);
        let (length, speed) = (path.length(), rpm * pass.lead);
        let most = f64::from(self.config.flush_keep_speed);
        if speed > most {
            return Err(PassError::Fast { speed, most });
        }
        let ramps = speed / 60.0 * (speed / 60.0) / self.acceleration(path);
        if ramps >= length {
            return Err(PassError::Short { length, ramps });
        }
        let moves = [
            pass.end.x.0 - self.motion.commanded.x.0,
            pass.end.z.0 - self.motion.commanded.z.0,
        ];
        let operated = [Some(self.reports.pins.x), Some(self.reports.pins.z)];
        if let Err(MotionRefused::TowardLimit(axis) | MotionRefused::OnLimit(axis)) =
            self.limits.allow(moves, operated)
        {
            return Err(PassError::Limit(axis));
        }
        let cutting = Duration::from_secs_f64(SLOWER * length / pass.lead / rpm * 60.0);
        self.send(&self.pass_line(pass), false);
        self.motion.queued.push_back(Queued {
            duration: RunTime::ZERO,
            end: self.motion.executed,
            pulses: pass.end,
            answered: false,
        });
        self.motion.progressed = self.session.now;
        self.thread.pass = Some(Cutting {
            pass: *pass,
            until: self.session.now + INDEX_WAIT + cutting + MARGIN,
            speed,
            ramps: ramps + speed / 60.0 * PREPARED,
            begun: false,
        });
        self.enter(LinkState::Moving);
        Ok(())
    }

    /// Returns which threads the board can cut, or the conditions that are missing.
    pub(super) fn thread_rights(&self) -> ThreadCapability {
        let sync = self.board().spindle_sync;
        let is_set = |number| self.opening.setting(number) != 0.0;
        let lacks = MissingForThreads {
            sync: !sync,
            proof: !self.config.line.thread_proved,
            encoder: sync && !is_set(38),
            gains: sync && [90, 91, 92].into_iter().any(is_set),
            offset: sync && self.opening.offset,
            index: false,
        };
        if lacks == MissingForThreads::default() {
            return ThreadCapability::Passes;
        }
        ThreadCapability::None(lacks)
    }

    /// Returns the acceleration that the board permits in the direction of `path`, mm/s².
    fn acceleration(&self, path: Point) -> f64 {
        let length = path.length().max(1e-9);
        [(Axis::X, 120), (Axis::Z, 122)]
            .into_iter()
            .map(|(axis, number)| self.opening.setting(number) * length / path.get(axis).abs())
            .fold(f64::INFINITY, f64::min)
            .max(1e-3)
    }

    /// Returns the `G33` line of a pass; K is the lead along the path.
    fn pass_line(&self, pass: &ThreadPass) -> String {
        let [per_x, per_z] = self.required.pulses_per_mm;
        let mut line = String::from("G33");
        let axes = [
            (
                'X',
                self.motion.commanded.x,
                pass.end.x,
                self.motion.offset.x,
                per_x,
            ),
            (
                'Z',
                self.motion.commanded.z,
                pass.end.z,
                self.motion.offset.z,
                per_z,
            ),
        ];
        // Writing to a `String` cannot fail.
        for (letter, from, to, offset, per_mm) in axes {
            if from != to {
                let _ = write!(line, "{letter}{:.4}", (to.0 + offset.0) as f64 / per_mm);
            }
        }
        let _ = write!(line, "K{:.6}", pass.lead);
        line
    }

    /// Handles the board's answer to a thread pass: `error` is the number of the error with which
    /// the board has refused it; `None` if the pass is finished.
    pub(super) fn pass_answered(&mut self, error: Option<u16>) {
        let Some(cutting) = self.thread.pass.take() else {
            return;
        };
        self.motion.queued.clear();
        // Earlier reports do not describe this standstill.
        self.reports.forget_standstill();
        self.reports.hurry();
        if let Some(number) = error {
            // After a refused line the board accepts an empty line only.
            self.send("\n", false);
            let (number, text) = match number {
                20 => (alarm::BOARD_CANNOT, say::thread_code_refused()),
                41 => (alarm::THREAD_SPEED, say::thread_spindle_stands_at_start()),
                43 => (alarm::THREAD_SPEED, say::thread_spindle_too_fast()),
                _ => (alarm::LINK_PROTOCOL, say::thread_refused(number)),
            };
            self.session.alarm(number, text);
        } else {
            self.motion.made = cutting.pass.end;
            self.motion.commanded = cutting.pass.end;
            self.motion.resumes = true;
        }
        // G33 is modal: cancel it.
        self.send(MODES[1], false);
    }

    /// Takes the spindle speed of a status report. During a pass also checks the speed along the
    /// path: a wrong speed raises an alarm and stops the board.
    pub(super) fn follow_spindle(&mut self, status: &StatusReport) {
        self.thread.follow(status.spindle, self.session.now);
        let at = self.motion.kernel_count(*status);
        let from = self.motion.commanded;
        let (Some(cutting), Some(at)) = (&mut self.thread.pass, at) else {
            return;
        };
        cutting.begun |= at != from;
        let cutting = *cutting;
        let ends = [from, cutting.pass.end].map(|end| self.motion.between(end, at).length());
        let between = ends.into_iter().all(|distance| distance > cutting.ramps);
        if let (true, Some(feed)) = (between, status.feed)
            && (feed - cutting.speed).abs() > MISREAD * cutting.speed
        {
            // No other check detects a value that was damaged on the wire.
            self.session.alarm(
                alarm::LINK_PROTOCOL,
                say::thread_speed_misread(feed, cutting.speed),
            );
            self.abandon_pass();
            self.enter(LinkState::Fault);
        }
    }

    pub(super) fn watch_pass(&mut self) {
        if self
            .thread
            .pass
            .is_some_and(|cutting| self.session.now >= cutting.until)
        {
            self.session
                .alarm(alarm::BOARD_FAULT, say::thread_never_ends());
            self.abandon_pass();
            self.enter(LinkState::Fault);
        }
    }

    /// Resets the board during a pass, which is a dead stop: the position becomes uncertain.
    pub(super) fn abandon_pass(&mut self) {
        self.session.lose_position(Uncertainty::StoppedDead);
        self.forget_motion();
        self.restart();
        self.enter(LinkState::Locked);
    }
}
