//! Who may take over what: the rights of the control, for one that stands still.

use gsk_core::memory::{Level, Parameters, Refusal, Rights};
use gsk_core::mode::Mode;

use crate::difference::Difference;
use crate::key::{Key, Section};

/// What the control refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Denied {
    /// Which value.
    pub key: Key,
    /// What stands against it.
    pub refusal: Refusal,
}

/// The differences that a control with these parameters refuses at this operation level. It
/// stands still, and 参数开关 and 程序开关 are on where it allows that; each value is written
/// in the mode that its page asks for, a program comes through the serial port (decision
/// PROJECT-3).
pub fn denied(differences: &[Difference], parameters: &Parameters, level: Level) -> Vec<Denied> {
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
    let allowed = |key: Key| match Section::of(key) {
        Section::Parameters | Section::Pitch => mdi.parameters(),
        Section::Offsets => mdi.offsets(),
        Section::Variables => mdi.variables(),
        Section::Settings => mdi.settings(),
        Section::Disks => mdi.disks(),
        Section::Ladder => edit.ladder(),
        Section::Programs => match key {
            Key::Program(number) => edit.receive_program(number),
            _ => Ok(()),
        },
        Section::Model | Section::Counters | Section::Panel | Section::Data => mdi.machine_data(),
        Section::Machine | Section::Jobs => Ok(()),
    };
    differences
        .iter()
        .filter_map(|difference| {
            // Of a switch that is not put on: why not.
            let refusal = match allowed(difference.key).err()? {
                Refusal::ParameterSwitch => off.parameter_switch().err()?,
                Refusal::ProgramSwitch => off.program_switch().err()?,
                refusal => refusal,
            };
            Some(Denied {
                key: difference.key,
                refusal,
            })
        })
        .collect()
}
