//! Emergency stop, feed hold and RESET are never covered (WINDOW-25), neither by a dialog nor
//! by the separate window of a view.

use egui::accesskit::Role;
use egui::{Context, Key, Modifiers, Order, Rect, Vec2, ViewportId, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use gsk_core::setup::Setup;
use gsk_window::layout::{Layouts, WindowLayout};
use gsk_window::view::{VIEWS, ViewId};

use crate::common::WindowBench;
use crate::common::windows::ViewWindows;
use crate::window::request_close;

const STOP_KEYS: [&str; 3] = ["Emergency stop", "Feed hold", "Reset"];
const SIZES: [Vec2; 4] = [
    vec2(1024.0, 768.0),
    vec2(1366.0, 768.0),
    vec2(1920.0, 1080.0),
    vec2(800.0, 1280.0),
];

fn stop_key_rects(bench: &WindowBench) -> [Rect; 3] {
    STOP_KEYS.map(|name| {
        let key = bench.harness.get_by_role_and_label(Role::Button, name);
        key.rect()
    })
}

/// Whether another layer covers a rectangle of the window.
fn is_covered(context: &Context, bounds: Rect) -> bool {
    let points = [bounds.center(), bounds.left_top(), bounds.right_bottom()];
    let layers = points.map(|at| context.layer_id_at(at + (bounds.center() - at) * 0.1));
    layers
        .into_iter()
        .flatten()
        .any(|layer| layer.order != Order::Background)
}

#[track_caller]
fn assert_stop_keys_visible(bench: &WindowBench, cover: &str) {
    for (bounds, name) in stop_key_rects(bench).into_iter().zip(STOP_KEYS) {
        let is_hidden = is_covered(&bench.harness.ctx, bounds);
        assert!(
            !is_hidden,
            "{cover} over {name} in {}",
            bench.harness.ctx.content_rect()
        );
    }
}

#[test]
fn no_dialog_covers_a_stop() {
    for size in SIZES {
        let panel = Layouts::with_layout(WindowLayout::Panel);
        let mut with_tabs = panel.clone();
        with_tabs.dock(ViewId::Data);
        for layouts in [
            panel,
            with_tabs,
            Layouts::with_layout(WindowLayout::Machine),
        ] {
            let mut bench = WindowBench::with_layouts(Setup::default(), layouts, size);
            for dialog in ["Help F1", "Keys"] {
                bench.click(dialog);
                bench.run(20);
                let layers = bench.harness.ctx.memory(|memory| {
                    let visible = memory.areas().visible_layer_ids();
                    visible.iter().any(|it| it.order == Order::Middle)
                });
                assert!(layers, "{dialog} is open");
                assert_stop_keys_visible(&bench, dialog);
            }
            // A question is open in addition to both.
            bench.open("01-stepped-shaft.CNC");
            let control = Modifiers::CTRL;
            bench.harness.key_press_modifiers(control, Key::Num2);
            bench.run(300);
            bench.harness.key_press(Key::F9);
            bench.run(300);
            request_close(&mut bench);
            bench.run(20);
            let question = bench.harness.query_by_label("Do not close");
            assert!(question.is_some(), "nobody asks in {size}");
            assert_stop_keys_visible(&bench, "a question");
        }
    }
}

#[test]
fn a_separate_window_covers_no_stop_key() {
    // Size that a title and a frame add, points.
    let frame = vec2(12.0, 44.0);
    for screen in SIZES {
        let size = screen - vec2(0.0, 60.0);
        let layouts = Layouts::with_layout(WindowLayout::Panel);
        let mut bench = WindowBench::with_layouts(Setup::default(), layouts, size);
        let windows = ViewWindows::enable(&bench);
        let main = Rect::from_min_size(pos2(0.0, 40.0), size);
        let viewports = &mut bench.harness.input_mut().viewports;
        let root = viewports.entry(ViewportId::ROOT).or_default();
        root.monitor_size = Some(screen);
        root.inner_rect = Some(main);
        bench.run(20);
        let stops = stop_key_rects(&bench).map(|it| it.translate(main.min.to_vec2()));
        let floating = VIEWS.iter().filter(|row| !row.opens_docked);
        let keys = floating.filter_map(|row| row.key);
        for (open_count, key) in keys.enumerate() {
            let shift = Modifiers::SHIFT;
            bench.harness.key_press_modifiers(shift, key);
            bench.run(20);
            let drawn = windows.draw_frame(&mut bench);
            assert_eq!(drawn.len(), open_count + 1, "{key:?} in {screen}");
            let bounds = drawn.last().and_then(|it| it.bounds);
            let bounds = bounds.expect("a window says where it wants to be");
            let whole = Rect::from_min_size(bounds.min, bounds.size() + frame);
            let covers = |stop: &Rect| stop.shrink(1.0).intersects(whole);
            assert!(!stops.iter().any(covers), "{key:?} in {screen}: {whole}");
        }
    }
}
