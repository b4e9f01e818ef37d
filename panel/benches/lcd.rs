//! Measures an LCD redraw: the page into a screen, and the screen into 320x240 pixels.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_panel::pages::{self, GraphicSettings, PageId, PageView};
use gsk_panel::raster;
use gsk_panel::screen::{ROWS, Screen};
use gsk_panel::trace::MAX_SEGMENTS;

/// A path of `segments` segments that cannot be joined.
fn view_with_path(segments: usize) -> PageView {
    let mut view = PageView::default();
    view.graphic = GraphicSettings {
        zx: true,
        max_x: 150_000,
        max_z: 200_000,
        min_x: -10_000,
        min_z: -10_000,
        ..view.graphic
    };
    view.graphic.recompute();
    let at = |index: usize| {
        let side = if index.is_multiple_of(2) { 10.0 } else { 12.0 };
        Point::new(
            side + 50.0 * (index as f64 / segments as f64),
            (index % 1800) as f64 / 10.0,
        )
    };
    for index in 0..segments {
        view.trace
            .push(at(index), at(index + 1), index.is_multiple_of(7));
    }
    view
}

fn lcd(criterion: &mut Criterion) {
    let cnc = Simulation::new(Setup::default()).cnc;
    let empty = PageView::default();
    let full = view_with_path(MAX_SEGMENTS - 1500);
    let cases = [
        ("position", PageId::PosRel, &empty),
        ("parameters", PageId::ParBit, &empty),
        ("graphic, 64000 pieces", PageId::Graph, &full),
    ];
    for (name, page, view) in cases {
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                let screen = pages::draw(page, black_box(view), &cnc);
                raster::rgba(&screen, view.brightness)
            });
        });
    }
    let mut chinese = Screen::new();
    for row in 0..ROWS {
        chinese.put(row, 0, "广州数控设备有限公司车床数控系统自检初始");
    }
    criterion.bench_function("a page full of Chinese, pixels only", |bencher| {
        bencher.iter(|| raster::rgba(black_box(&chinese), 8));
    });
    criterion.bench_function("the same at three times the size", |bencher| {
        bencher.iter(|| raster::render(black_box(&chinese), 3, 8));
    });
}

criterion_group!(benches, lcd);
criterion_main!(benches);
