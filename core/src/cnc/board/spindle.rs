//! The spindle that the board measures by its index, and the conditions of threads.
//!
//! ```text
//!  cycle ─► 20 steady turns? ─► feed in ─► wait for the index ─► thread ─► run-out ─► 091?
//!           no: wait, then 091             index against prediction: off ──┘
//! ```

use crate::alarm::{Alarm, number};
use crate::board::{BoardSpindle, SpindleTrouble};
use crate::cnc::Cnc;
use crate::command::{Action, ThreadStart};
use crate::machine::Inputs;
use crate::spindle::Encoder;
use crate::units::Feed;
use gsk_messages::say;

/// Greatest variation of the spindle speed in a thread, %.
const VARIATION: f64 = 0.2;

/// Time budget of a spindle to become steady: in ms, plus a number of turns.
const PATIENCE_MS: f64 = 10_000.0;

const PATIENCE_TURNS: f64 = 40.0;

/// Below this speed the spindle counts as stopped, r/min.
const STANDING_RPM: f64 = 1.0;

impl Cnc {
    /// Replaces the encoder inputs by those of the spindle that the board measures.
    pub(crate) fn with_board_spindle(&self, inputs: &Inputs, spindle: &BoardSpindle) -> Inputs {
        let counts = Encoder::counts_per_spindle_turn(&self.memory.parameters).unwrap_or(0.0);
        let count = |turns: f64| (turns * counts).floor() as i64;
        Inputs {
            encoder: count(spindle.turn.now),
            encoder_index: count(spindle.turn.index),
            spindle_index: spindle.passed,
            ..inputs.clone()
        }
    }

    /// Whether a thread waits for its spindle angle.
    pub(crate) fn waits_for_spindle(&self) -> bool {
        self.drives.interpolator.waits_for_spindle()
    }

    /// Lead of the thread under way, mm; `None` outside threads.
    pub(crate) fn lead_followed(&self) -> Option<f64> {
        if !self.drives.interpolator.in_thread() {
            return None;
        }
        match self.run.automatic.action() {
            Some(Action::Thread { lead, .. }) => Some(lead.abs().max(1e-3)),
            _ => None,
        }
    }

    /// Whether a command still waits for its spindle: known, and for a thread steady. If
    /// the time budget ends first, the command raises an alarm when it begins.
    pub(crate) fn board_spindle_delays(&mut self, action: &Action) -> bool {
        let Some(spindle) = self.drives.board.and_then(|board| board.spindle) else {
            return false;
        };
        let stands = spindle.rpm.abs() < STANDING_RPM;
        let ready = match action {
            Action::Thread {
                start: ThreadStart::AtIndex { .. },
                ..
            }
            | Action::ThreadCycle { .. } => self.steady(&spindle),
            Action::Line {
                feed: Feed::PerRevolution(_),
                ..
            }
            | Action::Arc {
                feed: Feed::PerRevolution(_),
                ..
            } => !stands,
            _ => true,
        };
        if ready || (stands && !spindle.commanded) || self.dry_run().is_some() {
            return false;
        }
        let turns = PATIENCE_TURNS * 60_000.0 / spindle.rpm.abs().max(STANDING_RPM);
        let patience = PATIENCE_MS + if stands { 0.0 } else { turns };
        let waited = &mut self.run.automatic.watch.waited;
        *waited += 1;
        f64::from(*waited) < patience
    }

    fn steady(&self, spindle: &BoardSpindle) -> bool {
        let variation = spindle.variation.unwrap_or(f64::INFINITY) * 100.0;
        variation <= self.variation_allowed() && spindle.turn.now != spindle.turn.before
    }

    /// Permitted variation, %: the smaller of No.106 and the board's limit.
    fn variation_allowed(&self) -> f64 {
        let limit = self.memory.parameters.fluctuation_limit();
        if limit > 0.0 {
            limit.min(VARIATION)
        } else {
            VARIATION
        }
    }

    /// Checks that the spindle is steady for a thread (alarm 091). A spindle at standstill
    /// has its own alarm.
    pub(crate) fn check_board_spindle(&self, action: &Action) -> Result<(), Alarm> {
        let Some(spindle) = self.drives.board.and_then(|board| board.spindle) else {
            return Ok(());
        };
        let rpm = spindle.rpm.abs();
        let begins = match action {
            Action::ThreadCycle { .. } => true,
            Action::Thread { start, .. } => matches!(start, ThreadStart::AtIndex { .. }),
            _ => return Ok(()),
        };
        if !begins || rpm < STANDING_RPM || self.steady(&spindle) {
            return Ok(());
        }
        Err(
            Alarm::new(number::SPEED_FLUCTUATES).because(match spindle.variation {
                Some(variation) => {
                    say::spindle_varies(variation * 100.0, rpm, self.variation_allowed())
                }
                None => say::spindle_not_steady(rpm),
            }),
        )
    }

    /// Handles a spindle fault that the board reports during a thread. A spoilt thread
    /// continues to its end with its run-out; without an index it ends at once.
    pub(crate) fn watch_board_spindle(&mut self) {
        let spindle = self.drives.board.and_then(|board| board.spindle);
        let Some(trouble) = spindle.and_then(|spindle| spindle.trouble) else {
            return;
        };
        let waits = self.drives.interpolator.waits_for_spindle();
        if waits || trouble == SpindleTrouble::Lost {
            self.raise_at_last(trouble.alarm());
        } else {
            self.run.automatic.watch.spoilt.get_or_insert(trouble);
        }
    }

    /// Raises the alarm of a spoilt thread before the next command. Returns whether it did.
    pub(crate) fn ends_spoilt(&mut self, next: &Action) -> bool {
        let goes_on = matches!(
            next,
            Action::Thread {
                start: ThreadStart::Continued,
                ..
            }
        );
        if goes_on {
            return false;
        }
        let spoilt = self.run.automatic.watch.spoilt.take();
        if let Some(trouble) = spoilt {
            self.raise_at_last(trouble.alarm());
        }
        spoilt.is_some()
    }
}
