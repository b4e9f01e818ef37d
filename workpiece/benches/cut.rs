//! What cutting costs: a tick of a finishing cut along parts of many corners, and the
//! half section put together for a picture.

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_units::Point;
use gsk_workpiece::grid::to_grid;
use gsk_workpiece::part::Part;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{Shape, Tool};

/// Length of the part, mm.
const LENGTH: f64 = 200.0;

/// A part with so many corners along its outside: a fine saw.
fn part(corners: u32) -> Part {
    let mut contour = vec![to_grid(Point::new(0.0, 0.0))];
    for corner in 0..corners {
        let z = -LENGTH * f64::from(corner) / f64::from(corners);
        let x = if corner % 2 == 0 { 25.0 } else { 24.99 };
        contour.push(to_grid(Point::new(x, z)));
    }
    contour.push(to_grid(Point::new(0.0, -LENGTH)));
    Part::new(&Region::of(&[contour]))
}

fn cut(criterion: &mut Criterion) {
    let tool = Shape::of(&Tool::turning());
    for corners in [100, 1_000, 5_000, 20_000] {
        criterion.bench_function(&format!("tick of a cut, {corners} corners"), |bencher| {
            let mut part = part(corners);
            let mut z = 1.0;
            // 0.2 mm a revolution at 1000 r/min: 3.3 µm a tick.
            bencher.iter(|| {
                let next = if z < 1.0 - LENGTH { 1.0 } else { z - 0.0033 };
                part.cut(
                    &tool.cutting,
                    Point::new(24.5, z.max(next)),
                    Point::new(24.5, next),
                );
                z = next;
            });
        });
        let whole = part(corners);
        criterion.bench_function(&format!("half section, {corners} corners"), |bencher| {
            bencher.iter(|| whole.section());
        });
    }
}

criterion_group!(benches, cut);
criterion_main!(benches);
