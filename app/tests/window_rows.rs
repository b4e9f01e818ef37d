//! What has its place in the window at the sizes of usual screens: rows of tool bars, the names of
//! the scope, the picture of the lathe, the panel above and beside the time line.

use egui::{Rect, Shape, vec2};
use egui_kittest::kittest::Queryable as _;
use gsk_core::model::ModelId;
use gsk_core::setup::Setup;
use gsk_messages::Language;
use gsk_panel::keys::KEYS;
use gsk_window::WindowSettings;
use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::view::ViewId;

use crate::common::WindowBench;
use crate::common::folder::TempFolder;

fn open(layouts: Layouts, size: (f32, f32)) -> WindowBench {
    let mut bench = WindowBench::with_layouts(Setup::default(), layouts, vec2(size.0, size.1));
    bench.run(50);
    bench
}

/// All texts of the last frame, each with its rectangle, and the curves among the shapes.
fn drawn(bench: &WindowBench) -> (Vec<(String, Rect)>, Vec<Rect>) {
    fn collect(shape: &Shape, texts: &mut Vec<(String, Rect)>, curves: &mut Vec<Rect>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|it| collect(it, texts, curves)),
            Shape::Text(text) => {
                let bounds = text.galley.rect.translate(text.pos.to_vec2());
                texts.push((text.galley.text().to_owned(), bounds));
            }
            Shape::Path(path) if path.points.len() > 1 => {
                curves.push(Rect::from_points(&path.points));
            }
            _ => {}
        }
    }
    let (mut texts, mut curves) = (Vec::new(), Vec::new());
    for shape in &bench.harness.output().shapes {
        collect(&shape.shape, &mut texts, &mut curves);
    }
    (texts, curves)
}

/// The heights of the middles of widgets with these names, points.
#[track_caller]
fn rows(bench: &WindowBench, names: &[&str]) -> Vec<f32> {
    let middle = |name: &&str| bench.harness.get_by_label(name).rect().center().y;
    let mut rows: Vec<f32> = names.iter().map(middle).collect();
    rows.sort_by(f32::total_cmp);
    rows.dedup_by(|one, other| (*one - *other).abs() < 6.0);
    rows
}

#[test]
fn the_bar_of_the_program_view_has_two_rows_at_laptop_size() {
    let layouts = Layouts::with_layout(WindowLayout::Programmer);
    let bench = open(layouts, (1366.0, 768.0));
    let names = [
        "Save",
        "Store in the control",
        "Undo",
        "Redo",
        "Form",
        "Next",
    ];
    assert_eq!(rows(&bench, &names).len(), 2);
}

#[test]
fn the_bar_of_the_lathe_in_space_has_one_row_in_the_smallest_window() {
    let mut layouts = Layouts::with_layout(WindowLayout::Panel);
    layouts.dock(ViewId::Lathe);
    let mut bench = open(layouts, (800.0, 600.0));
    let names = ["Follow the tool", "Quarter cut", "Half cut", "Path"];
    assert_eq!(rows(&bench, &names).len(), 1);
    // Without room for the cameras they are in a menu.
    if bench.harness.query_by_label("From above").is_none() {
        bench.harness.get_by_label("Operator").click();
        bench.run(20);
    }
    assert!(bench.harness.query_by_label("From above").is_some());
}

#[test]
fn no_curve_of_the_scope_is_under_the_name_of_its_lane() {
    for size in [(1366.0, 768.0), (1920.0, 1080.0)] {
        let mut bench = open(Layouts::with_layout(WindowLayout::Instructor), size);
        bench.run(500);
        let plot = bench.harness.get_by_label("Scope picture").rect();
        let (texts, curves) = drawn(&bench);
        let names: Vec<&(String, Rect)> = texts
            .iter()
            .filter(|(text, at)| {
                plot.contains_rect(*at)
                    && ["Position", "Speed"].iter().any(|it| text.starts_with(it))
            })
            .collect();
        assert_eq!(names.len(), 2, "{texts:?}");
        let curves: Vec<&Rect> = curves
            .iter()
            .filter(|it| plot.contains_rect(**it))
            .collect();
        assert!(!curves.is_empty());
        for (text, at) in names {
            let hidden = curves.iter().find(|it| it.intersects(at.shrink(1.0)));
            assert_eq!(hidden, None, "{text} at {at} in {size:?}");
        }
    }
}

#[test]
fn the_scope_shows_all_lanes_and_the_time_beside_machine_and_faults() {
    let mut bench = open(
        Layouts::with_layout(WindowLayout::Instructor),
        (1366.0, 768.0),
    );
    bench.run(500);
    let plot = bench.harness.get_by_label("Scope picture").rect();
    let faults = bench.harness.get_by_label("Faults").rect();
    assert!(plot.bottom() < faults.top(), "{plot} {faults}");
    let (texts, _) = drawn(&bench);
    for name in ["Position", "Speed", "Acceleration"] {
        let is_inside =
            |(text, at): &(String, Rect)| text.starts_with(name) && plot.contains_rect(*at);
        assert!(texts.iter().any(is_inside), "{name}: {texts:?}");
    }
}

#[test]
fn a_long_name_of_a_program_ends_before_the_speed() {
    let folder = TempFolder::new("long-name");
    let name = "a-shaft-with-a-name-longer-than-the-bar.CNC";
    folder.write(name, "O0007\nM30\n");
    for (model, width) in [
        (ModelId::Gsk980td, 1024.0),
        (ModelId::Hx31, 1024.0),
        (ModelId::Hx31, 800.0),
        (ModelId::Ncb08, 1366.0),
    ] {
        let layouts = Layouts::with_layout(WindowLayout::Panel);
        let mut bench = open(layouts, (width, 768.0));
        bench.harness.state_mut().set_model(model, true);
        bench.open(folder.0.join(name).to_str().unwrap());
        bench.run(50);
        let speed = bench.harness.get_by_label("Speed 1x").rect();
        let (texts, _) = drawn(&bench);
        let shown = texts
            .iter()
            .find(|(text, at)| text == name && at.top() < 28.0);
        let (_, at) = shown.unwrap();
        assert!(at.width() >= 8.0, "{model:?}: {at}");
        assert!(at.right() < speed.left(), "{model:?}: {at} {speed}");
        let bar = bench.harness.get_by_label(name).rect();
        assert!(bar.right() < speed.left(), "{model:?}: {bar} {speed}");
    }
}

#[test]
fn no_text_of_a_card_is_shortened() {
    for size in [(800.0, 600.0), (1024.0, 768.0), (1366.0, 768.0)] {
        let mut bench = open(Layouts::with_layout(WindowLayout::Learner), size);
        bench.run(50);
        if bench
            .harness
            .query_by_label("See a part being cut")
            .is_none()
        {
            // The lessons are a tab.
            bench.click("Lessons");
        }
        bench.harness.get_by_label("See a part being cut");
        let is_shortened = |shape: &egui::epaint::ClippedShape| match &shape.shape {
            Shape::Text(text) if text.galley.elided => Some(text.galley.text().to_owned()),
            _ => None,
        };
        let shapes = bench.harness.output().shapes.iter();
        let shortened: Vec<String> = shapes.filter_map(is_shortened).collect();
        assert!(shortened.is_empty(), "{size:?}: {shortened:?}");
    }
}

#[test]
fn the_picture_of_the_lathe_is_high_enough_beside_scope_and_faults() {
    let bench = open(
        Layouts::with_layout(WindowLayout::Instructor),
        (1366.0, 768.0),
    );
    let picture = bench.harness.get_by_label("Machine picture").rect();
    assert!(picture.height() >= 115.0, "{picture}");
}

#[test]
fn the_legend_of_the_path_is_one_row_above_the_chuck() {
    let mut bench = open(Layouts::with_layout(WindowLayout::Learner), (1024.0, 768.0));
    bench.open("01-stepped-shaft.CNC");
    bench.run(50);
    let picture = bench.harness.get_by_label("Machine picture").rect();
    let (texts, _) = drawn(&bench);
    let legend: Vec<Rect> = ["rapid", "feed", "thread"]
        .iter()
        .filter_map(|name| {
            let mut found = texts.iter();
            let found = found.find(|(text, at)| text == name && picture.contains_rect(*at));
            found.map(|(_, at)| *at)
        })
        .collect();
    assert_eq!(legend.len(), 3, "{texts:?}");
    for at in legend {
        assert!(at.bottom() < picture.top() + 20.0, "{at} in {picture}");
    }
}

#[test]
fn the_time_line_moves_no_key_of_the_panel() {
    for (layout, size) in [
        (WindowLayout::Learner, (1366.0, 768.0)),
        (WindowLayout::Machine, (1366.0, 768.0)),
        (WindowLayout::Instructor, (1920.0, 1080.0)),
        (WindowLayout::Programmer, (1080.0, 1920.0)),
    ] {
        let places = |timeline: bool| {
            let settings = WindowSettings {
                language: Language::En,
                layouts: Layouts::with_layout(layout),
                timeline,
                ..WindowSettings::default()
            };
            let size = vec2(size.0, size.1);
            let mut bench = WindowBench::with_settings(Setup::default(), settings, size);
            bench.run(500);
            let is_open = bench.harness.query_by_label("Time line").is_some();
            assert_eq!(is_open, timeline, "{layout:?}");
            let keys = KEYS.iter();
            let keys = keys.map(|row| (row.id, bench.harness.get_by_label(row.name_en).rect()));
            keys.collect::<Vec<(&str, Rect)>>()
        };
        assert_eq!(places(false), places(true), "{layout:?} {size:?}");
    }
}

#[test]
fn the_program_text_follows_the_run() {
    let mut bench = open(
        Layouts::with_layout(WindowLayout::Programmer),
        (1366.0, 768.0),
    );
    bench.open("01-stepped-shaft.CNC");
    let top = |bench: &WindowBench| bench.harness.get_by_label("Program text").rect().top();
    let before = top(&bench);
    bench.click("Automatic mode");
    bench.click("Cycle start");
    for _ in 0..40 {
        bench.run(1000);
    }
    let running = top(&bench);
    assert!(running < before - 40.0, "{before} {running}");
    // While the cursor is in the text it stays.
    bench.harness.get_by_label("Program text").focus();
    bench.run(50);
    let edited = top(&bench);
    for _ in 0..40 {
        bench.run(1000);
    }
    assert_eq!(top(&bench), edited);
}
