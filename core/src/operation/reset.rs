//! RESET, emergency stop and the raising of alarms (manual III-2.3, III-2.4).

use super::active_alarms::EMERGENCY_STOP;
use super::automatic::RunState;
use crate::alarm::{Alarm, AlarmClass};
use crate::cnc::{Cnc, Event};
use crate::units::PerAxis;

/// RST stands at least this long, so that a whole cycle of level 2 sees it.
const LEVEL_2_CYCLE_MS: u32 = 32;

impl Cnc {
    /// Whether the reset signal RST stands.
    pub(crate) const fn resetting(&self) -> bool {
        self.reset_left > 0
    }

    /// AL: an alarm or a PLC message stands.
    pub(crate) fn alarm_state(&self) -> bool {
        !self.alarms.is_empty() || self.plc_message
    }

    /// Raises an alarm. A running program stops: the axes decelerate and the rest
    /// of the block is dropped.
    pub(crate) fn raise(&mut self, alarm: Alarm) {
        if !self.alarms.raise(alarm.clone()) {
            return;
        }
        self.events.push(Event::AlarmRaised(alarm));
        if self.automatic.operating() {
            self.stop_run(RunState::Stop);
        }
    }

    /// Ends the run: the axes decelerate, nothing that was read is carried out.
    pub(crate) fn stop_run(&mut self, state: RunState) {
        self.abandon_current();
        self.abandon_returns();
        self.interpolator.decelerate();
        self.held = None;
        // The next start begins at the block where this run broke off.
        if let Some(source) = self.automatic.broken_off() {
            self.cursor_line = source.line;
        }
        self.automatic.clear();
        self.automatic.state = state;
    }

    /// RESET key, external reset, or the end of an emergency stop.
    pub(crate) fn reset(&mut self) {
        self.stop_run(RunState::Reset);
        self.handshake.reset();
        self.spindle.abandon_gear_change();
        self.alarms.reset();
        if !self.emergency_stop {
            // A board tells of a chain that opened too shortly to be seen here.
            self.alarms.remove(EMERGENCY_STOP);
        }
        self.mdi.clear();
        self.programmed_ahead = 0.0;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.reset(&world);
        if !self.parameters.reset_keeps_offset() {
            self.tool.1 = 0;
        }
        self.frame = self.interpreter.frame();
        self.modal = *self.interpreter.modal();
        if self.mode == super::Mode::Edit {
            self.cursor_line = 1;
        }
    }

    /// Watches the causes of reset and the emergency stop; once a millisecond.
    pub(crate) fn watch_reset(&mut self, contacts_closed: bool) {
        let emergency = !contacts_closed || self.from_plc.emergency_stop;
        if emergency {
            if !self.emergency_stop {
                self.emergency_stop = true;
                self.interpolator.stop_now();
                self.reset();
                self.raise(Alarm::new(EMERGENCY_STOP));
                // Methods B and C lose their reference with the pulses.
                self.referenced = self.reference_without_switch();
                self.at_reference = PerAxis::default();
            }
        } else if self.emergency_stop {
            self.emergency_stop = false;
            self.alarms.remove(EMERGENCY_STOP);
        }

        let key = self.filter.accepted()[26] & 1 != 0;
        if emergency || key || self.from_plc.external_reset {
            if self.reset_left == 0 && !emergency {
                self.reset();
            }
            self.reset_left = self.parameters.reset_time_ms().max(LEVEL_2_CYCLE_MS);
        } else {
            self.reset_left = self.reset_left.saturating_sub(1);
        }
    }

    /// 准备未绪: emergency stop or a drive that is not ready.
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
    fn an_emergency_stop_too_short_to_be_seen_is_told_until_reset() {
        let mut simulation = Simulation::new(Setup::default());
        let run = |simulation: &mut Simulation, reset| {
            let key = BitAddress::new(Area::X, 26, 0);
            simulation.cnc.set_panel_key(key, reset);
            for _ in 0..100 {
                simulation.tick();
            }
            simulation.cnc.alarms.contains(EMERGENCY_STOP)
        };
        assert!(!run(&mut simulation, false));
        simulation.cnc.raise(Alarm::new(EMERGENCY_STOP));
        assert!(run(&mut simulation, false));
        assert!(!run(&mut simulation, true));
    }
}
