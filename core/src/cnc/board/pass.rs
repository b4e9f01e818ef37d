//! Threads that the board cuts, one straight pass after the other.

use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::command::{ThreadPassFeature, ThreadStart};
use crate::motion::ThreadMove;
use crate::units::{PerAxis, Point, Pulses};
use gsk_link::{ThreadCapability, ThreadPass};
use gsk_messages::say;

/// Returns the alarm for a thread that the board cannot cut as a single pass because of `feature`.
fn pass_alarm(feature: ThreadPassFeature) -> Alarm {
    Alarm::new(number::BOARD_CANNOT).with_detail(say::pass_one_at_a_time(feature.to_message()))
}

impl Cnc {
    /// Whether the board itself cuts the passes of a thread; false while machine lock is on
    /// for both axes.
    pub(crate) fn is_cutting_by_board(&self) -> bool {
        let locked = self.plc.signals.machine_lock;
        let cuts_passes =
            |board: crate::board::BoardDrives| board.threads == ThreadCapability::Passes;
        self.drives.board.is_some_and(cuts_passes) && !(locked.x && locked.z)
    }

    /// Checks, before a thread cycle feeds in, that its cuts are single passes and not faster than
    /// the motors can start; returns an alarm as error if not. `per_revolution` is the travel of
    /// each axis per revolution, mm; `extra_feature` is a feature of the cycle that a single pass
    /// cannot have.
    pub(crate) fn check_passes(
        &self,
        per_revolution: Point,
        extra_feature: Option<ThreadPassFeature>,
    ) -> Result<(), Alarm> {
        if let Some(feature) = extra_feature {
            return Err(pass_alarm(feature));
        }
        self.check_pass_speed(per_revolution.length())
    }

    /// Checks that the board can cut a thread as a single pass; returns an alarm as error if not.
    pub(crate) fn check_pass(&self, thread: &ThreadMove) -> Result<(), Alarm> {
        let feature = match thread.start {
            _ if thread.run_out => Some(ThreadPassFeature::RunOut),
            _ if thread.increase != 0.0 => Some(ThreadPassFeature::LeadChange),
            ThreadStart::Continued => Some(ThreadPassFeature::Continued),
            ThreadStart::AtIndex { degrees } if degrees != 0.0 => {
                Some(ThreadPassFeature::StartAngle)
            }
            ThreadStart::AtIndex { .. } => None,
        };
        if let Some(feature) = feature {
            return Err(pass_alarm(feature));
        }
        let locked = self.plc.signals.machine_lock;
        if locked.x || locked.z {
            return Err(Alarm::new(number::BOARD_CANNOT).with_detail(say::pass_with_locked_axis()));
        }
        self.check_pass_speed(thread.lead_along_path(self.drives.interpolator.commanded()))
    }

    fn check_pass_speed(&self, lead: f64) -> Result<(), Alarm> {
        let max_speed = self
            .drives
            .board
            .map_or(f64::INFINITY, |board| board.pass_speed_mm_per_min);
        let speed = lead * self.thread_rpm();
        if speed > max_speed {
            return Err(Alarm::new(number::BOARD_CANNOT)
                .with_detail(say::pass_speed_too_high(speed, max_speed)));
        }
        Ok(())
    }

    /// The alarm for `next`, a thread or run-out that continues from a pass of the board; `None` if
    /// the board does not cut passes.
    pub(crate) fn continuation_alarm(&self, next: &ThreadMove) -> Option<Alarm> {
        let feature = if next.run_out {
            ThreadPassFeature::RunOut
        } else {
            ThreadPassFeature::Continued
        };
        self.is_cutting_by_board().then(|| pass_alarm(feature))
    }

    /// Starts a thread that the board cuts: takes up the backlash of the screws, then waits until
    /// the board begins.
    pub(crate) fn request_pass(&mut self, thread: &ThreadMove) {
        let displacement = thread.to - self.drives.interpolator.position();
        self.drives.interpolator.start_external_cut(thread.to);
        self.drives.axis_chain.take_up_backlash(displacement);
    }

    /// Returns the pass that the board must start now; `None` without one, and while backlash is
    /// being taken up.
    pub(crate) fn pending_pass(&self) -> Option<ThreadPass> {
        let to = self.drives.interpolator.pending_external_cut()?;
        let current = self.run.automatic.current.as_ref()?;
        let thread = ThreadMove::from_action(&current.command.action)?;
        if self.drives.axis_chain.is_settling() {
            return None;
        }
        let mut at_end = self.drives.axis_chain.clone();
        at_end.advance(to, PerAxis::default());
        Some(ThreadPass {
            from: self.drives.axis_chain.pulses(),
            end: at_end.pulses(),
            lead: thread.lead_along_path(self.drives.interpolator.position()),
        })
    }

    /// Records that the board has started the current thread pass.
    pub(crate) const fn start_pass(&mut self) {
        self.drives.interpolator.begin_external_cut();
    }

    /// Sets the fraction of the current thread pass that the board has made, 0–1.
    pub(crate) fn report_pass_progress(&mut self, fraction: f64) {
        self.drives.interpolator.report_external_progress(fraction);
    }

    /// Ends the current thread pass at the pulse count `end` that the board reports.
    pub(crate) fn finish_pass(&mut self, end: PerAxis<Pulses>) {
        if self.drives.interpolator.end_external_cut() {
            let locked = self.plc.signals.machine_lock;
            self.drives.axis_chain.advance(self.position(), locked);
            if self.drives.axis_chain.pulses() == end {
                return;
            }
        }
        // The control's motion has changed meanwhile; the slides are at `end`.
        self.set_count(end);
    }
}
