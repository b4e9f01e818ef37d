//! The window without a display, driven through its accessible names as a screen
//! reader or a tester does: names, mouse, PC keys, and what the LCD says.

mod common;

use common::Bench;
use egui_kittest::kittest::Queryable;
use gsk_core::setup::Setup;
use gsk_panel::keys::{KEYS, Key, Role};

#[test]
fn a_program_is_opened_started_and_stopped_by_the_emergency_stop() {
    let mut bench = Bench::new();
    bench.open("01-stepped-shaft.CNC");
    bench.lcd_shows("O0001");
    let before = bench.shown_u();

    bench.click("Automatic mode");
    bench.lcd_shows("自动方式");
    bench.click("Cycle start");
    bench.run(10_000);
    assert_ne!(bench.shown_u(), before, "X stands:\n{}", bench.lcd());

    bench.click("Emergency stop");
    bench.lcd_shows("准备未绪");
    bench.lcd_shows("207");
    bench.click("Position pages");
    let stopped = bench.shown_u();
    bench.run(1000);
    assert_eq!(bench.shown_u(), stopped);

    bench.click("Emergency stop");
    bench.run(500);
    assert!(!bench.lcd().contains("准备未绪"), "it is released");
    bench.run(1000);
    assert_eq!(bench.shown_u(), stopped, "nothing moves by itself");
}

#[test]
fn every_key_is_there_by_name() {
    let bench = Bench::new();
    for row in &KEYS {
        let count = bench.harness.query_all_by_label(row.name_en).count();
        assert_eq!(count, 1, "{} by its name «{}»", row.id, row.name_en);
    }
}

#[test]
fn machine_keys_reach_their_contact_and_light_their_lamp() {
    let mut bench = Bench::new();
    for (name, mode) in [
        ("Jog mode", "手动方式"),
        ("Edit mode", "编辑方式"),
        ("MDI mode", "录入方式"),
        ("Automatic mode", "自动方式"),
    ] {
        bench.click(name);
        bench.lcd_shows(mode);
    }
    let lamp = Key::from_id("SBK").and_then(|key| key.row().lamp).unwrap();
    let lit = |bench: &Bench| lamp.of(&bench.kernel.emulator().lamps());
    assert!(!lit(&bench));
    bench.click("Single block");
    assert!(lit(&bench));
}

#[test]
fn a_held_mouse_button_holds_the_key() {
    let mut bench = Bench::new();
    bench.click("Jog mode");
    let place = bench
        .harness
        .get_by_label("Z axis, arrow left")
        .rect()
        .center();
    let button = |pressed| egui::Event::PointerButton {
        pos: place,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::default(),
    };
    bench.harness.event(egui::Event::PointerMoved(place));
    bench.harness.event(button(true));
    bench.run(50);
    let emulator = |bench: &Bench| bench.kernel.emulator().clone();
    for _ in 0..20 {
        bench.run(50);
    }
    assert!(
        emulator(&bench).simulation.cnc.is_moving(),
        "held: the axis moves"
    );
    bench.harness.event(button(false));
    bench.run(1000);
    assert!(
        !emulator(&bench).simulation.cnc.is_moving(),
        "let go: it stands"
    );
}

/// The axis jogs, the window loses the focus, and whoever lets go then lets go of
/// nothing.
fn ends_without_focus(hold: impl Fn(&Bench)) {
    let mut bench = Bench::new();
    bench.click("Jog mode");
    hold(&bench);
    for _ in 0..20 {
        bench.run(50);
    }
    let moves = |bench: &Bench| bench.kernel.emulator().simulation.cnc.is_moving();
    assert!(moves(&bench), "held: the axis moves");
    bench.harness.input_mut().focused = false;
    bench.run(1000);
    assert!(!moves(&bench), "nobody sees whether it is held");
    let stood = bench.kernel.emulator().simulation.cnc.pulses();
    bench.harness.input_mut().focused = true;
    bench.run(1000);
    let stands = bench.kernel.emulator().simulation.cnc.pulses();
    assert_eq!(stands, stood, "nor does it go on by itself");
}

#[test]
fn a_held_jog_key_comes_up_when_the_window_loses_the_focus() {
    ends_without_focus(|bench| {
        let control = egui::Modifiers::CTRL;
        bench
            .harness
            .key_down_modifiers(control, egui::Key::ArrowLeft);
    });
    ends_without_focus(|bench| {
        let place = bench
            .harness
            .get_by_label("Z axis, arrow left")
            .rect()
            .center();
        bench.harness.event(egui::Event::PointerMoved(place));
        bench.harness.event(egui::Event::PointerButton {
            pos: place,
            button: egui::PointerButton::Primary,
            pressed: true,
            modifiers: egui::Modifiers::default(),
        });
    });
}

#[test]
fn an_emergency_stop_that_knows_the_place_of_the_slides_says_it() {
    let mut bench = Bench::new();
    bench.click("Emergency stop");
    let line = |bench: &Bench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(line(&bench, "press it again to release"));
    let mut picture = bench.kernel.snapshot();
    let place = "machine coordinates X 1.000 Z -2.000 by the board's count, uncertain: the \
                 drives were without power";
    picture.alarm = picture.alarm.map(|alarm| alarm.because(place));
    bench.console.pictures.force_push(picture);
    bench.harness.step();
    bench.harness.step();
    assert!(line(&bench, "207: ") && line(&bench, place));
}

#[test]
fn pc_keys_press_panel_keys() {
    let mut bench = Bench::new();
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::CTRL, egui::Key::Num2);
    bench.run(300);
    bench.lcd_shows("自动方式");
    bench.harness.key_press(egui::Key::F5);
    bench.run(300);
    bench.lcd_shows("外部信息");
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    assert!(
        bench
            .harness
            .query_by_label("PC keyboard and panel keys")
            .is_some()
    );
}

#[test]
fn every_machine_key_has_its_contact() {
    for row in &KEYS {
        if let Role::Machine(bit) = row.role {
            assert!(
                (20..=26).contains(&bit.byte),
                "{} has X{}",
                row.id,
                bit.byte
            );
        }
    }
}

#[test]
fn the_line_below_the_panel_says_where_and_why_of_an_alarm() {
    let mut bench = Bench::new();
    bench.open("faulty/02-no-feed.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    bench.run(2000);
    let line = bench.harness.query_by_label_contains("011: ");
    assert!(line.is_some(), "{}", bench.lcd());
    bench.click("Reset");
    bench.run(500);
    assert!(bench.harness.query_by_label_contains("011: ").is_none());
}

#[test]
fn a_handwheel_that_moves_nothing_says_why() {
    let mut bench = Bench::new();
    bench.click("Step or handwheel mode");
    bench.lcd_shows("单步方式");
    bench.harness.key_press(egui::Key::CloseBracket);
    bench.run(200);
    let why = "step mode (001.3 = 0)";
    assert!(bench.harness.query_by_label_contains(why).is_some());

    let mut setup = Setup::default();
    setup.parameters.set_bit(1, 3, true).unwrap();
    let mut bench = Bench::with(setup);
    bench.click("Step or handwheel mode");
    bench.lcd_shows("手轮方式");
    let before = bench.shown_u();
    bench.harness.key_press(egui::Key::CloseBracket);
    bench.run(500);
    assert_ne!(bench.shown_u(), before, "{}", bench.lcd());
    assert!(bench.harness.query_by_label_contains(why).is_none());
}
