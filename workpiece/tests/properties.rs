//! Properties of all cuts: their order does not matter, no cut adds material, and mirrored
//! cuts leave the mirrored part.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

use gsk_units::Point;
use gsk_workpiece::curve::PlaneArc;
use gsk_workpiece::grid::{GridPoint, grid, to_grid};
use gsk_workpiece::part::TurnedPart;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{Tool, ToolShape};
use proptest::prelude::*;

/// A cut: index of the tool, start and end in µm as X and Z; X is a radius.
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

/// Converts micrometres to a point in mm.
fn point((x, z): (i32, i32)) -> Point {
    Point::new(f64::from(x) / 1000.0, f64::from(z) / 1000.0)
}

fn bar() -> Region {
    let corner = |z: f64, x: f64| GridPoint::new(grid(z), grid(x));
    Region::rectangle(corner(-50.0, 0.0), corner(0.0, 20.0))
}

fn cut(part: &mut TurnedPart, (tool, from, to): &Cut) {
    let shape = ToolShape::from_tool(&tools()[*tool]);
    part.cut(&shape.cutting, point(*from), point(*to));
}

fn mirrored(contour: &[GridPoint]) -> Vec<GridPoint> {
    let flipped = contour.iter().map(|it| GridPoint::new(-it.x, it.y));
    flipped.rev().collect()
}

/// The area that belongs to exactly one of two regions, mm².
fn difference(a: &Region, b: &Region) -> f64 {
    a.difference(b.contours()).area() + b.difference(a.contours()).area()
}

fn cuts() -> impl Strategy<Value = Vec<Cut>> {
    let position = || (500..22_000, -45_000..3_000);
    proptest::collection::vec((0..4_usize, position(), position()), 1..12)
}

/// Greatest area lost by rounding, mm²: half a grid unit in each direction at each
/// crossing, along a metre of edges.
const ROUNDING: f64 = 0.05;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn the_order_of_cuts_does_not_matter(cuts in cuts()) {
        let mut forward = TurnedPart::new(&bar());
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
    fn no_cut_adds_material(cuts in cuts()) {
        let mut part = TurnedPart::new(&bar());
        let mut before = part.section();
        for one in &cuts {
            cut(&mut part, one);
            let after = part.section();
            let grown = after.difference(before.contours()).area();
            prop_assert!(grown < ROUNDING / 10.0, "{grown} mm²");
            prop_assert!(part.volume() >= 0.0);
            before = after;
        }
    }

    #[test]
    fn a_path_cut_in_one_sweep_equals_its_lines_cut_one_by_one(
        tool in 0..4_usize,
        path in proptest::collection::vec((500..22_000, -45_000..3_000), 1..12),
        there_and_back in proptest::bool::ANY,
    ) {
        let mut path: Vec<(i32, i32)> = path;
        if there_and_back {
            path.extend(path.clone().iter().rev().skip(1));
        }
        let mut pieces = TurnedPart::new(&bar());
        let mut whole = pieces.clone();
        cut(&mut pieces, &(tool, path[0], path[0]));
        for pair in path.windows(2) {
            cut(&mut pieces, &(tool, pair[0], pair[1]));
        }
        let path: Vec<GridPoint> = path.iter().map(|at| to_grid(point(*at))).collect();
        whole.cut_along(&ToolShape::from_tool(&tools()[tool]).cutting, &path);
        let off = difference(&pieces.section(), &whole.section());
        prop_assert!(off < ROUNDING, "{off} mm²");
    }

    #[test]
    fn an_arc_cut_in_one_sweep_equals_its_chords_cut_one_by_one(
        tool in 0..4_usize,
        center in (2_000..22_000, -45_000..3_000),
        radius in 200..3_000,
        turns in (0.0..1.0_f64, -1.0..1.0_f64),
    ) {
        let arc = PlaneArc {
            center: point(center),
            radius: f64::from(radius) / 1000.0,
            begin: turns.0 * core::f64::consts::TAU,
            sweep: turns.1 * core::f64::consts::TAU,
        };
        let points: Vec<Point> = arc.points().collect();
        let shape = ToolShape::from_tool(&tools()[tool]);
        let mut pieces = TurnedPart::new(&bar());
        let mut whole = pieces.clone();
        let path: Vec<GridPoint> = points.iter().map(|at| to_grid(*at)).collect();
        for pair in path.windows(2) {
            pieces.cut_along(&shape.cutting, pair);
        }
        whole.cut_along(&shape.cutting, &path);
        let off = difference(&pieces.section(), &whole.section());
        // The crossings of each chord are rounded separately.
        prop_assert!(off < 2.0 * ROUNDING, "{off} mm²");
    }

    #[test]
    fn a_mirrored_cut_leaves_the_mirrored_part(cuts in cuts()) {
        let mut part = TurnedPart::new(&bar());
        let flipped: Vec<_> = bar().contours().iter().map(|it| mirrored(it)).collect();
        let mut image = TurnedPart::new(&Region::from_contours(&flipped));
        for one in &cuts {
            cut(&mut part, one);
            let shape = mirrored(&ToolShape::from_tool(&tools()[one.0]).cutting);
            let flip = |(x, z): (i32, i32)| point((x, -z));
            image.cut(&shape, flip(one.1), flip(one.2));
        }
        let back: Vec<_> = image.section().contours().iter().map(|it| mirrored(it)).collect();
        let off = difference(&part.section(), &Region::from_contours(&back));
        prop_assert!(off < ROUNDING, "{off} mm²");
    }
}

/// Regression test: the edges of these parts almost coincide. A wrong difference of them
/// had an edge through the solid part.
#[test]
fn the_difference_of_almost_equal_parts_is_almost_empty() {
    let cuts = [
        (2, (8056, -7574), (6832, -23885)),
        (0, (11942, -5715), (11417, -21898)),
    ];
    let mut forward = TurnedPart::new(&bar());
    let mut backward = forward.clone();
    for (one, other) in cuts.iter().zip(cuts.iter().rev()) {
        cut(&mut forward, one);
        cut(&mut backward, other);
    }
    let off = difference(&forward.section(), &backward.section());
    assert!(off < 1e-3, "{off} mm²");
}
