//! Threads and tapping in automatic operation: checks before and during them, and the rules
//! of feed hold and single block (manual I-3.2.4, PLC-I «feed hold», «rigid tapping»).
//!
//! ```text
//!  block     G32 ──► G32 ──► G00 ──►            G92: 1 ──► thread ──► retract ──►
//!  hold        ▲ SPL, continues  │ holds              ▲ SPL, continues      │ holds
//!                        ▲ again, or still active: holds in this block
//! ```

use crate::alarm::{Alarm, number};
use crate::board::SpindleFault;
use crate::cnc::Cnc;
use crate::command::{Action, ThreadStart};
use crate::motion::ThreadMove;
use crate::operation::{
    RunState, STANDSTILL_RPM, Strobe, TapStage, check_encoder, check_spindle_turns,
    check_thread_speed,
};
use crate::units::{Feed, Point};
use gsk_messages::say;

/// Factor on the measured spindle speed before it is compared with a limit: a speed at the limit
/// may be measured a little too high.
const WITHIN_MEASUREMENT: f64 = 0.99;

const SPINDLE_FORWARD: u8 = 3;

const SPINDLE_REVERSE: u8 = 4;

const SPINDLE_STOP: u8 = 5;

impl Cnc {
    /// Starts a thread: synchronised with the spindle, or as a cut in dry run.
    ///
    /// # Errors
    /// Alarm 092 for the encoder, or the alarm of a spindle that is at standstill or too fast.
    pub(crate) fn start_thread(&mut self, thread: &ThreadMove) -> Result<(), Alarm> {
        if self.dry_run().is_some() {
            let feed = Feed::PerRevolution(thread.lead);
            self.drives.interpolator.start_line(thread.to, feed);
            return Ok(());
        }
        self.check_encoder()?;
        check_spindle_turns(self.spindle.control.actual_rpm())?;
        let (from, rpm) = (self.drives.interpolator.position(), self.thread_rpm());
        check_thread_speed(
            thread.top_speed(from, rpm, &self.drives.limits),
            rpm,
            &self.drives.limits,
        )?;
        if self.is_cutting_by_board() {
            self.check_pass_end(thread.to)?;
            self.request_pass(thread);
            return Ok(());
        }
        self.drives
            .interpolator
            .start_thread(thread, &self.drives.limits);
        Ok(())
    }

    /// Checks encoder and spindle speed at the start of a thread cycle, so that the tool does not
    /// feed in for a cut that is not possible; returns alarm 092 or 094 as error. `per_revolution`
    /// is the travel of each axis per spindle revolution, mm.
    pub(crate) fn check_thread_cycle(&self, per_revolution: Point) -> Result<(), Alarm> {
        if self.dry_run().is_some() {
            return Ok(());
        }
        self.check_encoder()?;
        check_spindle_turns(self.spindle.control.actual_rpm())?;
        let rpm = self.thread_rpm();
        check_thread_speed(per_revolution * rpm, rpm, &self.drives.limits)
    }

    /// The spindle speed for thread checks, r/min: the measured one, or the commanded one
    /// that the spindle is still reaching.
    pub(crate) fn thread_rpm(&self) -> f64 {
        let commanded = self
            .spindle
            .control
            .commanded_rpm()
            .min(self.spindle.control.top_speed());
        let measured = self.spindle.control.actual_rpm().abs();
        if measured * WITHIN_MEASUREMENT <= commanded {
            commanded
        } else {
            measured
        }
    }

    /// Checks the run-out or thread that follows in phase, before the thread itself is cut; raises
    /// an alarm if it is not possible.
    pub(crate) fn check_thread_ahead(&mut self) {
        let (Some(current), Some(ahead)) = (
            &self.run.automatic.current,
            &self.run.automatic.next_command,
        ) else {
            return;
        };
        let (Some(first), Some(next)) = (
            ThreadMove::from_action(&current.command.action),
            ThreadMove::from_action(&ahead.action),
        ) else {
            return;
        };
        let is_first = matches!(first.start, ThreadStart::AtIndex { .. });
        if !is_first || next.start != ThreadStart::Continued || self.dry_run().is_some() {
            return;
        }
        let rpm = self.thread_rpm();
        let source = ahead.source;
        if let Some(alarm) = self.continuation_alarm(&next) {
            return self.raise(alarm.with_source(source));
        }
        let top = next.top_speed(first.to, rpm, &self.drives.limits);
        if let Err(alarm) = check_thread_speed(top, rpm, &self.drives.limits) {
            self.raise(alarm.with_source(source));
        }
    }

    /// Starts tapping to the bottom `to`, mm, with `lead`, mm per turn. Without control of the
    /// spindle (dry run, M locked) the tap is two cuts. Returns alarm 092 for the encoder, or the
    /// alarm of a spindle that is at standstill or too fast, as error.
    pub(crate) fn start_tap(&mut self, to: Point, lead: f64) -> Result<(), Alarm> {
        if self.is_dry_tap() {
            self.run.automatic.tap = Some(TapStage::In);
            self.drives
                .interpolator
                .start_line(to, Feed::PerRevolution(lead.abs()));
            return Ok(());
        }
        self.check_encoder()?;
        if self.is_tapping_by_board() {
            self.check_pass_end(to)?;
        }
        if self.run.automatic.tap_reverse != 0 {
            self.run.automatic.tap = Some(TapStage::Restart);
            return Ok(());
        }
        check_spindle_turns(self.spindle.control.actual_rpm())?;
        let rpm = self.thread_rpm();
        check_thread_speed(Point::new(0.0, lead.abs() * rpm), rpm, &self.drives.limits)?;
        self.run.automatic.tap = Some(TapStage::Ready);
        Ok(())
    }

    fn is_dry_tap(&self) -> bool {
        self.dry_run().is_some() || self.plc.signals.auxiliary_lock || self.is_tap_locked()
    }

    /// Returns alarm 092 as error if the encoder cannot be used.
    pub(crate) fn check_encoder(&self) -> Result<(), Alarm> {
        check_encoder(&self.memory.parameters)
    }

    /// Advances a tap by one tick: outputs the M functions that stop and reverse the
    /// spindle.
    pub(crate) fn advance_tap(&mut self) {
        let Some(stage) = self.run.automatic.tap else {
            return;
        };
        let Some(Action::Tap {
            to,
            lead,
            start_degrees,
        }) = self.run.automatic.current_action()
        else {
            self.run.automatic.tap = None;
            return;
        };
        let (to, lead, degrees) = (*to, *lead, *start_degrees);
        let busy = self.run.handshake.is_busy();
        let stands_still = self.spindle.control.actual_rpm().abs() < STANDSTILL_RPM;
        let next = match stage {
            TapStage::Restart if !busy => {
                let forward = self.run.automatic.tap_reverse != SPINDLE_FORWARD;
                let code = if forward {
                    SPINDLE_FORWARD
                } else {
                    SPINDLE_REVERSE
                };
                self.run.handshake.start(Strobe::M, code);
                TapStage::Ready
            }
            TapStage::Ready if !busy && self.is_spindle_steady() => {
                if self.is_tapping_by_board() {
                    self.request_tap(to, lead, degrees);
                } else {
                    self.drives.interpolator.start_tap(to, lead, degrees);
                }
                TapStage::In
            }
            // In dry run the tap is a cut, which ends at the bottom.
            TapStage::In if self.drives.interpolator.is_finished() => {
                let start = self.report_tap_half();
                self.drives
                    .interpolator
                    .start_line(start, Feed::PerRevolution(lead.abs()));
                TapStage::Done
            }
            TapStage::In if self.drives.interpolator.is_tap_at_bottom() => {
                self.run.automatic.tap_reverse = if self.is_turning_in_reverse() {
                    SPINDLE_FORWARD
                } else {
                    SPINDLE_REVERSE
                };
                self.run.handshake.start(Strobe::M, SPINDLE_STOP);
                TapStage::Stopping
            }
            TapStage::Stopping if !busy && stands_still => {
                self.report_tap_half();
                self.drives.interpolator.reverse_tap();
                self.run
                    .handshake
                    .start(Strobe::M, self.run.automatic.tap_reverse);
                TapStage::Out
            }
            TapStage::Out if self.drives.interpolator.is_finished() && !busy => {
                self.run.handshake.start(Strobe::M, SPINDLE_STOP);
                TapStage::Ending
            }
            TapStage::Ending if !busy && stands_still => TapStage::Done,
            same => same,
        };
        self.run.automatic.tap = Some(next);
    }

    /// Whether the spindle has a steady speed after its start for this tap. A spindle that
    /// turned before the tap is always accepted.
    fn is_spindle_steady(&mut self) -> bool {
        let rpm = self.spindle.control.actual_rpm().abs();
        self.run.automatic.tap_reverse == 0
            || (rpm >= STANDSTILL_RPM && self.run.automatic.watch.check_steady(rpm))
    }

    /// Whether the spindle turns in reverse according to the signals SRVB and SFRB of the ladder,
    /// or according to the measured speed if the ladder sets neither or both.
    fn is_turning_in_reverse(&self) -> bool {
        match (
            self.plc.signals.spindle_forward,
            self.plc.signals.spindle_reverse,
        ) {
            (true, false) => false,
            (false, true) => true,
            _ => self.spindle.control.actual_rpm() < 0.0,
        }
    }

    /// Checks the spindle during a cut: alarm 091 when its speed fluctuates in a thread
    /// (106), 094 when it is too fast for an axis, 098 when it has stopped (175.2).
    pub(crate) fn check_spindle(&mut self) {
        let thread = match self.run.automatic.current_action() {
            Some(Action::Thread { .. }) => self.drives.interpolator.is_in_thread(),
            Some(Action::Line { .. } | Action::Arc { .. }) => false,
            _ => return,
        };
        if self.dry_run().is_some() || self.run.automatic.state == RunState::Stop {
            return;
        }
        let rpm = self.spindle.control.actual_rpm();
        let watch = &mut self.run.automatic.watch;
        let stands_still = rpm.abs() < STANDSTILL_RPM;
        watch.has_turned |= !stands_still;
        let number = if stands_still && watch.has_turned && self.memory.parameters.watches_spindle()
        {
            number::SPINDLE_STOPPED
        } else if thread
            && watch.check_fluctuation(rpm.abs(), self.memory.parameters.speed_fluctuation_limit())
        {
            if self
                .drives
                .board
                .is_some_and(|board| board.spindle.is_some())
            {
                watch.fault = Some(SpindleFault::Fluctuates(rpm.abs()));
                return;
            }
            number::SPEED_FLUCTUATES
        } else {
            if thread {
                self.recheck_thread_speed(rpm);
            }
            return;
        };
        let alarm = Alarm::new(number).with_detail(say::spindle_at_speed(rpm.abs()));
        self.raise_at_last_block(alarm);
    }

    /// Raises alarm 094 if the spindle has become too fast for an axis since the start of the
    /// thread; `rpm` is its measured speed, r/min.
    fn recheck_thread_speed(&mut self, rpm: f64) {
        let current = self.run.automatic.current.as_ref();
        let thread = current.and_then(|current| {
            let thread = ThreadMove::from_action(&current.command.action)?;
            Some(thread.top_speed(current.from, rpm * WITHIN_MEASUREMENT, &self.drives.limits))
        });
        let result = thread.map_or(Ok(()), |top| {
            check_thread_speed(top, rpm, &self.drives.limits)
        });
        if let Err(alarm) = result {
            self.raise_at_last_block(alarm);
        }
    }

    pub(crate) fn raise_at_last_block(&mut self, alarm: Alarm) {
        self.raise(match self.run.automatic.last_source {
            Some(source) => alarm.with_source(source),
            None => alarm,
        });
    }
}
