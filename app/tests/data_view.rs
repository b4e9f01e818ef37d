//! The data view: it writes the values that the control accepts, shows why it refuses others,
//! and undoes changes.

use egui_kittest::kittest::Queryable as _;
use gsk_app::kernel::Command;
use gsk_core::cnc::{Cnc, Request};
use gsk_core::memory::{Parameters, parameter};
use gsk_core::setup::Setup;
use gsk_core::units::Axis;

use crate::common::Bench;

/// Opens the view of a control with the manufacturer's parameters (disk N0).
fn opened() -> Bench {
    opened_with(Setup::delivered())
}

fn opened_with(mut setup: Setup) -> Bench {
    setup.memory.parameters = Parameters::default();
    let mut bench = Bench::with(setup);
    for entry in ["Views", "Parameters and offsets"] {
        bench.harness.get_by_label(entry).click();
        bench.run(1);
        bench.run(1);
    }
    settle(&mut bench);
    bench
}

fn settle(bench: &mut Bench) {
    bench.run(1);
    bench.run(100);
}

/// Allows parameters to be written: the switch, and MDI.
fn may_write(bench: &mut Bench) {
    ask(bench, Request::SetParameterSwitch(true));
    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num3);
    bench.run(300);
    settle(bench);
}

/// Selects automatic mode, in which neither parameters nor variables can be written.
fn automatic(bench: &mut Bench) {
    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num1);
    bench.run(300);
    settle(bench);
}

fn ask(bench: &mut Bench, request: Request) {
    bench.console.send(Command::Ask(Box::new(request)));
    settle(bench);
}

fn cnc(bench: &Bench) -> &Cnc {
    &bench.kernel.emulator().simulation.cnc
}

/// Clicks the widget with exactly this name.
#[track_caller]
fn press(bench: &mut Bench, name: &str) {
    bench.harness.get_by_label(name).click();
    settle(bench);
}

/// Clicks a row or a check box by a part of its name.
#[track_caller]
fn choose(bench: &mut Bench, part: &str) {
    bench.harness.get_by_label_contains(part).click();
    settle(bench);
}

/// Replaces the text of a field and leaves it.
#[track_caller]
fn fill(bench: &mut Bench, field: &str, text: &str) {
    bench.harness.get_by_label(field).focus();
    bench.run(1);
    let command = egui::Modifiers::COMMAND;
    bench.harness.key_press_modifiers(command, egui::Key::A);
    bench.run(1);
    bench.harness.event(egui::Event::Text(text.to_owned()));
    bench.run(1);
    bench.harness.key_press(egui::Key::Enter);
    settle(bench);
}

fn says(bench: &Bench, words: &str) -> bool {
    bench
        .harness
        .query_all_by_label_contains(words)
        .next()
        .is_some()
}

#[test]
fn a_box_changes_its_bit_and_the_value_and_both_are_written_and_taken_back() {
    let mut bench = opened();
    choose(&mut bench, "Spindle, handwheel, radius");
    choose(&mut bench, "001.4 1 spindle speed by analog");
    let value = bench.harness.get_by_label("Value of 001").value();
    assert_eq!(value.as_deref(), Some("00010000"));
    // Without the rights no value is written.
    assert!(says(&bench, "cannot be written now: "));
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).parameters().byte(1), 0);
    may_write(&mut bench);
    assert!(says(&bench, "the control takes these values now"));
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).parameters().byte(1), 0b0001_0000);
    assert!(says(&bench, "differs from delivery"));
    press(&mut bench, "Undo: No.001 = 16");
    assert_eq!(cnc(&bench).parameters().byte(1), 0);
    assert!(!says(&bench, "Undo: "));
    assert!(bench.harness.query_by_label("Write 0").is_some());
}

#[test]
fn parameters_are_found_by_words_and_by_function_and_kept_in_their_range() {
    let mut bench = opened();
    may_write(&mut bench);
    let before = cnc(&bench).parameters().clone();
    press(&mut bench, "Backlash");
    assert!(says(&bench, "035 BKLZ") && !says(&bench, "RPDFX"));
    fill(&mut bench, "Search the parameters", "RPDFX");
    assert!(says(&bench, "1 found") && !says(&bench, "035 BKLZ"));
    choose(&mut bench, "022 RPDFX");
    fill(&mut bench, "Value of 022", "15001");
    assert!(says(&bench, "parameter 022: 15001 is outside 6..15000"));
    press(&mut bench, "Write 1");
    assert_eq!(*cnc(&bench).parameters(), before);
    assert!(cnc(&bench).alarms().iter().all(|alarm| alarm.number != 43));
    fill(&mut bench, "Value of 022", "fast");
    assert!(says(&bench, "fast is no value"));
    press(&mut bench, "Write 1");
    let complaints = |bench: &Bench| {
        let all = bench
            .harness
            .query_all_by_label_contains("fast is no value");
        all.count()
    };
    assert_eq!(complaints(&bench), 2, "beside the field and in the bar");
    // The error disappears as soon as the value is valid.
    fill(&mut bench, "Value of 022", "3000");
    assert_eq!(complaints(&bench), 0);
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).parameters().value(parameter::X_RAPID), 3000);
    assert!(says(&bench, "No.022 = 3000: 1 written"));
    // The value differs now, as do those that the control itself stores in parameters.
    let factory = Parameters::default();
    let own = cnc(&bench).parameters().clone();
    let differ = own.iter().zip(factory.iter());
    let differ: Vec<u16> = differ
        .filter(|(own, factory)| own != factory)
        .map(|((number, _), _)| number)
        .collect();
    assert!(differ.contains(&22) && differ.len() < 5, "{differ:?}");
    fill(&mut bench, "Search the parameters", " ");
    press(&mut bench, "All parameters");
    press(&mut bench, "Only what differs from delivery");
    assert!(says(&bench, &format!("{} found", differ.len())));
    assert!(says(&bench, "022 RPDFX 3000 differs from delivery"));
    assert!(!says(&bench, "035 BKLZ"));
    // A parameter that takes effect after power-on has a note.
    fill(&mut bench, "Search the parameters", "No. 005");
    press(&mut bench, "Only what differs from delivery");
    choose(&mut bench, "Spindle gear, M30");
    assert!(says(&bench, "when the power is switched on again"));
}

#[test]
fn offsets_are_values_and_wear_is_added_to_them_with_their_own_rights() {
    let mut bench = opened();
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
    settle(&mut bench);
    assert_eq!(cnc(&bench).offsets().get(1).x, 19.98);
    assert!(bench.harness.query_by_label("Write 0").is_some());
    // The mode for measured offsets (012.5) concerns the page of the control. The view always
    // writes the value itself.
    may_write(&mut bench);
    let measured = Request::SetParameterBit {
        number: 12,
        bit: 5,
        on: true,
    };
    ask(&mut bench, measured);
    fill(&mut bench, "offset 002 X", "7");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).offsets().get(2).x, 7.0);
    fill(&mut bench, "offset 001 T", "10");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).offsets().get(1).t, 3);
    press(&mut bench, "Discard");
    // Without a log-on, no value can be changed or undone.
    ask(&mut bench, Request::LeaveLevel);
    assert!(says(&bench, "the operation level is too low"));
    fill(&mut bench, "offset 001 R", "0.4");
    press(&mut bench, "Write 1");
    choose(&mut bench, "Undo: ");
    assert_eq!(cnc(&bench).offsets().get(1).r, 0.0);
    assert_eq!(cnc(&bench).offsets().get(2).x, 7.0);
}

#[test]
fn variables_are_written_in_mdi() {
    let mut bench = opened();
    automatic(&mut bench);
    press(&mut bench, "Macro variables");
    assert!(says(&bench, "cannot be written now: "));
    may_write(&mut bench);
    fill(&mut bench, "variable #201", "1.5");
    press(&mut bench, "Write 1");
    assert!(says(&bench, "is no whole number"));
    fill(&mut bench, "variable #201", "-77");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).variables().get(201), Some(-77));
    choose(&mut bench, "Undo: ");
    assert_eq!(cnc(&bench).variables().get(201), Some(0));
}

/// Macro B has null values. Undo restores null.
#[test]
fn a_null_variable_is_null_again_when_it_is_taken_back() {
    let mut setup = Setup::delivered();
    setup.memory.settings.macro_b = true;
    let mut bench = opened_with(setup);
    press(&mut bench, "Macro variables");
    may_write(&mut bench);
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
fn a_pitch_error_is_written_as_a_parameter_is_and_taken_back() {
    let mut bench = opened();
    press(&mut bench, "Pitch error table");
    fill(&mut bench, "pitch error 002 Z", "-12");
    press(&mut bench, "Write 1");
    assert_eq!(cnc(&bench).pitch().value(Axis::Z, 2), 0, "not in MDI");
    may_write(&mut bench);
    fill(&mut bench, "pitch error 003 X", "300");
    press(&mut bench, "Write 2");
    assert_eq!(cnc(&bench).pitch().value(Axis::Z, 2), 0, "300 is too much");
    fill(&mut bench, "pitch error 003 X", "7");
    press(&mut bench, "Write 2");
    let now = |bench: &Bench| {
        let pitch = cnc(bench).pitch();
        (pitch.value(Axis::X, 3), pitch.value(Axis::Z, 2))
    };
    assert_eq!(now(&bench), (7, -12));
    choose(&mut bench, "Undo: ");
    assert_eq!(now(&bench), (0, 0));
}
