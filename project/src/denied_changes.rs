//! Checks which differences the operator may apply, by the rights of a control at standstill.

use gsk_core::memory::{Level, Parameters, Refusal, Rights};
use gsk_core::mode::Mode;

use crate::difference::ProjectDifference;
use crate::key::{ProjectKey, ProjectSection};

/// A difference that the control refuses to apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeniedChange {
    /// Key of the value.
    pub key: ProjectKey,
    /// The condition that is not met.
    pub refusal: Refusal,
}

/// Finds the differences that a control with these parameters refuses at this operation level.
///
/// The control is at standstill. 参数开关 (parameter switch) and 程序开关 (program switch) are
/// on if the level allows it. Each value is written in the mode that its page requires. A
/// program arrives through the serial port (decision PROJECT-3).
pub fn find_denied_changes(
    differences: &[ProjectDifference],
    parameters: &Parameters,
    level: Level,
) -> Vec<DeniedChange> {
    let off = Rights {
        parameters,
        level,
        mode: Mode::Mdi,
        operating: false,
        running: false,
        moving: false,
        alarm: false,
        emergency_stop: false,
        parameter_switch: false,
        program_switch: false,
        protected: false,
    };
    let mdi = Rights {
        parameter_switch: off.parameter_switch().is_ok(),
        program_switch: off.program_switch().is_ok(),
        ..off
    };
    let edit = Rights {
        mode: Mode::Edit,
        ..mdi
    };
    let allowed = |key: ProjectKey| match ProjectSection::from_key(key) {
        ProjectSection::Parameters | ProjectSection::Pitch => mdi.parameters(),
        ProjectSection::Offsets => mdi.offsets(),
        ProjectSection::Variables => mdi.variables(),
        ProjectSection::Settings => mdi.settings(),
        ProjectSection::Disks => mdi.disks(),
        ProjectSection::Ladder => edit.ladder(),
        ProjectSection::Programs => match key {
            ProjectKey::Program(number) => edit.receive_program(number),
            _ => Ok(()),
        },
        ProjectSection::Model
        | ProjectSection::Counters
        | ProjectSection::Panel
        | ProjectSection::Data => mdi.machine_data(),
        ProjectSection::Machine | ProjectSection::Jobs => Ok(()),
    };
    differences
        .iter()
        .filter_map(|difference| {
            // A switch that is off: report why it cannot be turned on.
            let refusal = match allowed(difference.key).err()? {
                Refusal::ParameterSwitch => off.parameter_switch().err()?,
                Refusal::ProgramSwitch => off.program_switch().err()?,
                refusal => refusal,
            };
            Some(DeniedChange {
                key: difference.key,
                refusal,
            })
        })
        .collect()
}
