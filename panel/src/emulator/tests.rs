use gsk_core::machine::LatheFault;
use gsk_core::operation::OperatingMode;

use super::*;
use crate::panel::{FileId, SerialCable};

fn awake() -> Emulator {
    let mut emulator = Emulator::new(Setup::default());
    let outcome = emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    assert_eq!(outcome, WaitOutcome::Reached);
    emulator
}

#[test]
fn it_wakes_up_on_the_relative_page() {
    let mut emulator = Emulator::new(Setup::default());
    emulator.run(10);
    assert!(emulator.screen().text().contains("GSK980TD"));
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    assert!(emulator.screen().row(0).starts_with("现在位置(相对坐标)"));
}

#[test]
fn mode_keys_act_through_the_ladder() {
    let mut emulator = awake();
    for (key, mode) in [
        (Key::Auto, OperatingMode::Auto),
        (Key::Edit, OperatingMode::Edit),
        (Key::Jog, OperatingMode::Jog),
        (Key::Mdi, OperatingMode::Mdi),
    ] {
        emulator.press(key);
        assert_eq!(emulator.cnc().mode(), mode);
        assert!(emulator.lamp(key.row().lamp.unwrap()), "{}", key.id());
    }
}

#[test]
fn the_emergency_stop_latches_and_stops() {
    let mut emulator = awake();
    emulator.press(Key::EmergencyStop);
    assert!(emulator.panel().emergency_stop());
    assert!(emulator.cnc().is_shown_not_ready());
    assert!(emulator.screen().row(0).starts_with("报警信息"));
    emulator.press(Key::EmergencyStop);
    assert!(!emulator.panel().emergency_stop());
    assert!(!emulator.cnc().is_shown_not_ready());
}

#[test]
fn a_program_is_loaded_and_run() {
    let mut emulator = awake();
    emulator
        .load_program("o7.nc", "G0 X100 Z100;\nM30;\n")
        .unwrap();
    assert!(emulator.screen().row(0).contains("O0007"));
    emulator.press(Key::Auto);
    emulator.press(Key::CycleStart);
    assert!(!emulator.is_stopped());
    let outcome = emulator.run_until(&WaitCondition::Stopped, 60_000);
    assert_eq!(outcome, WaitOutcome::Reached);
    assert!(emulator.screen().text().contains("100.000"));
    let number = |name| number_of_name(name);
    assert_eq!(number("/a/O0012.CNC"), Some(12));
    assert_eq!(number("O12345"), None);
    assert_eq!(number("shaft.nc"), None);
}

#[test]
fn jogging_stops_when_all_keys_are_released() {
    let mut emulator = awake();
    emulator.press(Key::Jog);
    emulator.key_down(Key::ZLeft);
    emulator.run(300);
    assert!(!emulator.is_stopped());
    emulator.key(KeyEvent::ReleaseAll);
    let outcome = emulator.run_until(&WaitCondition::Stopped, 2000);
    assert_eq!(outcome, WaitOutcome::Reached);
}

#[test]
fn power_off_darkens_the_panel_and_power_on_shows_the_self_test() {
    let mut emulator = awake();
    let before = emulator.ticks();
    emulator.power_off();
    emulator.run(50);
    assert!(emulator.screen().text().trim().is_empty());
    assert_eq!(emulator.lamps(), [0; 20]);
    emulator.press(Key::Auto);
    emulator.power_on();
    assert!(emulator.panel().in_self_test());
    assert_eq!(emulator.ticks(), before + 50 + 2 * PRESS_TICKS);
    assert_eq!(
        emulator.run_until(&WaitCondition::SelfTestOver, 5000),
        WaitOutcome::Reached
    );
}

#[test]
fn two_copies_stay_alike() {
    let mut emulator = awake();
    emulator
        .load_program("O1", "G0 X100 Z100;\nM30;\n")
        .unwrap();
    emulator.press(Key::Auto);
    let mut copy = emulator.clone();
    for one in [&mut emulator, &mut copy] {
        one.press(Key::CycleStart);
        one.run(500);
    }
    assert_eq!(emulator, copy);
}

#[test]
fn a_text_is_waited_for_until_the_limit() {
    let mut emulator = awake();
    let text = |text: &str| WaitCondition::Text(text.to_owned());
    let now = emulator.ticks();
    assert_eq!(
        emulator.run_until(&text("现在位置(相对坐标) O0000"), 500),
        WaitOutcome::Reached
    );
    assert_eq!(emulator.ticks(), now);
    assert_eq!(
        emulator.run_until(&text("自动方式"), 500),
        WaitOutcome::TimedOut
    );
    assert_eq!(emulator.ticks(), now + 500);
}

#[test]
fn recorded_inputs_lead_a_copy_to_the_same_state() {
    let mut emulator = awake();
    let mut copy = emulator.clone();
    emulator.record_inputs();
    emulator.connect_cable(SerialCable::Line);
    emulator
        .load_program("O1", "G0 X100 Z100;\nM30;\n")
        .unwrap();
    emulator.press(Key::Edit);
    emulator.press(Key::Program);
    emulator.type_text("O1");
    emulator.press(Key::Output);
    assert_eq!(emulator.take_port_files().len(), 1);
    emulator.press(Key::Reset);
    assert!(emulator.take_aborted() && !emulator.take_aborted());
    let file = SerialFile {
        name: "O0002.CNC".to_owned(),
        text: "O0002;\nM99;\n".to_owned(),
    };
    emulator
        .request_port(PortRequest::Receive {
            id: FileId::Program(2),
            file,
            overwrite: false,
        })
        .unwrap();
    emulator.press(Key::Auto);
    emulator.press(Key::CycleStart);
    emulator.set_fault(LatheFault::DriveX, true);
    emulator.run(500);
    emulator.turn(7);
    emulator.power_cycle();
    emulator.run(3000);
    let inputs = emulator.take_inputs();
    assert!(emulator.take_inputs().is_empty());
    assert_ne!(copy, emulator);
    for stamped in inputs {
        copy.run(stamped.tick - copy.ticks());
        copy.apply(stamped.input);
    }
    copy.run(emulator.ticks() - copy.ticks());
    assert_eq!(copy, emulator);
    assert!(copy.take_inputs().is_empty(), "a copy records nothing");
}
