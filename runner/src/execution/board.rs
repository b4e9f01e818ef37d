//! Executes a program on a real machine: a pulse board makes the motion at its own pace, and
//! the operator confirms that a stopped program continues.

use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use super::{ExecutionEnd, ProgramRun, SETTLE_MS};
use crate::board::{OperatorAnswer, PulseBoard, RestartPlanner, TerminalOperator};

const RESET_KEY: BitAddress = BitAddress::new(Area::X, 26, 0);
const MACHINE_ZERO_KEY: BitAddress = BitAddress::new(Area::X, 20, 3);
pub(super) const FEED_HOLD_KEY: BitAddress = BitAddress::new(Area::X, 24, 7);
/// DM00 (F009.7), the decode signal of M00. It stays on until the PLC reports FIN; only then
/// does the program stop.
const PROGRAM_STOP: BitAddress = BitAddress::new(Area::F, 9, 7);

/// The PLC input of the panel key that returns an axis to its machine zero.
const fn reference_key(axis: Axis) -> BitAddress {
    match axis {
        Axis::X => BitAddress::new(Area::X, 23, 1),
        Axis::Z => BitAddress::new(Area::X, 22, 7),
    }
}
/// Time limit of a return to machine zero, ticks.
const MAX_RETURN_TICKS: u32 = 10 * 60 * 1000;
/// Ticks without motion after which a key counts as without effect.
const KEY_RESPONSE_TICKS: u32 = 1000;
/// Ticks within which RESET clears the alarms that can be cleared.
const RESET_RESPONSE_TICKS: u32 = 5000;
/// Ticks within which the spindle reaches the speed of a restart.
const RESTART_SPEED_TICKS: u32 = 30_000;
/// Ticks at standstill after which a stop cannot raise a delayed alarm any more.
const STOP_SETTLE_TICKS: u32 = 300;

/// A pulse board that makes the motion of a run, with the operator who supervises it.
pub struct SupervisedBoard {
    /// The board that moves the axes.
    pub(super) pulse_board: Box<dyn PulseBoard>,
    needs_reference_return: bool,
    pub(super) operator: Option<Box<dyn TerminalOperator>>,
    /// Plans the restart with which the run begins; `None`: the run begins at the head.
    pub(super) restart: Option<Box<dyn RestartPlanner>>,
    /// Whether the run is on the way to the start point of a restart, where it stops.
    pub(super) is_approaching: bool,
    /// Whether an alarm ends the run. Set after RESET, because alarms from before it do not
    /// count.
    checks_alarms: bool,
}

impl SupervisedBoard {
    /// Supervises an opened board. With `needs_reference_return` both axes return to machine
    /// zero before the program starts. `operator` answers the question at a stop; with `None`
    /// a stop ends the run.
    pub fn new(
        pulse_board: Box<dyn PulseBoard>,
        needs_reference_return: bool,
        operator: Option<Box<dyn TerminalOperator>>,
    ) -> Self {
        Self {
            pulse_board,
            needs_reference_return,
            operator,
            restart: None,
            is_approaching: false,
            checks_alarms: false,
        }
    }

    /// Begins the run with a restart at a block.
    #[must_use]
    pub fn with_restart(mut self, planner: Box<dyn RestartPlanner>) -> Self {
        self.restart = Some(planner);
        self
    }
}

/// State of a program stop that waits for the operator to continue it.
#[derive(Debug, Default)]
pub(super) struct StopState {
    /// Time since the program stopped, ticks.
    duration_ticks: u32,
    /// Whether the terminal already shows the question whether the program should continue.
    is_question_shown: bool,
    /// Time for which a restart has waited for the speed of the spindle, ticks.
    speed_wait_ticks: u32,
    /// Line at which the last M00 stopped the program, from 1; `None` before any M00.
    program_stop_line: Option<u32>,
}

impl ProgramRun<'_> {
    /// Waits until the board allows the next tick. Returns false if the end was requested
    /// (Ctrl-C).
    pub(super) fn wait_for_tick(&mut self) -> bool {
        let Some(board) = &mut self.board else {
            return true;
        };
        let can_continue = board.pulse_board.wait_for_tick(&mut self.simulation);
        if !can_continue {
            self.pending_end = Some(ExecutionEnd::Requested);
        }
        // An alarm that the board raises between two ticks is no event of either.
        if let Some(alarm) = self.simulation.cnc.alarms().first()
            && board.checks_alarms
            && self.pending_end.is_none()
        {
            self.pending_end = Some(ExecutionEnd::Alarm(alarm.clone()));
        }
        can_continue
    }

    /// Presses RESET, which unlocks the board, and returns both axes to machine zero if the
    /// caller of [`SupervisedBoard::new`] requested it.
    pub(super) fn prepare_board(&mut self) {
        let Some(needs_reference_return) = self
            .board
            .as_ref()
            .map(|board| board.needs_reference_return)
        else {
            return;
        };
        self.press(RESET_KEY);
        for _ in 0..RESET_RESPONSE_TICKS {
            if self.simulation.cnc.alarms().is_empty() {
                break;
            }
            self.run_tick();
        }
        if let Some(board) = &mut self.board {
            board.checks_alarms = true;
        }
        if !needs_reference_return {
            return;
        }
        self.press(MACHINE_ZERO_KEY);
        for axis in [Axis::X, Axis::Z] {
            self.return_to_reference(axis);
        }
    }

    /// Holds the key of an axis until the axis is referenced, or ends the run if that takes
    /// too long. Some boards return both axes with the key of the first.
    fn return_to_reference(&mut self, axis: Axis) {
        let key = reference_key(axis);
        let mut still_ticks = 0;
        for _ in 0..MAX_RETURN_TICKS {
            if *self.simulation.cnc.referenced_axes().get(axis) || self.pending_end.is_some() {
                self.simulation.cnc.set_panel_key(key, false);
                return self.wait_for_axes();
            }
            self.simulation.cnc.set_panel_key(key, true);
            self.run_tick();
            still_ticks = if self.is_at_standstill() {
                still_ticks + 1
            } else {
                0
            };
            if still_ticks >= KEY_RESPONSE_TICKS
                && let Some(why) = self.simulation.cnc.axis_key_refusal(axis)
            {
                self.pending_end = Some(ExecutionEnd::Refused(why));
            }
        }
        self.simulation.cnc.set_panel_key(key, false);
        let why = say::run_home_endless(format_args!("{axis:?}"));
        self.pending_end = Some(ExecutionEnd::Refused(why));
    }

    /// Whether the control does not move and the board has made all motion sent to it.
    fn is_at_standstill(&self) -> bool {
        let cnc = &self.simulation.cnc;
        !cnc.is_moving() && cnc.board_lag().is_none_or(|lag| lag.ticks == 0)
    }

    /// Supervises a program on a board, once a tick. The operator ends a stop at the terminal
    /// or with the cycle start of the machine. Without an operator at the terminal a stop ends
    /// the run.
    pub(super) fn supervise_stop(&mut self) {
        let state = self.simulation.cnc.run_state();
        if state == RunState::Run {
            let cnc = &self.simulation.cnc;
            let program_stop_line = match cnc.plc().memory().bit(PROGRAM_STOP) {
                true => Some(cnc.cursor().line),
                false => self.stop_state.program_stop_line,
            };
            self.stop_state = StopState {
                program_stop_line,
                speed_wait_ticks: self.stop_state.speed_wait_ticks,
                ..StopState::default()
            };
            self.supervise_restart_speed();
        }
        if state == RunState::Run || self.pending_end.is_some() || !self.is_at_standstill() {
            return;
        }
        self.stop_state.duration_ticks += 1;
        if self.stop_state.duration_ticks < STOP_SETTLE_TICKS {
            return;
        }
        if state == RunState::Reset {
            let why = match self.has_begun {
                true => ExecutionEnd::Stop(say::run_reset_ended()),
                false => ExecutionEnd::Refused(say::run_nothing_begun()),
            };
            self.pending_end = Some(self.start_refusal().unwrap_or(why));
            return;
        }
        let hold = state == RunState::Hold;
        if !hold && self.continues_restart() {
            return self.press_cycle_start_again();
        }
        let stop = self.stop_message(hold);
        if !self.stop_state.is_question_shown {
            self.stop_state.is_question_shown = true;
            match self.show_question(&stop) {
                true => {}
                // The operator held it at the machine, and continues it there.
                false if hold => self.watcher.show(&say::run_continues_at_machine(stop)),
                false => self.pending_end = Some(ExecutionEnd::Stop(say::run_start_at(stop))),
            }
            return;
        }
        match self.read_answer(&stop) {
            OperatorAnswer::Enter => {
                self.stops += u32::from(!hold);
                self.press_cycle_start_again();
                self.stop_state = StopState::default();
            }
            OperatorAnswer::EndOfInput if !hold => {
                self.pending_end = Some(ExecutionEnd::Stop(say::run_start_at(stop)));
            }
            OperatorAnswer::None | OperatorAnswer::Other | OperatorAnswer::EndOfInput => {}
        }
    }

    /// Ends a restart whose spindle does not reach its speed, in place of a wait without an end.
    fn supervise_restart_speed(&mut self) {
        let wait = self.simulation.cnc.restart_speed_wait();
        let Some((wanted, measured)) = wait.filter(|_| self.is_at_standstill()) else {
            self.stop_state.speed_wait_ticks = 0;
            return;
        };
        self.stop_state.speed_wait_ticks += 1;
        if self.stop_state.speed_wait_ticks >= RESTART_SPEED_TICKS {
            let why = say::run_restart_speed(wanted, measured);
            self.pending_end.get_or_insert(ExecutionEnd::Stop(why));
        }
    }

    /// The message with the line of the stop and its cause: feed hold, M00 or another stop.
    fn stop_message(&self, hold: bool) -> Message {
        let line = self.simulation.cnc.cursor().line;
        match self.stop_state.program_stop_line == Some(line) {
            _ if hold => say::run_feed_hold(line),
            true => say::run_program_stop(line),
            false => say::run_stop(line),
        }
    }

    /// Shows `stop` and the question whether to continue. Returns false if no operator is at
    /// the terminal.
    pub(super) fn show_question(&mut self, stop: &Message) -> bool {
        let operator = self
            .board
            .as_ref()
            .and_then(|board| board.operator.as_deref());
        let Some(operator) = operator else {
            return false;
        };
        operator.discard_input();
        self.watcher.show(&say::run_question(stop.clone()));
        true
    }

    /// Reads the operator's answer without blocking. An invalid answer repeats the question
    /// about `stop`.
    pub(super) fn read_answer(&mut self, stop: &Message) -> OperatorAnswer {
        let operator = self
            .board
            .as_ref()
            .and_then(|board| board.operator.as_deref());
        let answer = operator.map_or(OperatorAnswer::None, TerminalOperator::read_answer);
        if answer == OperatorAnswer::Other {
            self.show_question(stop);
        }
        answer
    }

    /// Asks the operator whether to start another part, and waits for the answer. Returns true
    /// for yes, and always without a board.
    pub(super) fn confirm_next_part(&mut self) -> bool {
        if self.board.is_none() {
            return true;
        }
        let progress = say::run_part_made(self.parts, self.wanted_parts);
        if !self.show_question(&progress) {
            return false;
        }
        while self.pending_end.is_none() {
            if self.simulation.cnc.run_state() == RunState::Run {
                return true;
            }
            match self.read_answer(&progress) {
                OperatorAnswer::Enter => return true,
                OperatorAnswer::EndOfInput => return false,
                OperatorAnswer::None | OperatorAnswer::Other => self.run_tick(),
            }
        }
        false
    }

    /// Holds a program that still runs at the end of the run, and waits until the board has
    /// made the motion sent to it.
    pub(super) fn stop_motion(&mut self) {
        if self.board.is_none() {
            return self.wait_for_axes();
        }
        if self.simulation.cnc.run_state() == RunState::Run {
            self.simulation.cnc.set_panel_key(FEED_HOLD_KEY, true);
        }
        for _ in 0..SETTLE_MS {
            let runs = self.simulation.cnc.run_state() == RunState::Run;
            if self.is_at_standstill() && !runs {
                break;
            }
            self.run_tick();
        }
        self.simulation.cnc.set_panel_key(FEED_HOLD_KEY, false);
    }

    /// Stops the board and closes its port.
    pub(super) fn close_board(&mut self) {
        if let Some(board) = self.board.take() {
            board.pulse_board.close(&mut self.simulation);
        }
    }
}
