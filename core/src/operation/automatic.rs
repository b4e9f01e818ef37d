//! The state of automatic operation (manual III-5, PLC-I «automatic operation»).
//!
//! ```text
//!            cycle start                 *SP, manual mode
//!  RESET ───────────────► RUN ◄──────────────────────────► HOLD
//!    ▲    ▲                │ block end with single block,   │ block of M, S, T
//!    │    └── STOP ◄───────┘ M00, mode change               │ alone done
//!    │          ▲───────────────────────────────────────────┘
//!    └─ RESET key, M30, emergency stop: from every state
//! ```

use super::arrival::Arrival;
use super::intervention::CycleShift;
use super::thread_state::{Protection, SpindleWatch, TapStage};
use crate::alarm::Alarm;
use crate::command::{Action, Command, Frame, ProgramId, Source};
use crate::interpreter::ReadTo;
use crate::motion::Interpolator;
use crate::run_state::RunState;
use crate::units::Point;
use serde::{Deserialize, Serialize};

/// What a command under way still waits for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Stage {
    /// Motion or dwell.
    Acting,
    /// Only the M/S/T handshake (DEN is up if nothing else runs).
    Handshake,
}

/// A command under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Current {
    pub(crate) command: Command,
    pub(crate) stage: Stage,
    /// Where it began, machine coordinates.
    pub(crate) from: Point,
    /// When it began, s.
    pub(crate) started: f64,
}

/// Automatic operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Automatic {
    /// Run state.
    pub state: RunState,
    pub(crate) current: Option<Current>,
    pub(crate) ahead: Option<Command>,
    /// A fault found while reading ahead; it counts when its block's turn comes.
    pub(crate) fault_ahead: Option<Alarm>,
    /// The interpreter waits for standstill; not asked again before.
    pub(crate) waiting: bool,
    /// A program has been started and its rest can be gone on with.
    pub(crate) started: bool,
    /// The interpreter has nothing more.
    pub(crate) ended: bool,
    /// Stop at the end of the block, whatever single block says.
    pub(crate) stop_requested: bool,
    pub(crate) dwell_left: u32,
    /// M00, M01, M02 or M30 whose decode signal is 1.
    pub(crate) decoded: Option<u8>,
    /// Which program runs: AUTO's or the MDI block.
    pub(crate) mdi: bool,
    /// Source of the last executed command.
    pub(crate) last: Option<Source>,
    /// More commands of the running block follow the one that ended.
    pub(crate) within_block: bool,
    pub(crate) protection: Protection,
    /// Tapping under way.
    pub(crate) tap: Option<TapStage>,
    /// M function that leads the tap out.
    pub(crate) tap_reverse: u8,
    pub(crate) watch: SpindleWatch,
    pub(crate) arrival: Arrival,
    /// The stopped AUTO run that MDI blocks are keyed in between.
    pub(crate) aside: Option<Box<Aside>>,
    pub(crate) cycle_shift: CycleShift,
    /// Feed hold was asked for while #3004 did not permit it.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    pub(crate) hold_put_off: bool,
}

/// A stopped AUTO run while MDI blocks are carried out (manual II, MDI; III-6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Aside {
    pub automatic: Automatic,
    /// The rest of its block, if it was held in one.
    pub held: Option<Interpolator>,
    /// Where its program has been read to, if that is not where the tool stands.
    pub read_to: Option<ReadTo>,
    /// The frame it was read in.
    pub frame: Frame,
}

impl Default for Automatic {
    fn default() -> Self {
        Self {
            state: RunState::Reset,
            current: None,
            ahead: None,
            fault_ahead: None,
            waiting: false,
            started: false,
            ended: false,
            stop_requested: false,
            dwell_left: 0,
            decoded: None,
            mdi: false,
            last: None,
            within_block: false,
            protection: Protection::None,
            tap: None,
            tap_reverse: 0,
            watch: SpindleWatch::default(),
            arrival: Arrival::default(),
            aside: None,
            cycle_shift: CycleShift::default(),
            hold_put_off: false,
        }
    }
}

impl Automatic {
    /// STL or SPL: a block is under way or held.
    pub const fn operating(&self) -> bool {
        matches!(self.state, RunState::Run | RunState::Hold)
    }

    /// DEN: all that is left of the block is FIN.
    pub(crate) fn distribution_end(&self) -> bool {
        self.current.as_ref().is_some_and(|current| {
            let is_last = matches!(current.command.action, Action::Tool { is_last: true, .. });
            current.stage == Stage::Handshake && (current.command.block_end || is_last)
        })
    }

    /// CUT: a cutting feed is under way; also while an interlock or an override of 0 %
    /// keeps it waiting.
    pub(crate) fn is_cutting(&self) -> bool {
        self.state == RunState::Run
            && self.current.as_ref().is_some_and(|current| {
                let cuts = matches!(
                    current.command.action,
                    Action::Line { .. }
                        | Action::Arc { .. }
                        | Action::Thread { .. }
                        | Action::Tap { .. }
                );
                current.stage == Stage::Acting && cuts
            })
    }

    /// Stopped by single block between two moves of one block: SPL shows that the block
    /// is not at its end (manual PLC-II 6.3.3).
    pub(crate) fn stands_within_block(&self) -> bool {
        let run = match &self.aside {
            Some(aside) if !self.operating() => &aside.automatic,
            _ => self,
        };
        run.state == RunState::Stop && run.goes_on() && run.within_block
    }

    /// The decode signals DM: M01 and M02 once motion and dwell of their block are over,
    /// unless FIN came before; FIN clears all of them (manual PLC-II 8.1).
    pub(crate) fn follow_decoded(&mut self, waiting_m: Option<u8>, fin: bool) {
        if fin {
            self.decoded = None;
        } else if self.distribution_end() && matches!(waiting_m, Some(1 | 2)) {
            self.decoded = waiting_m;
        }
    }

    /// Whether the dwell of a G04 runs.
    pub(crate) fn dwelling(&self) -> bool {
        self.dwell_left > 0 && matches!(self.action(), Some(Action::Dwell { .. }))
    }

    /// The action under way.
    pub(crate) fn action(&self) -> Option<&Action> {
        self.current.as_ref().map(|current| &current.command.action)
    }

    /// Whether the cut under way goes over into the command read ahead: it is a cut
    /// too, and nothing stops the run in between.
    pub(crate) fn cut_continues(&self) -> bool {
        self.state == RunState::Run
            && !self.stop_requested
            && self.ahead.as_ref().is_some_and(|next| is_cut(&next.action))
    }

    /// Drops everything that was read.
    pub(crate) fn clear(&mut self) {
        *self = Self {
            last: self.last,
            ..Self::default()
        };
    }

    /// Whether a run stands that can be gone on with.
    pub(crate) const fn goes_on(&self) -> bool {
        self.started && !self.ended
    }

    pub(crate) const fn begin_run(&mut self, mdi: bool) {
        self.mdi = mdi;
        self.started = true;
        self.state = RunState::Run;
    }

    /// Where the stopped AUTO run stands that MDI blocks are keyed in between.
    pub(crate) fn source_aside(&self) -> Option<Source> {
        self.aside.as_ref().and_then(|aside| aside.automatic.last)
    }

    /// The block of the program that a stop breaks off.
    pub(crate) fn broken_off(&self) -> Option<Source> {
        let run = match &self.aside {
            Some(aside) => &aside.automatic,
            None => self,
        };
        let stored = |last: &Source| last.program != ProgramId::Dnc;
        run.last
            .filter(|_| run.operating() && !run.mdi)
            .filter(stored)
    }

    /// Stops at the end of a block.
    pub(crate) const fn stop(&mut self) {
        self.state = RunState::Stop;
        self.stop_requested = false;
        self.hold_put_off = false;
        self.protection = Protection::None;
    }

    /// Asks for a stop at the end of the running block.
    pub(crate) const fn request_stop(&mut self) {
        self.stop_requested = true;
    }
}

/// Whether an action is a cut whose speed is its own (no thread).
pub(crate) const fn is_cut(action: &Action) -> bool {
    matches!(action, Action::Line { .. } | Action::Arc { .. })
}
