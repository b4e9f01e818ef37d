//! The keyboard alone: Tab reaches each widget of the bars and views once, in reading order,
//! and the focus is visible.

use std::collections::HashSet;

use egui::{Id, Key, Memory, Modifiers, Rect, Shape, Vec2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gsk_app::window::layout::{Layout, Layouts};
use gsk_app::window::view::{VIEWS, View};
use gsk_core::setup::Setup;

use crate::common::Bench;

/// A widget that has the focus.
#[derive(Clone, Debug)]
struct Stop {
    id: Id,
    name: String,
    place: Rect,
    /// Where the previous stop is in the same frame.
    before: Option<Rect>,
}

fn stop(bench: &Bench) -> Option<Stop> {
    let id = bench.harness.ctx.memory(Memory::focused)?;
    let nodes = bench.harness.root().children_recursive();
    let mut nodes = nodes.filter(|node| node.accesskit_node().is_focused());
    let node = nodes.next()?;
    let own = node.accesskit_node();
    let name = own.label().or_else(|| own.value()).unwrap_or_default();
    Some(Stop {
        id,
        name,
        place: node.rect(),
        before: None,
    })
}

/// Descriptions of the lines that are drawn around or under a rectangle, to detect a change.
fn lines(bench: &Bench, place: Rect) -> Vec<String> {
    fn of(shape: &Shape, place: Rect, found: &mut Vec<String>) {
        let around = place.expand(6.0);
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| of(shape, place, found)),
            Shape::Rect(it) if around.contains_rect(it.rect) => {
                let rect = it.rect.translate(-place.min.to_vec2());
                found.push(format!("{rect:?} {:?} {:?}", it.stroke, it.fill));
            }
            Shape::LineSegment { points, stroke } if around.contains(points[0]) => {
                let points = points.map(|point| point - place.min);
                found.push(format!("{points:?} {stroke:?}"));
            }
            Shape::Text(text) if around.contains(text.pos) => {
                found.push(format!("{:?} {:?}", text.underline, text.fallback_color));
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    for it in &bench.harness.output().shapes {
        of(&it.shape, place, &mut found);
    }
    found
}

fn tab(bench: &mut Bench, modifiers: Modifiers) -> Option<Stop> {
    bench.harness.key_press_modifiers(modifiers, Key::Tab);
    // The focus skips the edge of a panel in the next frame.
    for _ in 0..3 {
        bench.harness.step();
    }
    stop(bench)
}

/// Collects the stops of Tab until the first one comes again. Each has a name and a visible
/// focus: without the focus, the window draws something else.
fn round(bench: &mut Bench, what: &str) -> Vec<Stop> {
    let mut stops: Vec<Stop> = Vec::new();
    let mut seen = Vec::new();
    for _ in 0..600 {
        let Some(mut stop) = tab(bench, Modifiers::NONE) else {
            panic!("{what}: nothing has the focus after {:?}", stops.last());
        };
        if let Some(last) = stops.last() {
            stop.before = place_of(bench, last);
            let bare = lines(bench, stop.before.unwrap_or(last.place));
            assert_ne!(seen, bare, "{what}: the focus is not seen at {last:?}");
        }
        if let Some(first) = stops.iter().position(|it| it.id == stop.id) {
            assert_eq!(first, 0, "{what}: {} holds the focus", stop.name);
            return stops;
        }
        assert!(!stop.name.trim().is_empty(), "{what}: no name at {stop:?}");
        seen = lines(bench, stop.place);
        stops.push(stop);
    }
    panic!("{what}: there is no end");
}

/// In a row the focus moves to the right, and it does not jump back to the upper left.
fn read_in_order(stops: &[Stop], what: &str) {
    for stop in stops {
        let (Some(a), b) = (stop.before, stop.place) else {
            continue;
        };
        let row = b.center().y > a.top() && b.center().y < a.bottom();
        let back = row && b.center().x < a.center().x;
        let up = b.bottom() < a.top() && b.right() < a.left();
        assert!(!back && !up, "{what}: {stop:?}");
    }
}

/// The current rectangle of a stop.
fn place_of(bench: &Bench, stop: &Stop) -> Option<Rect> {
    let response = bench.harness.ctx.read_response(stop.id)?;
    Some(response.rect)
}

fn opened(view: Option<View>, size: Vec2) -> Bench {
    let mut layouts = Layouts::of(Layout::Panel);
    if let Some(view) = view {
        layouts.dock(view);
    }
    let mut bench = Bench::sized(Setup::default(), layouts, size);
    bench.open("01-stepped-shaft.CNC");
    bench.run(100);
    bench.run(100);
    bench
}

#[test]
fn tab_goes_through_every_view_as_it_is_read_and_is_seen() {
    // A small window: much of the content is scrolled.
    let size = vec2(1024.0, 768.0);
    let views = VIEWS.iter().map(|it| Some(it.view));
    for view in std::iter::once(None).chain(views) {
        let what = format!("{view:?}");
        let mut bench = opened(view, size);
        let forth = round(&mut bench, &what);
        read_in_order(&forth, &what);
        // Backwards, no widget holds the focus, either.
        let back = (0..12).map(|_| tab(&mut bench, Modifiers::SHIFT).map(|stop| stop.id));
        let back: HashSet<Option<Id>> = back.collect();
        assert_eq!(back.len(), forth.len().min(12), "{what}: no way back");
    }
}

#[test]
fn what_opens_within_a_view_is_reached_too() {
    for (view, open, inside) in [
        (View::Ladder, "Edit", "Insert rung"),
        (View::Machine, "Tools and stock", "Save"),
    ] {
        let what = format!("{view:?}, {open}");
        let mut bench = opened(Some(view), vec2(1920.0, 1080.0));
        bench.click(open);
        bench.run(50);
        let _ = bench.harness.get_by_label(inside);
        let forth = round(&mut bench, &what);
        read_in_order(&forth, &what);
    }
}

/// The name of the focused widget for a screen reader.
fn focused(bench: &Bench) -> String {
    stop(bench).map_or_else(String::new, |stop| stop.name)
}

/// Presses Tab until the name of the focused widget contains `part`.
#[track_caller]
fn tab_to(bench: &mut Bench, part: &str) {
    for _ in 0..60 {
        if tab(bench, Modifiers::NONE).is_some_and(|stop| stop.name.contains(part)) {
            return;
        }
    }
    panic!("Tab does not come to {part}");
}

fn key(bench: &mut Bench, key: Key) {
    bench.harness.key_press(key);
    bench.run(30);
    bench.run(30);
}

/// Holds a key with Ctrl for a time, then releases it.
fn with_control(bench: &mut Bench, key: Key, milliseconds: u64) {
    bench.harness.key_down_modifiers(Modifiers::CTRL, key);
    bench.run(milliseconds);
    bench.harness.key_up_modifiers(Modifiers::CTRL, key);
    bench.run(100);
}

#[test]
fn a_list_is_one_stop_and_the_keys_of_the_cursor_move_in_it() {
    let mut bench = opened(Some(View::Data), vec2(1366.0, 768.0));
    let stops = round(&mut bench, "data");
    assert!(stops.len() < 60, "{} stops", stops.len());
    let rows = stops.iter().filter(|it| it.name.starts_with("00"));
    assert_eq!(rows.count(), 1);
    tab_to(&mut bench, "001 ");
    let lcd = bench.lcd();
    for (pressed, at) in [
        (Key::ArrowDown, "002 "),
        (Key::ArrowDown, "003 "),
        (Key::ArrowUp, "002 "),
        (Key::Home, "001 "),
        (Key::End, "185 "),
    ] {
        key(&mut bench, pressed);
        assert!(focused(&bench).starts_with(at), "{}", focused(&bench));
    }
    // Moving selects the row, and its details are shown beside the list.
    let _ = bench.harness.get_by_label("Value of 185");
    key(&mut bench, Key::PageUp);
    let page = focused(&bench);
    assert!(
        !page.starts_with("185 ") && !page.starts_with("001 "),
        "{page}"
    );
    assert_eq!(bench.lcd(), lcd);
    // The next stop is outside of the list.
    let next = tab(&mut bench, Modifiers::NONE);
    assert!(next.is_some_and(|stop| !stop.name.starts_with(&page)));
}

#[test]
fn while_the_focus_is_in_a_list_no_axis_is_jogged_and_it_is_said() {
    let mut bench = opened(Some(View::Data), vec2(1366.0, 768.0));
    with_control(&mut bench, Key::Num6, 100);
    tab_to(&mut bench, "001 ");
    let before = bench.kernel.emulator().simulation.cnc.position_machine();
    with_control(&mut bench, Key::ArrowLeft, 300);
    let after = bench.kernel.emulator().simulation.cnc.position_machine();
    assert_eq!(before, after);
    let said = "no axis key acts while the cursor keys move in a list";
    assert!(bench.harness.query_by_label_contains(said).is_some());
    // The focus has left the list: the next press jogs the axis.
    with_control(&mut bench, Key::ArrowLeft, 300);
    let after = bench.kernel.emulator().simulation.cnc.position_machine();
    assert_ne!(before, after);
}

#[test]
fn a_bar_between_panes_is_moved_by_the_keys_of_the_cursor() {
    let mut bench = opened(Some(View::Data), vec2(1366.0, 768.0));
    tab_to(&mut bench, "Bar 0");
    let bar = |bench: &Bench| {
        let bar = bench.harness.get_by_label("Bar 0 between left and right");
        bar.rect().center().x
    };
    let first = bar(&bench);
    key(&mut bench, Key::ArrowLeft);
    key(&mut bench, Key::ArrowLeft);
    let moved = bar(&bench);
    assert!(moved < first - 40.0, "{first} {moved}");
    key(&mut bench, Key::ArrowRight);
    assert!(bar(&bench) > moved + 20.0);
    key(&mut bench, Key::Enter);
    assert!((bar(&bench) - first).abs() < 1.0);
}

#[test]
fn while_a_button_has_the_focus_the_keys_of_the_cursor_are_the_panels() {
    let mut bench = opened(None, vec2(1366.0, 768.0));
    let first = tab(&mut bench, Modifiers::NONE).map(|stop| stop.id);
    for pressed in [Key::ArrowRight, Key::ArrowDown] {
        key(&mut bench, pressed);
        assert_eq!(stop(&bench).map(|stop| stop.id), first);
    }
}
