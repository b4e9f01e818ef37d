//! The keyboard alone: Tab through bar and views reaches everything once, in the order in
//! which it is read, and shows where it is.

use std::collections::HashSet;

use egui::{Id, Key, Memory, Modifiers, Rect, Shape, Vec2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gsk_app::window::layout::{Layout, Layouts};
use gsk_app::window::view::{VIEWS, View};
use gsk_core::setup::Setup;

use crate::common::Bench;

/// Where the focus stands.
#[derive(Clone, Debug)]
struct Stop {
    id: Id,
    name: String,
    place: Rect,
    /// Where the stop before stands in the same picture.
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

/// Lines that are drawn around or under a place, to see whether there are others.
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
    // An edge of a panel is passed over in the next picture.
    for _ in 0..3 {
        bench.harness.step();
    }
    stop(bench)
}

/// The stops from the first to the one before it comes again. Each has a name, and the focus
/// is seen there: without it something else is drawn.
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

/// In a row the focus goes to the right, and it does not jump back to the left upwards.
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

/// Where a stop stands now.
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
    // Small, so that much is scrolled.
    let size = vec2(1024.0, 768.0);
    let views = VIEWS.iter().map(|it| Some(it.view));
    for view in std::iter::once(None).chain(views) {
        let what = format!("{view:?}");
        let mut bench = opened(view, size);
        let forth = round(&mut bench, &what);
        read_in_order(&forth, &what);
        // Back nothing holds it, either.
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
