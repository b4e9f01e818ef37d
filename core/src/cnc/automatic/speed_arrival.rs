//! Spindle speed arrival (manual PLC-I 9.4): with 175.6 = 1 the first cut after a rapid or an S
//! function begins only when the ladder's SAR (G29.4) is 1. The control checks SAR after the time
//! of parameter 072 from reading the cut, so that the ladder has seen the new speed.
//!
//! ```text
//!  S, rapid ──► cut read ──── 072 ────► SAR = 0: waits ... SAR = 1: the cut begins
//! ```

use crate::cnc::Cnc;
use crate::command::Action;
use crate::operation::SpeedArrival;

impl Cnc {
    /// Updates the check of the spindle speed when a command begins: after a rapid or an S
    /// function the next cut must wait for SAR.
    pub(crate) fn update_speed_arrival(&mut self, action: &Action) {
        let arrival = &mut self.run.automatic.arrival;
        match action {
            Action::Rapid { .. } | Action::Spindle(_) => *arrival = SpeedArrival::Due,
            Action::Line { .. }
            | Action::Arc { .. }
            | Action::Thread { .. }
            | Action::Tap { .. }
                if *arrival == SpeedArrival::Due =>
            {
                let needs_check =
                    self.memory.parameters.awaits_speed() && !self.plc.signals.dry_run;
                *arrival = if needs_check {
                    SpeedArrival::Awaited(self.memory.parameters.speed_arrival_delay_ms())
                } else {
                    SpeedArrival::Seen
                };
            }
            _ => {}
        }
    }
}
