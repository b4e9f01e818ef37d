//! Reasons of requests that are refused without an alarm (manual III-2.5.1), for the line
//! beside the panel.

use super::ControlRequest;
use crate::cnc::Cnc;
use crate::memory::WriteRefusal;
use crate::operation::OperatingMode;
use gsk_messages::{Message, say};

/// Returns the operating mode that a request requires.
const fn required_mode(request: &ControlRequest) -> OperatingMode {
    match request {
        ControlRequest::CreateProgram(_)
        | ControlRequest::SaveProgramAs(_)
        | ControlRequest::RenameProgram(_)
        | ControlRequest::DeleteProgram(_)
        | ControlRequest::DeleteAllPrograms
        | ControlRequest::CheckEdit(_)
        | ControlRequest::CheckSend(_) => OperatingMode::Edit,
        _ => OperatingMode::Mdi,
    }
}

fn refusal_message(refusal: WriteRefusal, mode: OperatingMode) -> Message {
    match (refusal, mode) {
        (WriteRefusal::Mode, OperatingMode::Edit) => say::request_needs_edit(),
        (WriteRefusal::Mode, _) => say::request_needs_mdi(),
        (WriteRefusal::Running, _) => say::request_while_running(),
        (WriteRefusal::Alarm, _) => say::request_in_alarm(),
        (WriteRefusal::ParameterSwitch, _) => say::request_parameter_switch_off(),
        (WriteRefusal::ProgramSwitch, _) => say::request_program_switch_off(),
        (WriteRefusal::Level, _) => say::request_level_too_low(),
        (WriteRefusal::Locked, _) => say::request_locked(),
    }
}

impl Cnc {
    /// Message that explains why a request would be refused now without an alarm. `None` if it
    /// would be executed, or if an alarm names the reason.
    pub fn request_refusal(&self, request: &ControlRequest) -> Option<Message> {
        let rights = self.rights();
        let check_running = |refused: bool| {
            if refused {
                Err(WriteRefusal::Running)
            } else {
                Ok(())
            }
        };
        let permission = match request {
            ControlRequest::Restart(restart) => return self.restart_refusal(restart),
            ControlRequest::SetRetrace(false) if self.is_off_hold() => {
                return Some(say::retrace_return_first());
            }
            ControlRequest::ZeroRelative(_)
            | ControlRequest::ClearParts
            | ControlRequest::ClearCuttingTime => check_running(self.is_moving()),
            ControlRequest::SetMachineZero(axis)
                if self.memory.parameters.has_zero_switch(*axis) =>
            {
                return Some(say::request_zero_by_return());
            }
            ControlRequest::SetMachineZero(_) => {
                check_running(self.is_moving() || rights.operating)
            }
            ControlRequest::CheckSend(number) => rights.check_send_program(*number),
            ControlRequest::CreateProgram(number)
            | ControlRequest::SaveProgramAs(number)
            | ControlRequest::RenameProgram(number)
            | ControlRequest::DeleteProgram(number)
            | ControlRequest::CheckEdit(number) => rights.check_program_edit(*number),
            ControlRequest::DeleteAllPrograms => rights.check_program_edit(0),
            ControlRequest::SetVariable { .. } | ControlRequest::SetMacroVariable { .. } => {
                rights.check_variables()
            }
            ControlRequest::SetOffset { .. } => rights.check_offsets(),
            ControlRequest::SetCoordinate(..) => rights
                .check_offsets()
                .and_then(|()| check_running(rights.moving)),
            ControlRequest::SetModelParameter { .. }
            | ControlRequest::SetParameter { .. }
            | ControlRequest::SetParameterBit { .. }
            | ControlRequest::SetPitch { .. } => rights.check_parameters(),
            ControlRequest::SetSetting(..) => rights.check_settings(),
            ControlRequest::SetParameterSwitch(true) => rights.check_parameter_switch(),
            ControlRequest::SelectProgram(_) | ControlRequest::SetParameterSwitch(false) => {
                check_running(rights.operating)
            }
            ControlRequest::SetProgramSwitch(_) => rights.check_program_switch(),
            ControlRequest::EnterPassword(_)
            | ControlRequest::ChangePassword { .. }
            | ControlRequest::LowerLevel => rights.check_password(),
            ControlRequest::LoadDisk(_) | ControlRequest::SaveDisk(_) => rights.check_disks(),
            ControlRequest::SetTool(_) => rights
                .check_machine_data()
                .and_then(|()| check_running(rights.operating)),
            ControlRequest::SetPreset(..) => rights.check_machine_data(),
            _ => Ok(()),
        };
        let refusal = permission.err()?;
        // A program level that is too low raises an alarm.
        let mode = required_mode(request);
        let has_alarm = mode == OperatingMode::Edit && refusal.alarm().is_some();
        (!has_alarm).then(|| refusal_message(refusal, mode))
    }
}
