//! The program view as a debugger: watched values, ladder slots, and the dialog of a restart.

use std::time::Duration;

use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use gsk_core::cnc::ControlRequest;
use gsk_core::setup::Setup;
use gsk_host::kernel::{BreakpointCommand, Command};
use gsk_messages::Language;
use gsk_panel::emulator::Emulator;
use gsk_twins::grbl::Variant;
use gsk_window::WindowSettings;
use gsk_window::layout::{Layouts, WindowLayout};

use crate::common::WindowBench;
use crate::lease::bench::board::LinkedMachine;

/// The block of the restarts is the last line: there a click below the text puts the cursor.
const TURNED: &str = "O0007\nG50 X100 Z100\nG97 G98 S800 M03\nT0101 M08\nG00 X52 Z2\n\
                      G01 X40 F120\nZ-10";
const LAST_LINE: u32 = 7;

fn settings() -> WindowSettings {
    WindowSettings {
        language: Language::En,
        layouts: Layouts::with_layout(WindowLayout::Panel),
        ..WindowSettings::default()
    }
}

/// A window with the program view, in which the cursor is on the first line of the program.
fn open_program(mut bench: WindowBench) -> WindowBench {
    let store = ControlRequest::StoreProgram(TURNED.to_owned());
    bench.console.send(Command::Request(Box::new(store)));
    bench.run(100);
    bench
        .harness
        .key_press_modifiers(Modifiers::SHIFT, Key::F11);
    bench.run(1);
    wait_for(&mut bench, "O0007");
    bench
}

fn is_shown(bench: &WindowBench, text: &str) -> bool {
    bench.harness.query_all_by_label_contains(text).count() > 0
}

#[track_caller]
fn wait_for(bench: &mut WindowBench, text: &str) {
    for _ in 0..2000 {
        bench.run(1);
        if is_shown(bench, text) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no {text}");
}

#[track_caller]
fn click(bench: &mut WindowBench, label: &str) {
    bench.harness.get_by_label(label).click();
    bench.run(1);
    bench.run(1);
}

/// Clicks a widget that may be scrolled out of sight.
#[track_caller]
fn click_in_list(bench: &mut WindowBench, label: &str) {
    bench.harness.get_by_label(label).click_accesskit();
    bench.run(1);
    bench.run(1);
}

/// The last text field with this value.
#[track_caller]
fn find_field<'a>(bench: &'a WindowBench, value: &'a str) -> egui_kittest::Node<'a> {
    let mut fields = bench
        .harness
        .query_all_by_role(egui::accesskit::Role::TextInput);
    let has_value = |field: &egui_kittest::Node<'_>| field.value().unwrap_or_default() == value;
    fields.rfind(has_value).expect("a field")
}

#[track_caller]
fn focus_field(bench: &mut WindowBench, value: &str) {
    find_field(bench, value).focus();
    bench.run(1);
}

#[track_caller]
fn type_in_field(bench: &mut WindowBench, value: &str, typed: &str) {
    focus_field(bench, value);
    find_field(bench, value).type_text(typed);
    bench.run(1);
}

/// Opens the dialog of a restart at the last line.
fn open_dialog(bench: &mut WindowBench) {
    let text = bench.harness.get_by_label("Program text");
    text.click_secondary();
    bench.run(1);
    bench.run(1);
    click(bench, &format!("Restart at line {LAST_LINE}…"));
    wait_for(bench, "Take over the values");
}

/// The label of a difference that begins with this text.
fn difference(bench: &WindowBench, begin: &str) -> String {
    let mut nodes = bench.harness.query_all_by_label_contains(begin);
    let label = nodes.find_map(|node| node.accesskit_node().label());
    label.unwrap_or_default()
}

#[test]
fn watched_values_are_kept_shown_and_removed() {
    let names = ["P22", "#100+1", "no such value"];
    let kept = WindowSettings {
        watches: names.map(str::to_owned).to_vec(),
        ..settings()
    };
    let size = vec2(1280.0, 806.0);
    let mut bench = open_program(WindowBench::with_settings(Setup::default(), kept, size));
    wait_for(&mut bench, "P22 = ");
    wait_for(&mut bench, "#100+1 = 1");
    assert!(!is_shown(&bench, "no such value"));
    assert_eq!(bench.harness.state().settings().watches, ["P22", "#100+1"]);
    click(&mut bench, "Watches (2)");
    let mut buttons = bench.harness.query_all_by_label("✕");
    buttons.next().expect("a button for each value").click();
    drop(buttons);
    wait_for(&mut bench, "Watches (1)");
    bench.run(1);
    assert!(!is_shown(&bench, "P22 = "));
    assert_eq!(bench.harness.state().settings().watches, ["#100+1"]);
}

#[test]
fn a_slot_of_the_ladder_is_eight_ticks() {
    let mut bench = WindowBench::new();
    bench.console.send(Command::Watch(vec![
        gsk_debugger::watch::WatchTarget::parse("tick").unwrap(),
    ]));
    let mut ticks = Vec::new();
    for _ in 0..3 {
        let slot = BreakpointCommand::NextSlot;
        bench.console.send(Command::Breakpoints(slot));
        bench.run(100);
        let snapshot = bench.kernel.snapshot();
        assert!(snapshot.halt.is_some());
        let tick: u64 = snapshot.watches[0].value.clone().unwrap().parse().unwrap();
        ticks.push(tick);
    }
    assert_eq!([ticks[1] - ticks[0], ticks[2] - ticks[1]], [8, 8]);
}

#[test]
fn a_slot_back_opens_the_time_line_and_leads_to_the_halt_again() {
    let mut bench = open_program(WindowBench::with_settings(
        Setup::default(),
        settings(),
        vec2(1280.0, 806.0),
    ));
    bench.run(4000);
    let slot = BreakpointCommand::NextSlot;
    bench.console.send(Command::Breakpoints(slot));
    bench.run(100);
    wait_for(&mut bench, "machine time stands still");
    assert!(!bench.harness.state().settings().timeline);
    bench
        .harness
        .query_all_by_label("Slot back")
        .next()
        .expect("a button")
        .click();
    wait_for(&mut bench, "You see the past");
    bench.run(50);
    assert!(bench.harness.state().settings().timeline);
    let first = bench.kernel.snapshot().past.expect("the past");
    assert_eq!(first.age_ms, 8);
    click(&mut bench, "Slot back");
    bench.run(1);
    let second = bench.kernel.snapshot().past.expect("the past");
    assert_eq!(second.age_ms, 16);
    for _ in 0..2 {
        click(&mut bench, "Ladder slot");
        bench.run(1);
    }
    assert_eq!(bench.kernel.snapshot().past, None);
    wait_for(&mut bench, "machine time stands still");
    // A closed strip shows the present, and stays closed.
    click(&mut bench, "Views");
    let mut entries = bench.harness.query_all_by_label("Time line");
    let is_entry =
        |it: &egui_kittest::Node<'_>| it.accesskit_node().role() != egui::accesskit::Role::Slider;
    entries.find(is_entry).expect("an entry").click();
    drop(entries);
    bench.run(50);
    bench.run(50);
    assert!(!bench.harness.state().settings().timeline);
}

#[test]
fn the_list_of_differences_is_edited_and_checked_again() {
    let mut bench = open_program(WindowBench::with_settings(
        Setup::default(),
        settings(),
        vec2(1280.0, 806.0),
    ));
    wait_for_guessed_part(&mut bench);
    open_dialog(&mut bench);
    assert!(is_shown(&bench, "coolant: M09, at the block M08"));
    click_in_list(&mut bench, "Leave out, keep M09");
    wait_for(&mut bench, "(changed; the program has M08)");
    click_in_list(&mut bench, "Change S800…");
    focus_field(&mut bench, "S800");
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::A);
    bench.run(1);
    type_in_field(&mut bench, "S800", "S500");
    click_in_list(&mut bench, "Check");
    wait_for(&mut bench, "(changed; the program has 800)");
    assert!(is_shown(&bench, "Output G97 S500"));
    click(&mut bench, "Take over the values");
    wait_for(&mut bench, "goes to the start point and stops there");
}

/// A control whose board has made its reference return.
fn emulator_with_board() -> Emulator {
    let machine = LinkedMachine::referenced(Variant::Grbl);
    let mut emulator = Emulator::new(Setup::delivered());
    emulator.run(4000);
    *emulator.board_simulation() = machine.simulation;
    emulator
}

/// Waits until the practice bar is replaced by the part that the program suggests.
fn wait_for_guessed_part(bench: &mut WindowBench) {
    for _ in 0..2000 {
        let (to, copies) = crossbeam::channel::bounded(1);
        bench.console.send(Command::SendMachine(to));
        bench.run(1);
        let (_, part) = *copies.try_recv().expect("a copy of the machine");
        if part.is_some_and(|part| part.machining().job().zero.is_none()) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no guessed part");
}

#[test]
fn with_real_slides_each_difference_must_be_ticked() {
    let size = vec2(1280.0, 806.0);
    let bench = WindowBench::with_emulator(emulator_with_board(), settings(), size);
    let mut bench = open_program(bench);
    wait_for_guessed_part(&mut bench);
    open_dialog(&mut bench);
    assert!(is_shown(&bench, "REAL MOTION: check each difference"));
    let confirm = |bench: &WindowBench| {
        let button = bench.harness.get_by_label("Take over the values");
        !button.accesskit_node().is_disabled()
    };
    assert!(!confirm(&bench), "nothing is ticked");
    let boxes = bench
        .harness
        .query_all_by_role(egui::accesskit::Role::CheckBox);
    let names: Vec<String> = boxes
        .filter_map(|it| it.accesskit_node().label())
        .filter(|it| it.contains("at the block"))
        .collect();
    assert!(names.len() >= 5, "{names:?}");
    for (index, name) in names.iter().enumerate() {
        assert!(!confirm(&bench), "{index} of {} ticked", names.len());
        click_in_list(&mut bench, name);
    }
    assert!(confirm(&bench), "each is ticked");
    // A changed value is another difference, which needs its own tick.
    click_in_list(&mut bench, "Leave out, keep M09");
    wait_for(&mut bench, "(changed; the program has M08)");
    assert!(!confirm(&bench));
    let changed = difference(&bench, "coolant:");
    click_in_list(&mut bench, &changed);
    assert!(confirm(&bench));
    assert!(!bench.kernel.emulator().cnc().has_restart());
    click(&mut bench, "Take over the values");
    assert!(bench.kernel.emulator().cnc().has_restart());
}
