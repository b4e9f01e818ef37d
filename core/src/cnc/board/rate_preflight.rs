//! Interprets a program before it begins, to check the pulse rates of its cuts.

use core::cell::LazyCell;

use crate::alarm::Alarm;
use crate::board::BoardDrives;
use crate::cnc::Cnc;
use crate::command::{Action, ProgramId, SpindleCommand};
use crate::interpreter::AdvanceResult;
use crate::interpreter::Host;
use crate::interpreter::ImmediateHost;

/// Number of commands after which the check ends: it must not delay a board that waits
/// for its heartbeat. Later commands are checked when they begin.
const MAX_COMMANDS: u32 = 100_000;

impl Cnc {
    /// Interprets a program, with the current offsets, overrides and inputs, and returns the alarm
    /// for the first cut whose pulse rate exceeds that of the board; `None` without one. Other
    /// errors of the program are reported at their execution.
    pub(crate) fn check_rates_for_board(
        &mut self,
        board: &BoardDrives,
        program: ProgramId,
    ) -> Option<Alarm> {
        if self.dry_run().is_some() {
            return None;
        }
        let line = if self.run.rewind_at_start {
            1
        } else {
            self.run.cursor_line
        };
        let mut interpreter = self.run.interpreter.clone();
        let (inputs, outputs) = {
            let (_, world) = self.interpreter_and_world(true);
            (world.interface_inputs(), world.interface_outputs())
        };
        let mut host = ImmediateHost {
            parameters: self.memory.parameters.clone(),
            offsets: self.memory.offsets.clone(),
            registers: self.run.registers,
            counters: self.memory.counters,
            settings: self.memory.settings,
            now_s: self.machine_time_s(),
            variables: self.memory.variables.clone(),
            inputs: LazyCell::new(Box::new(move || inputs)),
            outputs,
            programs: &self.memory.programs,
            machine_position: self.position(),
            referenced: self.coordinates.referenced,
            block_skip: self.plc.signals.block_skip,
        };
        let speed = self.spindle.control.commanded_rpm();
        let mut rpm = (speed > 0.0).then_some(speed);
        let mut at = host.machine_position;
        interpreter.start(program, line, &host);
        let mut next = None;
        for _ in 0..MAX_COMMANDS {
            let Ok(AdvanceResult::Command) = interpreter.advance(&mut host, &mut next) else {
                return None;
            };
            let command = next.as_ref()?;
            if let Some(alarm) = self.pulse_rate_alarm(board, &command.action, at, rpm) {
                return Some(alarm.with_source(command.source));
            }
            match command.action {
                Action::Rapid { to }
                | Action::Line { to, .. }
                | Action::Arc { to, .. }
                | Action::Thread { to, .. } => {
                    at = to;
                    host.machine_position = to;
                }
                Action::Spindle(SpindleCommand::Speed(speed)) => rpm = Some(speed),
                Action::Spindle(SpindleCommand::Limit(_)) => {}
                Action::Spindle(_) => rpm = None,
                Action::End { .. } | Action::Repeat => return None,
                _ => {}
            }
        }
        None
    }
}
