//! The layouts of the window: keys, splitters, docked views, a narrow window.

use crate::common::Bench;
use crate::common::windows::Windows;
use egui::{Event, Modifiers, PointerButton, Pos2, Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable};
use gsk_app::window::layout::{Layout, Layouts};
use gsk_app::window::view::View;
use gsk_core::model::ModelId;
use gsk_core::setup::Setup;
use gsk_panel::keys::KEYS;

fn shift(bench: &mut Bench, key: egui::Key) {
    bench.harness.key_press_modifiers(Modifiers::SHIFT, key);
    for _ in 0..3 {
        bench.run(50);
    }
}

fn layouts(bench: &Bench) -> &Layouts {
    &bench.harness.state().settings().layouts
}

fn drag(bench: &mut Bench, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::default(),
    };
    bench.harness.event(Event::PointerMoved(from));
    bench.run(1);
    bench.harness.event(button(from, true));
    bench.run(1);
    bench.harness.event(Event::PointerMoved(to));
    bench.run(1);
    bench.harness.event(button(to, false));
    bench.run(1);
}

#[test]
fn a_key_chooses_a_layout_whose_panes_stand_beside_the_panel() {
    let mut bench = Bench::new();
    assert!(bench.harness.query_by_label("Scope picture").is_none());
    shift(&mut bench, egui::Key::F9);
    assert_eq!(layouts(&bench).current(), Layout::Instructor);
    assert!(bench.harness.query_by_label("Scope picture").is_some());
    assert!(bench.harness.query_by_label("Faults").is_some());
    let lcd = bench.harness.get_by_label("LCD").rect();
    let scope = bench.harness.get_by_label("Scope picture").rect();
    assert!(!lcd.intersects(scope));
    // Machine keys work as before.
    bench.click("Automatic mode");
    bench.lcd_shows("自动方式");
    shift(&mut bench, egui::Key::F6);
    assert!(bench.harness.query_by_label("Scope picture").is_none());
}

#[test]
fn a_dragged_splitter_stays_and_a_double_click_puts_it_back() {
    let mut bench = Bench::new();
    shift(&mut bench, egui::Key::F9);
    let bar = |bench: &Bench| {
        bench
            .harness
            .get_by_label("Bar 0 between left and right")
            .rect()
            .center()
    };
    let before = bar(&bench);
    drag(&mut bench, before, before + vec2(-150.0, 0.0));
    let after = bar(&bench);
    assert!((before.x - after.x - 150.0).abs() < 3.0, "{before} {after}");
    shift(&mut bench, egui::Key::F6);
    shift(&mut bench, egui::Key::F9);
    assert_eq!(bar(&bench), after);
    // The next start restores it.
    let kept = layouts(&bench).clone();
    let again = Bench::sized(Setup::default(), kept, vec2(1280.0, 806.0));
    assert_eq!(bar(&again), after);
}

#[test]
fn lessons_stand_beside_the_panel_however_they_are_opened() {
    for opened in [
        |bench: &mut Bench| shift(bench, egui::Key::Home),
        |bench: &mut Bench| {
            let button = Role::Button;
            (bench.harness.get_by_role_and_label(button, "Lessons")).click();
            bench.run(50);
        },
    ] {
        let mut bench = Bench::new();
        opened(&mut bench);
        assert!(layouts(&bench).docked().contains(&View::Lesson));
        opened(&mut bench);
        assert!(!layouts(&bench).is_open(View::Lesson));
    }
}

#[test]
fn a_view_floats_docks_and_closes_by_the_signs_above_it() {
    let mut bench = Bench::new();
    let windows = Windows::of(&bench);
    shift(&mut bench, egui::Key::F2);
    assert_eq!(layouts(&bench).floating(), [View::Scope]);
    let shown = windows.look(&mut bench);
    assert_eq!(shown.len(), 1);
    assert!(shown[0].label("Scope picture").is_some());
    windows.click(&mut bench, "Dock Scope in the window");
    bench.run(10);
    assert_eq!(layouts(&bench).docked(), [View::Scope]);
    let click = |bench: &mut Bench, name: &str| {
        bench.harness.get_by_label(name).click();
        for _ in 0..3 {
            bench.run(10);
        }
    };
    assert!(bench.harness.query_by_label("Scope picture").is_some());
    click(&mut bench, "Scope in a window of its own");
    assert_eq!(layouts(&bench).floating(), [View::Scope]);
    windows.click(&mut bench, "Dock Scope in the window");
    bench.run(10);
    click(&mut bench, "Close Scope");
    assert!(!layouts(&bench).is_open(View::Scope));
    shift(&mut bench, egui::Key::F2);
    assert_eq!(
        layouts(&bench).docked(),
        [View::Scope],
        "it comes back where it was"
    );
}

#[test]
fn where_there_is_one_window_a_view_opens_in_a_pane_and_stays_there() {
    let mut bench = Bench::new();
    shift(&mut bench, egui::Key::F2);
    assert_eq!(layouts(&bench).docked(), [View::Scope]);
    let float = "Scope in a window of its own";
    assert!(bench.harness.query_by_label(float).is_none());
    assert!(bench.harness.query_by_label("Close Scope").is_some());
}

#[test]
fn in_a_narrow_window_every_key_is_inside_and_can_be_clicked() {
    let size = vec2(800.0, 1280.0);
    let mut bench = Bench::sized(Setup::default(), Layouts::of(Layout::Panel), size);
    let window = egui::Rect::from_min_size(Pos2::ZERO, size);
    for row in &KEYS {
        let place = bench.harness.get_by_label(row.name_en).rect();
        assert!(window.contains_rect(place), "{} at {place}", row.id);
        assert!(place.width() > 40.0, "{} is {} wide", row.id, place.width());
    }
    let lcd = bench.harness.get_by_label("LCD").rect();
    // The keys have priority (WINDOW-19): the LCD has at least one pixel per dot.
    assert!(lcd.width() > 340.0, "{lcd}");
    for (name, mode) in [("Jog mode", "手动方式"), ("Edit mode", "编辑方式")] {
        bench.click(name);
        bench.lcd_shows(mode);
    }
    bench.click("Program pages");
    for key in ["Address O", "Digit 7", "Digit 3"] {
        bench.click(key);
    }
    bench.lcd_shows("O73");
    bench.click("Emergency stop");
    bench.lcd_shows("准备未绪");
}

#[test]
fn a_view_without_room_beside_the_panel_takes_its_turn_and_the_stops_stay() {
    let size = vec2(1024.0, 768.0);
    let mut layout = Layouts::of(Layout::Panel);
    layout.dock(View::Data);
    layout.bring(None);
    let mut bench = Bench::sized(Setup::default(), layout, size);
    assert!(bench.harness.query_by_label("LCD").is_some());
    bench.click("Parameters and offsets");
    bench.run(50);
    assert!(bench.harness.query_by_label("LCD").is_none());
    assert!(bench.harness.query_by_label("All parameters").is_some());
    // The stop keys are at least as large as a finger.
    let window = egui::Rect::from_min_size(Pos2::ZERO, size);
    for stop in ["Emergency stop", "Feed hold", "Reset"] {
        let place = bench.harness.get_by_label(stop).rect();
        assert!(window.contains_rect(place), "{stop} at {place}");
        let side = place.size().min_elem();
        assert!(side >= 34.0, "{stop} is {side} points");
    }
    bench.click("Emergency stop");
    bench.click("Panel");
    bench.run(50);
    bench.lcd_shows("准备未绪");
    bench.click("Side by side");
    bench.run(50);
    assert!(bench.harness.query_by_label("LCD").is_some());
    assert!(bench.harness.query_by_label("All parameters").is_some());
}

#[test]
fn at_a_school_laptops_size_nothing_lies_beside_its_view() {
    let size = vec2(1366.0, 768.0);
    for (layout, key) in [
        (Layout::Machine, egui::Key::F7),
        (Layout::Programmer, egui::Key::F8),
        (Layout::Instructor, egui::Key::F9),
    ] {
        let mut bench = Bench::sized(Setup::default(), Layouts::of(Layout::Panel), size);
        shift(&mut bench, key);
        assert_eq!(layouts(&bench).current(), layout);
        let splitter = bench
            .harness
            .get_by_label("Bar 0 between left and right")
            .rect()
            .center()
            .x;
        let nodes = bench.harness.root().children_recursive();
        let operated = nodes.filter(|node| {
            matches!(
                node.accesskit_node().role(),
                Role::Button | Role::CheckBox | Role::RadioButton | Role::Label | Role::ComboBox
            )
        });
        let beside = operated.filter(|node| {
            let place = node.rect();
            // The bar and the message line extend over the whole width.
            let in_views = place.top() > 28.0 && place.bottom() < 740.0;
            let crosses = in_views && place.left() < splitter && place.right() > splitter;
            crosses || place.right() > size.x
        });
        let named = beside.map(|node| (node.accesskit_node().label(), node.rect()));
        let beside: Vec<_> = named.collect();
        assert!(beside.is_empty(), "{layout:?}: {beside:?}");
    }
}

#[test]
fn light_surroundings_are_chosen_in_the_menu_and_kept() {
    let mut bench = Bench::new();
    // The bar is drawn first.
    let bar = |bench: &Bench| {
        let shapes = bench.harness.output().shapes.iter();
        let mut grounds = shapes.filter_map(|it| match &it.shape {
            egui::Shape::Rect(rect) if rect.fill.is_opaque() => Some(rect.fill.r()),
            _ => None,
        });
        grounds.next().unwrap()
    };
    assert!(bar(&bench) < 60);
    for entry in ["Layout", "Light surroundings"] {
        bench.harness.get_by_label(entry).click();
        bench.run(20);
        bench.run(20);
    }
    assert!(bar(&bench) > 220);
    assert!(bench.harness.state().settings().light);
}

#[test]
fn another_control_model_is_asked_for_in_the_menu() {
    let mut bench = Bench::new();
    bench.click("Layout");
    assert!(bench.harness.query_by_label("Control NC-B08").is_none());
    bench.click("Layout");
    bench.harness.state_mut().set_model(ModelId::Gsk980td, true);
    bench.click("Layout");
    bench.click("Control NC-B08");
    assert_eq!(bench.harness.state_mut().take_model(), Some(ModelId::Ncb08));
    assert_eq!(bench.harness.state_mut().take_model(), None);
    bench.harness.state_mut().set_model(ModelId::Ncb08, true);
    bench.run(50);
    assert_eq!(bench.harness.state().title(), "NC-B08");
}
