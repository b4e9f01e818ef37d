//! Begins a run on a real machine in the middle of its program: the operator confirms each value
//! that differs.

use gsk_core::cnc::ControlRequest;
use gsk_messages::{Message, say};

use super::{ExecutionEnd, ProgramRun};
use crate::board::{BoardRestart, OperatorAnswer};
use crate::restart::StateDifference;

/// Ticks within which the board is ready for a restart.
const READY_TICKS: u32 = 5000;

impl ProgramRun<'_> {
    /// Plans the restart with which the run begins and hands it to the control, or ends the run.
    /// Does nothing without a restart.
    pub(super) fn prepare_board_restart(&mut self) {
        let planner = self.board.as_mut().and_then(|board| board.restart.take());
        let Some(mut planner) = planner else {
            return;
        };
        // After a reference return the board reports its count a little later.
        for _ in 0..READY_TICKS {
            let refusal = self.simulation.cnc.restart_state_refusal();
            if refusal.is_none() || self.pending_end.is_some() {
                break;
            }
            self.run_tick();
        }
        planner.begin(&self.simulation);
        while self.pending_end.is_none() {
            match planner.poll() {
                None => self.run_tick(),
                Some(Ok(restart)) => return self.accept_restart(restart),
                Some(Err(why)) => self.pending_end = Some(ExecutionEnd::Refused(why)),
            }
        }
    }

    fn accept_restart(&mut self, restart: BoardRestart) {
        let BoardRestart {
            plan,
            part,
            block_lines,
            is_confirmed,
        } = restart;
        let has_operator = self.board.as_ref().is_some_and(|it| it.operator.is_some());
        let asks = !is_confirmed && has_operator;
        self.show_lines(&block_lines);
        if !asks {
            let lines = plan.differences.iter().map(StateDifference::to_message);
            self.show_lines(&lines.collect::<Vec<_>>());
        }
        self.show_lines(&plan.way_lines());
        if !is_confirmed && !has_operator {
            let why = say::restart_needs_code(plan.confirmation_code());
            self.pending_end = Some(ExecutionEnd::Refused(why));
            return;
        }
        for difference in plan.differences.iter().filter(|_| asks) {
            if !self.confirm_difference(&difference.to_message()) {
                let why = ExecutionEnd::Refused(say::restart_confirm_each());
                self.pending_end.get_or_insert(why);
                return;
            }
        }
        let request = ControlRequest::Restart(plan.restart);
        if let Some(why) = self.simulation.cnc.request_refusal(&request) {
            self.pending_end = Some(ExecutionEnd::Refused(why));
            return;
        }
        // The restart raises no alarm.
        let _ = self.simulation.cnc.request(request);
        self.watcher.on_restart(part);
        if let Some(board) = &mut self.board {
            board.is_approaching = true;
        }
    }

    fn show_lines(&mut self, lines: &[Message]) {
        for line in lines {
            self.watcher.show(line);
        }
    }

    /// Shows a difference to the operator and waits for his answer. Returns true for yes.
    fn confirm_difference(&mut self, difference: &Message) -> bool {
        if !self.show_question(difference) {
            return false;
        }
        while self.pending_end.is_none() {
            match self.read_answer(difference) {
                OperatorAnswer::Enter => return true,
                OperatorAnswer::EndOfInput => return false,
                OperatorAnswer::None | OperatorAnswer::Other => self.run_tick(),
            }
        }
        false
    }

    /// Whether the run has stopped at the start point of a restart and continues without a
    /// question: an option has confirmed the differences, and no operator is at the terminal.
    pub(super) fn continues_restart(&mut self) -> bool {
        let has_restart = self.simulation.cnc.has_restart();
        let Some(board) = self.board.as_mut().filter(|it| it.is_approaching) else {
            return false;
        };
        board.is_approaching = has_restart;
        !has_restart && board.operator.is_none()
    }
}
