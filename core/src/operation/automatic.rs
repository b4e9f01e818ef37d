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

use std::collections::{BTreeMap, VecDeque};

use super::intervention::CycleShift;
use super::speed_arrival::SpeedArrival;
use super::thread_state::{HoldProtection, SpindleWatch, TapStage};
use crate::alarm::Alarm;
use crate::command::{Action, ControlCommand, Frame, ProgramId, SourcePosition};
use crate::interpreter::{Interpreter, ModalState, ReadState};
use crate::memory::{ControlParameters, ControlSettings, Offsets, SwitchedOff, Variables};
use crate::motion::Interpolator;
use crate::run_state::RunState;
use crate::units::Point;
use serde::{Deserialize, Serialize};

/// The event for which the current command still waits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum CommandStage {
    /// The motion, dwell or wait of the command is being executed.
    Acting,
    /// Only the M/S/T handshake is not complete (DEN is 1 if nothing else runs).
    Handshake,
}

/// The current command, with its stage and its start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CurrentCommand {
    pub(crate) command: ControlCommand,
    pub(crate) stage: CommandStage,
    /// Commanded position at the start of the command, machine coordinates.
    pub(crate) from: Point,
    /// Machine time at the start of the command, s.
    #[serde(rename = "started")]
    pub(crate) start_s: f64,
}

/// The state of automatic operation: the run, the commands read and the block in
/// execution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AutomaticRun {
    /// State of the run: reset, run, hold or stop.
    pub state: RunState,
    pub(crate) current: Option<CurrentCommand>,
    #[serde(rename = "ahead")]
    pub(crate) next_command: Option<ControlCommand>,
    /// An alarm found while reading ahead; it is raised when its block begins. `None`
    /// without one.
    pub(crate) fault_ahead: Option<Alarm>,
    /// Whether the interpreter waits for a standstill; it reads no block before.
    #[serde(rename = "waiting")]
    pub(crate) waits_for_standstill: bool,
    /// Whether a program has been started and can be resumed.
    #[serde(rename = "started")]
    pub(crate) is_started: bool,
    /// Whether the interpreter has reported the end of the program.
    #[serde(rename = "ended")]
    pub(crate) has_ended: bool,
    /// Whether the run stops at the end of the block, regardless of single block.
    pub(crate) stop_requested: bool,
    #[serde(rename = "dwell_left")]
    pub(crate) dwell_left_ms: u32,
    /// M00, M01, M02 or M30 whose decode signal (DM) is on; `None`: all decode signals are
    /// off.
    #[serde(rename = "decoded")]
    pub(crate) decoded_m: Option<u8>,
    /// Whether the run executes the MDI block, not the program of AUTO.
    #[serde(rename = "mdi")]
    pub(crate) is_mdi: bool,
    /// Source of the last command that was started; `None` before the first one.
    #[serde(rename = "last")]
    pub(crate) last_source: Option<SourcePosition>,
    /// Whether the current block has further commands.
    pub(crate) within_block: bool,
    pub(crate) protection: HoldProtection,
    /// Stage of the current tap; `None` without a tap.
    pub(crate) tap: Option<TapStage>,
    /// M code that reverses the spindle to move the tap out: 3 or 4; 0 if not set yet.
    pub(crate) tap_reverse: u8,
    pub(crate) watch: SpindleWatch,
    pub(crate) arrival: SpeedArrival,
    /// The stopped AUTO run that is suspended while MDI blocks are executed; `None` without
    /// one.
    #[serde(rename = "aside")]
    pub(crate) suspended: Option<Box<SuspendedRun>>,
    pub(crate) cycle_shift: CycleShift,
    /// Whether feed hold was requested while #3004 did not permit it.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    #[serde(rename = "hold_put_off")]
    pub(crate) hold_deferred: bool,
    /// The restart that the next cycle start begins, or whose approach is being executed; `None`
    /// without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) restart: Option<Box<PreparedRestart>>,
}

/// A restart at a block: the approach to its start point, and the state of the run that continues
/// there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PreparedRestart {
    /// The selected program and its text length in bytes, to detect another program.
    pub(crate) program: (ProgramId, usize),
    /// The block at which the run continues after the restart.
    pub(crate) source: SourcePosition,
    /// Machine coordinates at which the approach begins, mm.
    pub(crate) from: Point,
    /// The actions of the approach that are not executed yet.
    pub(crate) steps: VecDeque<Action>,
    /// The state of the run before the block.
    pub(crate) continuation: RunContinuation,
    /// For each tool that the skipped blocks cut with, the frame of its first cut.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) first_cut_frames: BTreeMap<u8, Frame>,
    /// The tool before the block, and the frame in force there.
    #[serde(default)]
    pub(crate) tool_frame: (u8, Frame),
}

/// The state of the control before a block, as far as a program changes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunContinuation {
    pub interpreter: Interpreter,
    pub automatic: AutomaticRun,
    pub modal: ModalState,
    pub off: SwitchedOff,
    pub variables: Variables,
    pub offsets: Offsets,
    pub parameters: ControlParameters,
    pub settings: ControlSettings,
    /// Absolute coordinates at which the relative ones are 0, mm.
    pub relative_zero: Point,
    /// Programmed X minus X of the tool tip, mm (radius).
    pub programmed_x_lead: f64,
}

/// A stopped AUTO run that is suspended while MDI blocks are executed (manual II, MDI;
/// III-6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SuspendedRun {
    pub automatic: AutomaticRun,
    /// The rest of the motion of a block that was held; `None` if the run stopped between
    /// blocks.
    pub held: Option<Interpolator>,
    /// Position up to which the program was read; `None` if it is that of the tool.
    pub read_to: Option<ReadState>,
    /// The coordinate frame in force when the run was suspended.
    pub frame: Frame,
}

impl Default for AutomaticRun {
    fn default() -> Self {
        Self {
            state: RunState::Reset,
            current: None,
            next_command: None,
            fault_ahead: None,
            waits_for_standstill: false,
            is_started: false,
            has_ended: false,
            stop_requested: false,
            dwell_left_ms: 0,
            decoded_m: None,
            is_mdi: false,
            last_source: None,
            within_block: false,
            protection: HoldProtection::None,
            tap: None,
            tap_reverse: 0,
            watch: SpindleWatch::default(),
            arrival: SpeedArrival::default(),
            suspended: None,
            cycle_shift: CycleShift::default(),
            hold_deferred: false,
            restart: None,
        }
    }
}

impl AutomaticRun {
    /// STL or SPL: whether a block is being executed or held.
    pub const fn is_operating(&self) -> bool {
        matches!(self.state, RunState::Run | RunState::Hold)
    }

    /// Whether the approach of a restart is being executed or held.
    pub(crate) const fn is_approaching(&self) -> bool {
        self.is_started && self.restart.is_some()
    }

    /// DEN: whether only FIN is missing for the end of the block.
    pub(crate) fn is_distribution_end(&self) -> bool {
        self.current.as_ref().is_some_and(|current| {
            let is_last = matches!(current.command.action, Action::Tool { is_last: true, .. });
            current.stage == CommandStage::Handshake && (current.command.block_end || is_last)
        })
    }

    /// CUT: whether a cutting feed is being executed, also while an interlock or an override of 0 %
    /// delays it.
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
                current.stage == CommandStage::Acting && cuts
            })
    }

    /// Whether single block has stopped between two moves of one block. SPL then shows that
    /// the block is not at its end (manual PLC-II 6.3.3).
    pub(crate) fn is_stopped_within_block(&self) -> bool {
        let run = match &self.suspended {
            Some(aside) if !self.is_operating() => &aside.automatic,
            _ => self,
        };
        run.state == RunState::Stop && run.can_resume() && run.within_block
    }

    /// Updates the decode signals DM: M01 and M02 are set once motion and dwell of their
    /// block are finished, unless FIN came before. FIN clears all of them (manual PLC-II
    /// 8.1).
    pub(crate) fn update_decoded(&mut self, waiting_m: Option<u8>, fin: bool) {
        if fin {
            self.decoded_m = None;
        } else if self.is_distribution_end() && matches!(waiting_m, Some(1 | 2)) {
            self.decoded_m = waiting_m;
        }
    }

    /// Whether the dwell of a G04 is running.
    pub(crate) fn is_dwelling(&self) -> bool {
        self.dwell_left_ms > 0 && matches!(self.current_action(), Some(Action::Dwell { .. }))
    }

    /// Returns the action of the current command; `None` between commands.
    pub(crate) fn current_action(&self) -> Option<&Action> {
        self.current.as_ref().map(|current| &current.command.action)
    }

    /// Whether the current cut continues into the command that was read ahead: that command is also
    /// a cut, and nothing stops the run in between.
    pub(crate) fn continues_cut(&self) -> bool {
        self.state == RunState::Run
            && !self.stop_requested
            && self
                .next_command
                .as_ref()
                .is_some_and(|next| is_cut(&next.action))
    }

    /// Resets the run and drops all commands read; only the source of the last command is
    /// kept.
    pub(crate) fn clear(&mut self) {
        *self = Self {
            last_source: self.last_source,
            ..Self::default()
        };
    }

    /// Whether a run was started and has not ended, so that it can be resumed.
    pub(crate) const fn can_resume(&self) -> bool {
        self.is_started && !self.has_ended
    }

    pub(crate) const fn begin_run(&mut self, mdi: bool) {
        self.is_mdi = mdi;
        self.is_started = true;
        self.state = RunState::Run;
    }

    /// Source of the last command of the suspended AUTO run; `None` without a suspended
    /// run.
    pub(crate) fn suspended_source(&self) -> Option<SourcePosition> {
        self.suspended
            .as_ref()
            .and_then(|aside| aside.automatic.last_source)
    }

    /// Returns the source of the block in a stored program that a stop would interrupt; `None` for
    /// MDI and DNC, and if no block is executed or held.
    pub(crate) fn interrupted_source(&self) -> Option<SourcePosition> {
        let run = match &self.suspended {
            Some(aside) => &aside.automatic,
            None => self,
        };
        let stored = |last: &SourcePosition| last.program != ProgramId::Dnc;
        run.last_source
            .filter(|_| run.is_operating() && !run.is_mdi)
            .filter(stored)
    }

    /// Stops the run at the end of a block and drops requests for stop and hold.
    pub(crate) const fn stop_at_block_end(&mut self) {
        self.state = RunState::Stop;
        self.stop_requested = false;
        self.hold_deferred = false;
        self.protection = HoldProtection::None;
    }

    /// Requests a stop at the end of the running block.
    pub(crate) const fn request_stop(&mut self) {
        self.stop_requested = true;
    }
}

/// Whether the action is a straight or circular cut, not a thread.
pub(crate) const fn is_cut(action: &Action) -> bool {
    matches!(action, Action::Line { .. } | Action::Arc { .. })
}
