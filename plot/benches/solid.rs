//! Measures how long it takes to build and draw a solid: a shaft with arcs and a thread, its
//! clamping and a tool, on 900 by 500 pixels.

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_plot::solid::{
    BodyResolution, SolidCanvas, SolidView, ViewDirection, clamping_bodies, part_bodies,
    tool_bodies,
};
use gsk_workpiece::grid::{GridContour, GridPoint, grid};
use gsk_workpiece::region::Region;
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;

const SIZE: (usize, usize) = (900, 500);

/// Two steps, a ball and 25 turns of a thread.
fn shaft(stock: &Region) -> Region {
    let mut contour: GridContour = Vec::new();
    let mut corner = |z: f64, x: f64| contour.push(GridPoint::new(grid(z), grid(x)));
    corner(3.0, 30.0);
    corner(3.0, 0.0);
    corner(0.0, 0.0);
    for step in 0..=900 {
        let angle = f64::from(step) / 900.0 * core::f64::consts::FRAC_PI_2;
        corner(-12.0 + 12.0 * libm::cos(angle), 12.0 * libm::sin(angle));
    }
    for turn in 0..25 {
        let z = -14.0 - 1.5 * f64::from(turn);
        corner(z, 15.0);
        corner(z - 0.7, 14.0);
        corner(z - 0.8, 14.0);
    }
    corner(-52.0, 15.0);
    corner(-52.0, 20.0);
    corner(-70.0, 22.0);
    corner(-70.0, 30.0);
    stock.difference(&[contour])
}

fn bench_solid(criterion: &mut Criterion) {
    let stock = Stock::bar(50.0, 1.0, 80.0);
    let section = stock.section();
    let shaft = shaft(&section);
    let view = SolidView::fit(ViewDirection::oblique(true), [&section], SIZE, 30.0);
    let fineness = BodyResolution::for_scale(view.pixels_per_mm);
    criterion.bench_function("solid of a shaft built", |bencher| {
        bencher.iter(|| part_bodies(&shaft, &section, fineness));
    });
    let mut bodies = part_bodies(&shaft, &section, fineness).to_vec();
    bodies.extend(clamping_bodies(&stock, false, fineness));
    bodies.extend(tool_bodies(&Tool::turning(), fineness));
    let mut canvas = SolidCanvas::default();
    for samples in [1, 2] {
        let name = format!("solid of a shaft drawn, {samples} x {samples} samples a pixel");
        criterion.bench_function(&name, |bencher| {
            let placed_bodies = || bodies.iter().map(|body| (body, (0.0, 0.0)));
            bencher.iter(|| canvas.draw(placed_bodies(), &view, SIZE, samples));
        });
    }
}

criterion_group!(benches, bench_solid);
criterion_main!(benches);
