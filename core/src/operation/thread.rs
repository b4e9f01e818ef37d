//! Threads and tapping: their protection against feed hold and single block, and the checks
//! of the spindle (manual I-3.2.4, PLC-I «feed hold», «rigid tapping»).

use super::automatic::CurrentCommand;
use super::thread_state::HoldProtection;
use crate::alarm::{Alarm, number};
use crate::command::{Action, ControlCommand, ThreadStart};
use crate::motion::MotionLimits;
use crate::run_state::RunState;
use crate::spindle::Encoder;
use crate::units::{Axis, Point};
use gsk_messages::say;

/// Below this speed the spindle counts as stopped, r/min.
pub(crate) const STANDSTILL_RPM: f64 = 1.0;

/// How the run continues after a finished command of a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AfterThread {
    /// The run continues with the next command.
    Continue,
    /// The run holds, because feed hold was requested in the thread.
    Hold,
    /// The run stops because single block is on.
    Stop,
}

impl super::automatic::AutomaticRun {
    /// Whether motion continues although feed hold is requested.
    pub(crate) fn is_hold_protected(&self) -> bool {
        let defers_hold = |current: &CurrentCommand| current.command.defers_feed_hold;
        self.protection != HoldProtection::None || self.current.as_ref().is_some_and(defers_hold)
    }

    /// Whether a thread or tap is being executed.
    pub(crate) fn is_threading(&self) -> bool {
        matches!(
            self.current_action(),
            Some(Action::Thread { .. } | Action::Tap { .. })
        )
    }

    /// Whether the command that was read ahead is a thread that continues in phase.
    pub(crate) fn continues_thread(&self) -> bool {
        matches!(
            self.next_command.as_ref().map(|command| &command.action),
            Some(Action::Thread {
                start: ThreadStart::Continued,
                ..
            })
        )
    }

    /// Whether the next command may begin in the present state.
    pub(crate) fn can_begin_command(&self) -> bool {
        match self.state {
            RunState::Run => true,
            RunState::Hold => match self.protection {
                HoldProtection::None => false,
                HoldProtection::Thread => true,
                HoldProtection::After { .. } => self.within_block,
            },
            RunState::Reset | RunState::Stop => false,
        }
    }

    /// Updates the protection against feed hold when a command begins.
    pub(crate) fn update_protection(&mut self, action: &Action) {
        if !self.within_block {
            self.tap_reverse = 0;
        }
        self.watch.rpm = None;
        self.watch.ticks = 0;
        self.watch.waited_ticks = 0;
        // A programmed stop is expected.
        if matches!(
            action,
            Action::Miscellaneous { code: 5 } | Action::End { .. }
        ) {
            self.watch.has_turned = false;
        }
        self.protection = match action {
            Action::Thread { .. } | Action::Tap { .. } => HoldProtection::Thread,
            _ if self.state == RunState::Hold && self.protection != HoldProtection::None => {
                match self.protection {
                    HoldProtection::After { again } => HoldProtection::After { again },
                    _ => HoldProtection::After {
                        again: !self.within_block,
                    },
                }
            }
            _ => HoldProtection::None,
        };
    }

    /// Decides how the run continues after a finished command of a thread. `single_block`: whether
    /// single block would stop the run at this point. `None`: the rules of other commands apply.
    pub(crate) fn after_thread(
        &self,
        command: &ControlCommand,
        single_block: bool,
    ) -> Option<AfterThread> {
        let held = self.state == RunState::Hold;
        match (&command.action, self.protection) {
            // Single block stops between the moves of a cycle, but never within a thread
            // block.
            (Action::Thread { .. }, _) => {
                let stops = !held && !command.block_end && single_block;
                Some(if stops && !self.continues_thread() {
                    AfterThread::Stop
                } else {
                    AfterThread::Continue
                })
            }
            (
                Action::Rapid { .. } | Action::Line { .. },
                HoldProtection::After { again: false },
            ) => Some(match held {
                true if single_block => AfterThread::Stop,
                true => AfterThread::Hold,
                false => AfterThread::Continue,
            }),
            _ => None,
        }
    }
}

/// Returns alarm 092 as error if the encoder has less than 100 or more than 5000 lines
/// (070).
pub(crate) fn check_encoder(parameters: &crate::memory::ControlParameters) -> Result<(), Alarm> {
    if Encoder::counts_per_turn(parameters).is_some() {
        return Ok(());
    }
    let lines = parameters.encoder_lines();
    Err(Alarm::new(number::ENCODER_LINES).with_detail(say::encoder_lines_out_of_range(lines)))
}

/// Returns alarm 094 as error if the spindle stands still at a thread.
pub(crate) fn check_spindle_turns(rpm: f64) -> Result<(), Alarm> {
    if rpm.abs() < STANDSTILL_RPM {
        return Err(Alarm::new(number::THREAD_SPEED).with_detail(say::thread_spindle_stands()));
    }
    Ok(())
}

/// Returns alarm 094 as error if an axis cannot follow the spindle (022, 023, 027).
/// `top` is the highest speed of each axis, mm/min.
pub(crate) fn check_thread_speed(top: Point, rpm: f64, limits: &MotionLimits) -> Result<(), Alarm> {
    for axis in [Axis::X, Axis::Z] {
        let (limit, parameter) = limits.thread_limit(axis);
        let speed = top.get(axis);
        if speed > limit {
            let why = say::thread_axis_too_fast(axis, speed, rpm.abs(), limit, parameter);
            return Err(Alarm::new(number::THREAD_SPEED).with_detail(why));
        }
    }
    Ok(())
}
