//! Handles the events of FluidNC's main task: resets, holds, alarms and input edges.

use super::super::{GrblState, GrblTwin};
use super::MS;

/// Time for which each alarm blocks the main task, ns.
const ALARM_DELAY_NS: u64 = 500 * MS;
/// Maximum number of events in the queue.
const MAX_EVENTS: usize = 50;

/// An event in the queue of FluidNC's main task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FluidEvent {
    Start,
    Restart,
    Reset,
    Hold,
    Resume,
    Macro,
    Alarm(u8),
    /// The limit switch of an axis (0 for X, 1 for Z) was operated (true) or released.
    Limit(usize, bool),
    /// The emergency stop was operated (`true`) or released (`false`).
    Emergency(bool),
    /// The delay of an alarm that needs a reset has elapsed.
    ResetToContinue,
    /// The second part of a reset during motion is due, after the alarm of that reset.
    FinishReset,
}

impl GrblTwin {
    pub(super) fn push_event(&mut self, event: FluidEvent) {
        if self.fluid.events.len() < MAX_EVENTS {
            self.fluid.events.push_back(event);
        }
    }

    pub(super) fn handle_events(&mut self) {
        while self.now >= self.fluid.blocked_until {
            let Some(event) = self.fluid.events.pop_front() else {
                return;
            };
            match event {
                FluidEvent::Start => self.handle_start(),
                FluidEvent::Restart => self.handle_restart(),
                FluidEvent::Reset => self.fluid_reset(),
                FluidEvent::Hold => self.fluid_hold(),
                FluidEvent::Resume => self.fluid_resume(),
                FluidEvent::Macro => self.macro_count += 1,
                FluidEvent::Alarm(number) => self.enter_alarm(number),
                FluidEvent::Limit(axis, operated) => self.handle_limit(axis, operated),
                FluidEvent::Emergency(operated) => self.handle_emergency(operated),
                FluidEvent::ResetToContinue => self.send_text("[MSG:ERR: Reset to continue]\r\n"),
                FluidEvent::FinishReset => self.finish_reset(),
            }
        }
    }

    /// Handles the start event after power-on: reports active input pins and queues a restart.
    fn handle_start(&mut self) {
        let pins = self.pin_letters();
        if !pins.is_empty() {
            self.send_text(&format!(
                "[MSG:WARN: Input pin(s) active on startup:{pins}]\r\n"
            ));
        }
        self.push_event(FluidEvent::Restart);
        self.state = GrblState::Critical;
        self.mark_unhomed();
        if self.fluid.unhomed == [false; 2] {
            self.state = GrblState::Idle;
        } else {
            self.push_event(FluidEvent::Alarm(14));
        }
    }

    /// Handles a restart: clears received lines and planned motion; the position remains.
    fn handle_restart(&mut self) {
        self.received.clear();
        self.fluid.polled_bytes.clear();
        self.fluid.after_cr = false;
        self.fluid.is_braking = false;
        self.fluid.planner_error = [0; 3];
        self.fluid.cycle = None;
        self.reports = 0;
        self.clear_work();
        self.send_text(self.variant.banner());
    }

    fn fluid_reset(&mut self) {
        self.reset_count += 1;
        let unhomed = self.fluid.unhomed != [false; 2];
        let alarm = match self.state {
            GrblState::Home => {
                self.fluid.cycle = None;
                self.push_event(FluidEvent::Alarm(6));
                None
            }
            _ if self.state == GrblState::Run || self.fluid.is_braking => Some(3),
            GrblState::Critical if unhomed => Some(14),
            GrblState::Alarm => None,
            _ => {
                self.state = GrblState::Idle;
                None
            }
        };
        let Some(alarm) = alarm else {
            return self.finish_reset();
        };
        self.enter_alarm(alarm);
        self.fluid.events.push_front(FluidEvent::FinishReset);
    }

    /// Switches the outputs off and ends the current line without an answer.
    fn finish_reset(&mut self) {
        self.spindle_code = 5;
        self.coolant = false;
        self.waiting_block = None;
        self.answer_at = None;
        self.fluid.command = None;
        self.fluid.is_homing = false;
        self.push_event(FluidEvent::Restart);
    }

    fn fluid_hold(&mut self) {
        match self.state {
            GrblState::Alarm | GrblState::Check | GrblState::Starting | GrblState::Hold { .. } => {}
            GrblState::Home => self.send_text("[MSG:INFO: No hold while homing]\r\n"),
            GrblState::Idle => self.state = GrblState::Hold { complete: true },
            GrblState::Run => {
                self.state = GrblState::Hold { complete: false };
                self.fluid.is_braking = true;
            }
            // A firmware bug: a hold leaves the state that only a reset should end.
            GrblState::Critical => self.state = GrblState::Hold { complete: false },
        }
    }

    fn fluid_resume(&mut self) {
        if self.state == (GrblState::Hold { complete: true }) {
            self.state = if self.planner.is_empty() {
                GrblState::Idle
            } else {
                GrblState::Run
            };
        }
    }

    pub(in super::super) fn push_alarm(&mut self, number: u8) {
        self.push_event(FluidEvent::Alarm(number));
    }

    fn enter_alarm(&mut self, number: u8) {
        if self.is_config_on("10V/off_on_alarm") {
            self.spindle_code = 5;
            self.modal.spindle_code = 5;
        }
        let critical = matches!(number, 1 | 2 | 13);
        if matches!(number, 1 | 13) {
            self.mark_unhomed();
        }
        self.state = if critical {
            GrblState::Critical
        } else {
            GrblState::Alarm
        };
        let name = alarm_name(number);
        self.send_text(&format!("[MSG:INFO: ALARM: {name}]\r\nALARM:{number}\r\n"));
        self.fluid.blocked_until = self.now + ALARM_DELAY_NS;
        if critical {
            self.fluid.events.push_front(FluidEvent::ResetToContinue);
        }
    }

    /// Marks all axes with homing as not homed if the configuration requires homing.
    fn mark_unhomed(&mut self) {
        if self.is_config_on("start/must_home") {
            self.fluid.unhomed = self.fluid.start.homing;
        }
    }

    fn handle_limit(&mut self, axis: usize, operated: bool) {
        self.fluid.known_inputs[axis] = operated;
        if !operated {
            self.fluid.blocked_motors[axis] = false;
            return;
        }
        let letter = ["x", "z"][axis];
        let hard = self.is_config_on(&format!("axes/{letter}/motor0/hard_limits"));
        match self.state {
            GrblState::Home => return self.stop_axis_at_switch(axis),
            _ if hard => self.fluid.blocked_motors[axis] = true,
            _ => {}
        }
        let acts = matches!(
            self.state,
            GrblState::Run | GrblState::Idle | GrblState::Hold { .. }
        );
        // At startup an operated switch is an alarm, even without hard limits.
        if self.state == GrblState::Starting {
            self.push_event(FluidEvent::Alarm(1));
        } else if hard && acts {
            self.planner.dead_stop();
            self.enter_alarm(1);
        }
    }

    fn handle_emergency(&mut self, operated: bool) {
        self.fluid.known_inputs[2] = operated;
        if !operated {
            return;
        }
        let acts = !matches!(
            self.state,
            GrblState::Alarm | GrblState::Critical | GrblState::Check
        );
        if self.state == GrblState::Starting {
            self.push_event(FluidEvent::Alarm(11));
        } else {
            self.send_text("[MSG:INFO: Stopped by estop_pin]\r\n");
            if acts {
                self.planner.dead_stop();
                self.fluid.cycle = None;
                self.enter_alarm(13);
            }
        }
    }
}

const fn alarm_name(number: u8) -> &'static str {
    match number {
        1 => "Hard Limit",
        2 => "Soft Limit",
        3 => "Abort Cycle",
        6 => "Homing Fail Reset",
        8 => "Homing Fail Pulloff",
        9 => "Homing Fail Approach",
        11 => "Input Pin Initially On",
        12 => "Ambiguous Switch",
        13 => "Hard Stop",
        14 => "Unhomed",
        _ => "Other",
    }
}
