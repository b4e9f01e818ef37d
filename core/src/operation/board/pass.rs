//! Threads that the drives cut by themselves, one straight pass after the other.

use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::{BeyondPass, ThreadStart};
use crate::machine::link::{Pass, ThreadRights};
use crate::motion::ThreadMove;
use crate::units::{PerAxis, Point, Pulses};

/// The board cannot cut it as a pass.
fn refuse(beyond: BeyondPass) -> Alarm {
    Alarm::new(604).because(format!(
        "the board cuts one straight pass at a time, not {}",
        beyond.text()
    ))
}

impl Cnc {
    /// Whether threads are passes of the board. Under machine lock none goes out.
    pub(in crate::operation) fn board_cuts(&self) -> bool {
        let locked = self.from_plc.machine_lock;
        let passes = |board: super::BoardDrives| board.threads == ThreadRights::Passes;
        self.board.is_some_and(passes) && !(locked.x && locked.z)
    }

    /// Before a cycle of threads feeds in: whether its cuts are passes, and not
    /// faster than the motors start.
    pub(super) fn check_passes(
        &self,
        per_revolution: Point,
        beyond: Option<BeyondPass>,
    ) -> Result<(), Alarm> {
        if let Some(beyond) = beyond {
            return Err(refuse(beyond));
        }
        self.check_pass_speed(per_revolution.length())
    }

    /// Whether a thread is a pass.
    pub(super) fn check_pass(&self, thread: &ThreadMove) -> Result<(), Alarm> {
        let beyond = match thread.start {
            _ if thread.run_out => Some(BeyondPass::RunOut),
            _ if thread.increase != 0.0 => Some(BeyondPass::LeadChange),
            ThreadStart::Continued => Some(BeyondPass::GoesOn),
            ThreadStart::AtIndex { degrees } if degrees != 0.0 => Some(BeyondPass::Start),
            ThreadStart::AtIndex { .. } => None,
        };
        if let Some(beyond) = beyond {
            return Err(refuse(beyond));
        }
        let locked = self.from_plc.machine_lock;
        if locked.x || locked.z {
            return Err(Alarm::new(604).because("a thread with one axis locked"));
        }
        self.check_pass_speed(thread.lead_along(self.interpolator.commanded()))
    }

    fn check_pass_speed(&self, lead: f64) -> Result<(), Alarm> {
        let most = self.board.map_or(f64::INFINITY, |board| board.pass_speed);
        let speed = lead * self.thread_rpm();
        if speed > most {
            return Err(Alarm::new(604).because(format!(
                "a pass begins without a ramp, at {speed:.0} mm/min: more than \
                 flush_keep_speed = {most:.0} of the machine file; a slower spindle helps"
            )));
        }
        Ok(())
    }

    /// What goes on from a pass is no pass.
    pub(in crate::operation) fn refuse_ahead(&self, next: &ThreadMove) -> Option<Alarm> {
        let beyond = if next.run_out {
            BeyondPass::RunOut
        } else {
            BeyondPass::GoesOn
        };
        self.board_cuts().then(|| refuse(beyond))
    }

    /// Begins a thread that the board cuts. The play of the screws is made up for
    /// before it.
    pub(in crate::operation) fn ask_pass(&mut self, thread: &ThreadMove) {
        let way = thread.to - self.interpolator.position();
        self.interpolator.start_driven(thread.to);
        self.axes.lean(way);
    }

    /// The pass that waits for the board.
    pub(crate) fn pass_waiting(&self) -> Option<Pass> {
        let to = self.interpolator.waits_for_drives()?;
        let current = self.automatic.current.as_ref()?;
        let thread = ThreadMove::of(&current.command.action)?;
        if self.axes.is_settling() {
            return None;
        }
        let end = self.axes.clone().advance(to, PerAxis::default());
        Some(Pass {
            from: self.axes.pulses(),
            end,
            lead: thread.lead_along(self.interpolator.position()),
        })
    }

    /// The board has taken the pass.
    pub(crate) const fn begin_pass(&mut self) {
        self.interpolator.begin_driven();
    }

    /// The board has made this part of its pass.
    pub(crate) fn tell_pass(&mut self, share: f64) {
        self.interpolator.tell_driven(share);
    }

    /// The board stands at the end of its pass.
    pub(crate) fn end_pass(&mut self, end: PerAxis<Pulses>) {
        let locked = self.from_plc.machine_lock;
        if self.interpolator.end_driven() && self.axes.advance(self.position(), locked) == end {
            return;
        }
        // Something else became of it here meanwhile; the slides are there.
        self.stand_at(end);
    }
}
