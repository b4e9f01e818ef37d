//! Checks the alarm and ready signals of the drives (manual III-12.3, IV-2.1.3).

use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::machine::MachineInputs;
use crate::units::{Axis, PerAxis};

/// Time within which the ready signal of a drive must follow its enable, ms.
const READY_DELAY_MS: u16 = 100;

/// State of a drive according to its signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DriveState {
    Healthy,
    NotReady,
    Alarm,
}

impl Cnc {
    /// Checks the drives once per tick, after their signals were read. An alarm stops all
    /// axes at once; RESET clears the alarm when the drive is healthy again.
    pub(crate) fn check_drives(&mut self, inputs: &MachineInputs) {
        let is_healthy = self.are_drives_healthy(inputs);
        self.drives.watch.ready = is_healthy && !self.emergency_stop;
        if is_healthy {
            self.drives.watch.disagree_ms = PerAxis::default();
            return;
        }
        let x = self.drive_state(Axis::X, inputs);
        let z = self.drive_state(Axis::Z, inputs);
        let number = match (x, z) {
            (DriveState::Healthy, DriveState::Healthy) => return,
            (DriveState::Alarm, DriveState::Alarm) => number::DRIVES_ALARM,
            (DriveState::Alarm, _) => number::X_DRIVE_ALARM,
            (_, DriveState::Alarm) => number::Z_DRIVE_ALARM,
            (DriveState::NotReady, DriveState::NotReady) => number::DRIVES_NOT_READY,
            (DriveState::NotReady, DriveState::Healthy) => number::X_DRIVE_NOT_READY,
            (DriveState::Healthy, DriveState::NotReady) => number::Z_DRIVE_NOT_READY,
        };
        if !self.alarms.contains(number) {
            let failed = [(Axis::X, x), (Axis::Z, z)].into_iter();
            let missed_switch = failed
                .filter(|(_, state)| *state != DriveState::Healthy)
                .find_map(|(axis, _)| self.missed_switch_message(axis));
            self.drives.interpolator.stop_now();
            self.leave_zero_points();
            self.raise(Alarm {
                detail: missed_switch,
                ..Alarm::new(number)
            });
        }
    }

    /// Whether no drive has an alarm, and the ready lines agree with the enable.
    fn are_drives_healthy(&self, inputs: &MachineInputs) -> bool {
        let drive_ok = self.drives.sensors.drive_ok;
        let level = self.memory.parameters.drive_ready_level();
        let follows = |ready: bool| (ready == level) != self.emergency_stop;
        let ready = inputs.drive_ready;
        drive_ok.x
            && drive_ok.z
            && (self.drives.board.is_some() || follows(ready.x) && follows(ready.z))
    }

    fn drive_state(&mut self, axis: Axis, inputs: &MachineInputs) -> DriveState {
        let parameters = &self.memory.parameters;
        let alarm = !*self.drives.sensors.drive_ok.get(axis);
        let ready = *inputs.drive_ready.get(axis) == parameters.drive_ready_level();
        let enabled = !self.emergency_stop;
        // A pulse board has no ready lines; it reports its drives' alarms.
        let has_ready_line = self.drives.board.is_none();
        let disagree = self.drives.watch.disagree_ms.get_mut(axis);
        if ready == enabled || !has_ready_line {
            *disagree = 0;
            return if alarm {
                DriveState::Alarm
            } else {
                DriveState::Healthy
            };
        }
        *disagree = disagree.saturating_add(1);
        let disagrees = *disagree > READY_DELAY_MS;
        if alarm || disagrees && ready && !parameters.can_drive_be_early() {
            DriveState::Alarm
        } else if disagrees && enabled {
            DriveState::NotReady
        } else {
            DriveState::Healthy
        }
    }
}
