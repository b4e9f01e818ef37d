//! Emergency stop, feed hold and RESET are never covered (WINDOW-25), neither by a dialog nor
//! by the separate window of a view.

use egui::accesskit::Role;
use egui::{Context, Key, Modifiers, Order, Rect, Vec2, ViewportId, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use gsk_app::window::layout::{Layout, Layouts};
use gsk_app::window::view::{VIEWS, View};
use gsk_core::setup::Setup;

use crate::common::Bench;
use crate::common::windows::Windows;
use crate::window::ask_to_close;

const STOPS: [&str; 3] = ["Emergency stop", "Feed hold", "Reset"];
const SIZES: [Vec2; 4] = [
    vec2(1024.0, 768.0),
    vec2(1366.0, 768.0),
    vec2(1920.0, 1080.0),
    vec2(800.0, 1280.0),
];

fn stops(bench: &Bench) -> [Rect; 3] {
    STOPS.map(|name| {
        let key = bench.harness.get_by_role_and_label(Role::Button, name);
        key.rect()
    })
}

/// Whether another layer covers a rectangle of the window.
fn is_covered(context: &Context, place: Rect) -> bool {
    let places = [place.center(), place.left_top(), place.right_bottom()];
    let over = places.map(|at| context.layer_id_at(at + (place.center() - at) * 0.1));
    over.into_iter()
        .flatten()
        .any(|layer| layer.order != Order::Background)
}

#[track_caller]
fn nothing_lies_over_them(bench: &Bench, what: &str) {
    for (place, name) in stops(bench).into_iter().zip(STOPS) {
        let covered = is_covered(&bench.harness.ctx, place);
        assert!(
            !covered,
            "{what} over {name} in {}",
            bench.harness.ctx.content_rect()
        );
    }
}

#[test]
fn no_dialog_covers_a_stop() {
    for size in SIZES {
        let panel = Layouts::of(Layout::Panel);
        let mut in_turn = panel.clone();
        in_turn.dock(View::Data);
        for layouts in [panel, in_turn, Layouts::of(Layout::Machine)] {
            let mut bench = Bench::sized(Setup::default(), layouts, size);
            for dialog in ["Help F1", "Keys"] {
                bench.click(dialog);
                bench.run(20);
                let layers = bench.harness.ctx.memory(|memory| {
                    let visible = memory.areas().visible_layer_ids();
                    visible.iter().any(|it| it.order == Order::Middle)
                });
                assert!(layers, "{dialog} is open");
                nothing_lies_over_them(&bench, dialog);
            }
            // A question is open in addition to both.
            bench.open("01-stepped-shaft.CNC");
            let control = Modifiers::CTRL;
            bench.harness.key_press_modifiers(control, Key::Num2);
            bench.run(300);
            bench.harness.key_press(Key::F9);
            bench.run(300);
            ask_to_close(&mut bench);
            bench.run(20);
            let question = bench.harness.query_by_label("Do not close");
            assert!(question.is_some(), "nobody asks in {size}");
            nothing_lies_over_them(&bench, "a question");
        }
    }
}

#[test]
fn a_view_opens_its_window_beside_the_stops() {
    // Size that a title and a frame add, points.
    let frame = vec2(12.0, 44.0);
    for screen in SIZES {
        let size = screen - vec2(0.0, 60.0);
        let layouts = Layouts::of(Layout::Panel);
        let mut bench = Bench::sized(Setup::default(), layouts, size);
        let windows = Windows::of(&bench);
        let main = Rect::from_min_size(pos2(0.0, 40.0), size);
        let viewports = &mut bench.harness.input_mut().viewports;
        let root = viewports.entry(ViewportId::ROOT).or_default();
        root.monitor_size = Some(screen);
        root.inner_rect = Some(main);
        bench.run(20);
        let stops = stops(&bench).map(|it| it.translate(main.min.to_vec2()));
        let own = VIEWS.iter().filter(|row| !row.docks);
        let keys = own.filter_map(|row| row.key);
        for (open, key) in keys.enumerate() {
            let shift = Modifiers::SHIFT;
            bench.harness.key_press_modifiers(shift, key);
            bench.run(20);
            let shown = windows.look(&mut bench);
            assert_eq!(shown.len(), open + 1, "{key:?} in {screen}");
            let place = shown.last().and_then(|it| it.place);
            let place = place.expect("a window says where it wants to be");
            let whole = Rect::from_min_size(place.min, place.size() + frame);
            let covers = |stop: &Rect| stop.shrink(1.0).intersects(whole);
            assert!(!stops.iter().any(covers), "{key:?} in {screen}: {whole}");
        }
    }
}
