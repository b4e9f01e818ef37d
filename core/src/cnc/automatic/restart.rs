//! Restart at a block: takes the state before the block from a copy of the control that has
//! run the program up to there, and moves the slides to the start point of the block.
//!
//! ```text
//!   copy:     head of program ──► stop before the block ──► its state
//!   control:  request ─► CYCLE START: retract, M, T, S, M, approach ─► takes over the state
//!             ─► STOP ─► CYCLE START: the block
//! ```

use std::collections::{BTreeMap, VecDeque};

use crate::cnc::parts::RunStop;
use crate::cnc::{Cnc, Event};
use crate::command::{Action, ControlCommand, Frame, SourcePosition, SpindleCommand, ThreadStart};
use crate::mode::OperatingMode;
use crate::motion::{Interpolator, ThreadMove};
use crate::operation::{PreparedRestart, RunContinuation, RunState};
use crate::units::{Axis, Point};
use gsk_messages::{Message, say};

/// Distance between two positions that count as one, mm.
const SAME_POSITION_MM: f64 = 0.000_5;
/// Deviation from the commanded spindle speed at which a restart continues, as a fraction.
const SPEED_TOLERANCE: f64 = 0.02;
/// Deviation from the commanded spindle speed at which a restart continues at low speeds, r/min.
const SPEED_TOLERANCE_RPM: f64 = 2.0;

/// The approach to the start point of a restart: points in machine coordinates, mm, each reached by
/// a rapid, and the M codes between.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestartRoute {
    /// Points that the tool passes before the tool change, machine coordinates, mm.
    pub retract: Vec<Point>,
    /// M codes that are output before the tool change.
    pub m_before_tool: Vec<u8>,
    /// M codes that are output after the tool change and S.
    pub m_after_tool: Vec<u8>,
    /// Points after the tool change; the last one is the start point of the block.
    pub approach: Vec<Point>,
    /// For each tool that the skipped blocks cut with, the frame of its first cut: it locates a
    /// part whose position is not known otherwise.
    pub first_cut_frames: BTreeMap<u8, Frame>,
}

impl Cnc {
    /// Prepares a copy of the control for the search of a block: the next cycle start runs the
    /// selected program from its head, and stops before the command `stop`.
    pub fn begin_restart_search(&mut self, stop: Option<RunStop>) {
        if self.run.automatic.state != RunState::Reset {
            self.reset();
        }
        self.run.automatic.clear();
        self.run.cursor_line = 1;
        self.run.rewind_at_start = false;
        self.set_run_stop(stop);
        self.set_explaining(true);
    }

    /// Takes a position, mm (X as a radius), as that of the slides, which stand still.
    pub(crate) fn place_slides(&mut self, position: Point) {
        self.forget_made_path();
        self.drives.interpolator = Interpolator::new(position);
        self.drives.axis_chain.preset(Axis::X, position.x);
        self.drives.axis_chain.preset(Axis::Z, position.z);
        self.settle_coordinates();
    }

    /// Sets the command before which the run stops; `None`: the run does not stop.
    pub const fn set_run_stop(&mut self, stop: Option<RunStop>) {
        self.run.stop = stop;
    }

    /// Whether the run has stopped before the command of [`Self::set_run_stop`].
    pub fn is_at_run_stop(&self) -> bool {
        self.run.stop.is_some_and(|stop| stop.is_in_block)
            && self.run.automatic.state == RunState::Stop
    }

    /// Whether the command that was read ahead continues the thread of the command before it:
    /// the run cannot begin there.
    pub fn continues_thread(&self) -> bool {
        let action = self.run.automatic.next_command.as_ref();
        let is_continued = |command: &ControlCommand| {
            let thread = ThreadMove::from_action(&command.action);
            thread.is_some_and(|thread| thread.start == ThreadStart::Continued)
        };
        action.is_some_and(is_continued)
    }

    /// Whether the command that was read ahead begins a block.
    pub const fn is_before_block(&self) -> bool {
        !self.run.automatic.within_block
    }

    /// The block of the command that was read ahead and has not begun; `None` without one.
    pub fn next_block(&self) -> Option<SourcePosition> {
        let next = self.run.automatic.next_command.as_ref();
        next.map(|command| command.source)
    }

    /// Machine coordinates of the end of the commanded motion, mm (X as a radius).
    pub fn commanded_machine_position(&self) -> Point {
        self.drives.interpolator.commanded()
    }

    /// Machine coordinates of the program zero, mm; `None` until a G50 has run.
    pub const fn program_zero(&self) -> Option<Point> {
        self.coordinates.program_zero
    }

    /// Whether the run stops before a command that is about to begin; the command is then kept
    /// for the next cycle start.
    pub(super) fn stops_before(&mut self, command: &ControlCommand) -> bool {
        let Some(stop) = &mut self.run.stop else {
            return false;
        };
        let explained = self.run.explanations.as_ref();
        let explained = explained.and_then(VecDeque::front).and_then(Option::as_ref);
        let pass = explained.map(|explanation| explanation.pass);
        if !stop.stops_before(!self.run.automatic.within_block, pass) {
            return false;
        }
        self.run.automatic.next_command = Some(command.clone());
        self.run.automatic.stop_at_block_end();
        true
    }

    /// Makes the restart that brings this control to the state of `target`, a copy that has
    /// stopped before a block. `None` if the copy has not read the block.
    pub fn prepare_restart(&self, target: &Self, route: &RestartRoute) -> Option<PreparedRestart> {
        let run = &target.run;
        let first = run.automatic.next_command.as_ref()?;
        let selected = self.memory.programs.selected()?;
        let length = self.memory.programs.get(selected)?.text().len();
        let rapid = |to: &Point| Action::Rapid { to: *to };
        let miscellaneous = |code: &u8| Action::Miscellaneous { code: *code };
        let mut steps: VecDeque<Action> = route.retract.iter().map(rapid).collect();
        steps.extend(route.m_before_tool.iter().map(miscellaneous));
        let (tool, offset) = run.tool;
        steps.push_back(Action::Tool {
            tool,
            offset,
            is_last: true,
        });
        steps.push_back(Action::Frame {
            frame: target.coordinates.frame,
            program_zero: target.coordinates.program_zero,
            relative: false,
        });
        steps.extend(target.spindle_commands().map(Action::Spindle));
        steps.extend(route.m_after_tool.iter().map(miscellaneous));
        steps.extend(route.approach.iter().map(rapid));
        Some(PreparedRestart {
            program: (selected, length),
            source: first.source,
            from: self.slide_position(),
            steps,
            continuation: RunContinuation {
                interpreter: run.interpreter.clone(),
                automatic: run.automatic.clone(),
                modal: run.modal,
                off: run.registers.off,
                variables: target.memory.variables.clone(),
                offsets: target.memory.offsets.clone(),
                parameters: target.memory.parameters.clone(),
                settings: target.memory.settings,
                relative_zero: target.coordinates.relative_zero,
                programmed_x_lead: target.coordinates.programmed_x_lead,
            },
            first_cut_frames: route.first_cut_frames.clone(),
            tool_frame: (tool, target.coordinates.frame),
        })
    }

    /// The frames in which the blocks that a restart skips first cut with their tools; `None`
    /// except in the approach of a restart.
    pub fn restart_first_cut_frames(&self) -> Option<&BTreeMap<u8, Frame>> {
        let restart = self.run.automatic.restart.as_ref();
        let restart = restart.filter(|_| self.run.automatic.is_approaching());
        restart.map(|restart| &restart.first_cut_frames)
    }

    /// The frame in which the block of a restart places the part for a tool; the frame in force
    /// except in the approach of a restart. The offset of another tool than that of the block is
    /// the one in force.
    pub fn frame_at_restart(&self, tool: u8) -> Frame {
        let now = self.coordinates.frame;
        match &self.run.automatic.restart {
            Some(restart) if self.run.automatic.is_approaching() => {
                let (tool_at_block, frame) = restart.tool_frame;
                match tool == tool_at_block {
                    true => frame,
                    false => Frame {
                        offset: now.offset,
                        ..frame
                    },
                }
            }
            _ => now,
        }
    }

    /// The S functions that lead to the present spindle command.
    fn spindle_commands(&self) -> impl Iterator<Item = SpindleCommand> + use<> {
        let control = &self.spindle.control;
        let s = control.s_word();
        let speed = if !self.memory.parameters.has_analog_spindle() {
            let step = self.run.modal.spindle as u8;
            (step > 0).then_some(SpindleCommand::Step(step))
        } else if control.is_surface_mode() {
            Some(SpindleCommand::Surface(s))
        } else {
            Some(SpindleCommand::Speed(s))
        };
        let limit = control.limit().map(SpindleCommand::Limit);
        limit.into_iter().chain(speed)
    }

    /// Message that explains why a restart cannot be requested now; `None` if it can.
    pub fn restart_refusal(&self, restart: &PreparedRestart) -> Option<Message> {
        if let Some(why) = self.restart_state_refusal() {
            return Some(why);
        }
        (!self.fits_restart(restart)).then(say::restart_state_changed)
    }

    /// Message that names the state of the machine in which no restart is possible; `None` in
    /// any other state.
    pub fn restart_state_refusal(&self) -> Option<Message> {
        let locks = &self.plc.signals;
        if self.is_alarm_active() || self.emergency_stop || self.is_resetting() {
            return Some(say::restart_in_alarm());
        }
        if self.run.automatic.is_operating() || self.is_moving() {
            return Some(say::restart_while_running());
        }
        if let Some(why) = self.board_restart_refusal() {
            return Some(why);
        }
        let is_locked = locks.machine_lock.x || locks.machine_lock.z || locks.auxiliary_lock;
        is_locked.then(say::restart_under_lock)
    }

    /// Whether slides and program are those for which a restart was prepared.
    fn fits_restart(&self, restart: &PreparedRestart) -> bool {
        let selected = self.memory.programs.selected();
        let text = selected.and_then(|program| self.memory.programs.get(program));
        let length = text.map(|text| text.text().len());
        selected.zip(length) == Some(restart.program)
            && (self.slide_position() - restart.from).length() <= SAME_POSITION_MM
    }

    /// Stores a restart for the next cycle start, or advises why not.
    pub(in crate::cnc) fn accept_restart(&mut self, restart: Box<PreparedRestart>) {
        if let Some(why) = self.restart_refusal(&restart) {
            return self.events.push(Event::Advised(why));
        }
        self.stop_run(RunState::Reset);
        self.run.interpreter.leave_mdi();
        self.run.automatic.restart = Some(restart);
    }

    /// Whether the next cycle start in AUTO begins a restart, or the approach of a restart is being
    /// executed.
    pub const fn has_restart(&self) -> bool {
        self.run.automatic.restart.is_some()
    }

    /// Begins the approach of a prepared restart at cycle start.
    pub(super) fn begin_restart(&mut self) {
        let Some(restart) = self.run.automatic.restart.take() else {
            return;
        };
        let refusal = match self.run.mode {
            OperatingMode::Auto => self.restart_refusal(&restart),
            _ => Some(say::restart_needs_auto()),
        };
        self.run.automatic.clear();
        self.settle_coordinates();
        if let Some(why) = refusal {
            return self.events.push(Event::Advised(why));
        }
        // After RESET the next start must not begin at the block without its state.
        self.run.automatic.last_source = None;
        self.run.automatic.restart = Some(restart);
        self.run.automatic.begin_run(false);
    }

    /// The next command of the approach. After the last one the run stops with the state before
    /// the block.
    pub(super) fn next_approach_command(&mut self) -> Option<ControlCommand> {
        let restart = self.run.automatic.restart.as_mut()?;
        if let Some(action) = restart.steps.pop_front() {
            return Some(ControlCommand {
                source: restart.source,
                action,
                modal: restart.continuation.modal,
                block_end: true,
                stop_point: false,
                defers_feed_hold: false,
                programmed_x: None,
            });
        }
        if self.restart_speed_wait().is_none() {
            self.take_over_run();
        }
        None
    }

    /// The commanded and the measured speed of the spindle, r/min, while the approach of a restart
    /// has ended and the two differ; `None` otherwise.
    pub fn restart_speed_wait(&self) -> Option<(f64, f64)> {
        let restart = self.run.automatic.restart.as_ref();
        let has_arrived = restart.is_some_and(|restart| restart.steps.is_empty());
        if !self.run.automatic.is_approaching() || !has_arrived {
            return None;
        }
        let top = self.spindle.control.top_speed();
        let wanted = self.spindle_switched().abs().min(top);
        let tolerance = wanted * SPEED_TOLERANCE + SPEED_TOLERANCE_RPM;
        let measured = self.spindle_actual().abs();
        let waits = self.spindle.control.has_encoder() && (measured - wanted).abs() > tolerance;
        waits.then_some((wanted, measured))
    }

    fn take_over_run(&mut self) {
        let Some(restart) = self.run.automatic.restart.take() else {
            return;
        };
        let state = restart.continuation;
        self.run.interpreter = state.interpreter;
        self.run.automatic = state.automatic;
        self.run.modal = state.modal;
        self.run.registers.off = state.off;
        self.memory.variables = state.variables;
        self.memory.offsets = state.offsets;
        self.memory.parameters = state.parameters;
        self.memory.settings = state.settings;
        self.coordinates.relative_zero = state.relative_zero;
        self.coordinates.programmed_x_lead = state.programmed_x_lead;
        // The slides stand where the last move of the cycle has ended.
        let at = self.position();
        let ended_at = &mut self.run.automatic.cycle_shift.ended_at;
        *ended_at = ended_at.map(|_| at);
        if let Some(explanations) = &mut self.run.explanations {
            explanations.clear();
            explanations.push_back(self.run.interpreter.explain());
        }
    }
}
