//! What a picture of the solid costs: a shaft with arcs and a thread, its clamping and a
//! tool, on 900 by 500 pixels.

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_runner::solid::{Canvas, Fineness, Turn, View, clamping, part, tool};
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

fn solid(criterion: &mut Criterion) {
    let stock = Stock::bar(50.0, 1.0, 80.0);
    let section = stock.section();
    let shaft = shaft(&section);
    let view = View::fit(Turn::oblique(true), [&section], SIZE, 30.0);
    let fineness = Fineness::of(view.scale);
    criterion.bench_function("solid of a shaft built", |bencher| {
        bencher.iter(|| part(&shaft, &section, fineness));
    });
    let mut bodies = part(&shaft, &section, fineness).to_vec();
    bodies.extend(clamping(&stock, false, fineness));
    bodies.extend(tool(&Tool::turning(), fineness));
    let mut canvas = Canvas::default();
    for samples in [1, 2] {
        let name = format!("solid of a shaft drawn, {samples} x {samples} samples a pixel");
        criterion.bench_function(&name, |bencher| {
            let all = || bodies.iter().map(|body| (body, (0.0, 0.0)));
            bencher.iter(|| canvas.draw(all(), &view, SIZE, samples));
        });
    }
}

criterion_group!(benches, solid);
criterion_main!(benches);
