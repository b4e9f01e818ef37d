//! A pass of a thread: one `G33`, which the board makes by itself behind its spindle.
//!
//! ```text
//!   drained, spindle steady ─► G33 X Z K ─► two one-turn signals ─► cut ─► ok, Idle
//!                                           (no report, ≤ 5 s)      reports   count compared
//! ```
//!
//! The board hears no hold in it: what stops it is the reset alone, and then nobody
//! knows where the slides stand.

use core::fmt::Write;
use core::time::Duration;

use super::super::super::{CannotCut, Doubt, HostTime, LinkState, Pass, Refused};
use super::super::answers::{BoardState, Status};
use super::{LineLink, MODES, Queued, RunTime};
use crate::units::{Axis, PerAxis, Point, Pulses};

/// The board waits so long for its one-turn signals, and reports nothing meanwhile.
const INDEX_WAIT: Duration = Duration::from_secs(5);
/// Time for what the board does besides.
const MARGIN: Duration = Duration::from_secs(2);
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
pub(super) struct Cutting {
    pass: Pass,
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
pub(super) struct Turning {
    since: HostTime,
    /// The speed then, and now.
    rpm: f64,
    latest: f64,
}

impl LineLink {
    /// Hands over a pass; the link must be drained and the spindle turn steadily.
    ///
    /// # Errors
    /// What is not as it must be, for now or for good; nothing was sent.
    pub fn cut(&mut self, pass: &Pass) -> Result<(), CannotCut> {
        let stands = self.stands_in(&[BoardState::Idle])
            && self.state == LinkState::Ready
            && self.wanted == self.switched
            && self.segments.pending() == RunTime::ZERO;
        if !stands || self.cutting.is_some() {
            return Err(CannotCut::NotReady);
        }
        let turning = self.turning.ok_or(CannotCut::Unseen)?;
        if self.now.saturating_sub(turning.since) < STEADY_FOR {
            return Err(CannotCut::Unsteady);
        }
        let rpm = turning.latest;
        if rpm < 1.0 {
            return Err(CannotCut::Standing);
        }
        if rpm < LEAST_RPM {
            return Err(CannotCut::Slow {
                rpm,
                least: LEAST_RPM,
            });
        }
        let way = self.between(self.commanded, pass.end);
        let (length, speed) = (way.length(), rpm * pass.lead);
        let most = f64::from(self.config.flush_keep_speed);
        if speed > most {
            return Err(CannotCut::Fast { speed, most });
        }
        let ramps = speed / 60.0 * (speed / 60.0) / self.acceleration(way);
        if ramps >= length {
            return Err(CannotCut::Short { length, ramps });
        }
        let moves = [
            pass.end.x.0 - self.commanded.x.0,
            pass.end.z.0 - self.commanded.z.0,
        ];
        let operated = [Some(self.pins.x), Some(self.pins.z)];
        if let Err(Refused::TowardLimit(axis) | Refused::UponLimit(axis)) =
            self.limits.allow(moves, operated)
        {
            return Err(CannotCut::Limit(axis));
        }
        let cutting = Duration::from_secs_f64(SLOWER * length / pass.lead / rpm * 60.0);
        self.send(&self.pass_line(pass), false);
        self.queued.push_back(Queued {
            duration: RunTime::ZERO,
            end: self.executed,
            pulses: pass.end,
            answered: false,
        });
        self.progressed = self.now;
        self.cutting = Some(Cutting {
            pass: *pass,
            until: self.now + INDEX_WAIT + cutting + MARGIN,
            speed,
            ramps: ramps + speed / 60.0 * PREPARED,
            begun: false,
        });
        self.enter(LinkState::Moving);
        Ok(())
    }

    /// From one place to another as the board goes, mm.
    fn between(&self, from: PerAxis<Pulses>, to: PerAxis<Pulses>) -> Point {
        let [per_x, per_z] = self.required.pulses_per_mm;
        Point::new(
            (to.x.0 - from.x.0) as f64 / per_x,
            (to.z.0 - from.z.0) as f64 / per_z,
        )
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
    fn pass_line(&self, pass: &Pass) -> String {
        let [per_x, per_z] = self.required.pulses_per_mm;
        let mut line = String::from("G33");
        let axes = [
            ('X', self.commanded.x, pass.end.x, self.offset.x, per_x),
            ('Z', self.commanded.z, pass.end.z, self.offset.z, per_z),
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

    /// Whether a pass is under way.
    pub const fn is_cutting(&self) -> bool {
        self.cutting.is_some()
    }

    /// The board has answered the pass: it is made, or was refused.
    pub(super) fn pass_answered(&mut self, error: Option<u16>) {
        let Some(cutting) = self.cutting.take() else {
            return;
        };
        self.queued.clear();
        // What was reported before says nothing about the standstill.
        self.still_since = None;
        self.last_asked = HostTime::ZERO;
        if let Some(number) = error {
            // The board takes no line after one that it has refused, but an empty one.
            self.send("\n", false);
            match number {
                20 => self.alarm(604, "the board refuses G33 (error:20)"),
                41 => self.alarm(94, "the spindle stands at the beginning of the thread"),
                43 => self.alarm(94, "the spindle is too fast for the thread (error:43)"),
                _ => {
                    let text = format!("the thread was refused with error:{number}");
                    self.alarm(608, &text);
                }
            }
        } else {
            self.made = cutting.pass.end;
            self.commanded = cutting.pass.end;
            self.resumes = true;
        }
        // G33 stays in force otherwise.
        self.send(MODES[1], false);
    }

    /// A report while a pass is under way, or of the spindle before it.
    pub(super) fn follow_spindle(&mut self, status: &Status) {
        self.turning = status.spindle.map(|rpm| match self.turning {
            Some(turning) if (rpm - turning.rpm).abs() <= ROUNDING_RPM.max(STEADY * rpm) => {
                Turning {
                    latest: rpm,
                    ..turning
                }
            }
            _ => Turning {
                since: self.now,
                rpm,
                latest: rpm,
            },
        });
        let at = self.pulses(*status).map(|board| self.to_kernel(board));
        let from = self.commanded;
        let (Some(cutting), Some(at)) = (&mut self.cutting, at) else {
            return;
        };
        cutting.begun |= at != from;
        let cutting = *cutting;
        let ends = [from, cutting.pass.end].map(|end| self.between(end, at).length());
        let between = ends.into_iter().all(|way| way > cutting.ramps);
        if let (true, Some(feed)) = (between, status.feed)
            && (feed - cutting.speed).abs() > MISREAD * cutting.speed
        {
            // Nothing but this tells that a figure was damaged on its way.
            self.alarm(
                608,
                &format!(
                    "the board cuts the thread at {feed:.0} mm/min instead of {:.0}",
                    cutting.speed
                ),
            );
            self.abandon_pass();
            self.enter(LinkState::Fault);
        }
    }

    /// How long the board may be silent now.
    pub(super) fn patience(&self, usual: Duration) -> Duration {
        match self.cutting {
            Some(cutting) if !cutting.begun => INDEX_WAIT + MARGIN,
            _ => usual,
        }
    }

    pub(super) fn watch_pass(&mut self) {
        if self
            .cutting
            .is_some_and(|cutting| self.now >= cutting.until)
        {
            self.alarm(607, "the board has not ended its thread in time");
            self.abandon_pass();
            self.enter(LinkState::Fault);
        }
    }

    /// While the computer was away nobody waited for the board.
    pub(super) fn pass_was_unwatched(&mut self, gap: Duration) {
        if let Some(cutting) = &mut self.cutting {
            cutting.until += gap;
        }
    }

    /// Stops the board dead in its pass.
    pub(super) fn abandon_pass(&mut self) {
        self.lose_position(Doubt::StoppedDead);
        self.forget_motion();
        self.restart();
        self.enter(LinkState::Locked);
    }
}
