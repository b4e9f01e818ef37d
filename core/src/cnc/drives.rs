//! Checks the alarm and ready signals of the drives (manual III-12.3, IV-2.1.3).

use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::machine::Inputs;
use crate::units::{Axis, PerAxis};

/// Time in which the ready signal of a drive must follow its enable, ms.
const FOLLOWS_WITHIN_MS: u16 = 100;

/// State of a drive according to its signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Said {
    Well,
    NotReady,
    Alarm,
}

impl Cnc {
    /// Checks the drives after their signals were read; once per tick. In an alarm all axes
    /// stop at once; RESET clears it when the drive is healthy again.
    pub(crate) fn watch_drives(&mut self, inputs: &Inputs) {
        let well = self.drives_are_well(inputs);
        self.drives.watch.ready = well && !self.emergency_stop;
        if well {
            self.drives.watch.disagree = PerAxis::default();
            return;
        }
        let x = self.drive_says(Axis::X, inputs);
        let z = self.drive_says(Axis::Z, inputs);
        let number = match (x, z) {
            (Said::Well, Said::Well) => return,
            (Said::Alarm, Said::Alarm) => number::DRIVES_ALARM,
            (Said::Alarm, _) => number::X_DRIVE_ALARM,
            (_, Said::Alarm) => number::Z_DRIVE_ALARM,
            (Said::NotReady, Said::NotReady) => number::DRIVES_NOT_READY,
            (Said::NotReady, Said::Well) => number::X_DRIVE_NOT_READY,
            (Said::Well, Said::NotReady) => number::Z_DRIVE_NOT_READY,
        };
        if !self.alarms.contains(number) {
            let failed = [(Axis::X, x), (Axis::Z, z)].into_iter();
            let unmet = failed
                .filter(|(_, said)| *said != Said::Well)
                .find_map(|(axis, _)| self.unmet_switch(axis));
            self.drives.interpolator.stop_now();
            self.leave_zero_points();
            self.raise(Alarm {
                detail: unmet,
                ..Alarm::new(number)
            });
        }
    }

    /// Whether no drive has an alarm, and all ready lines follow their enable.
    fn drives_are_well(&self, inputs: &Inputs) -> bool {
        let well = self.drives.sensors.drive_well;
        let level = self.memory.parameters.drive_ready_level();
        let follows = |ready: bool| (ready == level) != self.emergency_stop;
        let ready = inputs.drive_ready;
        well.x && well.z && (self.drives.board.is_some() || follows(ready.x) && follows(ready.z))
    }

    fn drive_says(&mut self, axis: Axis, inputs: &Inputs) -> Said {
        let parameters = &self.memory.parameters;
        let alarm = !*self.drives.sensors.drive_well.get(axis);
        let ready = *inputs.drive_ready.get(axis) == parameters.drive_ready_level();
        let enabled = !self.emergency_stop;
        // A pulse board has no ready lines; it reports its drives' alarms.
        let told = self.drives.board.is_none();
        let disagree = self.drives.watch.disagree.get_mut(axis);
        if ready == enabled || !told {
            *disagree = 0;
            return if alarm { Said::Alarm } else { Said::Well };
        }
        *disagree = disagree.saturating_add(1);
        let disagrees = *disagree > FOLLOWS_WITHIN_MS;
        if alarm || disagrees && ready && !parameters.drive_may_be_early() {
            Said::Alarm
        } else if disagrees && enabled {
            Said::NotReady
        } else {
            Said::Well
        }
    }
}
