use super::*;
use crate::memory::Authority;

/// A state in which everything is allowed: EDIT for programs, MDI for other data.
fn open(parameters: &Parameters, mode: Mode) -> Rights<'_> {
    Rights {
        parameters,
        level: Level::WORKSHOP,
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

fn level(password: &str) -> Level {
    let mut authority = Authority::default();
    assert!(authority.enter(password));
    authority.level()
}

#[test]
fn programs() {
    let parameters = Parameters::default();
    let edit = open(&parameters, Mode::Edit);
    assert_eq!(edit.program(1), Ok(()));
    assert_eq!(edit.program(9999), Ok(()));
    let refused = |rights: Rights<'_>, number| rights.program(number).unwrap_err();
    assert_eq!(refused(open(&parameters, Mode::Auto), 1), Refusal::Mode);
    let running = Rights {
        running: true,
        ..edit
    };
    assert_eq!(refused(running, 1), Refusal::Running);
    let off = Rights {
        program_switch: false,
        ..edit
    };
    assert_eq!(refused(off, 1), Refusal::ProgramSwitch);
    let key = Rights {
        protected: true,
        ..edit
    };
    assert_eq!(refused(key, 1), Refusal::Locked);
    let operator = Rights {
        level: level("1234"),
        ..edit
    };
    assert_eq!(operator.program(8999), Ok(()));
    assert_eq!(refused(operator, 9000), Refusal::Level);
    assert_eq!(Refusal::Level.alarm().unwrap().number, 74);
    assert_eq!(Refusal::Running.alarm(), None);
    let nobody = Rights {
        level: Level::NONE,
        ..edit
    };
    assert_eq!(refused(nobody, 1), Refusal::Level);
}

#[test]
fn programs_in_alarm_and_hidden_ones() {
    let mut parameters = Parameters::default();
    fn in_alarm(parameters: &Parameters) -> Rights<'_> {
        Rights {
            alarm: true,
            ..open(parameters, Mode::Edit)
        }
    }
    assert_eq!(in_alarm(&parameters).program(1), Ok(()), "012.3 = 1");
    parameters.set_bit(12, 3, false).unwrap();
    assert_eq!(in_alarm(&parameters).program(1), Err(Refusal::Alarm));
    assert_eq!(in_alarm(&parameters).program_memory(1), Ok(()));
    parameters.set_bit(12, 4, true).unwrap();
    let edit = open(&parameters, Mode::Edit);
    assert_eq!(edit.program(9000), Err(Refusal::Locked));
    assert_eq!(edit.program(8999), Ok(()));
    parameters.set_bit(172, 1, true).unwrap();
    let edit = open(&parameters, Mode::Edit);
    assert_eq!(edit.program(1), Err(Refusal::Locked));
    assert_eq!(edit.program_switch(), Err(Refusal::Locked));
}

#[test]
fn parameters_settings_and_disks() {
    let mut parameters = Parameters::default();
    let writes = |rights: Rights<'_>| [rights.parameters(), rights.disks()];
    let mdi = open(&parameters, Mode::Mdi);
    assert_eq!(writes(mdi), [Ok(()); 2]);
    assert_eq!(mdi.settings(), Ok(()));
    let jog = open(&parameters, Mode::Jog);
    assert_eq!(writes(jog), [Err(Refusal::Mode); 2]);
    let stopped = Rights {
        emergency_stop: true,
        ..jog
    };
    assert_eq!(writes(stopped), [Ok(()); 2]);
    assert_eq!(stopped.settings(), Err(Refusal::Mode));
    for (rights, refusal) in [
        (
            Rights {
                parameter_switch: false,
                ..mdi
            },
            Refusal::ParameterSwitch,
        ),
        (
            Rights {
                moving: true,
                ..mdi
            },
            Refusal::Running,
        ),
        (
            Rights {
                operating: true,
                ..mdi
            },
            Refusal::Running,
        ),
        (
            Rights {
                level: level("1234"),
                ..mdi
            },
            Refusal::Level,
        ),
    ] {
        assert_eq!(writes(rights), [Err(refusal); 2]);
        assert_eq!(rights.settings(), Err(refusal));
    }
    parameters.set_bit(172, 2, true).unwrap();
    let locked = open(&parameters, Mode::Mdi);
    assert_eq!(locked.parameters(), Err(Refusal::Locked));
    assert_eq!(locked.parameter_switch(), Err(Refusal::Locked));
    assert_eq!(locked.program_switch(), Ok(()));
}

#[test]
fn offsets_variables_and_presets() {
    let parameters = Parameters::default();
    let auto = Rights {
        operating: true,
        running: true,
        parameter_switch: false,
        program_switch: false,
        ..open(&parameters, Mode::Auto)
    };
    assert_eq!(auto.offsets(), Ok(()), "while a program runs too");
    assert_eq!(auto.variables(), Err(Refusal::Mode));
    assert_eq!(auto.parameter_switch(), Err(Refusal::Running));
    let mdi = open(&parameters, Mode::Mdi);
    assert_eq!(mdi.variables(), Ok(()));
    assert_eq!(mdi.machine_data(), Ok(()));
    let nobody = Rights {
        level: Level::NONE,
        ..mdi
    };
    assert_eq!(nobody.offsets(), Err(Refusal::Level));
    assert_eq!(nobody.variables(), Err(Refusal::Level));
    assert_eq!(nobody.password(), Ok(()));
    let key = Rights {
        protected: true,
        ..mdi
    };
    assert_eq!(key.offsets(), Err(Refusal::Locked));
    assert_eq!(key.parameters(), Err(Refusal::Locked));
    assert_eq!(key.disks(), Err(Refusal::Locked));
}

#[test]
fn a_ladder_is_loaded_in_edit_mode_with_the_parameter_switch_on() {
    let parameters = Parameters::default();
    let edit = open(&parameters, Mode::Edit);
    assert_eq!(edit.ladder(), Ok(()));
    for (rights, refusal) in [
        (open(&parameters, Mode::Mdi), Refusal::Mode),
        (
            Rights {
                operating: true,
                ..edit
            },
            Refusal::Running,
        ),
        (
            Rights {
                parameter_switch: false,
                ..edit
            },
            Refusal::ParameterSwitch,
        ),
        (
            Rights {
                protected: true,
                ..edit
            },
            Refusal::Locked,
        ),
        (
            Rights {
                level: level("1234"),
                ..edit
            },
            Refusal::Level,
        ),
    ] {
        assert_eq!(rights.ladder(), Err(refusal));
    }
}

#[test]
fn the_key_of_the_memory_guards_presets_and_tool_number() {
    let parameters = Parameters::default();
    let mdi = open(&parameters, Mode::Mdi);
    assert_eq!(mdi.machine_data(), Ok(()));
    let key = Rights {
        protected: true,
        ..mdi
    };
    assert_eq!(key.machine_data(), Err(Refusal::Locked));
}
