//! The spindle that the board sees by its index, and what threads ask of it.
//!
//! ```text
//!  cycle ─► 20 steady turns? ─► feed in ─► wait for the index ─► thread ─► run-out ─► 091?
//!           no: wait, then 091             index against prediction: off ──┘
//! ```

use serde::{Deserialize, Serialize};

use super::BoardDrives;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::command::{Action, ThreadStart};
use crate::machine::Inputs;
use crate::machine::link::{Lacks, ThreadRights};
use crate::spindle::{Encoder, SpindleTurn};
use crate::units::Feed;

/// A thread bears no greater variation of the spindle's speed, %.
const VARIATION: f64 = 0.2;
/// How long is waited for a spindle to become steady, ms, and turns besides.
const PATIENCE_MS: f64 = 10_000.0;
const PATIENCE_TURNS: f64 = 40.0;
/// Below this a spindle stands, r/min.
const STANDING_RPM: f64 = 1.0;

/// The spindle in a tick, at the moment at which the board makes its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct BoardSpindle {
    /// Speed, r/min; negative in reverse.
    pub rpm: f64,
    /// Angle around the tick.
    pub turn: SpindleTurn,
    /// The index comes by in the tick.
    pub passed: bool,
    /// M03 or M04 is in force.
    pub commanded: bool,
    /// Greatest difference of its periods of late, a part of their mean.
    pub variation: Option<f64>,
    /// What has gone wrong in a thread.
    pub trouble: Option<SpindleTrouble>,
}

/// Why a thread is not what it should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum SpindleTrouble {
    /// An index came so far from where the axes were, turns.
    Deviates(f64),
    /// The speed has changed by more than No.106 allows, to so many r/min.
    Fluctuates(f64),
    /// No index comes any more.
    Lost,
}

impl SpindleTrouble {
    fn alarm(self) -> Alarm {
        Alarm::new(91).because(match self {
            Self::Deviates(turns) => format!(
                "the index came {:.1} % of a turn beside the thread",
                turns * 100.0
            ),
            Self::Fluctuates(rpm) => format!("spindle at {rpm:.0} r/min"),
            Self::Lost => "no index of the spindle comes any more (io.index)".to_owned(),
        })
    }
}

/// What is missing for something that needs the spindle's angle or speed.
pub(super) fn why_not(board: &BoardDrives, what: &str) -> &'static str {
    match board.threads {
        ThreadRights::None(Lacks { index: true, .. }) => {
            ": io.index of the machine file names no pin"
        }
        ThreadRights::Followed if what == "tapping" => {
            ": the index does not tell how the spindle brakes and reverses"
        }
        _ => "",
    }
}

impl Cnc {
    /// What the encoder would say of the spindle that the board sees.
    pub(crate) fn with_board_spindle(&self, inputs: &Inputs, spindle: &BoardSpindle) -> Inputs {
        let counts = Encoder::counts_per_spindle_turn(&self.parameters).unwrap_or(0.0);
        let count = |turns: f64| (turns * counts).floor() as i64;
        Inputs {
            encoder: count(spindle.turn.now),
            encoder_index: count(spindle.turn.index),
            spindle_index: spindle.passed,
            ..*inputs
        }
    }

    /// Whether a thread waits for its angle of the spindle.
    pub(crate) fn waits_for_spindle(&self) -> bool {
        self.interpolator.waits_for_spindle()
    }

    /// Lead of the thread under way, mm.
    pub(crate) fn lead_followed(&self) -> Option<f64> {
        if !self.interpolator.in_thread() {
            return None;
        }
        match self.automatic.action() {
            Some(Action::Thread { lead, .. }) => Some(lead.abs().max(1e-3)),
            _ => None,
        }
    }

    /// Whether the spindle is still to become what a command needs: known, and for a
    /// thread steady. What it never becomes is an alarm when the command begins.
    pub(super) fn board_spindle_delays(&mut self, action: &Action) -> bool {
        let Some(spindle) = self.board.and_then(|board| board.spindle) else {
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
        let waited = &mut self.automatic.watch.waited;
        *waited += 1;
        f64::from(*waited) < patience
    }

    fn steady(&self, spindle: &BoardSpindle) -> bool {
        let variation = spindle.variation.unwrap_or(f64::INFINITY) * 100.0;
        variation <= self.variation_allowed() && spindle.turn.now != spindle.turn.before
    }

    /// The smaller of No.106 and what the board can follow, %.
    fn variation_allowed(&self) -> f64 {
        let limit = self.parameters.fluctuation_limit();
        if limit > 0.0 {
            limit.min(VARIATION)
        } else {
            VARIATION
        }
    }

    /// A thread needs a steady spindle (alarm 091). A spindle that stands has its own
    /// alarm.
    pub(super) fn check_board_spindle(&self, action: &Action) -> Result<(), Alarm> {
        let Some(spindle) = self.board.and_then(|board| board.spindle) else {
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
        Err(Alarm::new(91).because(match spindle.variation {
            Some(variation) => format!(
                "the spindle varies by {:.2} % at {rpm:.0} r/min, {} % are allowed",
                variation * 100.0,
                self.variation_allowed()
            ),
            None => format!("the spindle has not kept its {rpm:.0} r/min for 20 turns"),
        }))
    }

    /// What the board tells of the spindle in a thread. A spoilt one goes on to its end
    /// with its run-out; without an index it ends here.
    pub(in crate::operation) fn watch_board_spindle(&mut self) {
        let spindle = self.board.and_then(|board| board.spindle);
        let Some(trouble) = spindle.and_then(|spindle| spindle.trouble) else {
            return;
        };
        let waits = self.interpolator.waits_for_spindle();
        if waits || trouble == SpindleTrouble::Lost {
            self.raise_at_last(trouble.alarm());
        } else {
            self.automatic.watch.spoilt.get_or_insert(trouble);
        }
    }

    /// Behind a spoilt thread nothing begins. Returns whether that is so.
    pub(in crate::operation) fn ends_spoilt(&mut self, next: &Action) -> bool {
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
        let spoilt = self.automatic.watch.spoilt.take();
        if let Some(trouble) = spoilt {
            self.raise_at_last(trouble.alarm());
        }
        spoilt.is_some()
    }
}
