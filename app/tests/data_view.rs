//! The data view: it writes the values that the control accepts, shows why it refuses others,
//! and undoes changes.

use egui_kittest::kittest::Queryable as _;
use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::memory::{ControlParameters, parameter};
use gsk_core::setup::Setup;
use gsk_core::units::Axis;
use gsk_host::kernel::Command;

use crate::common::WindowBench;

/// Opens the view of a control with the manufacturer's parameters (disk N0).
fn open_view() -> WindowBench {
    open_view_with(Setup::delivered())
}

fn open_view_with(mut setup: Setup) -> WindowBench {
    setup.memory.parameters = ControlParameters::default();
    let mut bench = WindowBench::with_setup(setup);
    for entry in ["Views", "Parameters and offsets"] {
        bench.harness.get_by_label(entry).click();
        bench.run(1);
        bench.run(1);
    }
    run_briefly(&mut bench);
    bench
}

fn run_briefly(bench: &mut WindowBench) {
    bench.run(1);
    bench.run(100);
}

/// Allows parameters to be written: the switch, and MDI.
fn allow_writing(bench: &mut WindowBench) {
    send_request(bench, ControlRequest::SetParameterSwitch(true));
    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num3);
    bench.run(300);
    run_briefly(bench);
}

/// Selects automatic mode, in which neither parameters nor variables can be written.
fn select_automatic(bench: &mut WindowBench) {
    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num1);
    bench.run(300);
    run_briefly(bench);
}

fn send_request(bench: &mut WindowBench, request: ControlRequest) {
    bench.console.send(Command::Request(Box::new(request)));
    run_briefly(bench);
}

fn cnc(bench: &WindowBench) -> &Cnc {
    bench.kernel.emulator().cnc()
}

/// Clicks the widget with exactly this name.
#[track_caller]
fn press(bench: &mut WindowBench, name: &str) {
    bench.harness.get_by_label(name).click();
    run_briefly(bench);
}

/// Clicks a row or a check box by a part of its name.
#[track_caller]
fn choose(bench: &mut WindowBench, part: &str) {
    bench.harness.get_by_label_contains(part).click();
    run_briefly(bench);
}

/// Replaces the text of a field and leaves it.
#[track_caller]
fn fill(bench: &mut WindowBench, field: &str, text: &str) {
    bench.harness.get_by_label(field).focus();
    bench.run(1);
    let command = egui::Modifiers::COMMAND;
    bench.harness.key_press_modifiers(command, egui::Key::A);
    bench.run(1);
    bench.harness.event(egui::Event::Text(text.to_owned()));
    bench.run(1);
    bench.harness.key_press(egui::Key::Enter);
    run_briefly(bench);
}

fn is_shown(bench: &WindowBench, text: &str) -> bool {
    bench
        .harness
        .query_all_by_label_contains(text)
        .next()
        .is_some()
}

#[test]
fn a_check_box_changes_its_bit_and_the_value_and_both_are_written_and_undone() {
    let mut bench = open_view();
    choose(&mut bench, "Spindle, handwheel, radius");
    choose(&mut bench, "001.4 1 spindle speed by analog");
    let value = bench.harness.get_by_label("Value of 001").value();
    assert_eq!(value.as_deref(), Some("00010000"));
    // Without the rights no value is written.
    assert!(is_shown(&bench, "cannot be written now: "));
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).parameters().byte(1), 0);
    allow_writing(&mut bench);
    assert!(is_shown(&bench, "the control takes these values now"));
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).parameters().byte(1), 0b0001_0000);
    assert!(is_shown(&bench, "changed from the factory value"));
    press(&mut bench, "Undo: No.001 = 16");
    assert_eq!(cnc(&bench).parameters().byte(1), 0);
    assert!(!is_shown(&bench, "Undo: "));
    assert!(bench.harness.query_by_label("Write 0").is_some());
}

#[test]
fn parameters_are_found_by_words_and_by_function_and_kept_in_their_range() {
    let mut bench = open_view();
    allow_writing(&mut bench);
    let previous = cnc(&bench).parameters().clone();
    press(&mut bench, "Backlash");
    assert!(is_shown(&bench, "035 BKLZ") && !is_shown(&bench, "RPDFX"));
    fill(&mut bench, "Search the parameters", "RPDFX");
    assert!(is_shown(&bench, "1 found") && !is_shown(&bench, "035 BKLZ"));
    choose(&mut bench, "022 RPDFX");
    fill(&mut bench, "Value of 022", "15001");
    assert!(is_shown(&bench, "parameter 022: 15001 is outside 6..15000"));
    press(&mut bench, "Write 1");
    assert_eq!(*cnc(&bench).parameters(), previous);
    assert!(cnc(&bench).alarms().iter().all(|alarm| alarm.number != 43));
    fill(&mut bench, "Value of 022", "fast");
    assert!(is_shown(&bench, "fast is not a valid value"));
    press(&mut bench, "Write 1");
    let count_errors = |bench: &WindowBench| {
        let all = bench
            .harness
            .query_all_by_label_contains("fast is not a valid value");
        all.count()
    };
    assert_eq!(count_errors(&bench), 2, "beside the field and in the bar");
    // The error disappears as soon as the value is valid.
    fill(&mut bench, "Value of 022", "3000");
    assert_eq!(count_errors(&bench), 0);
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).parameters().value(parameter::X_RAPID), 3000);
    assert!(is_shown(&bench, "No.022 = 3000: 1 written"));
    // The value differs now, as do those that the control itself stores in parameters.
    let factory = ControlParameters::default();
    let current = cnc(&bench).parameters().clone();
    let pairs = current.iter().zip(factory.iter());
    let changed_numbers: Vec<u16> = pairs
        .filter(|(own, factory)| own != factory)
        .map(|((number, _), _)| number)
        .collect();
    assert!(
        changed_numbers.contains(&22) && changed_numbers.len() < 5,
        "{changed_numbers:?}"
    );
    fill(&mut bench, "Search the parameters", " ");
    press(&mut bench, "All parameters");
    press(&mut bench, "Only values changed from the factory settings");
    assert!(is_shown(
        &bench,
        &format!("{} found", changed_numbers.len())
    ));
    assert!(is_shown(
        &bench,
        "022 RPDFX 3000 changed from the factory value"
    ));
    assert!(!is_shown(&bench, "035 BKLZ"));
    // A parameter that takes effect after power-on has a note.
    fill(&mut bench, "Search the parameters", "No. 005");
    press(&mut bench, "Only values changed from the factory settings");
    choose(&mut bench, "Spindle gear, M30");
    assert!(is_shown(&bench, "when the power is switched on again"));
}

#[test]
fn offsets_and_wear_are_written_with_separate_rights() {
    let mut bench = open_view();
    press(&mut bench, "Tool offsets");
    // Offsets need neither MDI nor the parameter switch.
    fill(&mut bench, "offset 001 X", "20");
    fill(&mut bench, "offset 001 Z", "-12,5");
    fill(&mut bench, "offset 001 T", "3");
    press(&mut bench, "Write 3");
    let row = cnc(&bench).offsets().get(1);
    assert_eq!((row.x, row.z, row.t), (20.0, -12.5, 3));
    fill(&mut bench, "offset 001 X", "u-0.02");
    press(&mut bench, "Write 1");
    run_briefly(&mut bench);
    assert_eq!(cnc(&bench).offsets().get(1).x, 19.98);
    assert!(bench.harness.query_by_label("Write 0").is_some());
    // The mode for measured offsets (012.5) concerns the page of the control. The view always
    // writes the value itself.
    allow_writing(&mut bench);
    let measured = ControlRequest::SetParameterBit {
        number: 12,
        bit: 5,
        on: true,
    };
    send_request(&mut bench, measured);
    fill(&mut bench, "offset 002 X", "7");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).offsets().get(2).x, 7.0);
    fill(&mut bench, "offset 001 T", "10");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).offsets().get(1).t, 3);
    press(&mut bench, "Discard");
    // Without a log-on, no value can be changed or undone.
    send_request(&mut bench, ControlRequest::LowerLevel);
    assert!(is_shown(&bench, "the operation level is too low"));
    fill(&mut bench, "offset 001 R", "0.4");
    press(&mut bench, "Write 1");
    choose(&mut bench, "Undo: ");
    assert_eq!(cnc(&bench).offsets().get(1).r, 0.0);
    assert_eq!(cnc(&bench).offsets().get(2).x, 7.0);
}

#[test]
fn variables_are_written_in_mdi() {
    let mut bench = open_view();
    select_automatic(&mut bench);
    press(&mut bench, "Macro variables");
    assert!(is_shown(&bench, "cannot be written now: "));
    allow_writing(&mut bench);
    fill(&mut bench, "variable #201", "1.5");
    press(&mut bench, "Write 1");
    assert!(is_shown(&bench, "is not a whole number"));
    fill(&mut bench, "variable #201", "-77");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).variables().get(201), Some(-77));
    choose(&mut bench, "Undo: ");
    assert_eq!(cnc(&bench).variables().get(201), Some(0));
}

/// Macro B has null values. Undo restores null.
#[test]
fn undo_restores_a_null_variable() {
    let mut setup = Setup::delivered();
    setup.memory.settings.macro_b = true;
    let mut bench = open_view_with(setup);
    press(&mut bench, "Macro variables");
    allow_writing(&mut bench);
    assert_eq!(cnc(&bench).real_variable(1), None);
    fill(&mut bench, "variable #1", "0.25");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).real_variable(1), Some(0.25));
    choose(&mut bench, "Undo: ");
    assert_eq!(cnc(&bench).real_variable(1), None);
    let value = bench.harness.get_by_label("variable #1").value();
    assert_eq!(value.as_deref().unwrap_or_default(), "");
}

#[test]
fn a_pitch_error_is_written_like_a_parameter_and_undone() {
    let mut bench = open_view();
    press(&mut bench, "Pitch error table");
    fill(&mut bench, "pitch error 002 Z", "-12");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).pitch().value(Axis::Z, 2), 0, "not in MDI");
    allow_writing(&mut bench);
    fill(&mut bench, "pitch error 003 X", "300");
    press(&mut bench, "Write 2");
    assert_eq!(cnc(&bench).pitch().value(Axis::Z, 2), 0, "300 is too much");
    fill(&mut bench, "pitch error 003 X", "7");
    press(&mut bench, "Write 2");
    let current_values = |bench: &WindowBench| {
        let pitch = cnc(bench).pitch();
        (pitch.value(Axis::X, 3), pitch.value(Axis::Z, 2))
    };
    assert_eq!(current_values(&bench), (7, -12));
    choose(&mut bench, "Undo: ");
    assert_eq!(current_values(&bench), (0, 0));
}
