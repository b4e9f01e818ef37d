//! Forms in the program view: written, inserted, opened again, replaced.

use crate::common::WindowBench;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

/// A window with the program view.
fn open_view() -> WindowBench {
    let mut bench = WindowBench::new();
    bench
        .harness
        .key_press_modifiers(Modifiers::SHIFT, Key::F11);
    bench.run(1);
    bench
}

fn is_shown(bench: &WindowBench, text: &str) -> bool {
    bench.harness.query_all_by_label_contains(text).count() > 0
}

#[track_caller]
fn wait_for_text(bench: &mut WindowBench, text: &str) {
    for _ in 0..1000 {
        bench.run(1);
        if is_shown(bench, text) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let labels = bench.harness.query_all_by(|_| true);
    let labels: Vec<String> = labels
        .filter_map(|it| it.accesskit_node().value())
        .collect();
    panic!("no {text}: {labels:?}");
}

#[track_caller]
fn click(bench: &mut WindowBench, label: &str) {
    bench.harness.get_by_label(label).click();
    bench.run(2);
}

/// Puts the cursor at the end of the text.
fn cursor_to_end(bench: &mut WindowBench) {
    bench.harness.get_by_label("Program text").focus();
    bench.run(1);
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::End);
    bench.run(1);
}

fn type_text(bench: &mut WindowBench, text: &str) {
    bench.harness.event(egui::Event::Text(text.to_owned()));
    bench.run(1);
}

fn editor_text(bench: &WindowBench) -> String {
    let field = bench.harness.get_by_label("Program text");
    field.value().unwrap_or_default()
}

/// Replaces the text of a field.
fn set_field(bench: &mut WindowBench, name: &str, text: &str) {
    bench.harness.get_by_label(name).focus();
    bench.run(1);
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::A);
    bench.run(1);
    type_text(bench, text);
}

/// Opens the form pane, chooses turning with these diameters, and waits for the check.
fn fill_in_turning(bench: &mut WindowBench, stock: &str, diameter: &str) {
    click(bench, "Form");
    click(bench, "Turn");
    set_field(bench, "Stock diameter", stock);
    set_field(bench, "Diameter", diameter);
    wait_for_text(bench, "Check: no alarm, no collision");
}

#[test]
fn a_form_is_inserted_opened_and_replaced() {
    let mut bench = open_view();
    cursor_to_end(&mut bench);
    type_text(&mut bench, "N100 G00 X100 Z100 ");
    fill_in_turning(&mut bench, "45", "36");
    click(&mut bench, "Insert at the cursor");
    let text = editor_text(&bench);
    assert!(
        text.contains("N100 G00 X100 Z100 \n(FORM turn STOCK=45 D=36"),
        "{text}"
    );
    // N100 is in use.
    assert!(text.contains("G71 P110 Q111"), "{text}");
    assert!(is_shown(&bench, "The section of the form was inserted"));
    bench.run(2);
    click(&mut bench, "Open form");
    set_field(&mut bench, "Diameter", "30");
    wait_for_text(&mut bench, "Check: no alarm, no collision");
    click(&mut bench, "Replace the section");
    let text = editor_text(&bench);
    assert_eq!(text.matches("(FORM turn").count(), 1, "{text}");
    assert!(
        text.contains("D=30") && text.contains("P110 Q111"),
        "{text}"
    );
}

#[test]
fn blocks_changed_by_hand_are_not_replaced_without_a_question() {
    let mut bench = open_view();
    fill_in_turning(&mut bench, "45", "36");
    click(&mut bench, "Insert at the cursor");
    let text = editor_text(&bench);
    // The section is selected: its end is typed again, with another check sum.
    bench.harness.get_by_label("Program text").focus();
    bench.run(1);
    bench.harness.key_press(Key::ArrowRight);
    bench.run(1);
    bench.harness.key_press(Key::Backspace);
    bench.harness.key_press(Key::Backspace);
    bench.run(1);
    type_text(&mut bench, "-)");
    let edited = editor_text(&bench);
    assert!(
        edited.trim_end().ends_with("-)") && edited != text,
        "{edited}"
    );
    bench.run(2);
    click(&mut bench, "Open form");
    wait_for_text(&mut bench, "were changed by hand");
    click(&mut bench, "Replace the section");
    wait_for_text(&mut bench, "Replace them and lose the changes?");
    bench.run(2);
    click(&mut bench, "Replace and lose the changes");
    assert_eq!(editor_text(&bench).trim(), text.trim());
}

#[test]
fn a_wrong_value_is_named_and_cannot_be_inserted() {
    let mut bench = open_view();
    click(&mut bench, "Form");
    set_field(&mut bench, "Diameter", "60");
    assert!(is_shown(
        &bench,
        "Stock diameter: the stock must be at least 60 mm"
    ));
    let insert = bench.harness.get_by_label("Insert at the cursor");
    assert!(insert.accesskit_node().is_disabled());
    click(&mut bench, "Close the form");
    assert!(is_shown(&bench, "Program text"));
}

#[test]
fn every_form_is_previewed_and_becomes_a_program() {
    let mut bench = open_view();
    click(&mut bench, "Form");
    for name in [
        "Face", "Turn", "Bore", "Contour", "Groove", "Part off", "Thread", "Drill", "Centre",
    ] {
        bench.harness.get_all_by_label(name).next().unwrap().click();
        bench.run(2);
        wait_for_text(&mut bench, "Check: no alarm, no collision");
        assert!(is_shown(&bench, "Part with the path of the tool"));
    }
    click(&mut bench, "New program");
    bench.run(2);
    let text = editor_text(&bench);
    assert!(
        text.starts_with("O0001\n(FORM centre") && text.ends_with("M30\n%\n"),
        "{text}"
    );
}

#[test]
fn number_keys_replace_the_value_of_the_field_and_go_to_the_next_one() {
    let mut bench = open_view();
    click(&mut bench, "Form");
    click(&mut bench, "Turn");
    click(&mut bench, "Number keys");
    bench.harness.get_by_label("Diameter").focus();
    bench.run(2);
    for key in ["3", "6", "1", "Erase", "Next", "3", "5", ".", "5"] {
        click(&mut bench, key);
        bench.run(2);
    }
    wait_for_text(&mut bench, "Check: no alarm, no collision");
    assert!(is_shown(&bench, "STOCK=50 D=36 DF=35.5"));
}

#[test]
fn a_row_of_a_contour_without_a_solution_is_named() {
    let mut bench = open_view();
    click(&mut bench, "Form");
    click(&mut bench, "Contour");
    wait_for_text(&mut bench, "Check: no alarm, no collision");
    set_field(&mut bench, "Point 3: angle", "95");
    assert!(is_shown(&bench, "point 3: the angle must be"));
    set_field(&mut bench, "Point 3: angle", "40");
    wait_for_text(&mut bench, "Check: no alarm, no collision");
    assert!(is_shown(&bench, "X30A40R2"));
    assert!(is_shown(&bench, "Outline with its dimensions"));
}
