//! Messages for the operator that name what a running program waits for.

use crate::cnc::Cnc;
use crate::command::Action;
use crate::operation::{RunState, Strobe, ZeroReturnStage};
use crate::units::{Axis, Feed};
use gsk_messages::{Message, say};

impl Cnc {
    /// Returns the message about the condition for which the running program waits; `None` if it
    /// does not wait, or no program runs.
    pub fn wait_reason(&self) -> Option<Message> {
        match self.run.automatic.state {
            RunState::Reset | RunState::Stop => None,
            RunState::Hold => {
                let held = match self.plc.signals.feed_hold {
                    true => say::wait_in_feed_hold(),
                    false => say::wait_for_cycle_start(),
                };
                Some(match self.fin_wait() {
                    Some(fin) => say::wait_held_in_function(fin, held),
                    None => held,
                })
            }
            RunState::Run => self
                .interlock_wait()
                .or_else(|| self.fin_wait())
                .or_else(|| self.motion_wait()),
        }
    }

    /// Message that names the signal that locks the motion of the program; `None` without a
    /// lock.
    fn interlock_wait(&self) -> Option<Message> {
        let g = &self.plc.signals;
        if !self.is_run_interlocked() {
            return None;
        }
        let lock = if g.start_lock {
            say::wait_in_start_lock()
        } else if g.interlock {
            say::wait_in_interlock()
        } else if self.spindle.control.is_changing_gear() {
            self.gear_wait()
        } else if self.run.automatic.arrival.is_waiting(g.speed_arrival) {
            say::wait_for_spindle_speed()
        } else if self.has_brake_interlock() {
            say::wait_for_brake()
        } else {
            say::wait_in_axis_interlock(self.locked_axis()?)
        };
        Some(lock)
    }

    fn locked_axis(&self) -> Option<Axis> {
        let commanded = self.drives.interpolator.distance_to_go();
        [Axis::X, Axis::Z]
            .into_iter()
            .find(|axis| self.is_commanded_and_locked(*axis, commanded))
    }

    /// Message that names the M, S or T function that waits for FIN, and why the ladder
    /// withholds FIN; `None` without one.
    fn fin_wait(&self) -> Option<Message> {
        let (strobe, code) = self.run.handshake.unanswered_strobe()?;
        if self.is_moving() || self.run.automatic.is_dwelling() {
            return None;
        }
        let fin = match strobe {
            Strobe::M => say::wait_for_fin_of_m(code),
            Strobe::S => say::wait_for_fin_of_s(code),
            Strobe::T => say::wait_for_fin_of_t(code),
        };
        Some(match (strobe, code) {
            (Strobe::M, 12 | 13)
                if self.memory.parameters.has_chuck() && self.memory.parameters.watches_chuck() =>
            {
                say::wait_for_chuck(fin)
            }
            (Strobe::M, 41..=44) => self.gear_wait(),
            (Strobe::T, _) => say::wait_for_tool_post(fin),
            _ => fin,
        })
    }

    fn gear_wait(&self) -> Message {
        if self.memory.parameters.watches_gear() {
            say::wait_for_gear_input()
        } else {
            say::wait_for_gear()
        }
    }

    /// Returns the message about the condition for which a motion without progress waits; `None`
    /// without such a wait.
    fn motion_wait(&self) -> Option<Message> {
        for axis in [Axis::X, Axis::Z] {
            match self.coordinates.returns.get(axis) {
                Some(ZeroReturnStage::Approach | ZeroReturnStage::Back) => {
                    return Some(say::wait_for_zero_switch(axis));
                }
                Some(ZeroReturnStage::OnSwitch) => {
                    return Some(say::wait_for_zero_switch_end(axis));
                }
                Some(ZeroReturnStage::Search) => return Some(say::wait_for_zero_signal(axis)),
                _ => {}
            }
        }
        if let Some(Action::InputWait { input, high }) = self.run.automatic.current_action() {
            return Some(match high {
                true => say::wait_for_input_high(*input),
                false => say::wait_for_input_low(*input),
            });
        }
        if let Some((wanted, _)) = self.restart_speed_wait() {
            return Some(say::wait_for_restart_speed(wanted));
        }
        if self.drives.interpolator.is_finished() || self.is_moving() {
            return None;
        }
        let stands_still = self.spindle.control.actual_rpm().abs() < 1.0;
        let needs_spindle = match self.run.automatic.current_action()? {
            Action::Line { feed, .. } | Action::Arc { feed, .. } => {
                if matches!(feed, Feed::PerRevolution(_)) && stands_still {
                    true
                } else if self.plc.signals.feed_override == 0 {
                    return Some(say::wait_for_feed_override());
                } else {
                    return None;
                }
            }
            Action::Thread { .. } | Action::Tap { .. } => stands_still,
            _ => false,
        };
        needs_spindle.then(say::wait_for_spindle)
    }
}
