//! Random profiles: the nose circle stays outside the part within 1 µm, or an alarm is
//! raised. The test has its own geometry of the part.

use std::fmt::Write;
use std::ops::RangeInclusive;

use proptest::prelude::*;

use super::cases::{run_with_nose, tip_vector};
use crate::command::{ExecutedMove, MoveKind};
use crate::memory::ToolOffset;
use crate::units::Point;

/// Greatest permitted depth to which the nose cuts into the surface, mm.
const TOLERANCE: f64 = 0.001;
/// Distance between sampled points on the nose path, mm.
const STEP: f64 = 0.02;

/// One element of a profile in thousandths of a millimetre, X as a radius.
#[derive(Clone, Copy, Debug)]
struct ProfileStep {
    dz: i64,
    dx: i64,
    /// Radius of an arc minus half its chord, in thousandths of a millimetre, and whether the
    /// arc is clockwise. `None` for a line.
    arc: Option<(i64, bool)>,
}

/// An element of the surface of the part: a line, or an arc about `about`.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProfileSurface {
    pub(super) from: Point,
    pub(super) to: Point,
    /// Centre of an arc, mm, and whether it is clockwise; `None` for a line.
    pub(super) about: Option<(Point, bool)>,
}

fn polar_angle(center: Point, point: Point) -> f64 {
    libm::atan2(point.x - center.x, point.z - center.z)
}

/// Angle of an arc about `center` from `from` to `to`, 0 to a full turn, rad.
fn swept(center: Point, from: Point, to: Point, clockwise: bool) -> f64 {
    use core::f64::consts::TAU;
    let difference = polar_angle(center, to) - polar_angle(center, from);
    (if clockwise { -difference } else { difference }).rem_euclid(TAU)
}

impl ProfileSurface {
    fn distance(&self, point: Point) -> f64 {
        let ends = (point - self.from).length().min((point - self.to).length());
        let between = match self.about {
            None => {
                let along = self.to - self.from;
                let arm = point - self.from;
                let length = along.length();
                let part = (arm.x * along.x + arm.z * along.z) / (length * length);
                (0.0..=1.0)
                    .contains(&part)
                    .then(|| (arm - along * part).length())
            }
            Some((center, clockwise)) => {
                let whole = swept(center, self.from, self.to, clockwise);
                let radius = (self.from - center).length();
                let growth = (self.to - center).length() - radius;
                let angle = swept(center, self.from, point, clockwise);
                (angle <= whole).then(|| {
                    let radius = radius + growth * (angle / whole);
                    ((point - center).length() - radius).abs()
                })
            }
        };
        between.map_or(ends, |between| between.min(ends))
    }
}

/// Points on the executed move `made`, [`STEP`] apart.
fn points(made: &ExecutedMove) -> Vec<Point> {
    let (from, to) = (made.from, made.to);
    let pieces = |length: f64| (length / STEP).ceil().max(1.0) as usize;
    let Some(center) = made.center else {
        let count = pieces((to - from).length());
        return (0..=count)
            .map(|index| from + (to - from) * (index as f64 / count as f64))
            .collect();
    };
    let clockwise = made.kind == MoveKind::Clockwise;
    let sweep = swept(center, from, to, clockwise);
    let radius = (from - center).length();
    let growth = (to - center).length() - radius;
    let count = pieces(sweep * radius);
    (0..=count)
        .map(|index| {
            let part = index as f64 / count as f64;
            let turn = if clockwise { -sweep } else { sweep } * part;
            let at = polar_angle(center, from) + turn;
            center + Point::new(libm::sin(at), libm::cos(at)) * (radius + growth * part)
        })
        .collect()
}

pub(super) fn mm(thousandths: i64) -> String {
    let sign = if thousandths < 0 { "-" } else { "" };
    format!(
        "{sign}{}.{:03}",
        thousandths.abs() / 1000,
        thousandths.abs() % 1000
    )
}

/// Radius, in thousandths of a millimetre, and centre, mm, of an arc of at most half a turn.
/// `more` is the radius minus half the chord.
fn arc_circle(from: Point, to: Point, more: i64, clockwise: bool) -> (i64, Point) {
    let chord = (to - from).length();
    let thousandths = (chord * 500.0).ceil() as i64 + more;
    let radius = thousandths as f64 / 1000.0;
    let height = (radius * radius - chord * chord / 4.0).max(0.0).sqrt();
    let along = (to - from) * (1.0 / chord);
    // To the right of the travel for G02, to the left for G03.
    let normal = Point::new(-along.z, along.x) * if clockwise { 1.0 } else { -1.0 };
    (thousandths, from + (to - from) * 0.5 + normal * height)
}

/// Whether an arc never moves away from the chuck: the surface is a function of Z.
fn is_monotonic(from: Point, to: Point, (more, clockwise): (i64, bool), left: bool) -> bool {
    let clockwise = clockwise != left;
    let (_, center) = arc_circle(from, to, more, clockwise);
    [from, to].iter().all(|end| {
        let arm = *end - center;
        if clockwise {
            arm.x <= 0.0
        } else {
            arm.x >= 0.0
        }
    })
}

/// The text of a program that cuts the profile `steps`, and the surface it cuts.
fn profile_program(steps: &[ProfileStep], left: bool) -> (String, Vec<ProfileSurface>) {
    let mut text = String::from("T0101 F100\n");
    let (mut x, mut z) = (20_000_i64, 0_i64);
    let point = |x: i64, z: i64| Point::new(x as f64 / 1000.0, z as f64 / 1000.0);
    let code = if left { 41 } else { 42 };
    writeln!(text, "G{code} G00 X{} Z{}", mm(2 * x), mm(z)).unwrap();
    let mut surface = Vec::new();
    for step in steps {
        let from = point(x, z);
        // G41 runs on the mirrored profile, inside a bore.
        let dx = if left { -step.dx } else { step.dx };
        (x, z) = (x + dx, z + step.dz);
        let to = point(x, z);
        let chord = (to - from).length();
        let arc = step
            .arc
            .filter(|arc| chord > 0.0 && is_monotonic(from, to, *arc, left));
        let Some((ratio, clockwise)) = arc else {
            writeln!(text, "G01 X{} Z{}", mm(2 * x), mm(z)).unwrap();
            surface.push(ProfileSurface {
                from,
                to,
                about: None,
            });
            continue;
        };
        let clockwise = clockwise != left;
        let (radius, center) = arc_circle(from, to, ratio, clockwise);
        surface.push(ProfileSurface {
            from,
            to,
            about: Some((center, clockwise)),
        });
        let g = if clockwise { 2 } else { 3 };
        writeln!(text, "G0{g} X{} Z{} R{}", mm(2 * x), mm(z), mm(radius)).unwrap();
    }
    let away = if left { -10_000 } else { 10_000 };
    writeln!(text, "G40 G00 X{} Z{}", mm(2 * (x + away)), mm(z - 2_000)).unwrap();
    (text, surface)
}

/// The result of running a profile with compensation.
enum ProfileResult {
    Alarm(u16),
    /// The nose cuts into the part: depth, mm, and a text with the position.
    Cut(f64, String),
}

fn run_profile(steps: &[ProfileStep], nose: ToolOffset, left: bool) -> ProfileResult {
    let (text, surface) = profile_program(steps, left);
    let start = Point::new(20.0, 10.0);
    let (moves, preview) = run_with_nose(&text, nose, start);
    if let Some(alarm) = preview.alarm {
        return ProfileResult::Alarm(alarm.number);
    }
    let (deep, position) = deepest_cut(&surface, &moves, nose, 3..=steps.len() as u32 + 2);
    ProfileResult::Cut(deep, format!("{position} in\n{text}"))
}

/// Greatest depth to which the nose cuts into the surface on the moves of the lines `lines`, mm,
/// and a text with the position.
pub(super) fn deepest_cut(
    surface: &[ProfileSurface],
    moves: &[ExecutedMove],
    nose: ToolOffset,
    lines: RangeInclusive<u32>,
) -> (f64, String) {
    let mut worst = (f64::MIN, String::new());
    for made in moves
        .iter()
        .filter(|made| lines.contains(&made.source.line))
    {
        for point in points(made) {
            let center = point - tip_vector(&nose);
            let clear = surface
                .iter()
                .map(|piece| piece.distance(center))
                .fold(f64::MAX, f64::min);
            let deep = nose.r.abs() - clear;
            if deep > worst.0 {
                worst = (deep, format!("line {} at {point:?}", made.source.line));
            }
        }
    }
    worst
}

/// Generates random profiles that lead towards the chuck and never back in Z.
fn steps() -> impl Strategy<Value = Vec<ProfileStep>> {
    let long = (1_000_i64..8_000, -4_000_i64..4_000);
    let short = (0_i64..800, -600_i64..600);
    let square = prop_oneof![
        (500_i64..6_000).prop_map(|z| (z, 0)),
        (-4_000_i64..4_000).prop_map(|x| (0, x)),
    ];
    let displacement = prop_oneof![3 => long, 2 => short, 3 => square];
    let arc = prop_oneof![
        3 => Just(None),
        2 => (0_i64..6_000, any::<bool>()).prop_map(Some),
    ];
    let step = (displacement, arc).prop_map(|((dz, dx), arc)| ProfileStep { dz: -dz, dx, arc });
    // Free length to approach and to leave, wherever the profile begins and ends.
    let clearance = ProfileStep {
        dz: -5_000,
        dx: 0,
        arc: None,
    };
    prop::collection::vec(step, 1..9).prop_map(move |mut steps| {
        // A wall that reverses on itself does not bound a part.
        let mut down = false;
        for step in &mut steps {
            if step.dz == 0 && down {
                step.dz = -500;
            }
            down = step.dz == 0;
        }
        steps.insert(0, clearance);
        steps.push(clearance);
        steps
    })
}

fn noses() -> impl Strategy<Value = ToolOffset> {
    (50_i32..2_000, 0_u8..10).prop_map(|(r, t)| ToolOffset {
        r: f64::from(r) / 1000.0,
        t,
        ..ToolOffset::default()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_nose_stays_outside_or_there_is_an_alarm(
        steps in steps(), nose in noses(), left in any::<bool>(),
    ) {
        match run_profile(&steps, nose, left) {
            ProfileResult::Alarm(number) => prop_assert!(matches!(number, 50..=59), "{}", number),
            ProfileResult::Cut(deep, position) => {
                prop_assert!(deep <= TOLERANCE, "{} deep, {:?} {}", deep, nose, position);
            }
        }
    }
}
