//! RESET, emergency stop and the raising of alarms (manual III-2.3, III-2.4).

use crate::alarm::{Alarm, AlarmClass, number};
use crate::cnc::{Cnc, Event};
use crate::machine::MachineInputs;
use crate::memory::SwitchedOff;
use crate::operation::RunState;

/// Minimum duration of the reset signal RST, ms, so that each rung of level 2 of the ladder sees
/// it.
const LEVEL_2_CYCLE_MS: u32 = 32;

impl Cnc {
    /// Whether the reset signal RST of the control is active.
    pub(crate) const fn is_resetting(&self) -> bool {
        self.reset_left_ms > 0
    }

    /// Signal AL: whether an alarm or a PLC message is active.
    pub(crate) fn is_alarm_active(&self) -> bool {
        !self.alarms.is_empty() || self.plc.message
    }

    /// Raises an alarm. A running program stops: the axes decelerate and the rest of the
    /// block is dropped.
    pub(crate) fn raise(&mut self, alarm: Alarm) {
        let alarm = alarm.with_model(self.memory.model.record());
        if !self.alarms.raise(alarm.clone()) {
            return;
        }
        self.events.push(Event::AlarmRaised(alarm));
        if self.run.automatic.is_operating() {
            self.stop_run(RunState::Stop);
        }
    }

    /// Ends the run, which then has the state `state`: the axes decelerate, and commands that were
    /// read are not executed.
    pub(crate) fn stop_run(&mut self, state: RunState) {
        self.end_retrace();
        self.abandon_current();
        self.abandon_returns();
        self.drives.interpolator.decelerate();
        self.run.held_motion = None;
        // The next start begins at the block where this run was interrupted.
        if let Some(source) = self.run.automatic.interrupted_source() {
            self.run.cursor_line = source.line;
        }
        self.run.automatic.clear();
        self.run.automatic.state = state;
    }

    /// Resets the control: for the RESET key, an external reset, or the start of an
    /// emergency stop.
    pub(crate) fn reset(&mut self) {
        self.stop_run(RunState::Reset);
        self.run.handshake.reset();
        self.spindle.control.abandon_gear_change();
        let outside = self.overtravel_alarms();
        self.alarms.reset(|number| outside.contains(&Some(number)));
        if !self.emergency_stop {
            // A board reports an open chain that was too short to be seen here.
            self.alarms.remove(number::EMERGENCY_STOP);
        }
        self.run.registers.off = SwitchedOff::default();
        self.run.mdi.clear();
        self.coordinates.programmed_x_lead = 0.0;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.reset(&world);
        if !self.memory.parameters.reset_keeps_offset() {
            self.run.tool.1 = 0;
        }
        self.coordinates.frame = self.run.interpreter.frame();
        self.run.modal = *self.run.interpreter.modal();
        if self.run.mode == crate::operation::OperatingMode::Edit {
            self.run.cursor_line = 1;
        }
    }

    /// Checks the causes of a reset and the emergency stop, once per tick.
    /// `contacts_closed`: the emergency-stop loop is closed.
    pub(crate) fn check_reset(&mut self, contacts_closed: bool, inputs: &MachineInputs) {
        let emergency = !contacts_closed || self.plc.signals.emergency_stop;
        if emergency {
            if !self.emergency_stop {
                self.emergency_stop = true;
                let detail = self.tripped_limit_detail(inputs);
                self.forget_made_path();
                self.drives.interpolator.stop_now();
                self.reset();
                self.raise(Alarm {
                    detail,
                    ..Alarm::new(number::EMERGENCY_STOP)
                });
                // Methods B and C lose their reference together with the pulses.
                self.coordinates.referenced = self.reference_without_switch();
                self.leave_zero_points();
            }
        } else if self.emergency_stop {
            self.emergency_stop = false;
            self.alarms.remove(number::EMERGENCY_STOP);
        }

        let key = self.plc.filter.accepted()[26] & 1 != 0;
        if emergency || key || self.plc.signals.external_reset {
            if self.reset_left_ms == 0 && !emergency {
                self.reset();
            }
            self.reset_left_ms = self.memory.parameters.reset_time_ms().max(LEVEL_2_CYCLE_MS);
        } else {
            self.reset_left_ms = self.reset_left_ms.saturating_sub(1);
        }
    }

    /// Whether the control is not ready (准备未绪): the emergency stop or an alarm of a drive is
    /// active.
    pub(crate) fn is_not_ready(&self) -> bool {
        self.alarms
            .list()
            .iter()
            .any(|alarm| matches!(alarm.class(), AlarmClass::EmergencyStop | AlarmClass::Servo))
    }
}

#[cfg(test)]
mod tests {
    use gsk_plc::address::{Area, BitAddress};

    use super::*;
    use crate::setup::Setup;
    use crate::simulation::Simulation;

    #[test]
    fn an_unseen_emergency_stop_stays_until_reset() {
        let mut simulation = Simulation::new(Setup::default());
        let run = |simulation: &mut Simulation, reset| {
            let key = BitAddress::new(Area::X, 26, 0);
            simulation.cnc.set_panel_key(key, reset);
            for _ in 0..100 {
                simulation.tick();
            }
            simulation.cnc.alarms.contains(number::EMERGENCY_STOP)
        };
        assert!(!run(&mut simulation, false));
        simulation.cnc.raise(Alarm::new(number::EMERGENCY_STOP));
        assert!(run(&mut simulation, false));
        assert!(!run(&mut simulation, true));
    }
}
