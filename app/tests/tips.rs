//! Tool tips of the panel in the other language, and help by a long press.

use crate::common::Bench;
use egui::{Event, Pos2, TouchDeviceId, TouchId, TouchPhase};
use egui_kittest::kittest::Queryable;

fn touch(bench: &mut Bench, phase: TouchPhase, pos: Pos2) {
    bench.harness.event(Event::Touch {
        device_id: TouchDeviceId(0),
        id: TouchId(1),
        phase,
        pos,
        force: None,
    });
}

/// Keeps a finger on a widget for more than a second.
fn stay(bench: &mut Bench, name: &str) {
    let place = bench.harness.get_by_label(name).rect().center();
    touch(bench, TouchPhase::Start, place);
    for _ in 0..4 {
        bench.run(50);
    }
    touch(bench, TouchPhase::End, place);
    bench.run(50);
}

#[test]
fn a_finger_that_stays_opens_the_help_but_not_on_an_axis_key() {
    let mut bench = Bench::new();
    for key in ["X axis, arrow up", "Cycle start", "Reset"] {
        stay(&mut bench, key);
        let help = bench.harness.query_by_label("Explain");
        assert!(help.is_none(), "{key} is held to act");
    }
    stay(&mut bench, "Position pages");
    assert!(bench.harness.query_by_label("Explain").is_some());
    bench.lcd_shows("现在位置");
}

#[test]
fn under_the_pointer_the_lcd_speaks_the_other_language() {
    let mut bench = Bench::new();
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
fn an_axis_key_says_where_it_leads() {
    let mut bench = Bench::new();
    let place = bench
        .harness
        .get_by_label("Z axis, arrow left")
        .rect()
        .center();
    bench.harness.event(Event::PointerMoved(place));
    for _ in 0..6 {
        bench.run(50);
    }
    let tip = bench
        .harness
        .query_by_label_contains("Z-, towards the chuck");
    assert!(tip.is_some());
}
