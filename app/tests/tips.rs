//! Tool tips of the panel in the other language, and help by a long press.

use crate::common::WindowBench;
use egui::{Event, Pos2, TouchDeviceId, TouchId, TouchPhase};
use egui_kittest::kittest::Queryable;

fn touch(bench: &mut WindowBench, phase: TouchPhase, pos: Pos2) {
    bench.harness.event(Event::Touch {
        device_id: TouchDeviceId(0),
        id: TouchId(1),
        phase,
        pos,
        force: None,
    });
}

/// Keeps a finger on a widget for more than a second.
fn long_press(bench: &mut WindowBench, name: &str) {
    let center = bench.harness.get_by_label(name).rect().center();
    touch(bench, TouchPhase::Start, center);
    for _ in 0..4 {
        bench.run(50);
    }
    touch(bench, TouchPhase::End, center);
    bench.run(50);
}

#[test]
fn a_long_press_opens_the_help_except_on_an_axis_key() {
    let mut bench = WindowBench::new();
    for key in ["X axis, arrow up", "Cycle start", "Reset"] {
        long_press(&mut bench, key);
        let help = bench.harness.query_by_label("Explain");
        assert!(help.is_none(), "{key} is held to act");
    }
    long_press(&mut bench, "Position pages");
    assert!(bench.harness.query_by_label("Explain").is_some());
    bench.assert_lcd_contains("现在位置");
}

#[test]
fn pointing_at_the_lcd_shows_the_other_language() {
    let mut bench = WindowBench::new();
    assert_eq!(bench.kernel.snapshot().translated, None);
    let lcd = bench.harness.get_by_label("LCD").rect();
    let title = lcd.left_top() + egui::vec2(lcd.width() / 4.0, lcd.height() / 30.0);
    bench.harness.event(Event::PointerMoved(title));
    for _ in 0..6 {
        bench.run(50);
    }
    let translated = bench.kernel.snapshot().translated.expect("is asked for");
    assert!(translated.text().contains("POSITION(RELATIVE)"));
    let tip = bench
        .harness
        .query_all_by_label_contains("POSITION(RELATIVE)");
    assert!(tip.count() > 0, "it is shown");
    bench
        .harness
        .event(Event::PointerMoved(Pos2::new(2.0, 2.0)));
    for _ in 0..3 {
        bench.run(50);
    }
    assert_eq!(
        bench.kernel.snapshot().translated,
        None,
        "nobody looks any more"
    );
}

#[test]
fn an_axis_key_shows_its_direction() {
    let mut bench = WindowBench::new();
    let center = bench
        .harness
        .get_by_label("Z axis, arrow left")
        .rect()
        .center();
    bench.harness.event(Event::PointerMoved(center));
    for _ in 0..6 {
        bench.run(50);
    }
    let tip = bench
        .harness
        .query_by_label_contains("Z-, towards the chuck");
    assert!(tip.is_some());
}
