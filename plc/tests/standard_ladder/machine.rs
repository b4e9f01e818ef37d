//! Tests coolant, lubrication, chuck, tailstock and guards.

use crate::{AUTO, Control, MODES};

#[test]
fn coolant_in_every_mode() {
    for mode in MODES {
        let mut control = Control::new();
        control.mode(mode);
        control.press("X23.4");
        assert!(control.is("Y0.3") && control.is("Y5.0"));
        control.press("X23.4");
        assert!(!control.is("Y0.3"));
        control.run_m(8);
        assert!(control.is("Y0.3"));
        control.run_m(9);
        assert!(!control.is("Y0.3"));
    }
}

#[test]
fn lubrication() {
    let mut control = Control::new();
    control.press("X23.6");
    assert!(control.is("Y1.1") && control.is("Y8.7"));
    control.press("X23.6");
    assert!(!control.is("Y1.1"));
    control.run_m(32);
    assert!(control.is("Y1.1"));
    control.run_m(33);
    assert!(!control.is("Y1.1"));
    control.plc.memory_mut().set_dt(13, 200);
    control.request_m(32);
    control.cycles(2);
    assert!(control.is("Y1.1"));
    control.milliseconds(300);
    assert!(!control.is("Y1.1"), "limited, although M32 is still active");
    control.finish("F7.0");
    assert!(!control.is("Y1.1"));
}

#[test]
fn chuck() {
    let mut control = Control::new();
    control.plc.memory_mut().set_f(208, 0b1110_0001);
    assert!(
        !control.is("Y0.6") && !control.is("Y1.5"),
        "off at power-on"
    );
    control.press("X0.6");
    assert!(control.is("Y0.6") && !control.is("Y1.5"), "first clamps");
    control.press("X0.6");
    assert!(!control.is("Y0.6") && control.is("Y1.5"));
    control.set("F209.0", true);
    control.cycles(2);
    assert!(control.is("Y0.6"), "outer chuck: inverted outputs");
    control.set("F209.0", false);

    control.set("F209.2", true);
    control.request_m(12);
    control.milliseconds(1000);
    assert!(
        control.is("Y0.6") && !control.is("G4.3"),
        "waits for the position"
    );
    control.set("X1.2", true);
    control.finish("F7.0").unwrap();

    control.press("X23.3");
    assert!(control.is("Y1.2"));
    control.press("X0.6");
    assert!(control.is("Y0.6"), "ignored while the spindle turns");
    control.request_m(13);
    control.cycles(3);
    assert!(control.is("Y0.6"));
    assert_eq!(control.messages(), [1012]);
    control.reset();
    assert!(control.is("Y0.6"), "reset keeps the chuck");

    control.set("F208.0", false);
    control.request_m(12);
    control.cycles(3);
    assert_eq!(control.messages(), [1013]);
}

#[test]
fn tailstock() {
    let mut control = Control::new();
    control.press("X0.2");
    assert!(control.is("Y0.2") && !control.is("Y1.4"));
    control.press("X0.2");
    assert!(!control.is("Y0.2") && control.is("Y1.4"));
    control.run_m(10).unwrap();
    assert!(control.is("Y0.2"));
    control.press("X23.3");
    control.run_m(11).unwrap();
    assert!(control.is("Y0.2"));
    assert_eq!(control.messages(), [1009]);
    control.reset();
    control.run_m(11).unwrap();
    assert!(control.is("Y1.4"));
    control.set("F208.2", false);
    control.run_m(10).unwrap();
    assert_eq!(control.messages(), [1008]);
}

#[test]
fn an_input_closed_at_power_on_is_no_edge() {
    let mut control = Control::new();
    control.plc.power_on();
    control.plc.memory_mut().set_f(208, 0b0000_0101);
    control.plc.memory_mut().set_x(0, 0b0110_0100);
    control.plc.memory_mut().set_x(20, 0b0100_0000);
    control.cycles(4);
    assert!(!control.is("Y0.2") && !control.is("Y0.6") && !control.is("G46.1"));
}

#[test]
fn low_pressure() {
    let mut control = Control::new();
    control.plc.memory_mut().set_dt(2, 200);
    control.set("F209.4", true);
    control.press("X23.3");
    control.press("X23.4");
    control.set("X0.7", true);
    control.milliseconds(150);
    assert!(control.is("Y1.2"));
    control.milliseconds(150);
    assert!(!control.is("Y1.2") && !control.is("Y0.3") && !control.is("G8.5"));
    assert_eq!(control.messages(), [1014]);
    control.set("X25.0", true);
    control.plc.run_slot();
    assert!(!control.is("G7.2"), "no start");
    control.set("X25.0", false);
    control.reset();
    assert_eq!(control.messages(), [1014], "still low");
    control.set("X0.7", false);
    control.reset();
    assert_eq!(control.messages(), []);
    assert!(control.is("G8.5"));
}

#[test]
fn guard_door() {
    let mut control = Control::new();
    control.plc.memory_mut().set_f(209, 0b0100_0000);
    control.set("X1.5", true);
    control.press("X25.0");
    assert_eq!(control.messages(), [], "auto mode only");
    control.mode(AUTO);
    control.set("X25.0", true);
    control.cycles(3);
    assert!(!control.is("G7.2"));
    assert_eq!(control.messages(), [1015]);
    control.set("X25.0", false);
    control.set("X1.5", false);
    control.reset();
    assert!(control.is("G8.5"));
    control.run_m(3);
    control.set("F0.7", true);
    control.set("X1.5", true);
    control.cycles(3);
    assert!(!control.is("Y1.2") && !control.is("G8.5"));
    assert_eq!(control.messages(), [1015]);
}

#[test]
fn blocked_start_request_ends_in_feed_hold() {
    // G7.2 falls when the start is blocked. *SP must be 0 by then.
    let mut control = Control::new();
    control.plc.memory_mut().set_f(209, 0b0100_0000);
    control.mode(AUTO);
    control.set("X25.0", true);
    control.cycles(2);
    assert!(control.is("G7.2"));
    control.set("X1.5", true);
    for _ in 0..12 {
        control.plc.run_slot();
        assert!(control.is("G7.2") || !control.is("G8.5"));
    }
    assert!(!control.is("G7.2"));
}

#[test]
fn ladder_ignores_the_cycle_start_enable() {
    let mut control = Control::new();
    control.plc.memory_mut().set_f(208, 0b0001_0000); // STEN=1, AGIM=0: low is enabled
    control.set("X1.2", true);
    control.mode(AUTO);
    control.set("X25.0", true);
    control.cycles(3);
    assert!(control.is("G7.2"));
    assert_eq!(control.messages(), [0u16; 0]);
}
