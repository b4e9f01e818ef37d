//! The time line under the panel: seeing the past, continuing from it, returning.

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gsk_core::setup::Setup;
use gsk_host::kernel::Command;
use gsk_messages::Language;
use gsk_window::WindowSettings;
use gsk_window::layout::{Layouts, WindowLayout};

use crate::common::WindowBench;

/// A window of the smallest usual screen in the learner's layout, with the time line.
fn open_bench() -> WindowBench {
    let settings = WindowSettings {
        language: Language::En,
        layouts: Layouts::with_layout(WindowLayout::Learner),
        timeline: true,
        ..WindowSettings::default()
    };
    WindowBench::with_settings(Setup::default(), settings, vec2(1366.0, 768.0))
}

/// The value that a screen reader reads at the handle.
fn handle_value(bench: &WindowBench) -> String {
    let band = bench.harness.get_by_label("Time line");
    band.accesskit_node().value().unwrap_or_default()
}

fn has_button(bench: &WindowBench, name: &str) -> bool {
    bench.harness.query_by_label(name).is_some()
}

/// Runs until what was requested is drawn.
fn settle(bench: &mut WindowBench) {
    for _ in 0..30 {
        bench.run(1);
    }
}

#[test]
fn keys_on_the_handle_show_the_past_and_the_machine_continues_from_there() {
    let mut bench = open_bench();
    bench.click("Jog mode");
    bench.run(5000);
    bench.click("Edit mode");
    bench.assert_lcd_contains("编辑方式");
    bench.run(3000);
    assert_eq!(handle_value(&bench), "the present");
    assert!(!has_button(&bench, "Continue from here"));
    bench.harness.get_by_label("Time line").focus();
    bench.run(50);
    for _ in 0..4 {
        bench.harness.key_press(Key::ArrowLeft);
        settle(&mut bench);
    }
    bench.assert_lcd_contains("手动方式");
    let value = handle_value(&bench);
    assert!(value.ends_with("before the present"), "{value}");
    assert!(
        bench
            .harness
            .query_by_label_contains("You see the past")
            .is_some()
    );
    // Keys do nothing, and the message names the buttons.
    bench.click("Automatic mode");
    bench.assert_lcd_contains("手动方式");
    assert!(
        bench
            .harness
            .query_by_label_contains("keys and changes do nothing")
            .is_some()
    );
    bench.click("Continue from here");
    bench.assert_lcd_contains("手动方式");
    bench.click("Automatic mode");
    bench.assert_lcd_contains("自动方式");
    assert!(!has_button(&bench, "Continue from here"));
    bench.click("Return to the other future");
    settle(&mut bench);
    bench.assert_lcd_contains("编辑方式");
}

#[test]
fn the_pointer_drags_the_handle_and_the_present_returns() {
    let mut bench = open_bench();
    bench.click("Jog mode");
    bench.run(5000);
    bench.click("Edit mode");
    bench.run(1000);
    let band = bench.harness.get_by_label("Time line").rect();
    bench.harness.drag_at(band.right_center() - vec2(4.0, 0.0));
    settle(&mut bench);
    bench.harness.hover_at(band.center());
    settle(&mut bench);
    bench.assert_lcd_contains("手动方式");
    bench.harness.drop_at(band.center());
    settle(&mut bench);
    bench.assert_lcd_contains("手动方式");
    let before = bench.kernel.emulator().ticks();
    bench.run(500);
    assert_eq!(bench.kernel.emulator().ticks(), before, "it stands still");
    bench.click("Back to the present");
    bench.assert_lcd_contains("编辑方式");
    assert_eq!(handle_value(&bench), "the present");
}

#[test]
fn closing_the_time_line_shows_the_present() {
    let mut bench = open_bench();
    bench.click("Jog mode");
    bench.run(5000);
    bench.click("Edit mode");
    bench.run(1000);
    bench.harness.get_by_label("Time line").focus();
    bench.run(50);
    bench.harness.key_press(Key::PageUp);
    settle(&mut bench);
    bench
        .harness
        .key_press_modifiers(Modifiers::NONE, Key::Home);
    settle(&mut bench);
    assert!(!bench.lcd().contains("编辑方式"));
    bench.click("Views");
    // The handle has the same name as the entry of the menu.
    let entry = bench
        .harness
        .get_all_by_label("Time line")
        .find(|node| node.accesskit_node().role() != egui::accesskit::Role::Slider)
        .map(|node| node.rect().center());
    let entry = entry.expect("an entry of the menu");
    bench.harness.hover_at(entry);
    bench.harness.event(egui::Event::PointerButton {
        pos: entry,
        button: PointerButton::Primary,
        pressed: true,
        modifiers: Modifiers::NONE,
    });
    bench.harness.event(egui::Event::PointerButton {
        pos: entry,
        button: PointerButton::Primary,
        pressed: false,
        modifiers: Modifiers::NONE,
    });
    settle(&mut bench);
    assert!(!bench.harness.state().settings().timeline);
    bench.assert_lcd_contains("编辑方式");
}

#[test]
fn without_a_board_the_switch_of_the_handwheel_run_retraces_nothing() {
    let mut bench = open_bench();
    bench.click("Automatic mode");
    bench.run(3000);
    bench.click("Handwheel run");
    settle(&mut bench);
    assert!(!bench.kernel.emulator().cnc().has_retrace());
    bench.console.send(Command::Turn(-5));
    settle(&mut bench);
    let value = handle_value(&bench);
    assert!(value.ends_with("before the present"), "{value}");
}
