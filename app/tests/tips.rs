//! Tool tips of the panel in the other language, and help by a long press.

use crate::common::WindowBench;
use egui::{
    Event, Modifiers, MouseWheelSource, MouseWheelUnit, Pos2, TouchDeviceId, TouchId, TouchPhase,
};
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

fn scroll(bench: &mut WindowBench, modifiers: Modifiers) {
    bench.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 1.0),
        phase: TouchPhase::Move,
        source: MouseWheelSource::Unknown,
        modifiers,
    });
    bench.run(50);
}

#[test]
fn a_notch_turns_one_graduation_and_with_shift_ten_and_hides_the_tip() {
    let mut bench = WindowBench::new();
    let place = bench.harness.get_by_label("Handwheel").rect();
    let edge = place.center() + egui::vec2(place.width() * 0.3, 0.0);
    bench.harness.event(Event::PointerMoved(edge));
    let is_tip_shown = |bench: &mut WindowBench| {
        for _ in 0..20 {
            bench.run(50);
        }
        let mut tips = bench.harness.query_all_by_label_contains("Shift");
        tips.next().is_some()
    };
    assert!(is_tip_shown(&mut bench));
    let before = bench.kernel.snapshot().wheel;
    scroll(&mut bench, Modifiers::NONE);
    assert_eq!(bench.kernel.snapshot().wheel - before, 1);
    scroll(&mut bench, Modifiers::SHIFT);
    assert_eq!(bench.kernel.snapshot().wheel - before, 11);
    assert!(!is_tip_shown(&mut bench), "it covers what is turned");
    bench
        .harness
        .event(Event::PointerMoved(Pos2::new(2.0, 2.0)));
    bench.run(50);
    bench.harness.event(Event::PointerMoved(edge));
    assert!(is_tip_shown(&mut bench), "the pointer has come again");
}
