//! The layouts of the window: keys, splitters, docked views, a narrow window.

use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::view::ViewId;

use crate::common::WindowBench;
use crate::common::windows::{DrawnWindow, ViewWindows};
use egui::{Event, Modifiers, PointerButton, Pos2, Role, ViewportCommand, ViewportId, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable};
use gsk_core::model::ModelId;
use gsk_core::setup::Setup;
use gsk_panel::keys::KEYS;

fn press_with_shift(bench: &mut WindowBench, key: egui::Key) {
    bench.harness.key_press_modifiers(Modifiers::SHIFT, key);
    for _ in 0..3 {
        bench.run(50);
    }
}

fn layouts_of(bench: &WindowBench) -> &Layouts {
    &bench.harness.state().settings().layouts
}

fn drag(bench: &mut WindowBench, from: Pos2, to: Pos2) {
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
fn a_key_chooses_a_layout_with_panes_beside_the_panel() {
    let mut bench = WindowBench::new();
    assert!(bench.harness.query_by_label("Scope picture").is_none());
    press_with_shift(&mut bench, egui::Key::F9);
    assert_eq!(layouts_of(&bench).current(), WindowLayout::Instructor);
    assert!(bench.harness.query_by_label("Scope picture").is_some());
    assert!(bench.harness.query_by_label("Faults").is_some());
    let lcd = bench.harness.get_by_label("LCD").rect();
    let scope = bench.harness.get_by_label("Scope picture").rect();
    assert!(!lcd.intersects(scope));
    // Machine keys work as before.
    bench.click("Automatic mode");
    bench.assert_lcd_contains("自动方式");
    press_with_shift(&mut bench, egui::Key::F6);
    assert!(bench.harness.query_by_label("Scope picture").is_none());
}

#[test]
fn a_dragged_splitter_stays_and_a_double_click_restores_it() {
    let mut bench = WindowBench::new();
    press_with_shift(&mut bench, egui::Key::F9);
    let splitter_center = |bench: &WindowBench| {
        bench
            .harness
            .get_by_label("Bar 0 between left and right")
            .rect()
            .center()
    };
    let before = splitter_center(&bench);
    drag(&mut bench, before, before + vec2(-150.0, 0.0));
    let after = splitter_center(&bench);
    assert!((before.x - after.x - 150.0).abs() < 3.0, "{before} {after}");
    press_with_shift(&mut bench, egui::Key::F6);
    press_with_shift(&mut bench, egui::Key::F9);
    assert_eq!(splitter_center(&bench), after);
    // The next start restores it.
    let stored = layouts_of(&bench).clone();
    let restarted = WindowBench::with_layouts(Setup::default(), stored, vec2(1280.0, 806.0));
    assert_eq!(splitter_center(&restarted), after);
}

#[test]
fn lessons_open_beside_the_panel_by_key_and_by_menu() {
    for toggle in [
        |bench: &mut WindowBench| press_with_shift(bench, egui::Key::Home),
        |bench: &mut WindowBench| {
            let button = Role::Button;
            (bench.harness.get_by_role_and_label(button, "Lessons")).click();
            bench.run(50);
        },
    ] {
        let mut bench = WindowBench::new();
        toggle(&mut bench);
        assert!(layouts_of(&bench).docked().contains(&ViewId::Lesson));
        toggle(&mut bench);
        assert!(!layouts_of(&bench).is_open(ViewId::Lesson));
    }
}

#[test]
fn a_view_floats_docks_and_closes_by_its_header_buttons() {
    let mut bench = WindowBench::new();
    let windows = ViewWindows::enable(&bench);
    press_with_shift(&mut bench, egui::Key::F2);
    assert_eq!(layouts_of(&bench).floating(), [ViewId::Scope]);
    let drawn = windows.draw_frame(&mut bench);
    assert_eq!(drawn.len(), 1);
    assert!(drawn[0].label_center("Scope picture").is_some());
    windows.click(&mut bench, "Dock Scope in the window");
    bench.run(10);
    assert_eq!(layouts_of(&bench).docked(), [ViewId::Scope]);
    let click = |bench: &mut WindowBench, name: &str| {
        bench.harness.get_by_label(name).click();
        for _ in 0..3 {
            bench.run(10);
        }
    };
    assert!(bench.harness.query_by_label("Scope picture").is_some());
    click(&mut bench, "Scope in a separate window");
    assert_eq!(layouts_of(&bench).floating(), [ViewId::Scope]);
    windows.click(&mut bench, "Dock Scope in the window");
    bench.run(10);
    click(&mut bench, "Close Scope");
    assert!(!layouts_of(&bench).is_open(ViewId::Scope));
    press_with_shift(&mut bench, egui::Key::F2);
    assert_eq!(
        layouts_of(&bench).docked(),
        [ViewId::Scope],
        "it comes back where it was"
    );
}

#[test]
fn a_covered_separate_window_comes_to_the_front_by_its_key_and_shows_the_messages() {
    let mut bench = WindowBench::new();
    let windows = ViewWindows::enable(&bench);
    press_with_shift(&mut bench, egui::Key::F2);
    assert_eq!(windows.draw_frame(&mut bench).len(), 1);
    // In one frame, whose commands are read.
    bench.harness.input_mut().events.push(Event::Key {
        key: egui::Key::F2,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::SHIFT,
    });
    bench.harness.step();
    let scope = ViewportId::from_hash_of("Scope");
    let output = bench.harness.output().viewport_output.get(&scope);
    let is_raised = output.is_some_and(|it| it.commands.contains(&ViewportCommand::Focus));
    assert!(is_raised);
    assert_eq!(layouts_of(&bench).floating(), [ViewId::Scope]);
    // The operator of the window does not see the message line of the main one.
    let has_text = |windows: &[DrawnWindow], text: &str| {
        let mut labels = windows[0].labels.iter();
        labels.any(|(label, _)| label.contains(text))
    };
    let drawn = windows.draw_frame(&mut bench);
    assert!(!has_text(&drawn, "press it again to release"));
    bench.click("Emergency stop");
    bench.run(300);
    let drawn = windows.draw_frame(&mut bench);
    assert!(has_text(&drawn, "press it again to release"));
}

#[test]
fn a_view_stays_docked_in_a_single_window() {
    let mut bench = WindowBench::new();
    press_with_shift(&mut bench, egui::Key::F2);
    assert_eq!(layouts_of(&bench).docked(), [ViewId::Scope]);
    let float = "Scope in a separate window";
    assert!(bench.harness.query_by_label(float).is_none());
    assert!(bench.harness.query_by_label("Close Scope").is_some());
}

#[test]
fn in_a_narrow_window_every_key_is_inside_and_can_be_clicked() {
    let size = vec2(800.0, 1280.0);
    let mut bench = WindowBench::with_layouts(
        Setup::default(),
        Layouts::with_layout(WindowLayout::Panel),
        size,
    );
    let window = egui::Rect::from_min_size(Pos2::ZERO, size);
    for row in &KEYS {
        let bounds = bench.harness.get_by_label(row.name_en).rect();
        assert!(window.contains_rect(bounds), "{} at {bounds}", row.id);
        assert!(
            bounds.width() > 40.0,
            "{} is {} wide",
            row.id,
            bounds.width()
        );
    }
    let lcd = bench.harness.get_by_label("LCD").rect();
    // The keys have priority (WINDOW-19): the LCD has at least one pixel per dot.
    assert!(lcd.width() >= 320.0, "{lcd}");
    for (name, mode) in [("Jog mode", "手动方式"), ("Edit mode", "编辑方式")] {
        bench.click(name);
        bench.assert_lcd_contains(mode);
    }
    bench.click("Program pages");
    for key in ["Address O", "Digit 7", "Digit 3"] {
        bench.click(key);
    }
    bench.assert_lcd_contains("O73");
    bench.click("Emergency stop");
    bench.assert_lcd_contains("准备未绪");
}

#[test]
fn a_view_that_does_not_fit_becomes_a_tab_and_the_stop_keys_stay() {
    let size = vec2(1024.0, 768.0);
    let mut layout = Layouts::with_layout(WindowLayout::Panel);
    layout.dock(ViewId::Data);
    layout.bring_to_front(None);
    let mut bench = WindowBench::with_layouts(Setup::default(), layout, size);
    assert!(bench.harness.query_by_label("LCD").is_some());
    bench.click("Parameters and offsets");
    bench.run(50);
    assert!(bench.harness.query_by_label("LCD").is_none());
    assert!(bench.harness.query_by_label("All parameters").is_some());
    // The stop keys are at least as large as a finger.
    let window = egui::Rect::from_min_size(Pos2::ZERO, size);
    for stop in ["Emergency stop", "Feed hold", "Reset"] {
        let bounds = bench.harness.get_by_label(stop).rect();
        assert!(window.contains_rect(bounds), "{stop} at {bounds}");
        let side = bounds.size().min_elem();
        assert!(side >= 34.0, "{stop} is {side} points");
    }
    bench.click("Emergency stop");
    bench.click("Panel");
    bench.run(50);
    bench.assert_lcd_contains("准备未绪");
    bench.click("Side by side");
    bench.run(50);
    assert!(bench.harness.query_by_label("LCD").is_some());
    assert!(bench.harness.query_by_label("All parameters").is_some());
}

#[test]
fn at_laptop_size_every_widget_is_inside_its_view() {
    let size = vec2(1366.0, 768.0);
    for (layout, key) in [
        (WindowLayout::Machine, egui::Key::F7),
        (WindowLayout::Programmer, egui::Key::F8),
        (WindowLayout::Instructor, egui::Key::F9),
    ] {
        let mut bench = WindowBench::with_layouts(
            Setup::default(),
            Layouts::with_layout(WindowLayout::Panel),
            size,
        );
        press_with_shift(&mut bench, key);
        assert_eq!(layouts_of(&bench).current(), layout);
        let splitter = bench
            .harness
            .get_by_label("Bar 0 between left and right")
            .rect()
            .center()
            .x;
        let nodes = bench.harness.root().children_recursive();
        let widgets = nodes.filter(|node| {
            matches!(
                node.accesskit_node().role(),
                Role::Button | Role::CheckBox | Role::RadioButton | Role::Label | Role::ComboBox
            )
        });
        let outside = widgets.filter(|node| {
            let bounds = node.rect();
            // The bar and the message line extend over the whole width.
            let in_views = bounds.top() > 28.0 && bounds.bottom() < 740.0;
            let crosses = in_views && bounds.left() < splitter && bounds.right() > splitter;
            crosses || bounds.right() > size.x
        });
        let described = outside.map(|node| (node.accesskit_node().label(), node.rect()));
        let outside: Vec<_> = described.collect();
        assert!(outside.is_empty(), "{layout:?}: {outside:?}");
    }
}

#[test]
fn the_light_theme_is_chosen_in_the_menu_and_stored() {
    let mut bench = WindowBench::new();
    // The bar is drawn first.
    let bar_brightness = |bench: &WindowBench| {
        let shapes = bench.harness.output().shapes.iter();
        let mut fills = shapes.filter_map(|it| match &it.shape {
            egui::Shape::Rect(rect) if rect.fill.is_opaque() => Some(rect.fill.r()),
            _ => None,
        });
        fills.next().unwrap()
    };
    assert!(bar_brightness(&bench) < 60);
    for entry in ["Layout", "Light theme"] {
        bench.harness.get_by_label(entry).click();
        bench.run(20);
        bench.run(20);
    }
    assert!(bar_brightness(&bench) > 220);
    assert!(bench.harness.state().settings().light);
}

#[test]
fn another_control_model_is_requested_in_the_menu() {
    let mut bench = WindowBench::new();
    bench.click("Layout");
    assert!(bench.harness.query_by_label("Control NC-B08").is_none());
    bench.click("Layout");
    bench.harness.state_mut().set_model(ModelId::Gsk980td, true);
    bench.click("Layout");
    bench.click("Control NC-B08");
    assert_eq!(
        bench.harness.state_mut().take_requested_model(),
        Some(ModelId::Ncb08)
    );
    assert_eq!(bench.harness.state_mut().take_requested_model(), None);
    bench.harness.state_mut().set_model(ModelId::Ncb08, true);
    bench.run(50);
    assert_eq!(bench.harness.state().title(), "NC-B08");
    bench.harness.state_mut().set_model(ModelId::Hx31, true);
    bench.run(50);
    assert_eq!(bench.harness.state().title(), "Huaxing 31/32");
    bench.click("Layout");
    bench.harness.get_by_label("Control Huaxing 31/32");
}
