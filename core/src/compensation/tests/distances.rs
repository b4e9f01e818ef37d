//! Compares the distance of curves with the least distance of sampled points.

use proptest::prelude::*;

use crate::compensation::clearance::{Curve, distance, is_closer_than};
use crate::compensation::segment::ContourSegment;
use crate::units::Point;

fn coordinate() -> impl Strategy<Value = f64> {
    (-5_000_i32..5_000).prop_map(|value| f64::from(value) / 1000.0)
}

fn point() -> impl Strategy<Value = Point> {
    (coordinate(), coordinate()).prop_map(|(x, z)| Point::new(x, z))
}

/// Generates random lines and arcs, for property tests.
fn piece() -> impl Strategy<Value = ContourSegment> {
    let line = (point(), point()).prop_filter_map("no length", |(from, to)| {
        ContourSegment::line(from, to).ok()
    });
    let arc = (
        point(),
        0.1_f64..4.0,
        0.0_f64..6.3,
        0.1_f64..6.2,
        any::<bool>(),
    );
    let arc = arc.prop_map(|(center, radius, from, sweep, clockwise)| {
        let at = |angle: f64| center + Point::new(libm::sin(angle), libm::cos(angle)) * radius;
        let to = if clockwise {
            from - sweep
        } else {
            from + sweep
        };
        ContourSegment::arc(at(from), at(to), center, clockwise).unwrap()
    });
    prop_oneof![line, arc]
}

fn points(piece: &ContourSegment) -> Vec<Point> {
    const COUNT: u32 = 400;
    let part = |index: u32| f64::from(index) / f64::from(COUNT);
    (0..=COUNT)
        .map(|index| match &piece.circle {
            None => piece.start + (piece.end - piece.start) * part(index),
            Some(circle) => {
                let arm = piece.start - circle.center;
                let turned = piece.sweep() * circle.turn * part(index);
                let (sine, cosine) = libm::sincos(turned);
                circle.center
                    + Point::new(arm.x * cosine + arm.z * sine, arm.z * cosine - arm.x * sine)
            }
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn distance_matches_sampled_points(a in piece(), b in piece()) {
        let exact = distance(&Curve::surface(&a), &Curve::surface(&b));
        let others = points(&b);
        let sampled = points(&a)
            .iter()
            .flat_map(|one| others.iter().map(|other| (*one - *other).length()))
            .fold(f64::MAX, f64::min);
        prop_assert!(exact <= sampled + 1e-9, "{} {}", exact, sampled);
        // Half the distance of neighbouring points on either curve.
        prop_assert!(sampled - exact <= 0.08, "{} {}", exact, sampled);
    }

    /// The quick checks with bounding boxes and sides of lines agree with `distance`.
    #[test]
    fn closeness_agrees_with_the_distance(a in piece(), b in piece(), least in 0.01_f64..3.0) {
        let (a, b) = (Curve::surface(&a), Curve::surface(&b));
        let between = distance(&a, &b);
        prop_assume!((between - least).abs() > 1e-9);
        prop_assert_eq!(is_closer_than(&a, &b, least), between < least, "{}", between);
        let near = is_closer_than(&a, &b, between + 1e-9);
        let far = is_closer_than(&a, &b, between - 1e-9);
        prop_assert!(near && !far, "{} {} {}", between, near, far);
    }
}
