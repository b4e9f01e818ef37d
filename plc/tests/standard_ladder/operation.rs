//! Tests modes, cycle start, overrides, axis keys and lamps.

use std::sync::Arc;

use gsk_plc::Plc;

use crate::{AUTO, Control, EDIT, HANDWHEEL, JOG, MACHINE_ZERO, MDI, PROGRAM_ZERO};

#[test]
fn mode_keys() {
    let mut control = Control::new();
    let keys = [
        ("X20.0", EDIT),
        ("X20.1", AUTO),
        ("X20.2", MDI),
        ("X20.3", MACHINE_ZERO),
        ("X20.4", HANDWHEEL),
        ("X20.5", JOG),
        ("X21.3", PROGRAM_ZERO),
    ];
    for (key, (code, _)) in keys {
        control.press(key);
        assert_eq!(control.plc.memory().g(43), code, "{key}");
        assert_eq!(control.plc.memory().k(9), code, "{key}");
    }
}

#[test]
fn power_on_restores_mode_tool_and_overrides() {
    let mut control = Control::new();
    control.press("X20.1");
    control.press("X24.3");
    control.press("X24.4");
    control.plc.memory_mut().set_k(12, 3);
    let retained = control.plc.memory().retained();
    let mut plc = Plc::new(Arc::clone(control.plc.ladder()));
    plc.memory_mut().restore_retained(&retained);
    plc.power_on();
    plc.memory_mut().set_x(0, 0x20);
    for _ in 0..6 {
        plc.run_slot();
    }
    let memory = plc.memory();
    assert_eq!((memory.g(43), memory.g(201), memory.g(18)), (1, 3, 1));
    assert_eq!(
        (memory.g(12), memory.g(10), memory.g(14), memory.g(30)),
        (4, 4, 0, 1)
    );
}

#[test]
fn emergency_stop_and_feed_hold_act_in_one_slot() {
    let mut control = Control::new();
    assert!(control.is("G8.4") && control.is("G8.5"));
    control.set("X0.5", false);
    control.plc.run_slot();
    assert!(!control.is("G8.4"));
    control.set("F210.3", true);
    control.plc.run_slot();
    assert!(control.is("G8.4"), "masked by MESP");

    control.set("X24.7", true);
    control.plc.run_slot();
    assert!(!control.is("G8.5"));
    control.set("X24.7", false);
    control.plc.run_slot();
    assert!(control.is("G8.5"), "the open pin is masked by MSP");
    control.set("F210.5", false);
    control.plc.run_slot();
    assert!(!control.is("G8.5"));
    control.set("X1.5", true);
    control.plc.run_slot();
    assert!(control.is("G8.5"));
}

#[test]
fn cycle_start() {
    let mut control = Control::new();
    control.mode(AUTO);
    control.set("X25.0", true);
    control.plc.run_slot();
    assert!(control.is("G7.2"));
    control.set("X25.0", false);
    control.plc.run_slot();
    assert!(!control.is("G7.2"));

    control.set("X1.4", true);
    control.plc.run_slot();
    assert!(!control.is("G7.2"), "the pin is masked by MST");
    control.set("F210.6", false);
    control.plc.run_slot();
    assert!(control.is("G7.2"));
    control.set("X1.4", false);

    control.set("F197.1", true);
    control.set("F201.2", true);
    control.plc.run_slot();
    assert!(!control.is("G7.2"), "OUT starts in MDI only");
    control.mode(MDI);
    assert!(control.is("G7.2"));
}

#[test]
fn toggles_and_soft_switches() {
    let mut control = Control::new();
    // Key, soft switch, signal.
    let table = [
        ("X20.6", "F75.3", "G46.1"),
        ("X20.7", "F75.2", "G44.0"),
        ("X21.0", "F75.4", "G44.1"),
        ("X21.1", "F75.1", "G5.6"),
        ("X21.2", "F75.5", "G46.7"),
    ];
    for (key, switch, signal) in table {
        control.press(key);
        assert!(control.is(signal), "{key}");
        control.press(key);
        assert!(!control.is(signal), "{key}");
        control.set(switch, true);
        control.cycles(2);
        assert!(control.is(signal), "{switch}");
        control.press(key);
        assert!(!control.is(signal), "{key} against {switch}");
        control.press(key);
        control.set(switch, false);
        control.cycles(2);
        assert!(!control.is(signal), "{switch}");
    }
    control.press("X21.2");
    assert!(control.is("G44.1") && control.is("G5.6"), "dry run locks");
    control.press("X21.2");
    assert!(!control.is("G44.1") && !control.is("G5.6"));

    control.set("X0.2", true);
    control.cycles(2);
    assert!(!control.is("G44.0"), "the pin is the tailstock's");
    control.set("F208.2", false);
    control.cycles(2);
    assert!(control.is("G44.0"));
}

#[test]
fn feed_override_steps_once_a_press() {
    let mut control = Control::new();
    assert_eq!(control.plc.memory().g(12), 5);
    control.press("X24.3");
    assert_eq!(
        (control.plc.memory().c(0), control.plc.memory().g(12)),
        (12, 4)
    );
    assert_eq!(control.plc.memory().g(10), 4);
    for _ in 0..6 {
        control.press("X24.3");
    }
    assert_eq!(control.plc.memory().g(12), 0);
    assert!(control.is("Y8.4") && !control.is("Y8.1"));
    for code in 1..=15 {
        control.press("X24.6");
        assert_eq!(control.plc.memory().g(12), code);
    }
    control.press("X24.6");
    assert_eq!(control.plc.memory().g(12), 15);
    assert!(control.is("Y8.1") && !control.is("Y8.4"));

    control.set("F210.0", true);
    control.set("X1.0", true);
    control.cycles(2);
    assert_eq!(control.plc.memory().g(12), 0b0010, "external switch");
}

#[test]
fn rapid_and_spindle_override() {
    let mut control = Control::new();
    assert!(control.is("Y8.2"));
    for code in [2, 1, 3, 3] {
        control.press("X24.5");
        assert_eq!(control.plc.memory().g(14), code);
    }
    assert!(control.is("Y8.5") && !control.is("Y8.2"));
    control.mode(EDIT);
    control.press("X24.2");
    assert_eq!(control.plc.memory().g(14), 3, "not in edit mode");
    control.mode(HANDWHEEL);
    control.press("X24.2");
    assert_eq!(control.plc.memory().g(14), 3, "not in handwheel mode");

    for code in [4, 5, 5] {
        control.press("X24.1");
        assert_eq!(control.plc.memory().g(30), code);
    }
    assert!(control.is("Y8.6"));
    for code in [4, 0, 1, 3, 2, 6, 7, 7] {
        control.press("X24.4");
        assert_eq!(control.plc.memory().g(30), code);
    }
    assert!(control.is("Y8.3") && !control.is("Y8.6"));
    assert_eq!(control.plc.memory().k(11), 7);
}

#[test]
fn rapid_key_toggles_until_the_mode_changes() {
    let mut control = Control::new();
    control.press("X22.6");
    assert!(control.is("G19.7") && control.is("Y4.4") && control.is("Y6.1"));
    control.press("X22.6");
    assert!(!control.is("G19.7"));
    control.press("X22.6");
    control.press("X20.1");
    assert!(!control.is("G19.7"), "a mode change clears it");
    control.mode(EDIT);
    control.press("X22.6");
    assert!(!control.is("G19.7"), "dead in edit mode");
}

#[test]
fn axis_keys() {
    let mut control = Control::new();
    let table = [
        ("X22.3", "G102.0", "G100.0"),
        ("X23.1", "G100.0", "G102.0"),
        ("X22.5", "G102.1", "G100.1"),
        ("X22.7", "G100.1", "G102.1"),
    ];
    for turned in [false, true] {
        control.set("F214.0", turned);
        control.set("F214.1", turned);
        for (key, plain, inverse) in table {
            control.set(key, true);
            control.cycles(2);
            let (on, off) = if turned {
                (inverse, plain)
            } else {
                (plain, inverse)
            };
            assert!(control.is(on) && !control.is(off), "{key}");
            control.set(key, false);
            control.cycles(2);
            assert!(!control.is(on), "{key}");
        }
    }
    control.set("X22.3", true);
    control.set("X23.1", true);
    control.cycles(2);
    assert!(!control.is("G100.0") && !control.is("G102.0"));
    control.set("X22.3", false);
    control.set("X23.1", false);
    control.mode(AUTO);
    control.set("X22.3", true);
    control.cycles(2);
    assert!(!control.is("G100.0"), "no jog in auto mode");
    control.mode(JOG);
    control.cycles(2);
    assert!(!control.is("G100.0"), "held across a mode change");
    control.set("X22.3", false);
    control.cycles(2);
    control.set("X22.3", true);
    control.cycles(2);
    assert!(control.is("G100.0"));
}

#[test]
fn zero_return_keys_latch_with_znik() {
    for (mode, zero) in [(MACHINE_ZERO, "F94.0"), (PROGRAM_ZERO, "F198.0")] {
        let mut control = Control::new();
        control.mode(mode);
        control.press("X23.1");
        assert!(!control.is("G100.0"), "ZNIK=0: only while pressed");
        control.set("F205.2", true);
        control.press("X23.1");
        assert!(control.is("G100.0"));
        control.set(zero, true);
        control.cycles(2);
        assert!(!control.is("G100.0") && control.is("Y4.7"));
        control.set(zero, false);
        control.press("X23.1");
        control.reset();
        assert!(!control.is("G100.0"), "reset stops");
        control.press("X23.1");
        control.press("X20.5");
        assert!(!control.is("G100.0"), "a mode change stops");
    }
}

#[test]
fn handwheel_axis_and_step() {
    let mut control = Control::new();
    control.press("X22.1");
    assert_eq!(control.plc.memory().g(18), 1, "handwheel mode only");
    control.mode(HANDWHEEL);
    assert!(control.is("Y7.4") && control.is("Y7.7"));
    control.press("X22.1");
    assert_eq!(control.plc.memory().g(18), 2);
    assert!(control.is("Y7.2") && !control.is("Y7.4"));
    control.press("X21.5");
    assert_eq!(control.plc.memory().g(19) >> 4 & 3, 1);
    assert!(control.is("Y7.6"));
    control.press("X21.6");
    assert_eq!(control.plc.memory().g(19) >> 4 & 3, 2);
    assert!(control.is("Y7.5"));
    control.set("F211.1", true);
    control.cycles(2);
    assert_eq!(control.plc.memory().g(19) >> 4 & 3, 0, "SINC forbids 0.1");
    control.press("X21.6");
    assert_eq!(control.plc.memory().g(19) >> 4 & 3, 0);
}

#[test]
fn mode_and_function_lamps() {
    let mut control = Control::new();
    let mode_lamps = [
        (EDIT, "Y5.7"),
        (AUTO, "Y5.6"),
        (MDI, "Y5.5"),
        (MACHINE_ZERO, "Y5.4"),
        (HANDWHEEL, "Y5.3"),
        (JOG, "Y5.2"),
        (PROGRAM_ZERO, "Y6.2"),
    ];
    for (mode, lamp) in mode_lamps {
        control.mode(mode);
        let lit: Vec<&str> = mode_lamps
            .iter()
            .map(|(_, lamp)| *lamp)
            .filter(|lamp| control.is(lamp))
            .collect();
        assert_eq!(lit, [lamp]);
    }
    let lamps = [
        ("F4.4", "Y4.0", "Y6.4"),
        ("F4.1", "Y4.1", "Y6.5"),
        ("F4.0", "Y4.2", "Y6.6"),
        ("F4.3", "Y4.3", "Y6.7"),
        ("F2.7", "Y9.1", "Y6.3"),
        ("F0.5", "Y8.0", "Y8.0"),
        ("F0.4", "Y9.0", "Y9.0"),
        ("F94.1", "Y4.5", "Y4.5"),
    ];
    for (signal, strip, key) in lamps {
        control.set(signal, true);
        control.cycles(2);
        assert!(control.is(strip) && control.is(key), "{signal}");
        control.set(signal, false);
        control.cycles(2);
        assert!(!control.is(strip) && !control.is(key), "{signal}");
    }
}

#[test]
fn macro_inputs() {
    let mut control = Control::new();
    let pins = [
        "X1.6", "X1.7", "X0.0", "X0.1", "X0.2", "X0.3", "X0.6", "X0.7", "X0.4", "X1.0", "X1.1",
        "X1.2", "X0.5", "X1.3", "X1.4", "X1.5",
    ];
    for (number, pin) in pins.into_iter().enumerate() {
        control.plc.memory_mut().set_x(0, 0);
        control.plc.memory_mut().set_x(1, 0);
        control.set(pin, true);
        control.cycles(2);
        let word = control.plc.memory().word("G54".parse().unwrap());
        assert_eq!(word, 1 << number, "{pin}");
    }
}
