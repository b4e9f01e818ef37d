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

/// What the command under way still waits for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Stage {
    /// Motion or dwell is under way.
    Acting,
    /// Only the M/S/T handshake is open (DEN is 1 if nothing else runs).
    Handshake,
}

/// The command under way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Current {
    pub(crate) command: Command,
    pub(crate) stage: Stage,
    /// Position at its start, machine coordinates.
    pub(crate) from: Point,
    /// Machine time at its start, s.
    #[serde(rename = "started")]
    pub(crate) started: f64,
}

/// Automatic operation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Automatic {
    /// Current state of the run.
    pub state: RunState,
    pub(crate) current: Option<Current>,
    #[serde(rename = "ahead")]
    pub(crate) ahead: Option<Command>,
    /// An alarm found while reading ahead. It is raised when its block begins.
    pub(crate) fault_ahead: Option<Alarm>,
    /// Whether the interpreter waits for a standstill. It is not called before.
    #[serde(rename = "waiting")]
    pub(crate) waiting: bool,
    /// Whether a program has been started and can be resumed.
    #[serde(rename = "started")]
    pub(crate) started: bool,
    /// Whether the interpreter has no more commands.
    #[serde(rename = "ended")]
    pub(crate) ended: bool,
    /// Whether the run stops at the end of the block, regardless of single block.
    pub(crate) stop_requested: bool,
    #[serde(rename = "dwell_left")]
    pub(crate) dwell_left: u32,
    /// M00, M01, M02 or M30 whose decode signal is 1.
    #[serde(rename = "decoded")]
    pub(crate) decoded: Option<u8>,
    /// Whether the MDI block runs, not the program of AUTO.
    #[serde(rename = "mdi")]
    pub(crate) mdi: bool,
    /// Source of the last executed command.
    #[serde(rename = "last")]
    pub(crate) last: Option<Source>,
    /// Whether more commands of the running block follow.
    pub(crate) within_block: bool,
    pub(crate) protection: Protection,
    /// Stage of the tap under way.
    pub(crate) tap: Option<TapStage>,
    /// M code that reverses the spindle for the way out of the tap.
    pub(crate) tap_reverse: u8,
    pub(crate) watch: SpindleWatch,
    pub(crate) arrival: Arrival,
    /// The stopped AUTO run that is suspended while MDI blocks are executed.
    #[serde(rename = "aside")]
    pub(crate) aside: Option<Box<Aside>>,
    pub(crate) cycle_shift: CycleShift,
    /// Whether feed hold was requested while #3004 did not permit it.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    #[serde(rename = "hold_put_off")]
    pub(crate) hold_put_off: bool,
}

/// A stopped AUTO run that is suspended while MDI blocks are executed (manual II, MDI;
/// III-6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Aside {
    pub automatic: Automatic,
    /// The rest of its block, if it was held within one.
    pub held: Option<Interpolator>,
    /// How far its program was read, if that differs from the position of the tool.
    pub read_to: Option<ReadTo>,
    /// The coordinate frame in force when it was read.
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

    /// DEN: only FIN is missing for the end of the block.
    pub(crate) fn distribution_end(&self) -> bool {
        self.current.as_ref().is_some_and(|current| {
            let is_last = matches!(current.command.action, Action::Tool { is_last: true, .. });
            current.stage == Stage::Handshake && (current.command.block_end || is_last)
        })
    }

    /// CUT: a cutting feed is under way, or an interlock or an override of 0 % keeps it
    /// waiting.
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

    /// Whether single block has stopped between two moves of one block. SPL then shows that
    /// the block is not at its end (manual PLC-II 6.3.3).
    pub(crate) fn stands_within_block(&self) -> bool {
        let run = match &self.aside {
            Some(aside) if !self.operating() => &aside.automatic,
            _ => self,
        };
        run.state == RunState::Stop && run.goes_on() && run.within_block
    }

    /// Updates the decode signals DM: M01 and M02 are set once motion and dwell of their
    /// block are finished, unless FIN came before. FIN clears all of them (manual PLC-II
    /// 8.1).
    pub(crate) fn follow_decoded(&mut self, waiting_m: Option<u8>, fin: bool) {
        if fin {
            self.decoded = None;
        } else if self.distribution_end() && matches!(waiting_m, Some(1 | 2)) {
            self.decoded = waiting_m;
        }
    }

    /// Whether the dwell of a G04 is running.
    pub(crate) fn dwelling(&self) -> bool {
        self.dwell_left > 0 && matches!(self.action(), Some(Action::Dwell { .. }))
    }

    /// The action under way.
    pub(crate) fn action(&self) -> Option<&Action> {
        self.current.as_ref().map(|current| &current.command.action)
    }

    /// Whether the cut under way continues into the command read ahead: that is a cut too,
    /// and nothing stops the run in between.
    pub(crate) fn cut_continues(&self) -> bool {
        self.state == RunState::Run
            && !self.stop_requested
            && self.ahead.as_ref().is_some_and(|next| is_cut(&next.action))
    }

    /// Drops everything that was read, except the source of the last command.
    pub(crate) fn clear(&mut self) {
        *self = Self {
            last: self.last,
            ..Self::default()
        };
    }

    /// Whether a started run can be resumed.
    pub(crate) const fn goes_on(&self) -> bool {
        self.started && !self.ended
    }

    pub(crate) const fn begin_run(&mut self, mdi: bool) {
        self.mdi = mdi;
        self.started = true;
        self.state = RunState::Run;
    }

    /// Source of the suspended AUTO run, if MDI blocks are executed in between.
    pub(crate) fn source_aside(&self) -> Option<Source> {
        self.aside.as_ref().and_then(|aside| aside.automatic.last)
    }

    /// Source of the block in a stored program that a stop interrupts; `None` for MDI and
    /// DNC.
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

    /// Requests a stop at the end of the running block.
    pub(crate) const fn request_stop(&mut self) {
        self.stop_requested = true;
    }
}

/// Whether the action is a cut at its own feed, not a thread.
pub(crate) const fn is_cut(action: &Action) -> bool {
    matches!(action, Action::Line { .. } | Action::Arc { .. })
}
