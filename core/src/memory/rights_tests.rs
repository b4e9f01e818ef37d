use super::*;
use crate::memory::Authority;

fn all_allowed(parameters: &ControlParameters, mode: OperatingMode) -> Rights<'_> {
    Rights {
        parameters,
        level: OperationLevel::WORKSHOP,
        mode,
        operating: false,
        running: false,
        moving: false,
        alarm: false,
        emergency_stop: false,
        parameter_switch: true,
        program_switch: true,
        protected: false,
    }
}

fn level_for(password: &str) -> OperationLevel {
    let mut authority = Authority::default();
    assert!(authority.enter(password));
    authority.level()
}

#[test]
fn programs() {
    let parameters = ControlParameters::default();
    let edit = all_allowed(&parameters, OperatingMode::Edit);
    assert_eq!(edit.check_program_edit(1), Ok(()));
    assert_eq!(edit.check_program_edit(9999), Ok(()));
    let refused = |rights: Rights<'_>, number| rights.check_program_edit(number).unwrap_err();
    assert_eq!(
        refused(all_allowed(&parameters, OperatingMode::Auto), 1),
        WriteRefusal::Mode
    );
    let running = Rights {
        running: true,
        ..edit
    };
    assert_eq!(refused(running, 1), WriteRefusal::Running);
    let off = Rights {
        program_switch: false,
        ..edit
    };
    assert_eq!(refused(off, 1), WriteRefusal::ProgramSwitch);
    let key = Rights {
        protected: true,
        ..edit
    };
    assert_eq!(refused(key, 1), WriteRefusal::Locked);
    let operator = Rights {
        level: level_for("1234"),
        ..edit
    };
    assert_eq!(operator.check_program_edit(8999), Ok(()));
    assert_eq!(refused(operator, 9000), WriteRefusal::Level);
    assert_eq!(WriteRefusal::Level.alarm().unwrap().number, 74);
    assert_eq!(WriteRefusal::Running.alarm(), None);
    let logged_off = Rights {
        level: OperationLevel::NONE,
        ..edit
    };
    assert_eq!(refused(logged_off, 1), WriteRefusal::Level);
}

#[test]
fn programs_in_alarm_and_hidden_ones() {
    let mut parameters = ControlParameters::default();
    fn in_alarm(parameters: &ControlParameters) -> Rights<'_> {
        Rights {
            alarm: true,
            ..all_allowed(parameters, OperatingMode::Edit)
        }
    }
    assert_eq!(
        in_alarm(&parameters).check_program_edit(1),
        Ok(()),
        "012.3 = 1"
    );
    parameters.set_bit(12, 3, false).unwrap();
    assert_eq!(
        in_alarm(&parameters).check_program_edit(1),
        Err(WriteRefusal::Alarm)
    );
    assert_eq!(in_alarm(&parameters).check_program_store(1), Ok(()));
    parameters.set_bit(12, 4, true).unwrap();
    let edit = all_allowed(&parameters, OperatingMode::Edit);
    assert_eq!(edit.check_program_edit(9000), Err(WriteRefusal::Locked));
    assert_eq!(edit.check_program_edit(8999), Ok(()));
    parameters.set_bit(172, 1, true).unwrap();
    let edit = all_allowed(&parameters, OperatingMode::Edit);
    assert_eq!(edit.check_program_edit(1), Err(WriteRefusal::Locked));
    assert_eq!(edit.check_program_switch(), Err(WriteRefusal::Locked));
}

#[test]
fn parameters_settings_and_disks() {
    let mut parameters = ControlParameters::default();
    let writes = |rights: Rights<'_>| [rights.check_parameters(), rights.check_disks()];
    let mdi = all_allowed(&parameters, OperatingMode::Mdi);
    assert_eq!(writes(mdi), [Ok(()); 2]);
    assert_eq!(mdi.check_settings(), Ok(()));
    let jog = all_allowed(&parameters, OperatingMode::Jog);
    assert_eq!(writes(jog), [Err(WriteRefusal::Mode); 2]);
    let stopped = Rights {
        emergency_stop: true,
        ..jog
    };
    assert_eq!(writes(stopped), [Ok(()); 2]);
    assert_eq!(stopped.check_settings(), Err(WriteRefusal::Mode));
    for (rights, refusal) in [
        (
            Rights {
                parameter_switch: false,
                ..mdi
            },
            WriteRefusal::ParameterSwitch,
        ),
        (
            Rights {
                moving: true,
                ..mdi
            },
            WriteRefusal::Running,
        ),
        (
            Rights {
                operating: true,
                ..mdi
            },
            WriteRefusal::Running,
        ),
        (
            Rights {
                level: level_for("1234"),
                ..mdi
            },
            WriteRefusal::Level,
        ),
    ] {
        assert_eq!(writes(rights), [Err(refusal); 2]);
        assert_eq!(rights.check_settings(), Err(refusal));
    }
    parameters.set_bit(172, 2, true).unwrap();
    let locked = all_allowed(&parameters, OperatingMode::Mdi);
    assert_eq!(locked.check_parameters(), Err(WriteRefusal::Locked));
    assert_eq!(locked.check_parameter_switch(), Err(WriteRefusal::Locked));
    assert_eq!(locked.check_program_switch(), Ok(()));
}

#[test]
fn offsets_variables_and_presets() {
    let parameters = ControlParameters::default();
    let auto = Rights {
        operating: true,
        running: true,
        parameter_switch: false,
        program_switch: false,
        ..all_allowed(&parameters, OperatingMode::Auto)
    };
    assert_eq!(auto.check_offsets(), Ok(()), "while a program runs too");
    assert_eq!(auto.check_variables(), Err(WriteRefusal::Mode));
    assert_eq!(auto.check_parameter_switch(), Err(WriteRefusal::Running));
    let mdi = all_allowed(&parameters, OperatingMode::Mdi);
    assert_eq!(mdi.check_variables(), Ok(()));
    assert_eq!(mdi.check_machine_data(), Ok(()));
    let logged_off = Rights {
        level: OperationLevel::NONE,
        ..mdi
    };
    assert_eq!(logged_off.check_offsets(), Err(WriteRefusal::Level));
    assert_eq!(logged_off.check_variables(), Err(WriteRefusal::Level));
    assert_eq!(logged_off.check_password(), Ok(()));
    let key = Rights {
        protected: true,
        ..mdi
    };
    assert_eq!(key.check_offsets(), Err(WriteRefusal::Locked));
    assert_eq!(key.check_parameters(), Err(WriteRefusal::Locked));
    assert_eq!(key.check_disks(), Err(WriteRefusal::Locked));
}

#[test]
fn a_ladder_is_loaded_in_edit_mode_with_the_parameter_switch_on() {
    let parameters = ControlParameters::default();
    let edit = all_allowed(&parameters, OperatingMode::Edit);
    assert_eq!(edit.check_ladder(), Ok(()));
    for (rights, refusal) in [
        (
            all_allowed(&parameters, OperatingMode::Mdi),
            WriteRefusal::Mode,
        ),
        (
            Rights {
                operating: true,
                ..edit
            },
            WriteRefusal::Running,
        ),
        (
            Rights {
                parameter_switch: false,
                ..edit
            },
            WriteRefusal::ParameterSwitch,
        ),
        (
            Rights {
                protected: true,
                ..edit
            },
            WriteRefusal::Locked,
        ),
        (
            Rights {
                level: level_for("1234"),
                ..edit
            },
            WriteRefusal::Level,
        ),
    ] {
        assert_eq!(rights.check_ladder(), Err(refusal));
    }
}

#[test]
fn memory_key_protects_presets_and_tool_number() {
    let parameters = ControlParameters::default();
    let mdi = all_allowed(&parameters, OperatingMode::Mdi);
    assert_eq!(mdi.check_machine_data(), Ok(()));
    let key = Rights {
        protected: true,
        ..mdi
    };
    assert_eq!(key.check_machine_data(), Err(WriteRefusal::Locked));
}
