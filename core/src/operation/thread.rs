//! Threads and tapping in automatic operation: what is checked before and during
//! them, and the rules of feed hold and single block (manual I-3.2.4, PLC-I «feed
//! hold», «rigid tapping»).
//!
//! ```text
//!  block     G32 ──► G32 ──► G00 ──►            G92: 1 ──► thread ──► retract ──►
//!  hold        ▲ SPL, goes on    │ stop               ▲ SPL, goes on        │ stop
//!                        ▲ again, or still: stops in this block
//! ```

use serde::{Deserialize, Serialize};

use super::automatic::{Current, RunState};
use super::board::SpindleTrouble;
use super::handshake::Strobe;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::{Action, Command, ThreadStart};
use crate::motion::{MotionLimits, ThreadMove};
use crate::spindle::Encoder;
use crate::units::{Axis, Feed, Point};

/// Below this a spindle stands, r/min.
const STANDING_RPM: f64 = 1.0;
/// The spindle speed of a thread is compared over so many ticks (106).
const FLUCTUATION_TICKS: u32 = 100;
/// A speed at the limit is measured a little above it.
const WITHIN_MEASUREMENT: f64 = 0.99;

const SPINDLE_FORWARD: u8 = 3;
const SPINDLE_REVERSE: u8 = 4;
const SPINDLE_STOP: u8 = 5;

/// Whether feed hold may stop the motion under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Protection {
    /// It may.
    #[default]
    None,
    /// A thread or tap, and what follows it until the next command begins.
    Thread,
    /// Hold was asked for in a thread: the first thing after it goes to its end.
    After {
        /// Hold asked for again stops in it; not so the retract of a cycle.
        again: bool,
    },
}

/// How far a tap has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum TapStage {
    /// The spindle turns again for a further start of the thread.
    Restart,
    /// Other functions of the block are finished first, and a spindle that was
    /// started again has come to its speed.
    Ready,
    /// Inwards in phase.
    In,
    /// M05; the tool follows the spindle to its standstill.
    Stopping,
    /// Out in phase with the reversed spindle.
    Out,
    /// M05 again.
    Ending,
    /// Done.
    Done,
}

/// What is watched while a thread is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleWatch {
    /// Speed at the last comparison, and ticks since.
    rpm: Option<f64>,
    ticks: u32,
    /// The spindle has turned in a cut of this run.
    turned: bool,
    /// Ticks that a command has waited for the spindle.
    pub waited: u32,
    /// The thread under way is not what it should be: the run ends behind it.
    pub spoilt: Option<SpindleTrouble>,
}

impl super::automatic::Automatic {
    /// Whether motion goes on although hold is asked for.
    pub(crate) fn protected(&self) -> bool {
        let whole = |current: &Current| current.command.whole;
        self.protection != Protection::None || self.current.as_ref().is_some_and(whole)
    }

    /// Whether a thread or tap is under way.
    pub(crate) fn threading(&self) -> bool {
        matches!(
            self.action(),
            Some(Action::Thread { .. } | Action::Tap { .. })
        )
    }

    /// Whether the command read ahead goes on in phase from the one under way.
    pub(crate) fn thread_continues(&self) -> bool {
        matches!(
            self.ahead.as_ref().map(|command| &command.action),
            Some(Action::Thread {
                start: ThreadStart::Continued,
                ..
            })
        )
    }

    /// Whether the next command may begin in this state.
    pub(super) fn may_begin(&self) -> bool {
        match self.state {
            RunState::Run => true,
            RunState::Hold => match self.protection {
                Protection::None => false,
                Protection::Thread => true,
                Protection::After { .. } => self.within_block,
            },
            RunState::Reset | RunState::Stop => false,
        }
    }

    /// What the beginning of a command does to the protection.
    pub(super) fn protect(&mut self, action: &Action) {
        if !self.within_block {
            self.tap_reverse = 0;
        }
        self.watch.rpm = None;
        self.watch.ticks = 0;
        self.watch.waited = 0;
        // A stop that was programmed is expected.
        if matches!(
            action,
            Action::Miscellaneous { code: 5, .. } | Action::End { .. }
        ) {
            self.watch.turned = false;
        }
        self.protection = match action {
            Action::Thread { .. } | Action::Tap { .. } => Protection::Thread,
            _ if self.state == RunState::Hold && self.protection != Protection::None => {
                match self.protection {
                    Protection::After { again } => Protection::After { again },
                    _ => Protection::After {
                        again: !self.within_block,
                    },
                }
            }
            _ => Protection::None,
        };
    }

    /// Whether the run stops after a finished command, as far as threads decide it.
    pub(super) fn stop_after(&self, command: &Command, single_block: bool) -> Option<bool> {
        let held = self.state == RunState::Hold;
        match (&command.action, self.protection) {
            // The moves of a cycle stop one by one; a thread block never does.
            (Action::Thread { .. }, _) => Some(
                !held
                    && !command.block_end
                    && command.stop_point
                    && single_block
                    && !self.thread_continues(),
            ),
            (Action::Rapid { .. } | Action::Line { .. }, Protection::After { again: false }) => {
                Some(held)
            }
            _ => None,
        }
    }
}

impl Cnc {
    /// Begins a thread: synchronised, or in dry run as a cut.
    pub(super) fn begin_thread(&mut self, thread: &ThreadMove) -> Result<(), Alarm> {
        if self.dry_run().is_some() {
            let feed = Feed::PerRevolution(thread.lead);
            self.interpolator.start_line(thread.to, feed);
            return Ok(());
        }
        self.check_encoder()?;
        check_standing(self.spindle.actual_rpm())?;
        let (from, rpm) = (self.interpolator.position(), self.thread_rpm());
        check_thread_speed(thread.top_speed(from, rpm, &self.limits), rpm, &self.limits)?;
        if self.board_cuts() {
            self.check_pass_end(thread.to)?;
            self.ask_pass(thread);
            return Ok(());
        }
        self.interpolator.start_thread(thread, &self.limits);
        Ok(())
    }

    /// At the start of a cycle of threads: nothing is fed in toward a cut that the
    /// spindle does not allow (092, 094).
    pub(super) fn check_thread_cycle(&self, per_revolution: Point) -> Result<(), Alarm> {
        if self.dry_run().is_some() {
            return Ok(());
        }
        self.check_encoder()?;
        check_standing(self.spindle.actual_rpm())?;
        let rpm = self.thread_rpm();
        check_thread_speed(per_revolution * rpm, rpm, &self.limits)
    }

    /// The spindle speed that a thread has to reckon with: the measured one, or the
    /// commanded one that it is still coming up to.
    pub(super) fn thread_rpm(&self) -> f64 {
        let commanded = self.spindle.commanded_rpm().min(self.spindle.top_speed());
        let measured = self.spindle.actual_rpm().abs();
        if measured * WITHIN_MEASUREMENT <= commanded {
            commanded
        } else {
            measured
        }
    }

    /// A thread that is about to begin: the run-out (or thread) that goes on from it
    /// must be possible too, before anything is cut.
    pub(super) fn check_thread_ahead(&mut self) {
        let (Some(current), Some(ahead)) = (&self.automatic.current, &self.automatic.ahead) else {
            return;
        };
        let (Some(first), Some(next)) = (
            ThreadMove::of(&current.command.action),
            ThreadMove::of(&ahead.action),
        ) else {
            return;
        };
        let begins = matches!(first.start, ThreadStart::AtIndex { .. });
        if !begins || next.start != ThreadStart::Continued || self.dry_run().is_some() {
            return;
        }
        let rpm = self.thread_rpm();
        let source = ahead.source;
        if let Some(alarm) = self.refuse_ahead(&next) {
            return self.raise(alarm.at(source));
        }
        let top = next.top_speed(first.to, rpm, &self.limits);
        if let Err(alarm) = check_thread_speed(top, rpm, &self.limits) {
            self.raise(alarm.at(source));
        }
    }

    /// Begins tapping. Without control of the spindle (dry run, M locked) it is two
    /// cuts.
    pub(super) fn begin_tap(&mut self, to: Point, lead: f64) -> Result<(), Alarm> {
        if self.tap_is_dry() {
            self.automatic.tap = Some(TapStage::In);
            self.interpolator
                .start_line(to, Feed::PerRevolution(lead.abs()));
            return Ok(());
        }
        self.check_encoder()?;
        if self.automatic.tap_reverse != 0 {
            self.automatic.tap = Some(TapStage::Restart);
            return Ok(());
        }
        check_standing(self.spindle.actual_rpm())?;
        let rpm = self.thread_rpm();
        check_thread_speed(Point::new(0.0, lead.abs() * rpm), rpm, &self.limits)?;
        self.automatic.tap = Some(TapStage::Ready);
        Ok(())
    }

    fn tap_is_dry(&self) -> bool {
        self.dry_run().is_some() || self.from_plc.auxiliary_lock
    }

    /// The encoder must be one that can be used (alarm 092).
    pub(super) fn check_encoder(&self) -> Result<(), Alarm> {
        check_encoder(&self.parameters)
    }

    /// One tick of a tap: the M functions that stop and reverse the spindle.
    pub(super) fn tap_tick(&mut self) {
        let Some(stage) = self.automatic.tap else {
            return;
        };
        let Some(Action::Tap {
            to,
            lead,
            start_degrees,
        }) = self.automatic.action()
        else {
            self.automatic.tap = None;
            return;
        };
        let (to, lead, degrees) = (*to, *lead, *start_degrees);
        let busy = self.handshake.busy();
        let stands = self.spindle.actual_rpm().abs() < STANDING_RPM;
        let next = match stage {
            TapStage::Restart if !busy => {
                let forward = self.automatic.tap_reverse != SPINDLE_FORWARD;
                let code = if forward {
                    SPINDLE_FORWARD
                } else {
                    SPINDLE_REVERSE
                };
                self.handshake.start(Strobe::M, code);
                TapStage::Ready
            }
            TapStage::Ready if !busy && self.spindle_steady() => {
                self.interpolator.start_tap(to, lead, degrees);
                TapStage::In
            }
            // Carried out as a cut, it is finished at the bottom.
            TapStage::In if self.interpolator.finished() => {
                let start = self.report_half();
                self.interpolator
                    .start_line(start, Feed::PerRevolution(lead.abs()));
                TapStage::Done
            }
            TapStage::In if self.interpolator.tap_at_bottom() => {
                self.automatic.tap_reverse = if self.turns_in_reverse() {
                    SPINDLE_FORWARD
                } else {
                    SPINDLE_REVERSE
                };
                self.handshake.start(Strobe::M, SPINDLE_STOP);
                TapStage::Stopping
            }
            TapStage::Stopping if !busy && stands => {
                self.report_half();
                self.interpolator.turn_back();
                self.handshake.start(Strobe::M, self.automatic.tap_reverse);
                TapStage::Out
            }
            TapStage::Out if self.interpolator.finished() && !busy => {
                self.handshake.start(Strobe::M, SPINDLE_STOP);
                TapStage::Ending
            }
            TapStage::Ending if !busy && stands => TapStage::Done,
            same => same,
        };
        self.automatic.tap = Some(next);
    }

    /// A spindle that was started for this tap has come to its speed; one that
    /// turned before is taken as it is.
    fn spindle_steady(&mut self) -> bool {
        let rpm = self.spindle.actual_rpm().abs();
        self.automatic.tap_reverse == 0 || (rpm >= STANDING_RPM && self.automatic.watch.steady(rpm))
    }

    /// The direction that the ladder reports (SRVB, SFRB), or else the measured one.
    fn turns_in_reverse(&self) -> bool {
        match (self.from_plc.spindle_forward, self.from_plc.spindle_reverse) {
            (true, false) => false,
            (false, true) => true,
            _ => self.spindle.actual_rpm() < 0.0,
        }
    }

    /// Watches the spindle during a cut: alarm 091 when its speed changes too much
    /// in a thread (106), 094 when it has become too fast for an axis, 098 when it
    /// has stopped (175.2).
    pub(super) fn watch_spindle(&mut self) {
        let thread = match self.automatic.action() {
            Some(Action::Thread { .. }) => self.interpolator.in_thread(),
            Some(Action::Line { .. } | Action::Arc { .. }) => false,
            _ => return,
        };
        if self.dry_run().is_some() || self.automatic.state == RunState::Stop {
            return;
        }
        let rpm = self.spindle.actual_rpm();
        let watch = &mut self.automatic.watch;
        let stands = rpm.abs() < STANDING_RPM;
        watch.turned |= !stands;
        let number = if stands && watch.turned && self.parameters.watches_spindle() {
            98
        } else if thread && watch.fluctuates(rpm.abs(), self.parameters.fluctuation_limit()) {
            if self.board.is_some_and(|board| board.spindle.is_some()) {
                watch.spoilt = Some(SpindleTrouble::Fluctuates(rpm.abs()));
                return;
            }
            91
        } else {
            if thread {
                self.watch_thread_speed(rpm);
            }
            return;
        };
        let alarm = Alarm::new(number).because(format!("spindle at {:.0} r/min", rpm.abs()));
        self.raise_at_last(alarm);
    }

    /// A spindle that has become faster than at the beginning of the thread.
    fn watch_thread_speed(&mut self, rpm: f64) {
        let current = self.automatic.current.as_ref();
        let thread = current.and_then(|current| {
            let thread = ThreadMove::of(&current.command.action)?;
            Some(thread.top_speed(current.from, rpm * WITHIN_MEASUREMENT, &self.limits))
        });
        let found = thread.map_or(Ok(()), |top| check_thread_speed(top, rpm, &self.limits));
        if let Err(alarm) = found {
            self.raise_at_last(alarm);
        }
    }

    pub(crate) fn raise_at_last(&mut self, alarm: Alarm) {
        self.raise(match self.automatic.last {
            Some(source) => alarm.at(source),
            None => alarm,
        });
    }
}

impl SpindleWatch {
    /// Whether the speed has kept within a half per cent for a while.
    fn steady(&mut self, rpm: f64) -> bool {
        let before = *self.rpm.get_or_insert(rpm);
        self.ticks += 1;
        if self.ticks < FLUCTUATION_TICKS {
            return false;
        }
        self.ticks = 0;
        self.rpm = Some(rpm);
        (rpm - before).abs() * 200.0 <= rpm + before
    }

    /// `|n - n0| · 200 / (n + n0)` against the limit, %.
    fn fluctuates(&mut self, rpm: f64, limit: f64) -> bool {
        let before = *self.rpm.get_or_insert(rpm);
        self.ticks += 1;
        if limit <= 0.0 || self.ticks < FLUCTUATION_TICKS {
            return false;
        }
        self.ticks = 0;
        self.rpm = Some(rpm);
        (rpm - before).abs() * 200.0 > limit * (rpm + before)
    }
}

/// Alarm 092: an encoder with less than 100 or more than 5000 lines (070).
pub(crate) fn check_encoder(parameters: &crate::memory::Parameters) -> Result<(), Alarm> {
    if Encoder::counts_per_turn(parameters).is_some() {
        return Ok(());
    }
    let lines = parameters.encoder_lines();
    Err(Alarm::new(92).because(format!("070 = {lines} lines, 100 to 5000 are allowed")))
}

/// Alarm 094: a thread with a standing spindle.
pub(crate) fn check_standing(rpm: f64) -> Result<(), Alarm> {
    if rpm.abs() < STANDING_RPM {
        return Err(Alarm::new(94).because("thread with a standing spindle"));
    }
    Ok(())
}

/// Alarm 094: an axis that cannot follow the spindle (022, 023, 027).
pub(crate) fn check_thread_speed(top: Point, rpm: f64, limits: &MotionLimits) -> Result<(), Alarm> {
    for axis in [Axis::X, Axis::Z] {
        let (limit, parameter) = limits.thread_limit(axis);
        let speed = top.get(axis);
        if speed > limit {
            return Err(Alarm::new(94).because(format!(
                "{axis:?} would need {speed:.0} mm/min at {:.0} r/min, {limit:.0} are allowed \
                 ({parameter:03})",
                rpm.abs()
            )));
        }
    }
    Ok(())
}
