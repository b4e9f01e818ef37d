//! Tests tool change and completion.

use crate::{AUTO, Control, JOG};

/// Commands a tool. The turret passes a station every 600 ms while TL+ is on. Returns
/// whether FIN came.
fn turn_to(control: &mut Control, tool: u8, from: usize) -> bool {
    control.plc.memory_mut().set_f(26, tool);
    control.set("F7.3", true);
    let mut turned = from * 600;
    for _ in 0..2500 {
        control.plc.run_slot();
        if control.is("G4.3") {
            return true;
        }
        if control.is("Y1.6") {
            assert!(!control.is("Y1.7"), "never both ways");
            turned += 8;
        }
        // The contact of a station is closed for 50 ms before and after its position.
        let station = (turned + 50) / 600;
        let near = (turned + 50) % 600 < 100;
        control.station(if near { (station - 1) % 4 + 1 } else { 0 });
    }
    false
}

#[test]
fn tool_change() {
    let mut control = Control::new();
    assert!(turn_to(&mut control, 3, 1));
    assert_eq!(
        (control.plc.memory().g(201), control.plc.memory().k(12)),
        (3, 3)
    );
    assert!(!control.is("Y1.6") && !control.is("Y1.7"));
    control.finish("F7.3").unwrap();
    assert!(turn_to(&mut control, 2, 3), "past the last station");
    assert_eq!(control.plc.memory().g(201), 2);
    assert_eq!(control.messages(), []);
}

#[test]
fn tool_change_sequence() {
    let mut control = Control::new();
    control.plc.memory_mut().set_dt(7, 200);
    control.set("F205.0", true); // TCPS=1: clamped when closed
    control.plc.memory_mut().set_f(26, 2);
    control.set("F7.3", true);
    control.cycles(2);
    assert!(control.is("Y1.6") && control.is("Y7.0"));
    control.station(2);
    control.cycles(2);
    assert!(!control.is("Y1.6") && !control.is("Y1.7"), "pause");
    control.milliseconds(240);
    assert!(control.is("Y1.7"), "reverse");
    control.milliseconds(200);
    control.set("X0.7", true);
    control.milliseconds(900);
    assert!(control.is("Y1.7") && !control.is("G4.3"), "lock time");
    control.milliseconds(200);
    assert!(!control.is("Y1.7") && control.is("G4.3"));
    assert_eq!(control.plc.memory().g(201), 2);
}

#[test]
fn tool_change_alarms() {
    // The turret does not move.
    let mut control = Control::new();
    control.plc.memory_mut().set_f(26, 2);
    control.set("F7.3", true);
    control.milliseconds(1100);
    assert_eq!(control.messages(), [1000]);
    assert!(!control.is("Y1.6") && !control.is("G4.3"));
    control.station(2);
    control.cycles(4);
    assert!(
        !control.is("Y1.7"),
        "a station that comes later changes nothing"
    );
    control.reset();
    assert_eq!(control.messages(), []);
    assert_eq!(control.plc.memory().g(201), 1, "tool number as before");

    // The clamp signal does not arrive.
    control.set("F205.0", true);
    control.set("F7.3", true);
    control.milliseconds(650);
    assert_eq!(control.messages(), [1002]);
    assert!(!control.is("Y1.7"));
    control.reset();

    // The station is lost while the turret locks.
    control.set("X0.7", true);
    control.set("F7.3", true);
    control.milliseconds(400);
    control.station(3);
    control.milliseconds(900);
    assert_eq!(control.messages(), [1001]);
    assert!(!control.is("G4.3"));
}

#[test]
fn emergency_stop_ends_a_tool_change() {
    let mut control = Control::new();
    control.plc.memory_mut().set_f(26, 2);
    control.set("F7.3", true);
    control.cycles(2);
    assert!(control.is("Y1.6"));
    control.set("X0.5", false);
    control.cycles(2);
    assert!(!control.is("Y1.6"));
}

#[test]
fn without_turret_tool_number_is_accepted_at_once() {
    let mut control = Control::new();
    control.plc.memory_mut().set_f(207, 0);
    control.plc.memory_mut().set_f(26, 7);
    control.set("F7.3", true);
    let time = control.finish("F7.3").unwrap();
    assert!(time < 100);
    assert_eq!(control.plc.memory().g(201), 7);
    assert!(!control.is("Y1.6"));
    control.set("F54.6", true);
    control.cycles(2);
    assert!(control.is("Y1.6"), "macro output");
}

#[test]
fn stations_above_the_turret_size_are_ignored() {
    // With TSGN=1 the open pins T05 to T08 look like stations, but the turret has six.
    let mut control = Control::new();
    control.plc.memory_mut().set_f(207, 6);
    control.station(0);
    control.set("X0.4", true);
    control.cycles(2);
    assert_eq!(control.plc.memory().r(61), 6);
}

#[test]
fn tool_change_key_requests_the_next_tool() {
    let mut control = Control::new();
    control.mode(AUTO);
    control.press("X24.0");
    assert!(!control.is("G44.7"));
    control.mode(JOG);
    control.press("X24.0");
    assert!(control.is("G44.7") && control.is("Y7.0"));
    control.set("F7.3", true);
    control.cycles(2);
    assert!(!control.is("G44.7"));
}

#[test]
fn several_functions_share_one_completion() {
    let mut control = Control::new();
    control.plc.memory_mut().set_f(26, 1);
    control.set("F7.3", true);
    control.request_m(3);
    control.milliseconds(700);
    assert!(!control.is("G4.3"), "M is done, T is not");
    control.milliseconds(600);
    assert!(control.is("G4.3"));
}
