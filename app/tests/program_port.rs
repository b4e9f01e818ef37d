//! Programs of other controls in the program view: recognised, ported, taken over.

use crate::common::WindowBench;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

/// A window with the program view, in which a text was typed.
fn open_view(text: &str) -> WindowBench {
    let mut bench = WindowBench::new();
    bench
        .harness
        .key_press_modifiers(Modifiers::SHIFT, Key::F11);
    bench.run(1);
    bench.harness.get_by_label("Program text").focus();
    bench.run(1);
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::A);
    bench.run(1);
    bench.harness.event(egui::Event::Text(text.to_owned()));
    bench.run(2);
    bench
}

fn is_shown(bench: &WindowBench, text: &str) -> bool {
    bench.harness.query_all_by_label_contains(text).count() > 0
}

#[track_caller]
fn click(bench: &mut WindowBench, label: &str) {
    // The button rests once the check has listed its findings.
    for _ in 0..20 {
        bench.run(1);
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    bench.harness.get_by_label(label).click();
    bench.run(3);
}

fn editor_text(bench: &WindowBench) -> String {
    let field = bench.harness.get_by_label("Program text");
    field.accesskit_node().value().unwrap_or_default()
}

#[test]
fn a_foreign_program_is_offered_ported_and_taken_over() {
    let mut bench = open_view("O0012\nG21 G99\nG0 X50. Z2.\nG71 P1 Q2 U.4 D2000 F.2\n");
    assert!(is_shown(
        &bench,
        "Line 2 has G21, which this control lacks: the program seems to be written for Fanuc 10T/15T."
    ));
    click(&mut bench, "Port…");
    // Both texts are beside each other.
    assert!(is_shown(&bench, "G71 P1 Q2 U.4 D2000 F.2"));
    assert!(is_shown(&bench, "G71 U2. R0.5"));
    assert!(is_shown(
        &bench,
        "4: G71: depth and retract precede the cycle"
    ));
    click(&mut bench, "Take over as a new program");
    click(&mut bench, "Do not save");
    assert_eq!(
        editor_text(&bench),
        "O0012\nG99\nG0 X50. Z2.\nG71 U2. R0.5\nG71 P1 Q2 U.4 F.2\n"
    );
    assert!(!is_shown(&bench, "which this control lacks"));
}

#[test]
fn settings_of_the_other_control_port_again() {
    let mut bench = open_view("O0012\nG54 G0 X1. Z1\nG31 Z2.\n");
    click(&mut bench, "Port…");
    assert!(is_shown(&bench, "G0 X1. Z0.001"));
    assert!(is_shown(&bench, "G65 H99 P0 (G31 Z2.)"));
    click(&mut bench, "Inches before G20 or G21");
    assert!(is_shown(&bench, "G0 X25.4 Z0.003"));
    click(&mut bench, "Numbers without a point are not increments");
    assert!(is_shown(&bench, "G0 X25.4 Z25.4"));
    click(&mut bench, "Close without a change");
    assert_eq!(editor_text(&bench), "O0012\nG54 G0 X1. Z1\nG31 Z2.\n");
}

#[test]
fn a_program_of_this_control_is_not_offered() {
    let bench = open_view("O0012\nG50 X100. Z100.\nG0 X50. Z2.\nG71 U2. R0.5\nM30\n");
    assert!(!is_shown(&bench, "which this control lacks"));
}
