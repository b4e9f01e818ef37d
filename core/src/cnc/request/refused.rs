//! Reasons of requests that are refused without an alarm (manual III-2.5.1), for the line
//! beside the panel.

use super::Request;
use crate::cnc::Cnc;
use crate::memory::Refusal;
use crate::operation::Mode;
use gsk_messages::{Message, say};

/// The mode that a request needs.
const fn needed(request: &Request) -> Mode {
    match request {
        Request::CreateProgram(_)
        | Request::SaveProgramAs(_)
        | Request::RenameProgram(_)
        | Request::DeleteProgram(_)
        | Request::DeleteAllPrograms
        | Request::AskToEdit(_)
        | Request::AskToSend(_) => Mode::Edit,
        _ => Mode::Mdi,
    }
}

fn words(refusal: Refusal, mode: Mode) -> Message {
    match (refusal, mode) {
        (Refusal::Mode, Mode::Edit) => say::request_needs_edit(),
        (Refusal::Mode, _) => say::request_needs_mdi(),
        (Refusal::Running, _) => say::request_while_running(),
        (Refusal::Alarm, _) => say::request_in_alarm(),
        (Refusal::ParameterSwitch, _) => say::request_parameter_switch_off(),
        (Refusal::ProgramSwitch, _) => say::request_program_switch_off(),
        (Refusal::Level, _) => say::request_level_too_low(),
        (Refusal::Locked, _) => say::request_locked(),
    }
}

impl Cnc {
    /// Why a request would be refused now without an alarm. `None`: it would be executed,
    /// or an alarm names the reason.
    pub fn refuses(&self, request: &Request) -> Option<Message> {
        let rights = self.rights();
        let running = |refused: bool| {
            if refused {
                Err(Refusal::Running)
            } else {
                Ok(())
            }
        };
        let right = match request {
            Request::ZeroRelative(_) | Request::ClearParts | Request::ClearCuttingTime => {
                running(self.is_moving())
            }
            Request::SetMachineZero(axis) if self.memory.parameters.has_zero_switch(*axis) => {
                return Some(say::request_zero_by_return());
            }
            Request::SetMachineZero(_) => running(self.is_moving() || rights.operating),
            Request::AskToSend(number) => rights.send_program(*number),
            Request::CreateProgram(number)
            | Request::SaveProgramAs(number)
            | Request::RenameProgram(number)
            | Request::DeleteProgram(number)
            | Request::AskToEdit(number) => rights.program(*number),
            Request::DeleteAllPrograms => rights.program(0),
            Request::SetVariable { .. } | Request::SetMacroVariable { .. } => rights.variables(),
            Request::SetOffset { .. } => rights.offsets(),
            Request::SetParameter { .. }
            | Request::SetParameterBit { .. }
            | Request::SetPitch { .. } => rights.parameters(),
            Request::SetSetting(..) => rights.settings(),
            Request::SetParameterSwitch(true) => rights.parameter_switch(),
            Request::SelectProgram(_) | Request::SetParameterSwitch(false) => {
                running(rights.operating)
            }
            Request::SetProgramSwitch(_) => rights.program_switch(),
            Request::EnterPassword(_) | Request::ChangePassword { .. } | Request::LeaveLevel => {
                rights.password()
            }
            Request::LoadDisk(_) | Request::SaveDisk(_) => rights.disks(),
            Request::SetTool(_) => rights
                .machine_data()
                .and_then(|()| running(rights.operating)),
            Request::SetPreset(..) => rights.machine_data(),
            _ => Ok(()),
        };
        let refusal = right.err()?;
        // A program level that is too low raises an alarm.
        let mode = needed(request);
        let told = mode == Mode::Edit && refusal.alarm().is_some();
        (!told).then(|| words(refusal, mode))
    }
}
