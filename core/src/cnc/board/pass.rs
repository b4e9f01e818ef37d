//! Threads that the drives cut by themselves, one straight pass after the other.

use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::command::{BeyondPass, ThreadStart};
use crate::motion::ThreadMove;
use crate::units::{PerAxis, Point, Pulses};
use gsk_link::{ThreadCapability, ThreadPass};
use gsk_messages::say;

/// The board cannot cut it as a pass.
fn refuse(beyond: BeyondPass) -> Alarm {
    Alarm::new(number::BOARD_CANNOT).because(say::pass_one_at_a_time(beyond.text()))
}

impl Cnc {
    /// Whether threads are passes of the board. Under machine lock none goes out.
    pub(crate) fn board_cuts(&self) -> bool {
        let locked = self.plc.signals.machine_lock;
        let passes = |board: crate::board::BoardDrives| board.threads == ThreadCapability::Passes;
        self.drives.board.is_some_and(passes) && !(locked.x && locked.z)
    }

    /// Before a cycle of threads feeds in: whether its cuts are passes, and not
    /// faster than the motors start.
    pub(crate) fn check_passes(
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
    pub(crate) fn check_pass(&self, thread: &ThreadMove) -> Result<(), Alarm> {
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
        let locked = self.plc.signals.machine_lock;
        if locked.x || locked.z {
            return Err(Alarm::new(number::BOARD_CANNOT).because(say::pass_with_locked_axis()));
        }
        self.check_pass_speed(thread.lead_along(self.drives.interpolator.commanded()))
    }

    fn check_pass_speed(&self, lead: f64) -> Result<(), Alarm> {
        let most = self
            .drives
            .board
            .map_or(f64::INFINITY, |board| board.pass_speed);
        let speed = lead * self.thread_rpm();
        if speed > most {
            return Err(
                Alarm::new(number::BOARD_CANNOT).because(say::pass_speed_too_high(speed, most))
            );
        }
        Ok(())
    }

    /// What goes on from a pass is no pass.
    pub(crate) fn refuse_ahead(&self, next: &ThreadMove) -> Option<Alarm> {
        let beyond = if next.run_out {
            BeyondPass::RunOut
        } else {
            BeyondPass::GoesOn
        };
        self.board_cuts().then(|| refuse(beyond))
    }

    /// Begins a thread that the board cuts. The play of the screws is made up for
    /// before it.
    pub(crate) fn ask_pass(&mut self, thread: &ThreadMove) {
        let way = thread.to - self.drives.interpolator.position();
        self.drives.interpolator.start_driven(thread.to);
        self.drives.chain.lean(way);
    }

    /// The pass that waits for the board.
    pub(crate) fn pass_waiting(&self) -> Option<ThreadPass> {
        let to = self.drives.interpolator.waits_for_drives()?;
        let current = self.run.automatic.current.as_ref()?;
        let thread = ThreadMove::of(&current.command.action)?;
        if self.drives.chain.is_settling() {
            return None;
        }
        let mut at_end = self.drives.chain.clone();
        at_end.advance(to, PerAxis::default());
        Some(ThreadPass {
            from: self.drives.chain.pulses(),
            end: at_end.pulses(),
            lead: thread.lead_along(self.drives.interpolator.position()),
        })
    }

    /// The board has taken the pass.
    pub(crate) const fn begin_pass(&mut self) {
        self.drives.interpolator.begin_driven();
    }

    /// The board has made this part of its pass.
    pub(crate) fn pass_progress(&mut self, share: f64) {
        self.drives.interpolator.driven_progress(share);
    }

    /// The board stands at the end of its pass.
    pub(crate) fn end_pass(&mut self, end: PerAxis<Pulses>) {
        if self.drives.interpolator.end_driven() {
            let locked = self.plc.signals.machine_lock;
            self.drives.chain.advance(self.position(), locked);
            if self.drives.chain.pulses() == end {
                return;
            }
        }
        // Something else became of it here meanwhile; the slides are there.
        self.stand_at(end);
    }
}
