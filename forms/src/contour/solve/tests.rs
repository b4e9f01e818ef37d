//! Outlines whose ends follow from two conditions, and those that have no solution.

use super::*;

fn solve(text: &str) -> OutlineSolution {
    TurnedOutline::parse(text).unwrap().solve(1.0)
}

/// Diameter and Z of the ends, in thousandths.
fn ends(text: &str) -> Vec<(i64, i64)> {
    let solution = solve(text);
    assert_eq!(solution.fault, None, "{text}");
    let ends = solution.pieces.iter().map(|it| it.piece.end);
    let round = |value: f64| (value * 1000.0).round() as i64;
    ends.map(|end| (round(end.x * 2.0), round(end.z))).collect()
}

/// The greatest angle between two pieces in succession, radians.
fn greatest_turn(text: &str) -> f64 {
    let pieces = solve(text).pieces;
    let turns = pieces.windows(2).map(|pair| {
        let (one, two) = (&pair[0].piece, &pair[1].piece);
        let (one, two) = (one.direction_at(1.0), two.direction_at(0.0));
        atan2(one.cross(two), one.dot(two)).abs()
    });
    turns.fold(0.0, f64::max)
}

#[test]
fn ends_follow_from_the_point_before() {
    assert_eq!(
        ends("X20/L20/X30A45/Z-40/X40"),
        [
            (20_000, -20_000),
            (30_000, -25_000),
            (30_000, -40_000),
            (40_000, -40_000)
        ]
    );
    assert_eq!(ends("X20/Z-10A-30"), [(8_453, -10_000)]);
    assert_eq!(ends("X20/X30Z-5CW5"), [(30_000, -5_000)]);
    let inside = TurnedOutline::parse("X40/Z-10A45").unwrap().solve(-1.0);
    assert!((inside.pieces[0].piece.end.x - 10.0).abs() < 1e-9);
}

#[test]
fn tangent_arcs_end_at_one_condition() {
    // A quarter from a face into a cylinder and on to another face.
    let quarter = "X10/X20/CCW5TZ-5/TZ-12";
    assert_eq!(ends(quarter)[1..], [(30_000, -5_000), (30_000, -12_000)]);
    assert!(greatest_turn(quarter) < 1e-9);
    assert_eq!(ends("X20/Z-10/CW5TX30")[1], (30_000, -15_000));
    assert_eq!(ends("X20/Z-10/CW5TA90")[1], (30_000, -15_000));
    assert_eq!(ends("X20/Z-10/CWTX30Z-15")[1], (30_000, -15_000));
    let cone = "X20/Z-10/CW8TA30/TX40";
    assert!(greatest_turn(cone) < 1e-9);
    // 8 (1 - cos 30) = 1.0718 rise, 8 sin 30 = 4 run.
    assert_eq!(ends(cone)[1], (22_144, -14_000));
}

#[test]
fn open_ends_are_closed_by_the_next_point() {
    // Both lines with angles: they meet at X20.
    assert_eq!(
        ends("X20/A0/X40Z-30A45"),
        [(20_000, -20_000), (40_000, -30_000)]
    );
    for text in [
        "X20/Z-5/A0/CW8TX50Z-30",
        "X20/Z-5/CW8T/X50A30",
        "X20/Z-5/CW8T/X50A30Z-30/X60",
        "X20/Z-5/CW8T/TX50Z-30",
        "X20/Z-5/CW8T/CCW6TX50Z-15",
        "X20/Z-5/CCW12T/CW6TX10Z-20",
        "X0/X2/CCW6T/CCW20TX22Z-15",
    ] {
        let solution = solve(text);
        if text.contains("A30Z-30") {
            assert!(solution.fault.is_some(), "{text}: too much");
            continue;
        }
        assert_eq!(solution.fault, None, "{text}");
        assert!(greatest_turn(text) < 1e-7, "{text}: {solution:?}");
        let last = solution.pieces.last().unwrap().piece.end;
        let first = solution.pieces[0].piece.start;
        assert_ne!(last, first);
    }
    let end = solve("X20/Z-5/CW8T/CCW6TX50Z-15").pieces[2].piece.end;
    assert!((end - Point::new(25.0, -15.0)).length() < 1e-9);
}

#[test]
fn points_that_say_too_little_or_too_much_are_named() {
    for (text, wanted, solved) in [
        ("X20", "form_points_too_few", 0),
        ("Z0;X5", "form_point_first", 0),
        ("X20;X30Z-5A20", "form_point_over", 0),
        ("X20;Z-5;R2", "form_point_missing", 1),
        ("X20;X30A91", "form_point_angle", 0),
        ("X20;X30A0", "form_point_angle", 0),
        ("X20;L5Z-5", "form_point_z_and_l", 0),
        ("X20;A30", "form_point_missing", 0),
        ("X20;A30;X40", "form_point_not_closed", 0),
        ("X20;A30;X40Z20A40", "form_point_unsolvable", 0),
        ("X20;X40Z-5CW5", "form_point_unsolvable", 0),
        ("X20;X30Z-5CW", "form_point_arc_missing", 0),
        ("X20;CW5TZ-5", "form_point_no_tangent", 0),
        ("X20;Z-5;CW5TZ-15", "form_point_unsolvable", 1),
        ("X20;Z-5;CW5TX30Z-10", "form_point_over", 1),
        ("X20;Z-5;CCWTX30Z-15", "form_point_unsolvable", 1),
        ("X20;Z-5;CW5T;Z-20", "form_point_not_closed", 1),
        ("X20;X20", "form_point_unsolvable", 0),
    ] {
        let solution = solve(text);
        let fault = solution.fault.as_ref().map(|fault| fault.id().name());
        assert_eq!(fault, Some(wanted), "{text}");
        assert_eq!(solution.pieces.len(), solved, "{text}");
    }
}
