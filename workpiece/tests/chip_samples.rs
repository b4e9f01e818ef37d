//! The chip of a tool in a real part, against the formulas of straight edges.

use gsk_units::Point;
use gsk_workpiece::cutting::ChipSample;
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::scene::{LatheScene, SceneTool};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::{Holder, Insert, InsertLetter, Tool, ToolShape};

fn samples(
    tool: &Tool,
    kind: MotionKind,
    from: (f64, f64),
    to: (f64, f64),
    feed: f64,
) -> Vec<ChipSample> {
    let scene = LatheScene::new(&Stock::bar(50.0, 0.0, 60.0));
    let motion = ToolMotion {
        from: Point::new(from.0, from.1),
        to: Point::new(to.0, to.1),
        kind,
        turning: true,
        by_hand: false,
    };
    let tool = SceneTool::new(ToolShape::from_tool(tool));
    scene.chip_samples(&tool, &motion, feed)
}

fn square(entering: f64) -> Tool {
    Tool {
        insert: Insert::Turning {
            letter: InsertLetter::S,
            entering,
            size: 12.7,
            nose: 0.0,
        },
        tip: 3,
        holder: Holder::None,
    }
}

#[track_caller]
fn assert_near(computed: f64, expected: f64) {
    assert!(
        (computed - expected).abs() < 2e-4 * expected.abs().max(1.0),
        "{computed} instead of {expected}"
    );
}

#[test]
fn a_straight_edge_has_the_chip_of_the_formula() {
    for (entering, depth) in [(45.0f64, 3.0), (75.0, 2.5), (90.0, 4.0)] {
        let x = 25.0 - depth;
        let line = samples(
            &square(entering),
            MotionKind::Line,
            (x, -2.0),
            (x, -40.0),
            0.25,
        );
        assert!(line.len() >= 60, "{}", line.len());
        for sample in &line {
            let sine = libm::sin(entering.to_radians());
            assert_near(sample.chip.area_mm2, depth * 0.25);
            assert_near(sample.chip.width_mm, depth / sine);
            assert_near(sample.chip.thickness_mm(), 0.25 * sine);
            assert_near(sample.outer_radius_mm, 25.0);
            assert_near(sample.mean_radius_mm, 25.0 - depth / 2.0);
            // The chip presses at right angles to the edge: along the feed and outwards.
            let cosine = libm::cos(entering.to_radians());
            assert_near(sample.into_material.dot(sample.feed), sine);
            assert_near(-sample.into_material.x, cosine);
        }
    }
}

#[test]
fn a_nose_changes_the_width_and_not_the_area() {
    let line = samples(
        &Tool::turning(),
        MotionKind::Line,
        (23.0, -2.0),
        (23.0, -40.0),
        0.3,
    );
    for sample in &line {
        assert_near(sample.chip.area_mm2, 2.0 * 0.3);
        // A quarter of the nose is longer than the corner that it cuts off.
        assert!(
            sample.chip.width_mm > 2.0 && sample.chip.width_mm < 2.6,
            "{sample:?}"
        );
    }
}

#[test]
fn a_groove_cuts_with_its_width() {
    let line = samples(
        &Tool::grooving(3.0),
        MotionKind::Line,
        (24.5, -20.0),
        (10.0, -20.0),
        0.1,
    );
    let deepest = line.last().expect("cuts");
    assert_near(deepest.chip.area_mm2, 0.3);
    assert!(deepest.chip.thickness_mm() > 0.09 && deepest.chip.thickness_mm() <= 0.1);
    assert!(deepest.outer_radius_mm < 10.5, "{deepest:?}");
}

#[test]
fn a_lip_of_a_drill_cuts_from_the_axis_to_its_radius() {
    let line = samples(
        &Tool::drill(20.0),
        MotionKind::Line,
        (0.0, -10.0),
        (0.0, -30.0),
        0.15,
    );
    for sample in &line {
        assert_near(sample.chip.area_mm2, 10.0 * 0.15);
        assert_near(sample.mean_radius_mm, 5.0);
        assert_near(
            sample.chip.thickness_mm(),
            0.15 * libm::sin(59f64.to_radians()),
        );
    }
}

#[test]
fn a_move_in_the_air_and_a_rapid_have_no_chip() {
    let air = samples(
        &square(75.0),
        MotionKind::Line,
        (25.5, 2.0),
        (25.5, -40.0),
        0.25,
    );
    assert!(air.is_empty());
    let rapid = samples(
        &square(75.0),
        MotionKind::Rapid,
        (20.0, 2.0),
        (20.0, -40.0),
        0.25,
    );
    assert!(rapid.is_empty());
}

#[test]
fn the_area_along_an_arc_adds_up_to_what_the_cut_removes() {
    let tool = SceneTool::new(ToolShape::from_tool(&Tool::turning()));
    let mut scene = LatheScene::new(&Stock::bar(50.0, 0.0, 60.0));
    let motion = |kind, from, to| ToolMotion {
        from,
        to,
        kind,
        turning: true,
        by_hand: false,
    };
    let (begin, end) = (Point::new(15.0, -10.0), Point::new(25.0, -20.0));
    scene.move_tool(&tool, &motion(MotionKind::Line, begin, begin));
    let arc = MotionKind::Arc {
        center: Point::new(15.0, -20.0),
        clockwise: false,
    };
    let arc = motion(arc, begin, end);
    // With a feed of 1 mm the area of a chip is that of 1 mm of the path.
    let sampled = scene.chip_samples(&tool, &arc, 1.0);
    let (length, count) = (10.0 * core::f64::consts::FRAC_PI_2, 32.0);
    let areas = sampled.iter().map(|it| it.chip.area_mm2);
    let swept = areas.sum::<f64>() * length / count;
    let removed = scene.move_tool(&tool, &arc).removed.area;
    assert!((swept / removed - 1.0).abs() < 0.02, "{swept} of {removed}");
}
