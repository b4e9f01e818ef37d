//! A pass of a thread: one `G33`, which the board makes by itself behind its spindle.
//!
//! ```text
//!   drained, spindle steady ─► G33 X Z K ─► two one-turn signals ─► cut ─► ok, Idle
//!                                           (no report, ≤ 5 s)      reports   count compared
//! ```
//!
//! The board hears no hold in it: what stops it is the reset alone, and then nobody
//! knows where the slides stand.

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

/// The board waits so long for its one-turn signals, and reports nothing meanwhile.
const INDEX_WAIT: Duration = Duration::from_secs(5);
/// Time for what the board does besides.
const MARGIN: Duration = Duration::from_secs(2);
/// A board that has not begun may be silent for so long.
const START_TIMEOUT: Duration = INDEX_WAIT.saturating_add(MARGIN);
/// A pass may take so much longer than at the speed measured before it.
const SLOWER: f64 = 1.5;
/// Two turns within [`INDEX_WAIT`], with some to spare, r/min.
const LEAST_RPM: f64 = 30.0;
/// A spindle is steady that has kept its speed to this part for so long.
const STEADY: f64 = 0.01;
const STEADY_FOR: Duration = Duration::from_millis(600);
/// A board that goes by more than this part beside the speed asked for has misread it.
const MISREAD: f64 = 0.1;
/// A report tells the speed of what is prepared, so far ahead.
const PREPARED: f64 = 0.1;
/// Reports name whole turns a minute.
const ROUNDING_RPM: f64 = 1.5;

/// A pass handed over.
#[derive(Clone, Copy, Debug)]
struct Cutting {
    pass: ThreadPass,
    /// It is over by then.
    until: HostTime,
    /// Speed along it, mm/min, and where that is not kept at either end, mm.
    speed: f64,
    ramps: f64,
    /// The board was seen beyond the start.
    begun: bool,
}

/// How the spindle has turned of late, as the board reports it.
#[derive(Clone, Copy, Debug)]
struct Turning {
    since: HostTime,
    /// The speed then, and now.
    rpm: f64,
    latest: f64,
}

/// A thread that the board cuts by itself, and the spindle before it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PassTracker {
    pass: Option<Cutting>,
    /// None: the board does not report its spindle.
    spindle: Option<Turning>,
}

impl PassTracker {
    /// The board reports the speed of its spindle, r/min.
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

    /// Speed of a spindle that turns steadily and fast enough for a pass, r/min.
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

    /// Whether a pass is under way.
    pub(super) const fn is_cutting(&self) -> bool {
        self.pass.is_some()
    }

    /// The pass is not made any more.
    pub(super) const fn forget(&mut self) {
        self.pass = None;
    }

    /// While the computer was away nobody waited for the board.
    pub(super) fn skip_absence(&mut self, gap: Duration) {
        if let Some(cutting) = &mut self.pass {
            cutting.until += gap;
        }
    }

    /// How long the board may be silent now.
    pub(super) const fn report_timeout(&self, usual: Duration) -> Duration {
        match self.pass {
            Some(Cutting { begun: false, .. }) => START_TIMEOUT,
            _ => usual,
        }
    }
}

impl LineLink {
    /// Hands over a pass; the link must be drained and the spindle turn steadily.
    pub(super) fn begin_pass(&mut self, pass: &ThreadPass) -> Result<(), PassError> {
        let stands = self.stands_in(&[BoardState::Idle])
            && self.session.state == LinkState::Ready
            && self.outputs.are_switched()
            && self.motion.segments.pending() == RunTime::ZERO;
        if !stands || self.thread.pass.is_some() {
            return Err(PassError::NotReady);
        }
        let rpm = self.thread.steady_rpm(self.session.now)?;
        let way = self.motion.between(self.motion.commanded, pass.end);
        let (length, speed) = (way.length(), rpm * pass.lead);
        let most = f64::from(self.config.flush_keep_speed);
        if speed > most {
            return Err(PassError::Fast { speed, most });
        }
        let ramps = speed / 60.0 * (speed / 60.0) / self.acceleration(way);
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

    /// Which threads the board cuts.
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

    /// The board's acceleration along a way, mm/s².
    fn acceleration(&self, way: Point) -> f64 {
        let length = way.length().max(1e-9);
        [(Axis::X, 120), (Axis::Z, 122)]
            .into_iter()
            .map(|(axis, number)| self.opening.setting(number) * length / way.get(axis).abs())
            .fold(f64::INFINITY, f64::min)
            .max(1e-3)
    }

    /// K counts along the path.
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
        // A `String` takes everything that is written to it.
        for (letter, from, to, offset, per_mm) in axes {
            if from != to {
                let _ = write!(line, "{letter}{:.4}", (to.0 + offset.0) as f64 / per_mm);
            }
        }
        let _ = write!(line, "K{:.6}", pass.lead);
        line
    }

    /// The board has answered the pass: it is made, or was refused.
    pub(super) fn pass_answered(&mut self, error: Option<u16>) {
        let Some(cutting) = self.thread.pass.take() else {
            return;
        };
        self.motion.queued.clear();
        // What was reported before says nothing about the standstill.
        self.reports.forget_standstill();
        self.reports.hurry();
        if let Some(number) = error {
            // The board takes no line after one that it has refused, but an empty one.
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
        // G33 stays in force otherwise.
        self.send(MODES[1], false);
    }

    /// A report while a pass is under way, or of the spindle before it.
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
        let between = ends.into_iter().all(|way| way > cutting.ramps);
        if let (true, Some(feed)) = (between, status.feed)
            && (feed - cutting.speed).abs() > MISREAD * cutting.speed
        {
            // Nothing but this tells that a figure was damaged on its way.
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

    /// Stops the board dead in its pass.
    pub(super) fn abandon_pass(&mut self) {
        self.session.lose_position(Uncertainty::StoppedDead);
        self.forget_motion();
        self.restart();
        self.enter(LinkState::Locked);
    }
}
