//! Tests spindle, brake, jog, speeds and gears.

use crate::{AUTO, Control, JOG};

#[test]
fn spindle_by_m_codes() {
    let mut control = Control::new();
    assert!(control.is("Y0.5"), "M05 is held from power-on");
    control.mode(AUTO);
    control.request_m(3);
    control.cycles(2);
    assert!(control.is("Y1.2") && !control.is("Y0.5") && control.is("G74.4"));
    let time = control.finish("F7.0").unwrap() + 48;
    assert!((496..=560).contains(&time), "FIN after {time} ms");
    assert!(control.is("Y1.2"), "held after the code");

    control.run_m(4);
    assert!(control.is("Y1.2") && !control.is("Y0.4"));
    assert_eq!(control.messages(), [1010]);
    assert!(!control.is("G8.5"), "a message holds the program");
    control.set("F204.3", true);
    control.reset();
    assert!(control.is("Y1.2"), "RSJG keeps the spindle");
    assert_eq!(control.messages(), []);

    control.run_m(5);
    assert!(!control.is("Y1.2") && control.is("Y0.5"));
    control.run_m(4);
    assert!(control.is("Y0.4") && control.is("G74.5"));
    control.set("F204.3", false);
    control.reset();
    assert!(!control.is("Y0.4"), "reset stops the spindle");
}

#[test]
fn program_end_stops_spindle_and_coolant() {
    let mut control = Control::new();
    control.mode(AUTO);
    control.run_m(3);
    control.run_m(8);
    assert!(control.is("Y1.2") && control.is("Y0.3"));
    control.set("F9.4", true);
    control.request_m(30);
    let time = control.finish("F7.0").unwrap();
    assert!(time < 100, "FIN at once, after {time} ms");
    assert!(!control.is("Y1.2") && !control.is("Y0.3"));
}

#[test]
fn spindle_by_keys_and_brake() {
    let mut control = Control::new();
    control.mode(AUTO);
    control.press("X23.3");
    assert!(!control.is("Y1.2"), "no manual start in auto mode");
    control.mode(JOG);
    control.press("X23.3");
    assert!(control.is("Y1.2") && control.is("Y5.1"));
    control.press("X23.7");
    assert!(control.is("Y1.2") && !control.is("Y0.4"));
    assert_eq!(control.messages(), [1010]);
    control.reset();

    control.press("X23.7");
    assert!(control.is("Y0.4") && control.is("Y7.1"));
    control.set("X23.5", true);
    control.cycles(2);
    control.set("X23.5", false);
    assert!(!control.is("Y0.4") && control.is("Y6.0"));
    let brake: Vec<bool> = (0..30)
        .map(|_| {
            control.plc.run_slot();
            control.is("Y0.7")
        })
        .collect();
    let first = brake.iter().position(|on| *on).unwrap();
    let length = brake.iter().filter(|on| **on).count();
    assert!((1..=9).contains(&first), "starts after {first} slots");
    assert!((6..=10).contains(&length), "length {length} slots");
}

#[test]
fn spindle_needs_enable_and_chuck() {
    let mut control = Control::new();
    control.plc.memory_mut().set_f(208, 0b0000_1000); // SPEN=1, AGIM=0: low is enabled
    control.set("X0.4", true);
    control.press("X23.3");
    assert!(!control.is("Y1.2"));
    assert_eq!(control.messages(), [1011]);
    control.reset();
    control.set("X0.4", false);
    control.press("X23.3");
    assert!(control.is("Y1.2"));
    control.press("X23.5");

    control.plc.memory_mut().set_f(208, 0b0000_0001); // SLQP=1
    control.press("X23.3");
    assert_eq!(control.messages(), [1011]);
    control.reset();
    control.press("X0.6");
    control.press("X23.3");
    assert!(control.is("Y1.2"), "clamped");
}

#[test]
fn emergency_stop_closes_outputs() {
    let mut control = Control::new();
    control.set("F204.3", true);
    for key in ["X23.3", "X23.4", "X23.6"] {
        control.press(key);
    }
    assert!(control.is("Y1.2") && control.is("Y0.3") && control.is("Y1.1"));
    control.set("X0.5", false);
    control.cycles(2);
    for output in ["Y1.2", "Y0.4", "Y0.3", "Y1.1"] {
        assert!(!control.is(output), "{output}");
    }
    control.set("X0.5", true);
    control.cycles(2);
    assert!(!control.is("Y1.2"), "stays off after release");
}

#[test]
fn spindle_jog() {
    let mut control = Control::new();
    control.set("F214.7", true);
    control.set("F200.4", true);
    control.press("X23.6");
    assert!(control.is("G200.0") && control.is("Y8.7") && !control.is("Y1.1"));
    control.press("X23.3");
    assert!(control.is("Y1.2"));
    control.milliseconds(2700);
    assert!(control.is("Y1.2"));
    control.milliseconds(300);
    assert!(!control.is("Y1.2"), "stops after DT12");
    control.press("X23.3");
    assert!(control.is("Y1.2"));
    control.press("X23.6");
    assert!(
        !control.is("G200.0") && !control.is("Y1.2"),
        "leaving the state stops"
    );
    control.press("X23.6");
    control.mode(AUTO);
    assert!(!control.is("G200.0"));
}

#[test]
fn switched_speeds() {
    let mut control = Control::new();
    let outputs = ["Y1.0", "Y0.0", "Y0.1", "Y1.3"];
    for speed in [1, 2, 3, 4, 0] {
        control.plc.memory_mut().set_f(22, speed);
        control.set("F7.2", true);
        let time = control.finish("F7.2").unwrap();
        assert!((496..=580).contains(&time), "FIN after {time} ms");
        for (number, output) in (1..).zip(outputs) {
            assert_eq!(control.is(output), number == speed, "S{speed} {output}");
        }
    }
    control.set("F211.0", true);
    control.set("F54.2", true);
    control.cycles(2);
    assert!(control.is("Y0.1"), "SUOS leaves S3 to the macro output");
}

#[test]
fn automatic_gear() {
    let mut control = Control::new();
    control.set("F200.4", true);
    control.set("X1.2", true); // gear 2 not in position: AGIM=1, valid when open
    control.request_m(42);
    control.milliseconds(1600);
    assert!(control.is("Y0.0"));
    assert!(!control.is("G4.3"), "waits for the gear");
    control.set("X1.2", false);
    let time = control.finish("F7.0").unwrap();
    assert!((990..=1080).contains(&time), "FIN after {time} ms");
    control.run_m(43);
    assert!(control.is("Y0.1") && !control.is("Y0.0"));
}
