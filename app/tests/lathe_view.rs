//! The lathe in space, operated by keyboard and through its accessible names alone.

use std::time::Duration;

use egui::{Key, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_host::kernel::{Command, OpenedProgram, StorePolicy};
use gsk_window::layout::{Layouts, WindowLayout};

use crate::common::WindowBench;

const TEXT: &str = "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
    G90 X36 Z-30 F300\nG00 X100 Z100\nM30\n";

/// Opens a program and the lathe view in a window of a size.
fn open_lathe(size: Vec2) -> WindowBench {
    let layouts = Layouts::with_layout(WindowLayout::Panel);
    let mut bench = WindowBench::with_layouts(Setup::default(), layouts, size);
    bench.console.send(Command::Open(Box::new(OpenedProgram {
        name: "O7.CNC".to_owned(),
        path: None,
        store_policy: StorePolicy::RunOnly,
        program: Program::new(TEXT),
        subprograms: Vec::new(),
    })));
    bench.harness.get_by_label("Views").click();
    bench.run(1);
    bench.harness.get_by_label("3D lathe").click();
    let is_shown = (0..300).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(10);
        picture_name(&bench).is_some()
    });
    assert!(is_shown, "there is no picture");
    bench
}

/// What a screen reader says of the picture.
fn picture_name(bench: &WindowBench) -> Option<String> {
    let picture = bench
        .harness
        .query_by_label_contains("Picture of the lathe")?;
    picture.accesskit_node().label()
}

fn press(bench: &mut WindowBench, key: Key) -> String {
    bench.harness.key_press(key);
    bench.run(30);
    bench.run(30);
    picture_name(bench).unwrap()
}

fn focus_picture(bench: &mut WindowBench) {
    let picture = bench.harness.get_by_label_contains("Picture of the lathe");
    picture.focus();
    bench.run(30);
    bench.run(30);
}

#[test]
fn keys_turn_move_zoom_and_choose_the_camera_and_the_reader_hears_it() {
    let mut bench = open_lathe(egui::vec2(1700.0, 900.0));
    assert!(picture_name(&bench).unwrap().contains("Operator"));
    focus_picture(&mut bench);
    for name in ["At the tool", "Chuck", "From above", "Section", "Operator"] {
        assert!(press(&mut bench, Key::End).contains(name), "{name}");
    }
    for key in [Key::ArrowLeft, Key::PageUp] {
        assert!(press(&mut bench, key).contains("moved"), "{key:?}");
        assert!(press(&mut bench, Key::Home).contains("Operator"));
    }
    // Space changes to moving; the cursor keys do not jog an axis.
    press(&mut bench, Key::Space);
    assert!(press(&mut bench, Key::ArrowUp).contains("moved"));
    assert!(!bench.kernel.emulator().cnc().is_moving());
}

#[test]
fn every_control_of_the_bar_works_by_its_name() {
    // In a narrower view a menu has the cameras.
    let mut bench = open_lathe(egui::vec2(2400.0, 900.0));
    for name in ["At the tool", "Chuck", "From above", "Section", "Operator"] {
        bench.harness.get_by_label(name).click();
        bench.run(30);
        assert!(picture_name(&bench).unwrap().contains(name), "{name}");
    }
    for name in ["Half cut", "Quarter cut", "Whole part", "Follow the tool"] {
        bench.harness.get_by_label(name).click();
        bench.run(30);
    }
}

#[test]
fn the_picture_names_an_alarm_whole_and_beside_tool_and_speed() {
    for size in [(1024.0, 768.0), (1366.0, 768.0)] {
        let mut bench = open_lathe(egui::vec2(size.0, size.1));
        bench.click("Emergency stop");
        bench.run(300);
        let picture = bench.harness.get_by_label_contains("Picture of the lathe");
        let picture = picture.rect();
        let texts = bench.harness.output().shapes.iter();
        let texts = texts.filter_map(|it| match &it.shape {
            egui::Shape::Text(text) => Some((text.galley.clone(), text.visual_bounding_rect())),
            _ => None,
        });
        let texts: Vec<_> = texts.filter(|(_, at)| picture.contains_rect(*at)).collect();
        let alarm = texts.iter().find(|(it, _)| it.text().starts_with("207: "));
        let (galley, at) = alarm.unwrap();
        assert!(!galley.elided, "{size:?}: {}", galley.text());
        for (other, place) in texts.iter().filter(|(it, _)| it.text() != galley.text()) {
            assert!(!place.intersects(*at), "{size:?}: {}", other.text());
        }
    }
}

#[test]
fn a_small_view_has_a_menu_of_the_cameras_and_one_of_all_other_controls() {
    let mut bench = open_lathe(egui::vec2(1024.0, 768.0));
    assert!(bench.harness.query_by_label("Quarter cut").is_none());
    let menu = bench.harness.query_all_by_label("Operator").next();
    menu.unwrap().click();
    bench.run(30);
    bench.harness.get_by_label("From above").click();
    bench.run(30);
    assert!(picture_name(&bench).unwrap().contains("From above"));
    for name in ["Follow the tool", "Quarter cut", "Path"] {
        bench.harness.get_by_label("…").click();
        bench.run(30);
        bench.harness.get_by_label(name).click();
        bench.run(30);
        bench.harness.key_press(Key::Escape);
        bench.run(30);
    }
}
