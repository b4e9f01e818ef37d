//! Tangent contours as CAM systems write them: arcs with rounded I and K. A contour that
//! runs with R runs with I and K, and the nose stays outside the part.

use std::fmt::Write;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use super::cases::run_with_nose;
use super::clearance::{ProfileSurface, deepest_cut, mm};
use crate::memory::ToolOffset;
use crate::units::Point;

/// Greatest permitted depth to which the nose cuts into the contour, mm.
const TOLERANCE: f64 = 0.001;
/// Alarms that an arc raises without compensation: its ends are farther apart than its
/// diameter, or its end is too far from its circle.
const OWN_LIMITS: [u16; 2] = [13, 48];
/// The greatest change of radius along an arc, mm, with which the control keeps its centre.
const FIT: f64 = 0.002;

/// An element of a random contour: a line of a length, or an arc that ends in a direction,
/// with a radius or as large as the nose.
#[derive(Clone, Copy, Debug)]
enum ContourStep {
    Line(f64),
    Arc { to: f64, radius: Option<f64> },
}

/// An element with its programmed end and centre, X as a radius.
#[derive(Clone, Copy, Debug)]
struct ContourElement {
    to: Point,
    /// Centre of an arc from the rounded I and K, whether the arc is clockwise, and R, mm.
    arc: Option<(Point, bool, f64)>,
}

fn round_to_grid(value: f64, grid: f64) -> f64 {
    (value / grid).round() * grid
}

/// Rounds a point to the least increment of the axes.
fn round_point(point: Point) -> Point {
    Point::new(
        round_to_grid(point.x, 0.0005),
        round_to_grid(point.z, 0.001),
    )
}

/// The centre with which the control runs an arc whose programmed centre is `center`.
fn used_center(from: Point, to: Point, center: Point) -> Point {
    let radius = (from - center).length();
    let chord = to - from;
    let square = radius * radius - chord.length() * chord.length() / 4.0;
    if ((to - center).length() - radius).abs() <= FIT || square < 0.0 {
        return center;
    }
    let middle = (from + to) * 0.5;
    let across = Point::new(chord.z, -chord.x) * (square.sqrt() / chord.length());
    let (one, other) = (middle + across, middle - across);
    if (one - center).length() <= (other - center).length() {
        one
    } else {
        other
    }
}

/// The start and the elements of a contour whose centres are on a grid of `grid`, mm.
fn contour_elements(steps: &[ContourStep], nose: f64, grid: f64) -> (Point, Vec<ContourElement>) {
    let first = Point::new(20.0, 0.0);
    let (mut at, mut heading, mut from) = (first, 0.0_f64, first);
    let mut pieces = Vec::new();
    for step in steps {
        let normal = |heading: f64| Point::new(libm::cos(heading), libm::sin(heading));
        let arc = match *step {
            ContourStep::Line(length) => {
                at = at + Point::new(libm::sin(heading), -libm::cos(heading)) * length;
                None
            }
            ContourStep::Arc { to, .. } if (to - heading).abs() < 0.05 => continue,
            ContourStep::Arc { to, radius } => {
                // An inner arc turns towards the nose, an outer one away from it.
                let inner = to > heading;
                let radius = match radius {
                    Some(more) if inner => nose + more,
                    Some(more) => more,
                    None => nose,
                };
                if grid > 0.001 && radius * (to - heading).abs() < 100.0 * grid {
                    continue;
                }
                let arm = if inner { radius } else { -radius };
                let center = at + normal(heading) * arm;
                at = center - normal(to) * arm;
                heading = to;
                let i_k = round_point(center) - from;
                let center =
                    from + Point::new(round_to_grid(i_k.x, grid), round_to_grid(i_k.z, grid));
                Some((center, inner, round_to_grid(radius, 0.001)))
            }
        };
        from = round_point(at);
        pieces.push(ContourElement { to: from, arc });
    }
    (first, pieces)
}

fn contour_program(first: Point, pieces: &[ContourElement], with_r: bool) -> String {
    let word = |value: f64| mm((value * 1000.0).round() as i64);
    let mut text = format!("T0101 F100\nG42 G00 X{} Z5\nZ0\n", word(2.0 * first.x));
    let mut from = first;
    for piece in pieces {
        let to = piece.to;
        let (x, z) = (word(2.0 * to.x), word(to.z));
        match piece.arc {
            None => writeln!(text, "G01 X{x} Z{z}").unwrap(),
            Some((center, clockwise, radius)) => {
                let (g, arm) = (if clockwise { 2 } else { 3 }, center - from);
                let about = if with_r {
                    format!("R{}", word(radius))
                } else {
                    format!("I{} K{}", word(arm.x), word(arm.z))
                };
                writeln!(text, "G0{g} X{x} Z{z} {about}").unwrap();
            }
        }
        from = to;
    }
    let (x, z) = (word(2.0 * from.x + 40.0), word(from.z - 4.0));
    writeln!(text, "G40 G00 X{x} Z{z}").unwrap();
    text
}

fn steps() -> impl Strategy<Value = Vec<ContourStep>> {
    let line = (0.1_f64..8.0).prop_map(ContourStep::Line);
    let radius = prop_oneof![
        1 => Just(None),
        2 => (-1.6_f64..3.5).prop_map(|power| Some(libm::exp(power))),
    ];
    let arc = (-1.3_f64..1.3, radius).prop_map(|(to, radius)| ContourStep::Arc { to, radius });
    prop::collection::vec((line, arc), 1..5).prop_map(|pairs| {
        let mut steps: Vec<ContourStep> = pairs
            .into_iter()
            .flat_map(|(line, arc)| [line, arc])
            .collect();
        steps.push(ContourStep::Line(6.0));
        steps
    })
}

fn noses() -> impl Strategy<Value = ToolOffset> {
    prop::sample::select(vec![0.2, 0.4, 0.8, 1.2]).prop_map(|r| ToolOffset {
        r,
        t: 3,
        ..ToolOffset::default()
    })
}

fn check_runs_as_with_r(
    steps: &[ContourStep],
    nose: ToolOffset,
    grid: f64,
) -> Result<(), TestCaseError> {
    let (first, pieces) = contour_elements(steps, nose.r, grid);
    let start = Point::new(40.0, 15.0);
    let text = contour_program(first, &pieces, false);
    let (moves, preview) = run_with_nose(&text, nose, start);
    if let Some(alarm) = &preview.alarm {
        let fits = run_with_nose(&contour_program(first, &pieces, true), nose, start)
            .1
            .alarm
            .is_none();
        prop_assert!(
            OWN_LIMITS.contains(&alarm.number) || !fits,
            "{} nose {} {}",
            alarm.line_text(),
            nose.r,
            text
        );
        return Ok(());
    }
    let mut from = first;
    let surface: Vec<ProfileSurface> = pieces
        .iter()
        .map(|piece| {
            let (start, to) = (core::mem::replace(&mut from, piece.to), piece.to);
            ProfileSurface {
                from: start,
                to,
                about: piece
                    .arc
                    .map(|(center, clockwise, _)| (used_center(start, to, center), clockwise)),
            }
        })
        .collect();
    let (deep, position) = deepest_cut(&surface, &moves, nose, 4..=3 + pieces.len() as u32);
    prop_assert!(
        deep <= TOLERANCE,
        "{} deep, {:?} {} {}",
        deep,
        nose,
        position,
        text
    );
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 250, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn centres_on_a_thousandth(steps in steps(), nose in noses()) {
        check_runs_as_with_r(&steps, nose, 0.001)?;
    }

    #[test]
    fn centres_on_a_hundredth(steps in steps(), nose in noses()) {
        // Coarser centres need coarser contours: no arc that the nose barely fits into.
        let steps: Vec<ContourStep> = steps
            .into_iter()
            .map(|step| match step {
                ContourStep::Arc { to, radius } => ContourStep::Arc { to, radius: radius.or(Some(0.1)) },
                line => line,
            })
            .collect();
        check_runs_as_with_r(&steps, nose, 0.01)?;
    }
}

/// Number of random contours: the environment variable `NOSE_CONTOURS`, e.g. 20000 for the
/// full test.
fn contour_count() -> usize {
    std::env::var("NOSE_CONTOURS").map_or(300, |count| count.parse().unwrap())
}

/// Each contour that runs with R also runs with rounded centres.
#[test]
fn contours_with_r_run_with_rounded_centres() {
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(ProptestConfig::default(), rng);
    let contour = (steps(), noses());
    let mut faults = Vec::new();
    for _ in 0..contour_count() {
        let (steps, nose) = contour.new_tree(&mut runner).unwrap().current();
        if let Err(fault) = check_runs_as_with_r(&steps, nose, 0.001) {
            faults.push(fault.to_string());
        }
    }
    let first = faults.iter().take(3).cloned().collect::<Vec<_>>();
    assert!(
        faults.is_empty(),
        "{} of {}: {}",
        faults.len(),
        contour_count(),
        first.join("\n")
    );
}

/// A line of 0.1 mm between an inner arc and one as large as the nose.
#[test]
fn a_short_line_between_inner_arcs_runs() {
    let text = "T0101 F100\nG42 G00 X40 Z5\nZ0\nG01 X40 Z-5.763\n\
                G02 X41.135 Z-7.064 I1.777 K0\nG01 X41.282 Z-7.133\n\
                G02 X41.986 Z-7.359 I0.816 K0.880\nG01 X53.049 Z-9.684\n\
                G40 G00 X93.049 Z-13.684\n";
    let nose = ToolOffset {
        r: 1.2,
        t: 3,
        ..ToolOffset::default()
    };
    let (_, preview) = run_with_nose(text, nose, Point::new(40.0, 15.0));
    assert_eq!(preview.alarm.map(|alarm| alarm.line_text()), None);
}

/// A move that is turned more by rounding than its length allows, beside an arc of
/// hundredths of a millimetre or an inner arc as large as the nose.
#[test]
fn short_moves_beside_arcs_run() {
    let bore = |lines: &str| {
        format!("O0001\nT0101\nG00 X74.000 Z10.000\nG41 G01 X90.000 Z7.000 F200\nZ2.000\n{lines}")
    };
    for lines in [
        "G01 X90.000 Z0.715\nG02 X94.132 Z-3.471 I5.273 K0.000\nG01 X94.800 Z-3.727\n\
         G02 X94.812 Z-3.731 I0.224 K0.293\nG01 X107.160 Z-8.259\nG01 X116.837 Z-11.808\n\
         G40 G00 X56.837 Z-14.208\nM30\n",
        "G01 X90.000 Z-3.149\nG03 X88.826 Z-4.180 I-1.200 K0.000\nG01 X88.606 Z-4.246\n\
         G01 X78.291 Z-7.312\nG40 G00 X18.291 Z-9.712\nM30\n",
    ] {
        let nose = ToolOffset {
            r: 1.2,
            t: 2,
            ..ToolOffset::default()
        };
        let (_, preview) = run_with_nose(&bore(lines), nose, Point::new(50.0, 20.0));
        let alarm = preview.alarm.map(|alarm| alarm.line_text());
        assert_eq!(alarm, None, "{lines}");
    }
}
