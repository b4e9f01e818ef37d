//! The machine view: path, part and what a click finds.

use std::time::Duration;

use crate::common::Bench;
use egui::Modifiers;
use egui_kittest::kittest::Queryable;
use gsk_app::kernel::{Command, Opened, Storing};
use gsk_app::window::layout::{Layout, Layouts};
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;

/// The layout of panel and machine with a program whose path has been made.
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

/// Runs until words are seen.
fn comes(bench: &mut Bench, words: &str) -> bool {
    (0..500).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(10);
        bench.harness.query_by_label_contains(words).is_some()
    })
}

const TEXT: &str = "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
    G90 X36 Z-30 F300\nG00 X100 Z100\nM30\n";

#[test]
fn a_click_on_the_path_says_its_block() {
    let mut bench = opened(TEXT);
    let picture = bench.harness.get_by_label("Machine picture").rect();
    // Along a vertical line the path is met sooner or later.
    let found = (0..200).any(|step| {
        // Far from the one before: two clicks side by side are a double click.
        let share = (step as f32 * 0.618) % 1.0;
        let at = egui::pos2(
            picture.left() + picture.width() * 0.7,
            picture.top() + picture.height() * share,
        );
        for pressed in [true, false] {
            bench.harness.event(egui::Event::PointerMoved(at));
            bench.harness.event(egui::Event::PointerButton {
                pos: at,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: Modifiers::default(),
            });
            bench.harness.step();
        }
        let found = bench.harness.query_by_label_contains("5  G90 X36 Z-30");
        found.is_some()
    });
    assert!(found, "no click on the cut finds its block");
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
