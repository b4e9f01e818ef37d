//! Properties of the roughing cycles over random profiles, checked by a sweep that is
//! independent of the cycles.
//!
//! ```text
//!   part + allowance = everything below the shifted contour
//!   1 no cut reaches into it
//!   2 before the contour pass nothing above it is thicker than the depth of cut
//! ```

use std::fmt::Write;

use proptest::prelude::*;

use super::InterpreterBench;
use crate::command::Action;
use crate::units::Point;

/// A random step of a profile: distance along the cut and distance back in depth, in
/// thousandths of a millimetre, and the kind of arc or line.
#[derive(Clone, Copy, Debug)]
struct ProfileLeg {
    along: i64,
    back: i64,
    arc: u8,
}

fn legs() -> impl Strategy<Value = Vec<ProfileLeg>> {
    let leg = (0_i64..9_000, 0_i64..9_000, 0_u8..4).prop_map(|(along, back, arc)| ProfileLeg {
        // Some legs are walls, some straight stretches.
        along: if along < 1_000 { 0 } else { along },
        back: if back < 1_000 { 0 } else { back },
        arc,
    });
    prop::collection::vec(leg, 1..12)
}

/// Appends a line, or an arc about `center` as 200 chords, to the points `out` (X as a
/// radius). The `bool` is whether the arc is clockwise.
fn chords(from: Point, to: Point, center: Option<(Point, bool)>, out: &mut Vec<Point>) {
    let Some((center, clockwise)) = center else {
        out.push(to);
        return;
    };
    let (a, b) = (from - center, to - center);
    let (start, mut sweep) = (
        libm::atan2(a.x, a.z),
        libm::atan2(b.x, b.z) - libm::atan2(a.x, a.z),
    );
    if clockwise && sweep > 0.0 {
        sweep -= core::f64::consts::TAU;
    } else if !clockwise && sweep < 0.0 {
        sweep += core::f64::consts::TAU;
    }
    let radius = a.length();
    for part in 1..=200 {
        let angle = start + sweep * f64::from(part) / 200.0;
        out.push(center + Point::new(radius * libm::sin(angle), radius * libm::cos(angle)));
    }
}

/// Least and greatest height (radius) of a chain of chords at position `along`; they differ at
/// a wall. `None` outside the chain.
fn heights(chain: &[Point], along: f64) -> Option<(f64, f64)> {
    let mut range: Option<(f64, f64)> = None;
    for pair in chain.windows(2) {
        let (low, high) = (pair[0].z.min(pair[1].z), pair[0].z.max(pair[1].z));
        if along < low || along > high {
            continue;
        }
        let ends = if high - low < 1e-12 {
            [pair[0].x, pair[1].x]
        } else {
            let share = (along - pair[0].z) / (pair[1].z - pair[0].z);
            [pair[0].x + (pair[1].x - pair[0].x) * share; 2]
        };
        for x in ends {
            let (least, most) = range.unwrap_or((x, x));
            range = Some((least.min(x), most.max(x)));
        }
    }
    range
}

struct RoughingCase {
    text: String,
    start: (f64, f64),
    facing: bool,
    /// +1 for an outer contour, with the part below, -1 for an inner one.
    side: f64,
    /// Direction of the cut along its axis, +1 or -1.
    cut_direction: f64,
}

/// Builds a roughing program whose profile leads from its deepest point back to the start.
fn build_case(
    legs: &[ProfileLeg],
    quadrant: u8,
    facing: bool,
    cut: i64,
    escape: i64,
) -> RoughingCase {
    let side = if quadrant & 1 == 0 { 1 } else { -1 };
    let cut_direction = if quadrant & 2 == 0 { -1 } else { 1 };
    let total_depth: i64 = legs.iter().map(|leg| leg.back).sum::<i64>() + 2_500;
    let mm = |value: i64| {
        let sign = if value < 0 { "-" } else { "" };
        format!("{sign}{}.{:03}", value.abs() / 1000, value.abs() % 1000)
    };
    // X is written as a diameter, so depths double there.
    let word = |depth: i64, along: i64| {
        let (depth, along) = (-side * depth, cut_direction * along);
        if facing {
            (
                format!("Z{}", mm(depth)),
                format!("X{}", mm(300_000 + 2 * along)),
            )
        } else {
            (
                format!("X{}", mm(300_000 + 2 * depth)),
                format!("Z{}", mm(along)),
            )
        }
    };
    let mut text = String::new();
    let code = if facing { "G72" } else { "G71" };
    let name = if facing { 'W' } else { 'U' };
    let (u, w) = if facing {
        (-cut_direction * 300, side * 200)
    } else {
        (side * 300, -cut_direction * 200)
    };
    writeln!(text, "{code} {name}{} R{} F100;", mm(cut), mm(escape)).unwrap();
    writeln!(text, "{code} P1 Q99 U{} W{};", mm(u), mm(w)).unwrap();
    let (mut depth, mut along) = (total_depth, 0);
    writeln!(text, "N1 G00 {};", word(depth, along).0).unwrap();
    for (index, leg) in legs.iter().enumerate() {
        // The last leg has a length.
        let last = index + 1 == legs.len();
        let step = if last {
            leg.along.max(1_000)
        } else {
            leg.along
        };
        (depth, along) = (depth - leg.back, along + step);
        let (first, second) = word(depth, along);
        let number = if last { "N99 " } else { "" };
        // A quarter circle where both distances are equal, a flatter arc elsewhere.
        let radius = if leg.arc == 3 && leg.back > 0 && step > 0 {
            let (a, b) = (leg.back as f64, step as f64);
            // The smallest radius that stays within a quadrant.
            let least = (a * a + b * b) / (2.0 * a.min(b));
            Some(least.ceil() as i64 + 1)
        } else if (1..3).contains(&leg.arc) && leg.back > 0 && step > 0 {
            let (a, b) = (leg.back as f64, step as f64);
            Some(((a * a + b * b) / (2.0 * a.min(b))).ceil() as i64 + 5_000)
        } else {
            None
        };
        match radius {
            Some(radius) => {
                let turn = if leg.arc & 1 == 0 { 2 } else { 3 };
                writeln!(text, "{number}G0{turn} {first} {second} R{};", mm(radius)).unwrap();
            }
            None => writeln!(text, "{number}G01 {first} {second};").unwrap(),
        }
    }
    RoughingCase {
        text,
        start: (300.0, 0.0),
        facing,
        side: side as f64,
        cut_direction: cut_direction as f64,
    }
}

/// Converts a machine point to its depth (negative away from the start) and its position along
/// the cut, mm.
fn to_case_plane(case: &RoughingCase, point: Point) -> Point {
    let (x, z) = (point.x - case.start.0 / 2.0, point.z - case.start.1);
    let (depth, along) = if case.facing { (z, x) } else { (x, z) };
    Point::new(depth * case.side, along * case.cut_direction)
}

fn check_case(case: &RoughingCase, cut: f64) -> Result<(), TestCaseError> {
    let mut bench = InterpreterBench::at(case.start.0, case.start.1);
    bench.open(&case.text);
    let mut at = bench.machine;
    let (commands, alarm) = bench.run_to_end();
    prop_assert_eq!(alarm, None, "{}", case.text);
    let mut moves = Vec::new();
    for command in &commands {
        let (to, center) = match command.action {
            Action::Rapid { to } | Action::Line { to, .. } => (to, None),
            Action::Arc {
                to,
                center,
                clockwise,
                ..
            } => (to, Some((center, clockwise))),
            _ => continue,
        };
        let mut chain = vec![at];
        chords(at, to, center, &mut chain);
        let chain: Vec<_> = chain
            .into_iter()
            .map(|point| to_case_plane(case, point))
            .collect();
        moves.push((matches!(command.action, Action::Rapid { .. }), chain));
        at = to;
    }
    // The contour pass is the last unbroken row of cuts.
    let home = moves.pop();
    prop_assert!(home.is_some_and(|(rapid, _)| rapid));
    let begin = moves.iter().rposition(|(rapid, _)| *rapid).unwrap_or(0) + 1;
    let mut contour: Vec<Point> = Vec::new();
    for (_, chain) in moves.split_off(begin) {
        contour.extend(chain);
    }
    prop_assert!(contour.len() > 1);

    // 1: levels, escapes and rapids stay above the contour pass.
    const ROUNDED: f64 = 0.0006;
    for (_, chain) in &moves {
        for pair in chain.windows(2) {
            for part in 0..=20 {
                let point = pair[0] + (pair[1] - pair[0]) * (f64::from(part) / 20.0);
                // Slightly before the end along, because intersections are rounded.
                if let Some((least, _)) = heights(&contour, point.z - ROUNDED) {
                    prop_assert!(
                        point.x >= least - ROUNDED,
                        "{point:?} beneath {least} in\n{}",
                        case.text
                    );
                }
            }
        }
    }

    // 2: the rest that the levels leave above the contour.
    let end = contour[contour.len() - 1].z;
    let first = contour[0].z;
    let top = moves[0].1[1].x;
    let levels: Vec<_> = moves
        .iter()
        .filter(|(rapid, chain)| !rapid && (chain[1].x - chain[0].x).abs() < 1e-9)
        .map(|(_, chain)| (chain[0].x, chain[0].z, chain[1].z))
        .collect();
    for part in 1..400 {
        let along = first + (end - first) * f64::from(part) / 400.0;
        let Some((_, part_top)) = heights(&contour, along) else {
            continue;
        };
        let reached = levels
            .iter()
            .filter(|(_, begin, stop)| along >= *begin - 1e-9 && along <= *stop + ROUNDED)
            .map(|(level, ..)| *level)
            .fold(top, f64::min);
        prop_assert!(
            reached - part_top <= cut + 0.002,
            "{reached} above {part_top} at {along} in\n{}",
            case.text
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn roughing_leaves_the_part_and_little_above_it(
        legs in legs(), quadrant in 0_u8..4, facing: bool,
        cut in 300_i64..5_000, escape in 0_i64..2_000,
    ) {
        let case = build_case(&legs, quadrant, facing, cut, escape);
        check_case(&case, cut as f64 / 1000.0)?;
    }

    #[test]
    fn cycles_of_any_words_end_or_alarm(
        words in "G7[0-6]( [XZUWRPQFIJK]-?[0-9]{1,5}(\\.[0-9])?){0,7}",
        more in "G(71|72|73|74|75|76|92)( [XZUWRPQFIJKL]-?[0-9]{1,4}){1,7}",
    ) {
        let text = format!("F1;\n{words};\n{more};\nG71 U3 R1;\nG73 U1 W1 R3;\n{words} P1 Q2;\n{more} P1 Q2;\nN1 G00 X20;\nN2 G01 Z-5;\n");
        let mut bench = InterpreterBench::at(50.0, 2.0);
        bench.open(&text);
        let (commands, _) = bench.run_to_end();
        for command in commands {
            if let Some(to) = super::target(&command.action) {
                prop_assert!(to.length().is_finite());
            }
        }
    }
}
