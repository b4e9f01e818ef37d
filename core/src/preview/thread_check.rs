//! Cautions about threads: run-in, constant surface speed, a speed that changes between passes.
//!
//! ```text
//!        start o-----------------> end       the axis reaches the speed of the
//!              |<-needed->|                  thread after this length
//!              |<-run-in->|####### thread
//!                         Z0
//! ```

use super::PreviewRun;
use super::caution::CautionKind;
use super::certainty::ProgramFacts;
use crate::command::{ControlCommand, ThreadStart};
use crate::motion::ThreadMove;
use crate::units::Axis;

/// Length of the run-in over speed times the time constant 029 (manual I-3.2.7, tables 3-10 and
/// 3-11).
const RUN_IN_FACTOR: f64 = 0.52;

/// Shorter run-ins than this share of the needed one are reported: the tables are rounded.
const RUN_IN_TOLERANCE: f64 = 0.98;

/// What two passes of one thread have in common, and their speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ThreadPass {
    /// Start and end in Z and the lead, in whole thousandths of a millimetre.
    thread: [i64; 3],
    /// The S word in force.
    speed: f64,
}

impl PreviewRun<'_> {
    /// Adds cautions about a pass of a thread at `rpm`, r/min, before it is executed.
    pub(super) fn check_thread_pass(
        &mut self,
        command: &ControlCommand,
        thread: &ThreadMove,
        rpm: f64,
    ) {
        if !matches!(thread.start, ThreadStart::AtIndex { .. }) || thread.run_out {
            return;
        }
        let source = command.source;
        let facts = ProgramFacts::MOTION
            .union(ProgramFacts::LEAD)
            .union(ProgramFacts::Z);
        if !self.is_certain(facts.union(ProgramFacts::SPINDLE_SPEED)) {
            return;
        }
        if command.modal.surface_speed {
            let rpm = libm::round(rpm.clamp(1.0, 99_999.0)) as u32;
            self.add_caution(CautionKind::ThreadSurfaceSpeed { rpm }, source);
        }
        if thread.lead_axis != Axis::Z {
            return;
        }
        let frame = self.preview.frame;
        let from = frame.to_program(self.preview.machine).z;
        let to = frame.to_program(thread.to).z;
        let needed = RUN_IN_FACTOR * thread.lead.abs() * rpm / 60.0
            * self.preview.parameters.feed_time()
            / 1000.0;
        // The face of the part is assumed at Z0; a thread that begins elsewhere has an unknown
        // run-in.
        if from > 0.0 && to < 0.0 && from < needed * RUN_IN_TOLERANCE {
            let kind = CautionKind::ThreadRunIn {
                programmed: from,
                needed,
            };
            self.add_caution(kind, source);
        }
        let thousandths = |mm: f64| libm::round(mm * 1000.0) as i64;
        let pass = ThreadPass {
            thread: [from, to, thread.lead].map(thousandths),
            speed: command.modal.spindle,
        };
        if let Some(before) = self.last_pass.replace(pass)
            && before.thread == pass.thread
            && before.speed != pass.speed
        {
            let kind = CautionKind::ThreadSpeedChanged {
                before: before.speed,
                now: pass.speed,
            };
            self.add_caution(kind, source);
        }
    }
}
