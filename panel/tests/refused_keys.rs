//! Checks that a key without effect has a reason, and one with an effect has none.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "tests fail by panicking"
)]

use gsk_core::operation::OperatingMode;
use gsk_core::setup::Setup;
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::keys::Key;
use gsk_panel::refusal::{CHECK_DELAY_TICKS, KeyPress};

fn awake(setup: Setup) -> Emulator {
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator
}

/// Presses a key and returns the reason if it has no effect.
fn pressed(emulator: &mut Emulator, key: Key) -> Option<String> {
    let press = KeyPress::new(key, emulator.cnc());
    let at_once = emulator.key_down(key);
    emulator.run(CHECK_DELAY_TICKS);
    let later = press.and_then(|press| press.refusal_reason(emulator.cnc()));
    emulator.run(100 - CHECK_DELAY_TICKS);
    emulator.key_up(key);
    emulator.run(100);
    at_once.or(later).map(|why| why.to_string())
}

fn refused(emulator: &mut Emulator, key: Key, words: &str) {
    let why = pressed(emulator, key);
    let reason = why.as_deref().unwrap_or("nothing");
    assert!(reason.contains(words), "{}: {reason}", key.id());
}

fn acts(emulator: &mut Emulator, key: Key) {
    let why = pressed(emulator, key);
    assert_eq!(why, None, "{}", key.id());
}

const MODES: [(Key, OperatingMode); 7] = [
    (Key::Edit, OperatingMode::Edit),
    (Key::Auto, OperatingMode::Auto),
    (Key::Mdi, OperatingMode::Mdi),
    (Key::MachineZero, OperatingMode::MachineZero),
    (Key::Handwheel, OperatingMode::Step),
    (Key::Jog, OperatingMode::Jog),
    (Key::ProgramZero, OperatingMode::ProgramZero),
];

#[test]
fn keys_of_the_machine_are_refused_where_the_ladder_refuses_them() {
    for (mode_key, mode) in MODES {
        let mut emulator = awake(Setup::default());
        acts(&mut emulator, mode_key);
        assert_eq!(emulator.cnc().mode(), mode);
        let manual = mode.is_manual();
        for key in [Key::SpindleForward, Key::ToolChange, Key::Lubrication] {
            if manual {
                let why = pressed(&mut emulator, key);
                let by_mode = why.is_some_and(|why| why.contains("manual and zero modes"));
                assert!(!by_mode, "{} in {mode:?}", key.id());
            } else {
                refused(&mut emulator, key, "manual and zero modes");
            }
        }
        if !manual {
            refused(&mut emulator, Key::ZLeft, "the axis keys act in");
        }
        if !mode.runs_programs() {
            refused(&mut emulator, Key::CycleStart, "only in the modes");
        }
        match mode {
            OperatingMode::Step => acts(&mut emulator, Key::Increment10),
            _ => refused(&mut emulator, Key::Increment10, "the step size"),
        }
        refused(&mut emulator, Key::WheelY, "no Y axis");
    }
}

#[test]
fn an_axis_key_names_interlock_override_reference_and_limit() {
    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(12, 0, false).unwrap();
    setup.referenced = false;
    let mut emulator = awake(setup);
    acts(&mut emulator, Key::Jog);
    acts(&mut emulator, Key::ZLeft);
    acts(&mut emulator, Key::Rapid);
    refused(&mut emulator, Key::ZLeft, "Z has no reference");
    acts(&mut emulator, Key::Rapid);
    for _ in 0..15 {
        pressed(&mut emulator, Key::FeedOverrideDown);
    }
    refused(&mut emulator, Key::XUp, "feed override is 0 %");

    let mut emulator = awake(Setup::default());
    emulator.press(Key::EmergencyStop);
    emulator.press(Key::Jog);
    refused(&mut emulator, Key::ZLeft, "alarm 207");
    acts(&mut emulator, Key::Jog);
}

#[test]
fn an_override_at_its_limit_has_a_reason() {
    let mut emulator = awake(Setup::default());
    acts(&mut emulator, Key::Auto);
    for (key, other, last) in [
        (
            Key::FeedOverrideUp,
            Key::FeedOverrideDown,
            "feed override stays at 150 %",
        ),
        (
            Key::FeedOverrideDown,
            Key::FeedOverrideUp,
            "feed override stays at 0 %",
        ),
        (
            Key::RapidOverrideUp,
            Key::RapidOverrideDown,
            "rapid override stays at 100 %",
        ),
        (
            Key::RapidOverrideDown,
            Key::RapidOverrideUp,
            "rapid override stays at 0 %",
        ),
        (
            Key::SpindleOverrideUp,
            Key::SpindleOverrideDown,
            "spindle override stays at 120 %",
        ),
        (
            Key::SpindleOverrideDown,
            Key::SpindleOverrideUp,
            "spindle override stays at 50 %",
        ),
    ] {
        let at_end = (0..20).find_map(|_| pressed(&mut emulator, key));
        let reason = at_end.unwrap_or_default();
        assert!(
            reason.contains(last) && reason.contains("at its limit"),
            "{reason}"
        );
        acts(&mut emulator, other);
    }
}

#[test]
fn a_hold_without_motion_has_a_reason() {
    let mut emulator = awake(Setup::default());
    acts(&mut emulator, Key::Auto);
    refused(&mut emulator, Key::FeedHold, "nothing to hold");
    emulator
        .load_program("o7.nc", "G98 G01 X100 F10\nM30\n")
        .unwrap();
    acts(&mut emulator, Key::CycleStart);
    acts(&mut emulator, Key::FeedHold);
    refused(&mut emulator, Key::FeedHold, "already held");
    acts(&mut emulator, Key::CycleStart);
    acts(&mut emulator, Key::FeedHold);
}

#[test]
fn cycle_start_names_what_holds_it() {
    let mut emulator = awake(Setup::default());
    acts(&mut emulator, Key::Mdi);
    refused(&mut emulator, Key::CycleStart, "no MDI block is entered");
    emulator
        .load_program("o7.nc", "G0 X100\nM12\nM30\n")
        .expect("a program");
    acts(&mut emulator, Key::Auto);
    acts(&mut emulator, Key::CycleStart);
    emulator.run_until(&WaitCondition::Alarm, 60_000);
    refused(&mut emulator, Key::CycleStart, "alarm 1013");
    let message = emulator.cnc().active_message().unwrap();
    assert_eq!((message.number, message.source.unwrap().line), (1013, 3));
    acts(&mut emulator, Key::Reset);
    assert_eq!(emulator.cnc().active_message(), None);
    acts(&mut emulator, Key::CycleStart);
}

#[test]
fn keys_of_text_and_data_name_page_mode_and_switch() {
    let mut emulator = awake(Setup::default());
    emulator.load_program("o7.nc", "G0 X100\nM30\n").unwrap();
    acts(&mut emulator, Key::Jog);
    refused(&mut emulator, Key::X, "this page takes no input");
    acts(&mut emulator, Key::Program);
    refused(&mut emulator, Key::G, "EDIT mode");
    acts(&mut emulator, Key::Edit);
    // The program switch is off at power-on.
    emulator
        .request(gsk_core::cnc::ControlRequest::SetProgramSwitch(false))
        .unwrap();
    refused(&mut emulator, Key::G, "program switch is off");
    refused(&mut emulator, Key::Delete, "program switch is off");
    emulator
        .request(gsk_core::cnc::ControlRequest::SetProgramSwitch(true))
        .unwrap();
    acts(&mut emulator, Key::G);
    acts(&mut emulator, Key::Parameter);
    acts(&mut emulator, Key::Digit1);
    refused(&mut emulator, Key::Input, "MDI mode");
    acts(&mut emulator, Key::Mdi);
    acts(&mut emulator, Key::Digit1);
    refused(&mut emulator, Key::Input, "parameter switch is off");
    acts(&mut emulator, Key::Offset);
    acts(&mut emulator, Key::Digit5);
    refused(&mut emulator, Key::Input, "not a valid value here");
    refused(&mut emulator, Key::Output, "004.2");
}
