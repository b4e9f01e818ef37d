//! What cutting costs: a tick of a finishing cut along parts of many corners, an arc, and
//! the half section put together for a picture.

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_units::Point;
use gsk_workpiece::grid::to_grid;
use gsk_workpiece::motion::{Kind, Motion};
use gsk_workpiece::part::Part;
use gsk_workpiece::region::Region;
use gsk_workpiece::scene::{Cutter, Scene};
use gsk_workpiece::stock::Stock;
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

/// Arcs of 90° one after another, each a tenth of a millimetre deeper than the one before:
/// their chords cut at once.
fn arcs(criterion: &mut Criterion) {
    let mut scene = Scene::new(&Stock::bar(50.0, 0.0, 220.0));
    let cutter = Cutter::new(Shape::of(&Tool::turning()));
    let mut count = 0;
    criterion.bench_function("an arc of 90 degrees", |bencher| {
        bencher.iter(|| {
            let (row, column) = (count / 50, count % 50);
            let center = Point::new(30.0 - 0.1 * f64::from(row % 100), -4.0 * f64::from(column));
            count += 1;
            let at = |x: f64, z: f64| Point::new(center.x + x, center.z + z);
            scene.carry_out(
                &cutter,
                &Motion {
                    from: at(-3.5, 3.5),
                    to: at(-3.5, -3.5),
                    kind: Kind::Arc {
                        center,
                        clockwise: true,
                    },
                    turning: true,
                },
            )
        });
    });
}

criterion_group!(benches, cut, arcs);
criterion_main!(benches);
