//! Benchmarks of cutting: one tick of a finishing cut along parts with many corners, an
//! arc, and the assembly of the half section for a picture.

use criterion::{Criterion, criterion_group, criterion_main};
use gsk_units::Point;
use gsk_workpiece::grid::to_grid;
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::part::TurnedPart;
use gsk_workpiece::region::Region;
use gsk_workpiece::scene::{LatheScene, SceneTool};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::{Tool, ToolShape};

/// Length of the turned part, mm.
const LENGTH: f64 = 200.0;

/// A part with a number of corners along its outer surface, like a fine saw blade.
fn part(corners: u32) -> TurnedPart {
    let mut contour = vec![to_grid(Point::new(0.0, 0.0))];
    for corner in 0..corners {
        let z = -LENGTH * f64::from(corner) / f64::from(corners);
        let x = if corner % 2 == 0 { 25.0 } else { 24.99 };
        contour.push(to_grid(Point::new(x, z)));
    }
    contour.push(to_grid(Point::new(0.0, -LENGTH)));
    TurnedPart::new(&Region::from_contours(&[contour]))
}

fn cut(criterion: &mut Criterion) {
    let tool = ToolShape::from_tool(&Tool::turning());
    for corners in [100, 1_000, 5_000, 20_000] {
        criterion.bench_function(&format!("tick of a cut, {corners} corners"), |bencher| {
            let mut part = part(corners);
            let mut z = 1.0;
            // 0.2 mm/r at 1000 r/min: 3.3 µm in each tick.
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

/// Consecutive arcs of 90°, each row 0.1 mm deeper than the previous one. All chords of an
/// arc are cut in one sweep.
fn arcs(criterion: &mut Criterion) {
    let mut scene = LatheScene::new(&Stock::bar(50.0, 0.0, 220.0));
    let cutter = SceneTool::new(ToolShape::from_tool(&Tool::turning()));
    let mut count = 0;
    criterion.bench_function("an arc of 90 degrees", |bencher| {
        bencher.iter(|| {
            let (row, column) = (count / 50, count % 50);
            let center = Point::new(30.0 - 0.1 * f64::from(row % 100), -4.0 * f64::from(column));
            count += 1;
            let at = |x: f64, z: f64| Point::new(center.x + x, center.z + z);
            scene.move_tool(
                &cutter,
                &ToolMotion {
                    from: at(-3.5, 3.5),
                    to: at(-3.5, -3.5),
                    kind: MotionKind::Arc {
                        center,
                        clockwise: true,
                    },
                    turning: true,
                    by_hand: false,
                },
            )
        });
    });
}

criterion_group!(benches, cut, arcs);
criterion_main!(benches);
