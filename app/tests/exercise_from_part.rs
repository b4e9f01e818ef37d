//! A teacher picks the dimensions of a new exercise on the part in the lathe.

use std::time::Duration;

use egui::PointerButton;
use egui_kittest::kittest::{NodeT as _, Queryable};
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_host::files::exercises;
use gsk_host::kernel::pace::RunSpeed;
use gsk_host::kernel::{Command, OpenedProgram, StorePolicy};
use gsk_panel::keys::Key;
use gsk_window::layout::{Layouts, WindowLayout};

use crate::common::WindowBench;

const PROGRAM: &str = "O0007;\nG50X100Z100;\nT0101M03S800;\nG00X42Z2;\n\
    G90X36Z-30F300;\nG00X100Z100;\nM30;\n";

fn wait_for(bench: &mut WindowBench, text: &str) -> bool {
    (0..500).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(10);
        let mut found = bench.harness.query_all_by_label_contains(text);
        found.next().is_some()
    })
}

/// Moves the pointer over the picture until the caliper measures a text, and clicks there.
fn click_surface(bench: &mut WindowBench, reading: &str) {
    let picture = bench.harness.get_by_label("Machine picture").rect();
    let is_kept = (0..400).any(|step| {
        // Another column in each sweep.
        let column = [0.9, 0.8, 0.7, 0.6][step / 100];
        let at = egui::pos2(
            picture.left() + picture.width() * column,
            picture.top() + picture.height() * (step % 100) as f32 / 100.0,
        );
        bench.harness.event(egui::Event::PointerMoved(at));
        bench.harness.step();
        bench.harness.step();
        if bench
            .harness
            .query_all_by_label_contains(reading)
            .next()
            .is_none()
        {
            return false;
        }
        for pressed in [true, false] {
            bench.harness.event(egui::Event::PointerButton {
                pos: at,
                button: PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::default(),
            });
            bench.harness.step();
        }
        bench.run(400);
        let kept = format!("from: cylinder {reading}");
        let mut kept = bench.harness.query_all_by_label_contains(&kept);
        kept.next().is_some()
    });
    assert!(is_kept, "the surface is in the picture");
    bench.run(50);
    bench.run(50);
}

/// Presses a button of the list, which is longer than its pane.
fn press(bench: &mut WindowBench, label: &str) {
    bench.harness.get_by_label(label).click_accesskit();
    bench.run(50);
    bench.run(50);
}

#[test]
fn a_surface_that_is_clicked_with_the_caliper_becomes_a_criterion() {
    let layouts = Layouts::with_layout(WindowLayout::Learner);
    let size = egui::vec2(1600.0, 1400.0);
    let mut bench = WindowBench::with_layouts(Setup::default(), layouts, size);
    let data = gsk_tests::test_folder("exercise-from-part").to_path_buf();
    let window = bench.harness.state_mut();
    let found = exercises::load_exercises(Some(&data));
    window.set_exercises(found, data.clone(), Ok(None));
    bench.console.send(Command::Open(Box::new(OpenedProgram {
        name: "O7.CNC".to_owned(),
        path: None,
        store_policy: StorePolicy::Replace,
        program: Program::new(PROGRAM),
        subprograms: Vec::new(),
    })));
    assert!(wait_for(&mut bench, "guessed from the program"));
    bench.console.send(Command::Speed(RunSpeed::Fastest));
    for key in [Key::Auto, Key::CycleStart] {
        bench.console.send(Command::Tap(key));
        bench.run(500);
    }
    bench.run(40_000);
    assert_eq!(bench.kernel.snapshot().run_state, RunState::Reset);
    bench.click("Measure");
    click_surface(&mut bench, "⌀36.000");
    press(&mut bench, "New exercise from this part");
    bench.run(50);
    press(&mut bench, "Add Diameter 36.000");
    let again = bench.harness.get_by_label("Add Diameter 36.000");
    assert!(again.accesskit_node().is_disabled(), "it is in the list");
    // The texts are proposed; only the name of the folder is missing.
    bench.harness.get_by_label("Write the exercise");
}
