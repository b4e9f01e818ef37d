//! The spindle whose one-turn signal the board measures, and the conditions for threads.
//!
//! ```text
//!  cycle ─► 20 steady turns? ─► feed in ─► wait for the index ─► thread ─► run-out ─► 091?
//!           no: wait, then 091             index against prediction: off ──┘
//! ```

use crate::alarm::{Alarm, number};
use crate::board::{BoardSpindle, SpindleFault};
use crate::cnc::Cnc;
use crate::command::{Action, ThreadStart};
use crate::machine::MachineInputs;
use crate::spindle::Encoder;
use crate::units::Feed;
use gsk_messages::say;

/// Greatest variation of the spindle speed in a thread, %.
const MAX_VARIATION_PERCENT: f64 = 0.2;

/// Time budget for a spindle to become steady, ms. The time of a number of turns, the next
/// constant, is added.
const STEADY_BUDGET_MS: f64 = 10_000.0;

const STEADY_BUDGET_TURNS: f64 = 40.0;

/// Speed below which the spindle counts as stopped, r/min.
const STANDSTILL_RPM: f64 = 1.0;

impl Cnc {
    /// Returns the inputs with the encoder counts replaced by those that follow from the spindle
    /// angle that the board measures.
    pub(crate) fn with_board_spindle(
        &self,
        inputs: &MachineInputs,
        spindle: &BoardSpindle,
    ) -> MachineInputs {
        let counts = Encoder::counts_per_spindle_turn(&self.memory.parameters).unwrap_or(0.0);
        let count = |turns: f64| (turns * counts).floor() as i64;
        MachineInputs {
            encoder: count(spindle.turn.now),
            encoder_index: count(spindle.turn.index),
            spindle_index: spindle.index_passed,
            ..inputs.clone()
        }
    }

    /// Whether a thread waits for its spindle angle.
    pub(crate) fn is_waiting_for_spindle(&self) -> bool {
        self.drives.interpolator.is_waiting_for_spindle()
    }

    /// Lead of the thread in progress, mm per revolution; `None` outside threads.
    pub(crate) fn followed_lead(&self) -> Option<f64> {
        if !self.drives.interpolator.is_in_thread() {
            return None;
        }
        match self.run.automatic.current_action() {
            Some(Action::Thread { lead, .. }) => Some(lead.abs().max(1e-3)),
            _ => None,
        }
    }

    /// Whether a command must still wait for the spindle: until it turns, or before a thread until
    /// its speed is steady. If the time budget ends first, the command raises an alarm when it
    /// begins.
    pub(crate) fn board_spindle_delays(&mut self, action: &Action) -> bool {
        let Some(spindle) = self.drives.board.and_then(|board| board.spindle) else {
            return false;
        };
        let stands_still = spindle.rpm.abs() < STANDSTILL_RPM;
        let is_ready = match action {
            Action::Thread {
                start: ThreadStart::AtIndex { .. },
                ..
            }
            | Action::ThreadCycle { .. } => self.is_steady(&spindle),
            Action::Tap { .. } if self.is_tapping_by_board() => self.is_steady(&spindle),
            Action::Line {
                feed: Feed::PerRevolution(_),
                ..
            }
            | Action::Arc {
                feed: Feed::PerRevolution(_),
                ..
            } => !stands_still,
            _ => true,
        };
        if is_ready || (stands_still && !spindle.is_commanded) || self.dry_run().is_some() {
            return false;
        }
        let turns = STEADY_BUDGET_TURNS * 60_000.0 / spindle.rpm.abs().max(STANDSTILL_RPM);
        let time_budget_ms = STEADY_BUDGET_MS + if stands_still { 0.0 } else { turns };
        let waited = &mut self.run.automatic.watch.waited_ticks;
        *waited += 1;
        f64::from(*waited) < time_budget_ms
    }

    fn is_steady(&self, spindle: &BoardSpindle) -> bool {
        let variation = spindle.variation.unwrap_or(f64::INFINITY) * 100.0;
        variation <= self.max_variation_percent() && spindle.turn.now != spindle.turn.before
    }

    /// Greatest permitted variation of the spindle speed in a thread, %: the smaller of No.106 and
    /// [`MAX_VARIATION_PERCENT`].
    fn max_variation_percent(&self) -> f64 {
        let limit = self.memory.parameters.speed_fluctuation_limit();
        if limit > 0.0 {
            limit.min(MAX_VARIATION_PERCENT)
        } else {
            MAX_VARIATION_PERCENT
        }
    }

    /// Returns alarm 091 as error if `action` starts a thread and the spindle is not steady enough.
    /// A spindle at standstill has another alarm.
    pub(crate) fn check_board_spindle(&self, action: &Action) -> Result<(), Alarm> {
        let Some(spindle) = self.drives.board.and_then(|board| board.spindle) else {
            return Ok(());
        };
        let rpm = spindle.rpm.abs();
        let is_start = match action {
            Action::ThreadCycle { .. } => true,
            Action::Thread { start, .. } => matches!(start, ThreadStart::AtIndex { .. }),
            _ => return Ok(()),
        };
        if !is_start || rpm < STANDSTILL_RPM || self.is_steady(&spindle) {
            return Ok(());
        }
        Err(
            Alarm::new(number::SPEED_FLUCTUATES).with_detail(match spindle.variation {
                Some(variation) => {
                    say::spindle_varies(variation * 100.0, rpm, self.max_variation_percent())
                }
                None => say::spindle_not_steady(rpm),
            }),
        )
    }

    /// Handles a spindle fault that the board reports during a thread. The thread continues
    /// to its end with its run-out; without index signal it ends at once.
    pub(crate) fn check_board_spindle_fault(&mut self) {
        let spindle = self.drives.board.and_then(|board| board.spindle);
        let Some(fault) = spindle.and_then(|spindle| spindle.fault) else {
            return;
        };
        let is_waiting = self.drives.interpolator.is_waiting_for_spindle();
        if is_waiting || fault == SpindleFault::Lost {
            self.raise_at_last_block(fault.to_alarm());
        } else {
            self.run.automatic.watch.fault.get_or_insert(fault);
        }
    }

    /// Raises the alarm of a spoilt thread before the next command, unless that command
    /// continues the thread. Returns whether an alarm was raised.
    pub(crate) fn end_spoilt_thread(&mut self, next: &Action) -> bool {
        let continues = matches!(
            next,
            Action::Thread {
                start: ThreadStart::Continued,
                ..
            }
        );
        if continues {
            return false;
        }
        let spindle_fault = self.run.automatic.watch.fault.take();
        if let Some(fault) = spindle_fault {
            self.raise_at_last_block(fault.to_alarm());
        }
        spindle_fault.is_some()
    }
}
