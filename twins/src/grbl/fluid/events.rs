//! What FluidNC's main task does at an event: a reset, a hold, an alarm, an edge of an
//! input.

use super::super::{GrblTwin, State};
use super::MS;

/// How long every alarm keeps the main task.
const ALARM_NS: u64 = 500 * MS;
/// Events that find room.
const EVENTS: usize = 50;

/// What waits for the main task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    Start,
    Restart,
    Reset,
    Hold,
    Resume,
    Macro,
    Alarm(u8),
    /// A limit switch, 0 X, 1 Z: operated, or let go.
    Limit(usize, bool),
    /// The emergency stop input.
    Emergency(bool),
    /// An alarm only a reset ends has had its half second.
    ResetToContinue,
    /// The second half of a reset in motion, behind its alarm.
    Cease,
}

impl GrblTwin {
    pub(super) fn put(&mut self, event: Event) {
        if self.fluid.events.len() < EVENTS {
            self.fluid.events.push_back(event);
        }
    }

    pub(super) fn handle_events(&mut self) {
        while self.now >= self.fluid.blocked_until {
            let Some(event) = self.fluid.events.pop_front() else {
                return;
            };
            match event {
                Event::Start => self.start(),
                Event::Restart => self.restart(),
                Event::Reset => self.fluid_reset(),
                Event::Hold => self.fluid_hold(),
                Event::Resume => self.fluid_resume(),
                Event::Macro => self.macros_run += 1,
                Event::Alarm(number) => self.alarm(number),
                Event::Limit(axis, operated) => self.limit(axis, operated),
                Event::Emergency(operated) => self.emergency(operated),
                Event::ResetToContinue => self.say("[MSG:ERR: Reset to continue]\r\n"),
                Event::Cease => self.cease(),
            }
        }
    }

    /// The first event after power-on.
    fn start(&mut self) {
        let pins = self.pin_letters();
        if !pins.is_empty() {
            self.say(&format!(
                "[MSG:WARN: Input pin(s) active on startup:{pins}]\r\n"
            ));
        }
        self.put(Event::Restart);
        self.state = State::Critical;
        self.forget_homing();
        if self.fluid.unhomed == [false; 2] {
            self.state = State::Idle;
        } else {
            self.put(Event::Alarm(14));
        }
    }

    /// Everything read and planned is gone; the place stays.
    fn restart(&mut self) {
        self.received.clear();
        self.fluid.looked_at.clear();
        self.fluid.after_cr = false;
        self.fluid.brakes = false;
        self.fluid.astray = [0; 3];
        self.fluid.cycle = None;
        self.reports = 0;
        self.forget_work();
        self.say(self.variant.banner());
    }

    fn fluid_reset(&mut self) {
        self.resets += 1;
        let unhomed = self.fluid.unhomed != [false; 2];
        let alarm = match self.state {
            State::Home => {
                self.fluid.cycle = None;
                self.put(Event::Alarm(6));
                None
            }
            _ if self.state == State::Run || self.fluid.brakes => Some(3),
            State::Critical if unhomed => Some(14),
            State::Alarm => None,
            _ => {
                self.state = State::Idle;
                None
            }
        };
        let Some(alarm) = alarm else {
            return self.cease();
        };
        self.alarm(alarm);
        self.fluid.events.push_front(Event::Cease);
    }

    /// Outputs off; the line under way ends without an answer.
    fn cease(&mut self) {
        self.spindle = 5;
        self.coolant = false;
        self.waiting = None;
        self.answers_at = None;
        self.fluid.command = None;
        self.fluid.homes = false;
        self.put(Event::Restart);
    }

    fn fluid_hold(&mut self) {
        match self.state {
            State::Alarm | State::Check | State::Starting | State::Hold { .. } => {}
            State::Home => self.say("[MSG:INFO: No hold while homing]\r\n"),
            State::Idle => self.state = State::Hold { complete: true },
            State::Run => {
                self.state = State::Hold { complete: false };
                self.fluid.brakes = true;
            }
            // It leaves the state a reset alone should end, and holds nothing.
            State::Critical => self.state = State::Hold { complete: false },
        }
    }

    fn fluid_resume(&mut self) {
        if self.state == (State::Hold { complete: true }) {
            self.state = if self.planner.is_empty() {
                State::Idle
            } else {
                State::Run
            };
        }
    }

    pub(in super::super) fn put_alarm(&mut self, number: u8) {
        self.put(Event::Alarm(number));
    }

    fn alarm(&mut self, number: u8) {
        if self.is_set("10V/off_on_alarm") {
            self.spindle = 5;
            self.modal.spindle = 5;
        }
        let critical = matches!(number, 1 | 2 | 13);
        if matches!(number, 1 | 13) {
            self.forget_homing();
        }
        self.state = if critical {
            State::Critical
        } else {
            State::Alarm
        };
        let name = alarm_name(number);
        self.say(&format!("[MSG:INFO: ALARM: {name}]\r\nALARM:{number}\r\n"));
        self.fluid.blocked_until = self.now + ALARM_NS;
        if critical {
            self.fluid.events.push_front(Event::ResetToContinue);
        }
    }

    /// No axis is homed any more, where the configuration asks for it.
    fn forget_homing(&mut self) {
        if self.is_set("start/must_home") {
            self.fluid.unhomed = self.fluid.start.homing;
        }
    }

    fn limit(&mut self, axis: usize, operated: bool) {
        self.fluid.seen[axis] = operated;
        if !operated {
            self.fluid.limited[axis] = false;
            return;
        }
        let letter = ["x", "z"][axis];
        let hard = self.is_set(&format!("axes/{letter}/motor0/hard_limits"));
        match self.state {
            State::Home => return self.limit_while_homing(axis),
            _ if hard => self.fluid.limited[axis] = true,
            _ => {}
        }
        let acts = matches!(self.state, State::Run | State::Idle | State::Hold { .. });
        // At the start a switch is an alarm whether it is a hard limit or not.
        if self.state == State::Starting {
            self.put(Event::Alarm(1));
        } else if hard && acts {
            self.planner.halt();
            self.alarm(1);
        }
    }

    fn emergency(&mut self, operated: bool) {
        self.fluid.seen[2] = operated;
        if !operated {
            return;
        }
        let acts = !matches!(self.state, State::Alarm | State::Critical | State::Check);
        if self.state == State::Starting {
            self.put(Event::Alarm(11));
        } else {
            self.say("[MSG:INFO: Stopped by estop_pin]\r\n");
            if acts {
                self.planner.halt();
                self.fluid.cycle = None;
                self.alarm(13);
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
