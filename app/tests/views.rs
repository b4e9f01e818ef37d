//! The views, operated through their accessible names.

use std::collections::BTreeSet;
use std::sync::Arc;

use gsk_host::kernel::probe::{Probe, ScopeSample};
use gsk_host::kernel::{Command, OpenedProgram, StorePolicy};

use crate::common::WindowBench;
use crossbeam::queue::ArrayQueue;
use egui_kittest::kittest::Queryable;
use gsk_core::machine::LatheFault;
use gsk_core::program::Program;

/// Opens a view by its entry in the menu.
fn open_view(bench: &mut WindowBench, name: &str) {
    bench.harness.get_by_label("Views").click();
    bench.run(1);
    bench.harness.get_by_label_contains(name).click();
    bench.run(1);
}

#[test]
fn the_scope_opens_by_its_key_and_shows_axis_motion() {
    let mut bench = WindowBench::new();
    assert!(bench.harness.query_by_label("Scope picture").is_none());
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::F2);
    bench.run(1);
    bench.run(500);
    assert!(bench.harness.query_by_label("Scope picture").is_some());

    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num6);
    bench.run(500);
    bench
        .harness
        .key_down_modifiers(control, egui::Key::ArrowLeft);
    bench.run(50);
    for _ in 0..20 {
        bench.run(50);
    }
    let rate = bench.kernel.emulator().cnc().jog_rate();
    assert!(rate > 0.0);
    let expected = format!("{:.1}", -rate);
    assert!(
        bench.harness.query_by_label(&expected).is_some(),
        "no {expected}"
    );
    bench
        .harness
        .key_up_modifiers(control, egui::Key::ArrowLeft);
    bench.run(300);

    bench.harness.key_press_modifiers(shift, egui::Key::F2);
    bench.run(1);
    bench.run(1);
    assert!(bench.harness.query_by_label("Scope picture").is_none());
}

/// All commanded speeds that the scope has received, and the last one.
fn commanded_speeds(queue: &ArrayQueue<ScopeSample>) -> (BTreeSet<i64>, i64) {
    let mut last = 0;
    let speeds = core::iter::from_fn(|| queue.pop());
    let all = speeds.map(|sample| {
        last = sample.commanded_spindle_rpm.round() as i64;
        last
    });
    (all.collect(), last)
}

#[test]
fn the_commanded_spindle_speed_of_the_scope_ends_with_m05_and_reset() {
    let mut bench = WindowBench::new();
    let queue = Arc::new(ArrayQueue::new(60_000));
    bench.console.send(Command::Probe(Some(Probe {
        queue: Arc::clone(&queue),
        bits: Vec::new(),
    })));
    let run_program = |bench: &mut WindowBench, text: &str| {
        bench.console.send(Command::Open(Box::new(OpenedProgram {
            name: "spindle.CNC".to_owned(),
            path: None,
            store_policy: StorePolicy::RunOnly,
            program: Program::new(text),
            subprograms: Vec::new(),
        })));
        bench.run(10);
        bench.click("Automatic mode");
        bench.click("Cycle start");
        bench.run(2000);
    };
    run_program(
        &mut bench,
        "O1\nG97 S500 M03\nG04 X0.5\nM05\nG04 X0.2\nM00\nM30\n",
    );
    let spindle = bench.kernel.emulator().cnc().spindle().s_word();
    assert_eq!(spindle, 500.0, "S stays for the next M03");
    assert_eq!(commanded_speeds(&queue), (BTreeSet::from([0, 500]), 0));
    bench.click("Reset");
    run_program(&mut bench, "O1\nG97 S300 M04\nG04 X60\nM30\n");
    assert_eq!(commanded_speeds(&queue), (BTreeSet::from([0, -300]), -300));
    bench.click("Reset");
    bench.run(500);
    assert_eq!(commanded_speeds(&queue).1, 0);
}

#[test]
fn the_trigger_stops_the_scope_at_the_start_of_motion() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Scope");
    let choose = |bench: &mut WindowBench, name: &str, entry: &str| {
        let role = egui::accesskit::Role::ComboBox;
        bench.harness.get_by_role_and_label(role, name).click();
        bench.run(1);
        bench.run(1);
        bench.harness.get_by_label(entry).click();
        bench.run(1);
        bench.run(1);
    };
    choose(&mut bench, "Span", "500 ms");
    choose(&mut bench, "Trigger", "once");
    bench.run(1000);
    bench.run(1);
    assert!(bench.harness.query_by_label("waiting").is_some());
    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num6);
    bench.run(500);
    bench
        .harness
        .key_down_modifiers(control, egui::Key::ArrowLeft);
    for _ in 0..30 {
        bench.run(50);
    }
    bench
        .harness
        .key_up_modifiers(control, egui::Key::ArrowLeft);
    bench.run(300);
    assert!(bench.harness.query_by_label("stopped").is_some());
    assert!(bench.harness.query_by_label("Run").is_some());
}

#[test]
fn a_bit_can_be_recorded_and_a_wrong_address_is_refused() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Scope");
    let enter = |bench: &mut WindowBench, text: &str| {
        bench.harness.get_by_label("Bit address").focus();
        bench.run(1);
        bench.harness.get_by_label("Bit address").type_text(text);
        bench.run(1);
        bench.harness.get_by_label("Add").click();
        bench.run(1);
    };
    enter(&mut bench, "x20.5");
    assert!(bench.harness.query_by_label("X0020.5").is_some());
    // After Enter the field accepts the next address.
    bench.harness.get_by_label("Bit address").focus();
    bench.run(1);
    for text in ["F0.5", "Y1.2"] {
        bench.harness.event(egui::Event::Text(text.to_owned()));
        bench.run(1);
        bench.harness.key_press(egui::Key::Enter);
        bench.run(1);
        bench.run(1);
    }
    assert!(bench.harness.query_by_label("F0000.5").is_some());
    assert!(bench.harness.query_by_label("Y0001.2").is_some());
    enter(&mut bench, "Q7.9");
    assert!(
        bench
            .harness
            .query_by_label_contains("Not an address")
            .is_some()
    );
    bench.harness.get_by_label("Remove X0020.5").click();
    bench.run(1);
    bench.run(1);
    assert!(bench.harness.query_by_label("X0020.5").is_none());
}

#[test]
fn the_fault_bench_sets_and_clears_faults() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Fault bench");
    bench.run(100);
    bench.run(100);
    let name = "alarm of the Z drive";
    bench.harness.get_by_label(name).click();
    bench.run(100);
    bench.run(100);
    let lathe = |bench: &WindowBench| bench.kernel.emulator().lathe().clone();
    assert!(lathe(&bench).has_fault(LatheFault::DriveZ));
    assert!(bench.kernel.emulator().cnc().is_in_alarm());

    bench.harness.get_by_label("X0000.5 0").click();
    bench.run(100);
    bench.run(100);
    let address = "X0.5".parse().unwrap();
    assert_eq!(lathe(&bench).forced_input(address), Some(false));

    bench.harness.get_by_label("Clear all").click();
    bench.run(100);
    bench.run(100);
    assert!(!lathe(&bench).has_fault(LatheFault::DriveZ));
    assert_eq!(lathe(&bench).forced_input(address), None);
}

/// Clicks a button of a view and runs the window.
fn click(bench: &mut WindowBench, name: &str) {
    bench.harness.get_by_label(name).click();
    bench.run(100);
    bench.run(100);
}

#[test]
fn the_ladder_can_be_searched_forced_halted_and_stepped() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Ladder");
    bench.run(100);
    bench.run(100);
    // The emergency stop: X0.5 sets G8.4 (*ESP).
    click(&mut bench, "X0000.5 normally open");
    assert!(bench.harness.query_by_label("LD X0000.5").is_some());
    click(&mut bench, "Force X0000.5 0");
    let plc = |bench: &WindowBench| bench.kernel.emulator().cnc().plc().clone();
    assert_eq!(plc(&bench).forces().len(), 1);
    assert!(bench.kernel.emulator().cnc().is_shown_not_ready());
    click(&mut bench, "Release X0000.5");
    assert!(plc(&bench).forces().is_empty());

    let field = egui::accesskit::Role::TextInput;
    let find = |bench: &WindowBench| bench.harness.get_by_role_and_label(field, "Find").rect();
    assert!(find(&bench).width() > 50.0);
    bench.harness.get_by_role_and_label(field, "Find").focus();
    bench.run(1);
    bench
        .harness
        .get_by_role_and_label(field, "Find")
        .type_text("DT10");
    bench.run(1);
    bench.harness.key_press(egui::Key::Enter);
    bench.run(1);
    bench.run(1);
    assert!(bench.harness.query_by_label("1 / 1").is_some());
    let timer = "TMRB T0010 DT0010 R0040.5";
    assert!(bench.harness.query_all_by_label(timer).count() > 0);
    let list = "DT0010: 1 match(es)";
    assert!(bench.harness.query_by_label(list).is_some());
    click(&mut bench, "Close the list");
    assert!(bench.harness.query_by_label(list).is_none());

    click(&mut bench, "Halt");
    assert!(bench.kernel.emulator().cnc().is_ladder_halted());
    let previous_rung = plc(&bench).next_rung();
    click(&mut bench, "One rung");
    assert_ne!(plc(&bench).next_rung(), previous_rung);
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::F4);
    bench.run(100);
    bench.run(100);
    assert!(!bench.kernel.emulator().cnc().is_ladder_halted());
}

#[test]
fn forced_bits_and_faults_are_shown_while_their_view_is_closed() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Ladder");
    bench.run(100);
    bench.run(100);
    click(&mut bench, "X0000.5 normally open");
    click(&mut bench, "Force X0000.5 1");
    click(&mut bench, "Force X0000.5 1");
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::F4);
    bench.run(100);
    open_view(&mut bench, "Fault bench");
    bench.run(100);
    bench.run(100);
    click(&mut bench, "X0001.5 1");
    click(&mut bench, "chuck does not move");
    // The effect of the fault is shown below it.
    let effect = "M12 and M13 wait for NQPJ";
    assert!(bench.harness.query_by_label_contains(effect).is_some());
    bench.harness.key_press_modifiers(shift, egui::Key::F3);
    bench.run(100);
    let sign = "forced 2   faults 1";
    click(&mut bench, sign);
    click(&mut bench, "Release forced PLC bits (1)");
    let imposed = |bench: &WindowBench| bench.harness.state().snapshot().unwrap().forced;
    assert_eq!(
        (imposed(&bench).forced_bits, imposed(&bench).forced_inputs),
        (0, 1)
    );
    click(&mut bench, "forced 1   faults 1");
    click(&mut bench, "Clear faults, release forced inputs (2)");
    assert_eq!(imposed(&bench), Default::default());
    assert!(bench.harness.query_by_label_contains("faults 1").is_none());
}

#[test]
fn rungs_are_cut_pasted_and_found_by_their_row() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Ladder");
    bench.run(100);
    bench.run(100);
    click(&mut bench, "Edit");
    let contact = "X0000.5 normally open";
    click(&mut bench, contact);
    let has = |bench: &WindowBench, label: &str| bench.harness.query_by_label(label).is_some();
    click(&mut bench, "Cut");
    assert!(!has(&bench, contact));
    // The first rung comes back after the one that was second.
    click(&mut bench, "X0024.7 normally closed");
    click(&mut bench, "Paste");
    assert!(has(&bench, contact));
    assert!(has(&bench, "LD X0000.5") && has(&bench, "Rung 0002"));
    click(&mut bench, "Undo");
    click(&mut bench, "Undo");
    assert!(has(&bench, contact));

    click(&mut bench, "Go to");
    click(&mut bench, "Program end");
    let last = bench.kernel.emulator().cnc().plc().ladder().rung_count();
    assert!(has(&bench, &format!("Rung {last:04}")));
    click(&mut bench, "Go to");
    click(&mut bench, "Program start");
    assert!(has(&bench, "Rung 0001"));
}

/// Clicks the row of a table whose texts contain this one.
fn click_row(bench: &mut WindowBench, text: &str) {
    // The texts of its cells come first.
    let row = bench.harness.query_all_by_label_contains(text).last();
    row.expect("a row").click();
    bench.run(100);
    bench.run(100);
}

#[test]
fn the_parameter_wizard_names_what_sets_a_value() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Ladder");
    bench.run(100);
    bench.run(100);
    click(&mut bench, "Parameters");
    click_row(&mut bench, "K0009");
    let has = |bench: &WindowBench, text: &str| {
        let found = bench.harness.query_all_by_label_contains(text);
        found.count() > 0
    };
    assert!(has(&bench, "survives power-off"));
    assert!(has(&bench, "K0009  0  0  "));
    // While the ladder is edited, its value in a blank memory can be written.
    click(&mut bench, "Edit");
    let field = egui::accesskit::Role::TextInput;
    let value = bench.harness.get_by_role_and_label(field, "New value");
    value.focus();
    bench.run(1);
    let value = bench.harness.get_by_role_and_label(field, "New value");
    value.type_text("3");
    bench.run(100);
    click(&mut bench, "Write as initial value");
    assert!(has(&bench, "K0009  0  3  "));
}

#[test]
fn a_row_of_a_ladder_table_selects_its_rung() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Ladder");
    bench.run(100);
    bench.run(100);
    click(&mut bench, "Messages");
    let rows =
        |bench: &WindowBench, text: &str| bench.harness.query_all_by_label_contains(text).count();
    assert!(rows(&bench, "防护门未关") > 0);
    click(&mut bench, "Initial data");
    assert!(rows(&bench, "DT0004  15000") > 0);
    click(&mut bench, "Messages");
    let first = "A0000.0  1000  0  换刀时间过长";
    bench.harness.get_by_label(first).click();
    bench.run(1);
    bench.run(1);
    // The first rung that uses A0.0 is selected.
    assert!(bench.harness.query_by_label_contains("1 / ").is_some());
}

#[test]
fn a_ladder_is_saved_only_when_the_control_allows_it() {
    let mut bench = WindowBench::new();
    let requirement = "saving needs edit mode: press [Edit 编辑]";
    for allowed in [false, true] {
        if allowed {
            allow_ladder(&mut bench);
        }
        open_view(&mut bench, "Ladder");
        bench.run(100);
        bench.run(100);
        if !allowed {
            click(&mut bench, "Edit");
            click(&mut bench, "X0000.5 normally open");
            click(&mut bench, "Open/closed");
            let label = "compiled: errors 0, warnings 0";
            assert!(bench.harness.query_by_label(label).is_some());
            // The coil of the next rung is used a second time: a warning, which does not
            // prevent saving.
            let field = "Instructions of the rung";
            bench.harness.get_by_label(field).focus();
            bench.run(1);
            let end = (egui::Modifiers::COMMAND, egui::Key::End);
            bench.harness.key_press_modifiers(end.0, end.1);
            bench.run(1);
            let text = "\nOUT G8.5";
            bench.harness.get_by_label(field).type_text(text);
            bench.run(1);
            bench.run(1);
            let label = "compiled: errors 0, warnings 1";
            assert!(bench.harness.query_by_label(label).is_some());
            assert!(bench.harness.query_by_label_contains(": W01").is_some());
        }
        assert_eq!(bench.harness.query_by_label(requirement).is_none(), allowed);
        click(&mut bench, "Save");
        let next = bench.kernel.emulator().cnc().next_ladder();
        assert_eq!(next.is_some(), allowed);
        let shift = egui::Modifiers::SHIFT;
        bench.harness.key_press_modifiers(shift, egui::Key::F4);
        bench.run(100);
    }
}

/// Selects edit mode and turns the parameter switch on: the control accepts a ladder.
fn allow_ladder(bench: &mut WindowBench) {
    for name in ["Edit mode", "Setting pages", "Page down"] {
        bench.click(name);
    }
    bench.harness.event(egui::Event::Text("D".to_owned()));
    bench.run(300);
}

#[test]
fn a_rung_is_edited_undone_saved_and_runs_after_power_on() {
    let mut bench = WindowBench::new();
    allow_ladder(&mut bench);
    open_view(&mut bench, "Ladder");
    bench.run(100);
    bench.run(100);
    click(&mut bench, "Edit");
    click(&mut bench, "X0000.5 normally open");
    click(&mut bench, "Open/closed");
    assert!(
        bench
            .harness
            .query_by_label("X0000.5 normally closed")
            .is_some()
    );
    click(&mut bench, "Undo");
    click(&mut bench, "X0000.5 normally open");
    let stored_source = |bench: &WindowBench| {
        let plc = bench.kernel.emulator().cnc().plc();
        plc.ladder().source().to_owned()
    };
    let standard = stored_source(&bench);

    // Typed instructions: an error is shown with its line, a valid text is accepted.
    let field = "Instructions of the rung";
    bench.harness.get_by_label(field).focus();
    bench.run(1);
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::End);
    bench.run(1);
    bench.harness.get_by_label(field).type_text("\nSET R99");
    bench.run(1);
    bench.run(1);
    assert!(
        bench
            .harness
            .query_by_label_contains("line 4: E03")
            .is_some()
    );
    bench.harness.get_by_label(field).type_text(".7");
    bench.run(1);
    bench.run(1);
    assert!(bench.harness.query_by_label_contains("E03").is_none());
    assert!(bench.harness.query_by_label("R0099.7 SET").is_some());

    click(&mut bench, "Save");
    assert_eq!(stored_source(&bench), standard, "not before power-on");
    click(&mut bench, "Power off and on");
    bench.run(4000);
    assert!(stored_source(&bench).contains("SET R99.7"));
    let memory = bench.kernel.emulator().cnc().plc().memory();
    assert!(memory.bit("R99.7".parse().unwrap()), "and it runs");
}

#[test]
fn a_table_row_can_be_edited_and_an_invalid_one_is_refused() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Ladder");
    bench.run(100);
    bench.run(100);
    click(&mut bench, "Edit");
    click(&mut bench, "Messages");
    let write = |bench: &mut WindowBench, fields: &[(&str, &str)]| {
        for (name, text) in fields {
            let role = egui::accesskit::Role::TextInput;
            bench.harness.get_by_role_and_label(role, name).focus();
            bench.run(1);
            let select = (egui::Modifiers::COMMAND, egui::Key::A);
            bench.harness.key_press_modifiers(select.0, select.1);
            bench.run(1);
            let field = bench.harness.get_by_role_and_label(role, name);
            field.type_text(text);
            bench.run(1);
        }
        click(bench, "Write");
    };
    let rows = |bench: &WindowBench, text: &str| bench.harness.query_all_by_label(text).count();
    write(
        &mut bench,
        &[("A address", "A5.0"), ("Number", "999"), ("Text", "oil")],
    );
    assert!(
        bench
            .harness
            .query_by_label_contains("1000 to 9999")
            .is_some()
    );
    write(&mut bench, &[("Number", "1050")]);
    assert_eq!(rows(&bench, "A0005.0  1050  0  oil"), 1);
    click(&mut bench, "Delete row");
    assert_eq!(rows(&bench, "A0005.0  1050  0  oil"), 0);
    click(&mut bench, "Undo");
    assert_eq!(rows(&bench, "A0005.0  1050  0  oil"), 1);
}

#[test]
fn without_a_board_the_link_page_explains_how_to_configure_one() {
    let mut bench = WindowBench::new();
    open_view(&mut bench, "Pulse board");
    bench.run(100);
    assert!(bench.harness.query_by_label("No pulse board").is_some());
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::F5);
    bench.run(1);
    bench.run(1);
    assert!(bench.harness.query_by_label("No pulse board").is_none());
}
