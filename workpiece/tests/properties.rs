//! What holds for every cut: the order does not matter, nothing grows, and mirrored cuts
//! leave the mirrored part.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

use gsk_units::Point;
use gsk_workpiece::grid::{GridPoint, grid};
use gsk_workpiece::part::Part;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{Shape, Tool};
use proptest::prelude::*;

/// A cut: tool, from, to; X a radius.
type Cut = (usize, (i32, i32), (i32, i32));

fn tools() -> [Tool; 4] {
    [
        Tool::turning(),
        Tool::grooving(3.0),
        Tool::threading(60.0),
        Tool {
            tip: 4,
            ..Tool::turning()
        },
    ]
}

/// Micrometres to a point, as programs have them.
fn point((x, z): (i32, i32)) -> Point {
    Point::new(f64::from(x) / 1000.0, f64::from(z) / 1000.0)
}

fn bar() -> Region {
    let corner = |z: f64, x: f64| GridPoint::new(grid(z), grid(x));
    Region::rectangle(corner(-50.0, 0.0), corner(0.0, 20.0))
}

fn cut(part: &mut Part, (tool, from, to): &Cut) {
    let shape = Shape::of(&tools()[*tool]);
    part.cut(&shape.cutting, point(*from), point(*to));
}

fn mirrored(contour: &[GridPoint]) -> Vec<GridPoint> {
    let flipped = contour.iter().map(|it| GridPoint::new(-it.x, it.y));
    flipped.rev().collect()
}

/// Area that belongs to one of two regions only, mm².
fn difference(a: &Region, b: &Region) -> f64 {
    a.without(b.contours()).area() + b.without(a.contours()).area()
}

fn cuts() -> impl Strategy<Value = Vec<Cut>> {
    let position = || (500..22_000, -45_000..3_000);
    proptest::collection::vec((0..4_usize, position(), position()), 1..12)
}

/// A crossing is rounded by half a unit, in each of two directions: along a metre of
/// edges that is less than this, mm².
const ROUNDING: f64 = 0.05;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn the_order_of_cuts_does_not_matter(cuts in cuts()) {
        let mut forward = Part::new(&bar());
        let mut backward = forward.clone();
        for one in &cuts {
            cut(&mut forward, one);
        }
        for one in cuts.iter().rev() {
            cut(&mut backward, one);
        }
        let off = difference(&forward.section(), &backward.section());
        prop_assert!(off < ROUNDING, "{off} mm²");
    }

    #[test]
    fn nothing_is_ever_more_after_a_cut(cuts in cuts()) {
        let mut part = Part::new(&bar());
        let mut before = part.section();
        for one in &cuts {
            cut(&mut part, one);
            let after = part.section();
            let grown = after.without(before.contours()).area();
            prop_assert!(grown < ROUNDING / 10.0, "{grown} mm²");
            prop_assert!(part.volume() >= 0.0);
            before = after;
        }
    }

    #[test]
    fn a_mirrored_cut_leaves_the_mirrored_part(cuts in cuts()) {
        let mut part = Part::new(&bar());
        let flipped: Vec<_> = bar().contours().iter().map(|it| mirrored(it)).collect();
        let mut image = Part::new(&Region::of(&flipped));
        for one in &cuts {
            cut(&mut part, one);
            let shape = mirrored(&Shape::of(&tools()[one.0]).cutting);
            let flip = |(x, z): (i32, i32)| point((x, -z));
            image.cut(&shape, flip(one.1), flip(one.2));
        }
        let back: Vec<_> = image.section().contours().iter().map(|it| mirrored(it)).collect();
        let off = difference(&part.section(), &Region::of(&back));
        prop_assert!(off < ROUNDING, "{off} mm²");
    }
}

/// Parts whose edges lie almost on each other: the difference of these two once had an
/// edge through the full part.
#[test]
fn parts_that_are_almost_alike_differ_almost_nowhere() {
    let cuts = [
        (2, (8056, -7574), (6832, -23885)),
        (0, (11942, -5715), (11417, -21898)),
    ];
    let mut forward = Part::new(&bar());
    let mut backward = forward.clone();
    for (one, other) in cuts.iter().zip(cuts.iter().rev()) {
        cut(&mut forward, one);
        cut(&mut backward, other);
    }
    let off = difference(&forward.section(), &backward.section());
    assert!(off < 1e-3, "{off} mm²");
}
