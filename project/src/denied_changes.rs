//! Checks which differences the operator may apply, by the rights of a control at standstill.

use gsk_core::memory::{ControlParameters, OperationLevel, Rights, WriteRefusal};
use gsk_core::mode::OperatingMode;

use crate::difference::ProjectDifference;
use crate::key::{ProjectKey, ProjectSection};

/// A difference that the control refuses to apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeniedChange {
    /// Key of the value that would change.
    pub key: ProjectKey,
    /// The switch, level or mode that forbids the change.
    pub refusal: WriteRefusal,
}

/// Finds the differences that a control with these parameters refuses at this operation level.
///
/// The control is at standstill. 参数开关 (parameter switch) and 程序开关 (program switch) are
/// on if the level allows it. Each value is written in the mode that its page requires. A
/// program arrives through the serial port (decision PROJECT-3).
pub fn find_denied_changes(
    differences: &[ProjectDifference],
    parameters: &ControlParameters,
    level: OperationLevel,
) -> Vec<DeniedChange> {
    let off = Rights {
        parameters,
        level,
        mode: OperatingMode::Mdi,
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
        parameter_switch: off.check_parameter_switch().is_ok(),
        program_switch: off.check_program_switch().is_ok(),
        ..off
    };
    let edit = Rights {
        mode: OperatingMode::Edit,
        ..mdi
    };
    let allowed = |key: ProjectKey| match ProjectSection::from_key(key) {
        ProjectSection::Parameters | ProjectSection::Pitch => mdi.check_parameters(),
        ProjectSection::Offsets => mdi.check_offsets(),
        ProjectSection::Variables => mdi.check_variables(),
        ProjectSection::Settings => mdi.check_settings(),
        ProjectSection::Disks => mdi.check_disks(),
        ProjectSection::Ladder => edit.check_ladder(),
        ProjectSection::Programs => match key {
            ProjectKey::Program(number) => edit.check_receive_program(number),
            _ => Ok(()),
        },
        ProjectSection::Model
        | ProjectSection::Counters
        | ProjectSection::Panel
        | ProjectSection::Data => mdi.check_machine_data(),
        ProjectSection::Machine | ProjectSection::Jobs => Ok(()),
    };
    differences
        .iter()
        .filter_map(|difference| {
            // A switch that is off: report why it cannot be turned on.
            let refusal = match allowed(difference.key).err()? {
                WriteRefusal::ParameterSwitch => off.check_parameter_switch().err()?,
                WriteRefusal::ProgramSwitch => off.check_program_switch().err()?,
                refusal => refusal,
            };
            Some(DeniedChange {
                key: difference.key,
                refusal,
            })
        })
        .collect()
}
