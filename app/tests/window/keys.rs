//! Keys of the panel by mouse and PC keyboard: contacts, lamps, bursts, a lost focus.

use egui::vec2;
use egui_kittest::kittest::Queryable;
use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_core::setup::Setup;
use gsk_panel::keys::{KEYS, Key, KeyRole};
use gsk_window::layout::{Layouts, WindowLayout};

use super::{click, is_shown};
use crate::common::WindowBench;

#[test]
fn every_key_has_a_unique_name() {
    let bench = WindowBench::new();
    for row in &KEYS {
        let count = bench.harness.query_all_by_label(row.name_en).count();
        assert_eq!(count, 1, "{} by its name «{}»", row.id, row.name_en);
    }
}

#[test]
fn machine_keys_reach_their_contact_and_light_their_lamp() {
    let mut bench = WindowBench::new();
    for (name, mode) in [
        ("Jog mode", "手动方式"),
        ("Edit mode", "编辑方式"),
        ("MDI mode", "录入方式"),
        ("Automatic mode", "自动方式"),
    ] {
        bench.click(name);
        bench.assert_lcd_contains(mode);
    }
    let lamp = Key::from_id("SBK").and_then(|key| key.row().lamp).unwrap();
    let lit = |bench: &WindowBench| lamp.is_set_in(&bench.kernel.emulator().lamps());
    assert!(!lit(&bench));
    bench.click("Single block");
    assert!(lit(&bench));
}

#[test]
fn a_held_mouse_button_holds_the_key() {
    let mut bench = WindowBench::new();
    bench.click("Jog mode");
    let center = bench
        .harness
        .get_by_label("Z axis, arrow left")
        .rect()
        .center();
    let button = |pressed| egui::Event::PointerButton {
        pos: center,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::default(),
    };
    bench.harness.event(egui::Event::PointerMoved(center));
    bench.harness.event(button(true));
    bench.run(50);
    let emulator = |bench: &WindowBench| bench.kernel.emulator().clone();
    for _ in 0..20 {
        bench.run(50);
    }
    assert!(emulator(&bench).cnc().is_moving(), "held: the axis moves");
    bench.harness.event(button(false));
    bench.run(1000);
    assert!(!emulator(&bench).cnc().is_moving(), "let go: it stands");
}

/// Jogs the axis, then the window loses the focus. The axis stops although the release never
/// arrives.
fn assert_stops_without_focus(hold_key: impl Fn(&WindowBench)) {
    let mut bench = WindowBench::new();
    bench.click("Jog mode");
    hold_key(&bench);
    for _ in 0..20 {
        bench.run(50);
    }
    let is_moving = |bench: &WindowBench| bench.kernel.emulator().cnc().is_moving();
    assert!(is_moving(&bench), "held: the axis moves");
    bench.harness.input_mut().focused = false;
    bench.run(1000);
    assert!(!is_moving(&bench), "a release would not arrive");
    let stopped_pulses = bench.kernel.emulator().cnc().pulses();
    bench.harness.input_mut().focused = true;
    bench.run(1000);
    let current_pulses = bench.kernel.emulator().cnc().pulses();
    assert_eq!(
        current_pulses, stopped_pulses,
        "nor does it go on by itself"
    );
}

#[test]
fn a_held_jog_key_comes_up_when_the_window_loses_the_focus() {
    assert_stops_without_focus(|bench| {
        let control = egui::Modifiers::CTRL;
        bench
            .harness
            .key_down_modifiers(control, egui::Key::ArrowLeft);
    });
    assert_stops_without_focus(|bench| {
        let center = bench
            .harness
            .get_by_label("Z axis, arrow left")
            .rect()
            .center();
        bench.harness.event(egui::Event::PointerMoved(center));
        bench.harness.event(egui::Event::PointerButton {
            pos: center,
            button: egui::PointerButton::Primary,
            pressed: true,
            modifiers: egui::Modifiers::default(),
        });
    });
}

#[test]
fn pc_keys_press_panel_keys() {
    let mut bench = WindowBench::new();
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::CTRL, egui::Key::Num2);
    bench.run(300);
    bench.assert_lcd_contains("自动方式");
    bench.harness.key_press(egui::Key::F5);
    bench.run(300);
    bench.assert_lcd_contains("外部信息");
    bench.harness.get_by_label("Keys").click();
    bench.run(10);
    let map = bench.harness.query_by_label("PC keyboard and panel keys");
    assert!(map.is_some());
}

#[test]
fn escape_closes_a_menu_and_also_resets_only_during_motion() {
    let mut bench = WindowBench::new();
    let escape = |bench: &mut WindowBench| {
        click(bench, "Views");
        assert!(bench.harness.query_by_label_contains("Fault").is_some());
        bench.harness.key_down(egui::Key::Escape);
        bench.run(40);
        assert!(bench.harness.query_by_label_contains("Fault").is_none());
        let pressed = bench.kernel.snapshot().pressed.contains(&Key::Reset);
        bench.harness.key_up(egui::Key::Escape);
        bench.run(100);
        pressed
    };
    assert!(!escape(&mut bench), "nothing moves");
    bench.harness.key_down(egui::Key::Escape);
    bench.run(40);
    assert!(bench.kernel.snapshot().pressed.contains(&Key::Reset));
    bench.harness.key_up(egui::Key::Escape);
    bench.open("01-stepped-shaft.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    assert_eq!(bench.kernel.snapshot().run_state, RunState::Run);
    assert!(escape(&mut bench), "a program runs");
    assert_eq!(bench.kernel.snapshot().run_state, RunState::Reset);
}

#[test]
fn f1_explains_the_key_under_the_mouse() {
    let mut bench = WindowBench::new();
    let start = bench.harness.get_by_label("Cycle start").rect().center();
    bench.harness.hover_at(start);
    bench.run(10);
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    let is_in_help =
        |bench: &WindowBench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(is_in_help(&bench, "Cycle start  key CS"));
    assert!(is_in_help(&bench, "Contact: X25.0"));
    // A second F1 closes the help.
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    assert!(!is_in_help(&bench, "Cycle start  key CS"));
}

#[test]
fn f1_explains_the_view_under_the_mouse_and_an_alarm_before_it() {
    let layouts = Layouts::with_layout(WindowLayout::Machine);
    let mut bench = WindowBench::with_layouts(Setup::default(), layouts, vec2(1366.0, 768.0));
    let press_f1_over = |bench: &mut WindowBench, part: &str| {
        let center = bench.harness.get_by_label(part).rect().center();
        bench.harness.hover_at(center);
        bench.run(10);
        bench.harness.key_press(egui::Key::F1);
        bench.run(10);
    };
    let is_in_help =
        |bench: &WindowBench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    let about_view = "The view Machine (Shift+F1)";
    press_f1_over(&mut bench, "Machine picture");
    assert!(is_in_help(&bench, about_view));
    press_f1_over(&mut bench, "Machine picture");
    assert!(!is_in_help(&bench, about_view), "a second F1 closes it");
    press_f1_over(&mut bench, "Cycle start");
    assert!(is_in_help(&bench, "Cycle start  key CS"));
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    bench.click("Emergency stop");
    bench.run(300);
    press_f1_over(&mut bench, "Machine picture");
    assert!(!is_in_help(&bench, about_view));
    assert!(is_in_help(&bench, "alarm 207  Overtravel"));
}

#[test]
fn an_explained_key_is_not_pressed_unless_it_stops() {
    let mut bench = WindowBench::new();
    bench.harness.get_by_label("Help F1").click();
    bench.run(10);
    bench.harness.get_by_label("Explain").click();
    bench.run(10);
    bench.click("Automatic mode");
    bench.run(300);
    let is_in_help =
        |bench: &WindowBench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(is_in_help(&bench, "Automatic mode  key AUTO"));
    bench.assert_lcd_contains("录入方式");
    bench.click("Emergency stop");
    bench.run(300);
    assert!(is_in_help(&bench, "Emergency stop  key ESTOP"));
    // The help no longer explains presses after it has been closed and opened again.
    for _ in 0..2 {
        bench.harness.get_by_label("Help F1").click();
        bench.run(10);
    }
    bench.click("Automatic mode");
    bench.run(300);
    bench.assert_lcd_contains("自动方式");
    assert!(
        bench
            .kernel
            .snapshot()
            .pressed
            .contains(&Key::EmergencyStop)
    );
}

#[test]
fn every_machine_key_has_its_contact() {
    for row in &KEYS {
        if let KeyRole::Machine(bit) = row.role {
            assert!(
                (20..=26).contains(&bit.byte),
                "{} has X{}",
                row.id,
                bit.byte
            );
        }
    }
}

/// Presses or releases a mouse button on a key.
fn mouse_button(bench: &mut WindowBench, name: &str, button: egui::PointerButton, pressed: bool) {
    let pos = bench.harness.get_by_label(name).rect().center();
    bench.harness.event(egui::Event::PointerMoved(pos));
    bench.harness.event(egui::Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers: egui::Modifiers::default(),
    });
    bench.run(100);
}

#[test]
fn a_right_click_latches_overtravel_release_for_one_axis_key() {
    let mut bench = WindowBench::new();
    bench.click("Jog mode");
    let (left, right) = (egui::PointerButton::Primary, egui::PointerButton::Secondary);
    let held_keys = |bench: &WindowBench| {
        let panel = bench.kernel.emulator().panel();
        [Key::OvertravelRelease, Key::ZLeft].map(|key| panel.is_held(key))
    };
    let latched_text = "is kept for the next key";
    mouse_button(&mut bench, "Overtravel release", right, true);
    mouse_button(&mut bench, "Overtravel release", right, false);
    assert_eq!(
        held_keys(&bench),
        [false, false],
        "nothing is held for nothing"
    );
    assert!(is_shown(&bench, latched_text));
    let ring = bench.harness.get_by_label("Overtravel release").value();
    assert_eq!(ring.as_deref(), Some("kept for the next key"));
    mouse_button(&mut bench, "Z axis, arrow left", left, true);
    assert_eq!(held_keys(&bench), [true, true]);
    assert!(is_shown(&bench, latched_text));
    mouse_button(&mut bench, "Z axis, arrow left", left, false);
    assert_eq!(held_keys(&bench), [false, false]);
    assert!(!is_shown(&bench, latched_text));
    mouse_button(&mut bench, "Z axis, arrow left", left, true);
    assert_eq!(held_keys(&bench), [false, true], "for one use");
    mouse_button(&mut bench, "Z axis, arrow left", left, false);

    mouse_button(&mut bench, "Z axis, arrow left", right, true);
    assert_eq!(held_keys(&bench), [false, false]);
    assert!(is_shown(&bench, "this key makes the machine move"));
}

#[test]
fn a_burst_of_keys_within_one_frame_arrives_complete() {
    let mut bench = WindowBench::new();
    bench.click("Edit mode");
    bench.click("Program pages");
    let type_burst = |bench: &mut WindowBench, text: &str| {
        for character in text.chars() {
            let name = character.to_string();
            let key = match character {
                ';' => egui::Key::Semicolon,
                '-' => egui::Key::Minus,
                '.' => egui::Key::Period,
                _ => egui::Key::from_name(&name).unwrap(),
            };
            for pressed in [true, false] {
                bench.harness.event(egui::Event::Key {
                    key,
                    physical_key: None,
                    pressed,
                    repeat: false,
                    modifiers: egui::Modifiers::default(),
                });
            }
        }
        bench.run(3000);
    };
    type_burst(&mut bench, "O0007;");
    let text = "G01X11.5Z-1.25F120;G00X31.125Z1.5S600M03;";
    type_burst(&mut bench, text);
    bench.click("Automatic mode");
    let programs = bench.kernel.emulator().cnc().programs();
    let program = programs.get(ProgramId::Stored(7)).unwrap();
    let stored: String = program.text().split_whitespace().collect();
    assert!(stored.starts_with(&format!("O0007;{text}")), "{stored}");
}
