//! The keyboard alone: Tab reaches each widget of the bars and views once, in reading order,
//! and the focus is visible.

use std::collections::HashSet;

use egui::{Id, Key, Memory, Modifiers, Rect, Shape, Vec2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gsk_core::setup::Setup;
use gsk_messages::Language;
use gsk_window::WindowSettings;
use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::view::{VIEWS, ViewId};

use crate::common::WindowBench;

/// A widget that has the focus.
#[derive(Clone, Debug)]
struct FocusStop {
    id: Id,
    name: String,
    bounds: Rect,
    /// Where the previous stop is in the same frame.
    previous: Option<Rect>,
}

fn focus_stop(bench: &WindowBench) -> Option<FocusStop> {
    let id = bench.harness.ctx.memory(Memory::focused)?;
    let nodes = bench.harness.root().children_recursive();
    let mut nodes = nodes.filter(|node| node.accesskit_node().is_focused());
    let node = nodes.next()?;
    let accessible = node.accesskit_node();
    let name = accessible
        .label()
        .or_else(|| accessible.value())
        .unwrap_or_default();
    Some(FocusStop {
        id,
        name,
        bounds: node.rect(),
        previous: None,
    })
}

/// Descriptions of the lines that are drawn around or under a rectangle, to detect a change.
fn lines_around(bench: &WindowBench, bounds: Rect) -> Vec<String> {
    fn collect(shape: &Shape, bounds: Rect, lines: &mut Vec<String>) {
        let near = bounds.expand(6.0);
        match shape {
            Shape::Vec(shapes) => shapes
                .iter()
                .for_each(|shape| collect(shape, bounds, lines)),
            Shape::Rect(it) if near.contains_rect(it.rect) => {
                let rect = it.rect.translate(-bounds.min.to_vec2());
                lines.push(format!("{rect:?} {:?} {:?}", it.stroke, it.fill));
            }
            Shape::LineSegment { points, stroke } if near.contains(points[0]) => {
                let points = points.map(|point| point - bounds.min);
                lines.push(format!("{points:?} {stroke:?}"));
            }
            Shape::Text(text) if near.contains(text.pos) => {
                lines.push(format!("{:?} {:?}", text.underline, text.fallback_color));
            }
            _ => {}
        }
    }
    let mut lines = Vec::new();
    for it in &bench.harness.output().shapes {
        collect(&it.shape, bounds, &mut lines);
    }
    lines
}

fn press_tab(bench: &mut WindowBench, modifiers: Modifiers) -> Option<FocusStop> {
    bench.harness.key_press_modifiers(modifiers, Key::Tab);
    // The focus skips the edge of a panel in the next frame.
    for _ in 0..3 {
        bench.harness.step();
    }
    focus_stop(bench)
}

/// Collects the stops of Tab until the first one comes again. Each has a name and a visible
/// focus: without the focus, the window draws something else.
fn tab_through(bench: &mut WindowBench, context: &str) -> Vec<FocusStop> {
    let mut stops: Vec<FocusStop> = Vec::new();
    let mut focused_lines = Vec::new();
    for _ in 0..600 {
        let Some(mut stop) = press_tab(bench, Modifiers::NONE) else {
            panic!("{context}: nothing has the focus after {:?}", stops.last());
        };
        if let Some(last) = stops.last() {
            stop.previous = current_bounds(bench, last);
            let unfocused_lines = lines_around(bench, stop.previous.unwrap_or(last.bounds));
            assert_ne!(
                focused_lines, unfocused_lines,
                "{context}: the focus is not seen at {last:?}"
            );
        }
        if let Some(first) = stops.iter().position(|it| it.id == stop.id) {
            assert_eq!(first, 0, "{context}: {} holds the focus", stop.name);
            return stops;
        }
        assert!(
            !stop.name.trim().is_empty(),
            "{context}: no name at {stop:?}"
        );
        focused_lines = lines_around(bench, stop.bounds);
        stops.push(stop);
    }
    panic!("{context}: there is no end");
}

/// In a row the focus moves to the right, and it does not jump back to the upper left. The
/// line of messages at the bottom follows the bar and comes before the views.
fn assert_reading_order(stops: &[FocusStop], context: &str) {
    let after_messages = stops
        .iter()
        .position(|stop| stop.name.starts_with("Messages ("))
        .map(|index| index + 1);
    for (index, stop) in stops.iter().enumerate() {
        if after_messages == Some(index) {
            continue;
        }
        let (Some(a), b) = (stop.previous, stop.bounds) else {
            continue;
        };
        // A splitter is as high as its panes, in no row of widgets.
        let is_splitter = b.height() > 20.0 * b.width();
        let is_same_row = !is_splitter && b.center().y > a.top() && b.center().y < a.bottom();
        let moves_left = is_same_row && b.center().x < a.center().x;
        let jumps_up_left = b.bottom() < a.top() && b.right() < a.left();
        assert!(!moves_left && !jumps_up_left, "{context}: {stop:?}");
    }
}

/// The current rectangle of a stop.
fn current_bounds(bench: &WindowBench, stop: &FocusStop) -> Option<Rect> {
    let response = bench.harness.ctx.read_response(stop.id)?;
    Some(response.rect)
}

fn open_view(view: Option<ViewId>, size: Vec2) -> WindowBench {
    let mut layouts = Layouts::with_layout(WindowLayout::Panel);
    if let Some(view) = view {
        layouts.dock(view);
    }
    let mut bench = WindowBench::with_layouts(Setup::default(), layouts, size);
    bench.open("01-stepped-shaft.CNC");
    bench.run(100);
    bench.run(100);
    bench
}

#[test]
fn tab_visits_every_view_in_reading_order_with_a_visible_focus() {
    // A small window: much of the content is scrolled.
    let size = vec2(1024.0, 768.0);
    let views = VIEWS.iter().map(|it| Some(it.view));
    for view in std::iter::once(None).chain(views) {
        let context = format!("{view:?}");
        let mut bench = open_view(view, size);
        let stops = tab_through(&mut bench, &context);
        assert_reading_order(&stops, &context);
        // Backwards, no widget holds the focus, either.
        let back_stops =
            (0..12).map(|_| press_tab(&mut bench, Modifiers::SHIFT).map(|stop| stop.id));
        let back_stops: HashSet<Option<Id>> = back_stops.collect();
        assert_eq!(
            back_stops.len(),
            stops.len().min(12),
            "{context}: no way back"
        );
    }
}

#[test]
fn tab_reaches_the_time_line_once() {
    let settings = WindowSettings {
        language: Language::En,
        layouts: Layouts::with_layout(WindowLayout::Panel),
        timeline: true,
        ..WindowSettings::default()
    };
    let mut bench = WindowBench::with_settings(Setup::default(), settings, vec2(1024.0, 768.0));
    bench.run(1000);
    let stops = tab_through(&mut bench, "time line");
    assert_reading_order(&stops, "time line");
    for name in ["Save", "Range", "Time line"] {
        let named = stops.iter().filter(|stop| stop.name.starts_with(name));
        assert_eq!(named.count(), 1, "{name}");
    }
}

#[test]
fn tab_reaches_what_opens_inside_a_view() {
    for (view, button, content) in [
        (ViewId::Ladder, "Edit", "Insert rung"),
        (ViewId::Machine, "Tools and stock", "Save"),
    ] {
        let context = format!("{view:?}, {button}");
        let mut bench = open_view(Some(view), vec2(1920.0, 1080.0));
        bench.click(button);
        bench.run(50);
        let _ = bench.harness.get_by_label(content);
        let stops = tab_through(&mut bench, &context);
        assert_reading_order(&stops, &context);
    }
}

/// The name of the focused widget for a screen reader.
fn focused_name(bench: &WindowBench) -> String {
    focus_stop(bench).map_or_else(String::new, |stop| stop.name)
}

/// Presses Tab until the name of the focused widget contains `part`.
#[track_caller]
fn tab_to(bench: &mut WindowBench, part: &str) {
    for _ in 0..60 {
        if press_tab(bench, Modifiers::NONE).is_some_and(|stop| stop.name.contains(part)) {
            return;
        }
    }
    panic!("Tab does not come to {part}");
}

fn press_key(bench: &mut WindowBench, key: Key) {
    bench.harness.key_press(key);
    bench.run(30);
    bench.run(30);
}

/// Holds a key with Ctrl for a time, then releases it.
fn hold_with_control(bench: &mut WindowBench, key: Key, milliseconds: u64) {
    bench.harness.key_down_modifiers(Modifiers::CTRL, key);
    bench.run(milliseconds);
    bench.harness.key_up_modifiers(Modifiers::CTRL, key);
    bench.run(100);
}

#[test]
fn a_list_is_one_stop_and_cursor_keys_move_in_it() {
    let mut bench = open_view(Some(ViewId::Data), vec2(1366.0, 768.0));
    let stops = tab_through(&mut bench, "data");
    assert!(stops.len() < 60, "{} stops", stops.len());
    let rows = stops.iter().filter(|it| it.name.starts_with("00"));
    assert_eq!(rows.count(), 1);
    tab_to(&mut bench, "001 ");
    let lcd = bench.lcd();
    for (pressed, row) in [
        (Key::ArrowDown, "002 "),
        (Key::ArrowDown, "003 "),
        (Key::ArrowUp, "002 "),
        (Key::Home, "001 "),
        (Key::End, "185 "),
    ] {
        press_key(&mut bench, pressed);
        assert!(
            focused_name(&bench).starts_with(row),
            "{}",
            focused_name(&bench)
        );
    }
    // Moving selects the row, and its details are shown beside the list.
    let _ = bench.harness.get_by_label("Value of 185");
    press_key(&mut bench, Key::PageUp);
    let page = focused_name(&bench);
    assert!(
        !page.starts_with("185 ") && !page.starts_with("001 "),
        "{page}"
    );
    assert_eq!(bench.lcd(), lcd);
    // The next stop is outside of the list.
    let next = press_tab(&mut bench, Modifiers::NONE);
    assert!(next.is_some_and(|stop| !stop.name.starts_with(&page)));
}

#[test]
fn a_focused_list_blocks_axis_keys_and_shows_why() {
    let mut bench = open_view(Some(ViewId::Data), vec2(1366.0, 768.0));
    hold_with_control(&mut bench, Key::Num6, 100);
    tab_to(&mut bench, "001 ");
    let before = bench.kernel.emulator().cnc().position_machine();
    hold_with_control(&mut bench, Key::ArrowLeft, 300);
    let after = bench.kernel.emulator().cnc().position_machine();
    assert_eq!(before, after);
    let message = "axis keys do not act while the cursor keys move in a list";
    assert!(bench.harness.query_by_label_contains(message).is_some());
    // The focus has left the list: the next press jogs the axis.
    hold_with_control(&mut bench, Key::ArrowLeft, 300);
    let after = bench.kernel.emulator().cnc().position_machine();
    assert_ne!(before, after);
}

#[test]
fn cursor_keys_move_a_splitter() {
    let mut bench = open_view(Some(ViewId::Data), vec2(1366.0, 768.0));
    tab_to(&mut bench, "Bar 0");
    let splitter_x = |bench: &WindowBench| {
        let bar = bench.harness.get_by_label("Bar 0 between left and right");
        bar.rect().center().x
    };
    let first = splitter_x(&bench);
    press_key(&mut bench, Key::ArrowLeft);
    press_key(&mut bench, Key::ArrowLeft);
    let moved = splitter_x(&bench);
    assert!(moved < first - 40.0, "{first} {moved}");
    press_key(&mut bench, Key::ArrowRight);
    assert!(splitter_x(&bench) > moved + 20.0);
    press_key(&mut bench, Key::Enter);
    assert!((splitter_x(&bench) - first).abs() < 1.0);
}

#[test]
fn a_focused_button_leaves_the_cursor_keys_to_the_panel() {
    let mut bench = open_view(None, vec2(1366.0, 768.0));
    let first = press_tab(&mut bench, Modifiers::NONE).map(|stop| stop.id);
    for pressed in [Key::ArrowRight, Key::ArrowDown] {
        press_key(&mut bench, pressed);
        assert_eq!(focus_stop(&bench).map(|stop| stop.id), first);
    }
}
