//! The machine view: path, part, and clicks on the path.

use std::time::Duration;

use crate::common::Bench;
use crate::window::ask_to_close;
use egui::Modifiers;
use egui::accesskit::Role;
use egui_kittest::kittest::{By, Queryable};
use gsk_app::kernel::{Command, Opened, Storing};
use gsk_app::window::layout::{Layout, Layouts};
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;

/// Opens a program with the layout of panel and machine, and waits for its path.
fn opened(text: &str) -> Bench {
    let size = egui::vec2(1600.0, 900.0);
    let mut bench = Bench::sized(Setup::default(), Layouts::of(Layout::Machine), size);
    bench.console.send(Command::Open(Box::new(Opened {
        name: "O7.CNC".to_owned(),
        path: None,
        storing: Storing::RunOnly,
        program: Program::new(text),
        subprograms: Vec::new(),
    })));
    assert!(
        comes(&mut bench, "guessed from the program"),
        "there is no part"
    );
    bench
}

/// Runs the window until a text is shown. Returns false after a time limit.
fn comes(bench: &mut Bench, words: &str) -> bool {
    (0..500).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(10);
        // The heading of a list has the same label as the list.
        let mut seen = bench.harness.query_all_by_label_contains(words);
        seen.next().is_some()
    })
}

const TEXT: &str = "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
    G90 X36 Z-30 F300\nG00 X100 Z100\nM30\n";

/// Clicks along a vertical line, which crosses the path, until a block is named.
fn clicks_find(bench: &mut Bench, block: &str) -> bool {
    let picture = bench.harness.get_by_label("Machine picture").rect();
    (0..200).any(|step| {
        // Each click is far from the one before: two close clicks would be a double click.
        let share = (step as f32 * 0.618) % 1.0;
        let at = egui::pos2(
            picture.left() + picture.width() * 0.7,
            picture.top() + picture.height() * share,
        );
        for pressed in [true, false] {
            press(bench, at, egui::PointerButton::Primary, pressed);
        }
        // The clicked block is named in the next frame.
        bench.harness.step();
        bench.harness.query_by_label_contains(block).is_some()
    })
}

fn press(bench: &mut Bench, pos: egui::Pos2, button: egui::PointerButton, pressed: bool) {
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
fn read_at(bench: &mut Bench, at: egui::Pos2) -> String {
    bench.harness.event(egui::Event::PointerMoved(at));
    bench.harness.step();
    bench.harness.step();
    let read = bench.harness.get_by_label_contains("  Z ");
    read.value().unwrap_or_default()
}

#[test]
fn a_click_on_the_path_says_its_block() {
    let mut bench = opened(TEXT);
    let block = "5  G90 X36 Z-30";
    assert!(clicks_find(&mut bench, block), "no click on the cut");
}

#[test]
fn a_solid_is_turned_moved_and_fitted_again_and_its_path_can_be_clicked() {
    let mut bench = opened(TEXT);
    // The bars around the picture keep their height from now on.
    assert!(comes(&mut bench, " in all:"), "there are no times");
    bench.run(10);
    let middle = bench
        .harness
        .get_by_label("Machine picture")
        .rect()
        .center();
    let flat = read_at(&mut bench, middle);
    bench.click("Solid");
    assert!(bench.harness.state().settings().solid, "it is remembered");
    let fitted = read_at(&mut bench, middle);
    assert_ne!(flat, fitted);
    let mut last = fitted.clone();
    for button in [egui::PointerButton::Primary, egui::PointerButton::Secondary] {
        let to = middle + egui::vec2(60.0, 30.0);
        press(&mut bench, middle, button, true);
        bench.harness.event(egui::Event::PointerMoved(to));
        bench.harness.step();
        press(&mut bench, to, button, false);
        // A turn about the middle keeps the middle; a move does not.
        let turns = button == egui::PointerButton::Primary;
        assert_eq!(read_at(&mut bench, middle) == last, turns, "{button:?}");
        let beside = read_at(&mut bench, middle + egui::vec2(100.0, 0.0));
        assert_ne!(beside, fitted);
        last = read_at(&mut bench, middle);
    }
    assert!(clicks_find(&mut bench, "5  G90 X36 Z-30"), "no click");
    // The text about the block makes the picture smaller; a click beside the path removes it.
    let corner = bench
        .harness
        .get_by_label("Machine picture")
        .rect()
        .left_top();
    for pressed in [true, false] {
        let beside = corner + egui::vec2(4.0, 4.0);
        press(&mut bench, beside, egui::PointerButton::Primary, pressed);
    }
    bench.click("Fit");
    assert_eq!(read_at(&mut bench, middle), fitted);
    bench.click("Section");
    assert!(!bench.harness.state().settings().solid);
    assert_eq!(read_at(&mut bench, middle), flat);
}

#[test]
fn the_work_zero_that_a_program_sets_moves_no_tool_through_the_part() {
    let mut bench = opened(TEXT);
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
    let cnc = &bench.kernel.emulator().simulation.cnc;
    assert_eq!(cnc.run_state(), RunState::Reset, "it has come to its end");
}

#[test]
fn what_is_said_of_a_collision_goes_with_new_stock() {
    let mut bench = opened(
        "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
        G90 X36 Z-30 F300\nG00 X20 Z-10\nG00 X100 Z100\nM30\n",
    );
    bench.click("Automatic mode");
    bench.click("Cycle start");
    let says = |bench: &Bench| {
        let mut all = bench.harness.query_all_by_label_contains("COLLISION: ");
        all.next().is_some()
    };
    for _ in 0..100 {
        bench.run(200);
    }
    assert!(comes(&mut bench, "Collisions: "), "nothing is hit");
    assert!(says(&bench), "the line of messages says nothing");
    bench.click("New stock");
    bench.run(100);
    assert!(!says(&bench));
}

/// Types a number into a field.
fn fill(bench: &mut Bench, label: &str, number: &str) {
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
fn tools_and_stock_are_changed_and_a_broken_rule_is_said() {
    let mut bench = opened(TEXT);
    bench.click("Tools and stock");
    assert!(comes(&mut bench, "Guessed from the program; change"));
    fill(&mut bench, "diameter of the stock", "61.5");
    assert!(comes(&mut bench, "Changed, not yet saved"));
    bench.click("Save");
    assert!(comes(&mut bench, "not in a file"));
    fill(&mut bench, "diameter of the stock", "0.1");
    assert!(comes(&mut bench, "0.1 is outside 0.5"));
    fill(&mut bench, "diameter of the stock", "60");
    assert!(comes(&mut bench, "Changed, not yet saved"));
    ask_to_close(&mut bench);
    assert!(comes(&mut bench, "Tools and stock are not saved"));
    bench.click("Do not close");
    bench.click("Path");
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
fn a_pass_of_a_cycle_says_why_it_lies_there_and_moves_with_its_words() {
    let text = "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X64 Z2\nG71 U3 R1\n\
        G71 P1 Q2 U0.5 F300\nN1 G00 X20\nG01 Z-30\nN2 X62\nG00 X100 Z100\nM30\n";
    let mut bench = opened(text);
    assert!(
        clicks_find(&mut bench, "[U(Δd), 051]"),
        "no click on a pass"
    );
    assert!(bench.harness.query_by_label_contains("of 8").is_some());
    // The bar below the picture has become higher.
    bench.run(50);
    fill(&mut bench, "U", "6");
    assert!(comes(&mut bench, "Tried out"));
    assert!(comes(&mut bench, "of 4"), "the passes have not moved");
    bench.click("As it was");
    assert!(comes(&mut bench, "of 8"), "they have not moved back");
}
