//! The machine view: path, part, and clicks on the path.

use std::time::Duration;

use gsk_host::kernel::{Command, OpenedProgram, StorePolicy};
use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::view::ViewId;

use crate::common::WindowBench;
use crate::window::request_close;
use egui::Modifiers;
use egui::accesskit::Role;
use egui_kittest::kittest::{By, Queryable};
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;

/// Opens a program with the layout of panel and machine, and waits for its path.
fn open_program(text: &str) -> WindowBench {
    let size = egui::vec2(1600.0, 900.0);
    let mut bench = WindowBench::with_layouts(
        Setup::default(),
        Layouts::with_layout(WindowLayout::Machine),
        size,
    );
    bench.console.send(Command::Open(Box::new(OpenedProgram {
        name: "O7.CNC".to_owned(),
        path: None,
        store_policy: StorePolicy::RunOnly,
        program: Program::new(text),
        subprograms: Vec::new(),
    })));
    assert!(
        wait_for_text(&mut bench, "guessed from the program"),
        "there is no part"
    );
    bench
}

/// Runs the window until a text is shown. Returns false after a time limit.
fn wait_for_text(bench: &mut WindowBench, text: &str) -> bool {
    (0..500).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(10);
        // The heading of a list has the same label as the list.
        let mut found = bench.harness.query_all_by_label_contains(text);
        found.next().is_some()
    })
}

const TEXT: &str = "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
    G90 X36 Z-30 F300\nG00 X100 Z100\nM30\n";

/// Clicks along a vertical line, which crosses the path, until a block is named.
fn click_until_block(bench: &mut WindowBench, block: &str) -> bool {
    let picture = bench.harness.get_by_label("Machine picture").rect();
    (0..450).any(|step: usize| {
        // Each click is far from the one before: two close clicks would be a double click.
        let share = (step as f32 * 0.618) % 1.0;
        let column = [0.7, 0.55, 0.4][step % 3];
        let position = egui::pos2(
            picture.left() + picture.width() * column,
            picture.top() + picture.height() * share,
        );
        for pressed in [true, false] {
            press(bench, position, egui::PointerButton::Primary, pressed);
        }
        // The clicked block is named in the next frame.
        bench.harness.step();
        bench.harness.query_by_label_contains(block).is_some()
    })
}

fn press(bench: &mut WindowBench, pos: egui::Pos2, button: egui::PointerButton, pressed: bool) {
    bench.harness.event(egui::Event::PointerMoved(pos));
    bench.harness.event(egui::Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers: Modifiers::default(),
    });
    bench.harness.step();
}

/// The coordinates that are shown with the pointer at a position.
fn coordinates_at(bench: &mut WindowBench, position: egui::Pos2) -> String {
    bench.harness.event(egui::Event::PointerMoved(position));
    bench.harness.step();
    bench.harness.step();
    let readout = bench.harness.get_by_label_contains("  Z ");
    readout.value().unwrap_or_default()
}

#[test]
fn a_click_on_the_path_names_its_block() {
    let mut bench = open_program(TEXT);
    let block = "5  G90 X36 Z-30";
    assert!(click_until_block(&mut bench, block), "no click on the cut");
}

#[test]
fn a_solid_can_be_turned_moved_fitted_and_clicked() {
    let mut bench = open_program(TEXT);
    // The bars around the picture keep their height from now on.
    assert!(wait_for_text(&mut bench, " in all:"), "there are no times");
    bench.run(10);
    let middle = bench
        .harness
        .get_by_label("Machine picture")
        .rect()
        .center();
    let flat = coordinates_at(&mut bench, middle);
    bench.click("Solid");
    assert!(bench.harness.state().settings().solid, "it is remembered");
    let fitted = coordinates_at(&mut bench, middle);
    assert_ne!(flat, fitted);
    let mut last_reading = fitted.clone();
    for button in [egui::PointerButton::Primary, egui::PointerButton::Secondary] {
        let to = middle + egui::vec2(60.0, 30.0);
        press(&mut bench, middle, button, true);
        bench.harness.event(egui::Event::PointerMoved(to));
        bench.harness.step();
        press(&mut bench, to, button, false);
        // A turn about the middle keeps the middle; a move does not.
        let is_turn = button == egui::PointerButton::Primary;
        assert_eq!(
            coordinates_at(&mut bench, middle) == last_reading,
            is_turn,
            "{button:?}"
        );
        let off_middle = coordinates_at(&mut bench, middle + egui::vec2(100.0, 0.0));
        assert_ne!(off_middle, fitted);
        last_reading = coordinates_at(&mut bench, middle);
    }
    assert!(click_until_block(&mut bench, "5  G90 X36 Z-30"), "no click");
    // The text about the block makes the picture smaller; a click beside the path removes it.
    let corner = bench
        .harness
        .get_by_label("Machine picture")
        .rect()
        .left_top();
    for pressed in [true, false] {
        let off_path = corner + egui::vec2(4.0, 4.0);
        press(&mut bench, off_path, egui::PointerButton::Primary, pressed);
    }
    bench.click("Fit");
    assert_eq!(coordinates_at(&mut bench, middle), fitted);
    bench.click("Section");
    assert!(!bench.harness.state().settings().solid);
    assert_eq!(coordinates_at(&mut bench, middle), flat);
}

#[test]
fn a_work_zero_set_by_the_program_causes_no_collision() {
    let mut bench = open_program(TEXT);
    bench.click("Automatic mode");
    bench.click("Cycle start");
    for _ in 0..100 {
        bench.run(200);
    }
    assert!(
        bench
            .harness
            .query_by_label_contains("Collisions")
            .is_none()
    );
    let cnc = bench.kernel.emulator().cnc();
    assert_eq!(cnc.run_state(), RunState::Reset, "it has come to its end");
}

#[test]
fn a_crash_remains_until_the_lathe_is_free() {
    let mut bench = open_program(
        "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
        G90 X36 Z-30 F300\nG00 X20 Z-10\nG00 X100 Z100\nM30\n",
    );
    bench.click("Automatic mode");
    bench.click("Cycle start");
    let is_shown = |bench: &WindowBench| {
        let mut all = bench.harness.query_all_by_label_contains("CRASH: ");
        all.next().is_some()
    };
    for _ in 0..100 {
        bench.run(200);
    }
    assert!(wait_for_text(&mut bench, "Collisions: "), "nothing is hit");
    assert!(is_shown(&bench), "the line of messages says nothing");
    bench.click("New stock");
    bench.run(100);
    assert!(is_shown(&bench), "its faults remain");
    bench.click("Free the lathe");
    bench.run(300);
    assert!(!is_shown(&bench));
}

/// The label with the time left of the running program.
fn time_left(bench: &WindowBench) -> String {
    let mut all = bench.harness.query_all_by_label_contains(" left:");
    let label = all.next().and_then(|node| node.value());
    label.expect("the time left")
}

#[test]
fn the_time_left_runs_within_a_block() {
    let mut bench = open_program(
        "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
        G90 X36 Z-30 F60\nG00 X100 Z100\nM30\n",
    );
    bench.click("Automatic mode");
    bench.click("Cycle start");
    let mut left = Vec::new();
    for _ in 0..3 {
        for _ in 0..30 {
            bench.run(200);
        }
        assert!(bench.lcd().contains("G90"), "the cycle runs");
        left.push(time_left(&bench));
    }
    assert!(left[0] != left[1] && left[1] != left[2], "{left:?}");
}

/// Types a number into a field.
fn fill(bench: &mut WindowBench, label: &str, number: &str) {
    let spin = By::new().role(Role::SpinButton).label_contains(label);
    let mut fields = bench.harness.query_all(spin);
    fields.next().expect("there is no such field").click();
    drop(fields);
    bench.harness.step();
    bench.harness.step();
    bench.harness.event(egui::Event::Text(number.to_owned()));
    bench.harness.step();
    for pressed in [true, false] {
        bench.harness.event(egui::Event::Key {
            key: egui::Key::Enter,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::default(),
        });
        bench.harness.step();
    }
}

#[test]
fn tools_and_stock_can_be_changed_and_invalid_values_are_reported() {
    let mut bench = open_program(TEXT);
    bench.click("Tools and stock");
    assert!(wait_for_text(
        &mut bench,
        "Guessed from the program; change"
    ));
    fill(&mut bench, "diameter of the stock", "61.5");
    assert!(wait_for_text(&mut bench, "Changed, not yet saved"));
    // The program has no file: it is saved with its job.
    let save = bench.harness.query_by_label("Save program and job as…");
    assert!(save.is_some());
    fill(&mut bench, "diameter of the stock", "0.1");
    assert!(wait_for_text(&mut bench, "0.1 is outside 0.5"));
    fill(&mut bench, "diameter of the stock", "60");
    assert!(wait_for_text(&mut bench, "Changed, not yet saved"));
    request_close(&mut bench);
    assert!(wait_for_text(&mut bench, "Tools and stock are not saved"));
    bench.click("Do not close");
    bench.click("Pick a block");
    bench.click("Measure");
    let middle = bench.harness.get_by_label("Machine picture").rect();
    let found = (0..200).any(|step| {
        let x = middle.left() + middle.width() * 0.5;
        let y = middle.top() + middle.height() * step as f32 / 200.0;
        bench
            .harness
            .event(egui::Event::PointerMoved(egui::pos2(x, y)));
        bench.harness.step();
        bench.harness.step();
        bench.harness.query_by_label_contains("⌀60.000").is_some()
    });
    assert!(found, "the lathe holds another bar");
}

#[test]
fn a_tool_of_the_library_is_added_by_its_code_and_used() {
    let folder = crate::common::folder::TempFolder::new("library-view");
    gsk_host::files::tool_library::set_data_folder(&folder);
    let mut bench = open_program(TEXT);
    bench.click("Tools and stock");
    assert!(wait_for_text(&mut bench, "Guessed from the program"));
    bench.click("Tool library");
    bench.run(10);
    assert!(wait_for_text(&mut bench, "The tool library is empty"));
    let code = "ISO code or dimensions";
    let enter = |bench: &mut WindowBench, text: &str| {
        let field = By::new().role(Role::TextInput).label(code);
        bench.harness.get(field).focus();
        bench.run(1);
        bench.harness.event(egui::Event::Text(text.to_owned()));
        bench.run(2);
        bench.click("Add");
        bench.run(2);
    };
    enter(&mut bench, "CNMG 130408");
    assert!(wait_for_text(&mut bench, "position 5 (edge length)"));
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, egui::Key::A);
    enter(&mut bench, "X");
    let known = gsk_host::files::tool_library::read().expect("a library");
    assert_eq!(known.tools.len(), 0);
    gsk_host::files::tool_library::change(|library| {
        let tool = gsk_tooling::LibraryTool::from_description("CNMG 120408 PCLNR 2020K12")?;
        library.insert("rough", tool)
    })
    .expect("written");
    let row = "rough  turning C 95° R0.8";
    let found = (0..100).any(|_| {
        bench.run(50);
        bench.harness.query_by_label_contains(row).is_some()
    });
    assert!(found, "the file is read again");
    bench.harness.get_by_label_contains(row).click();
    bench.run(5);
    let button = "Use as T0";
    assert!(wait_for_text(&mut bench, button));
    bench.harness.get_by_label_contains(button).click();
    bench.run(5);
    assert!(wait_for_text(&mut bench, "rough of the tool library"));
}

#[test]
fn a_pass_of_a_cycle_is_explained_and_follows_changed_words() {
    let text = "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X64 Z2\nG71 U3 R1\n\
        G71 P1 Q2 U0.5 F300\nN1 G00 X20\nG01 Z-30\nN2 X62\nG00 X100 Z100\nM30\n";
    let mut bench = open_program(text);
    assert!(
        click_until_block(&mut bench, "[U(Δd), 051]"),
        "no click on a pass"
    );
    assert!(bench.harness.query_by_label_contains("of 8").is_some());
    // The bar below the picture has become higher.
    bench.run(50);
    fill(&mut bench, "U", "6");
    assert!(wait_for_text(&mut bench, "Trial: "));
    assert!(
        wait_for_text(&mut bench, "of 4"),
        "the passes have not moved"
    );
    bench.click("Restore");
    assert!(
        wait_for_text(&mut bench, "of 8"),
        "they have not moved back"
    );
}

#[test]
fn the_bar_opens_the_lathe_in_three_dimensions() {
    let mut bench = open_program(TEXT);
    let is_open = |bench: &WindowBench| {
        let layouts = &bench.harness.state().settings().layouts;
        layouts.docked().contains(&ViewId::Lathe)
    };
    assert!(!is_open(&bench));
    bench.click("3D lathe");
    bench.run(10);
    assert!(is_open(&bench));
}

#[test]
fn the_load_is_drawn_once_the_path_is_complete() {
    let bar = "Cutting force over the time of the program";
    let mut bench = open_program(TEXT);
    bench.click("Load");
    assert!(wait_for_text(&mut bench, bar), "no bar");
    assert!(wait_for_text(&mut bench, "load in C45"), "no material");
    let pending = "computing the load";
    assert!(bench.harness.query_by_label_contains(pending).is_none());
}

/// Return ends the entry in the field; it is not [输入] on the panel as well.
#[test]
fn return_in_a_field_does_not_reach_the_panel() {
    let mut bench = open_program(TEXT);
    bench
        .console
        .send(Command::Tap(gsk_panel::keys::Key::Program));
    bench.click("Automatic mode");
    bench.run(200);
    bench.click("Tools and stock");
    assert!(wait_for_text(
        &mut bench,
        "Guessed from the program; change"
    ));
    fill(&mut bench, "diameter of the stock", "61.5");
    assert!(wait_for_text(&mut bench, "Changed, not yet saved"));
    let refused = "to select a program, enter O";
    assert!(bench.harness.query_by_label_contains(refused).is_none());
    // Without a field it is [输入], which has no effect here.
    bench.harness.key_press(egui::Key::Enter);
    assert!(wait_for_text(&mut bench, refused));
}
