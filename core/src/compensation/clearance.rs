//! Distance between two curves: the path of the nose centre and a surface. If they are
//! closer than the nose radius, the nose cuts into the part.
//!
//! ```text
//!    nose path  ________________        the nearest points are
//!                  |     ^              - an end of the one, or
//!                  |d    | foot         - the foot of a centre on a line, or
//!              .--'|'--. |              - on the line of two centres, or
//!            .'    + <---+ '.           - a crossing: no distance at all
//! ```

use core::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::plane::sweep;
use super::segment::{Circle, ContourSegment};
use crate::units::Point;

/// Tolerance of the check, mm: rounding and joined corners may bring the nose this much closer
/// to a surface than its radius.
pub(super) const ROUNDING_MM: f64 = 0.0003;
/// An arc of at most half a turn whose chord is shorter than this, mm, counts as the chord.
const SHORT_CHORD_MM: f64 = 1e-6;
/// A radius that changes by less than this along an arc, mm, counts as constant.
const NEGLIGIBLE_GROWTH_MM: f64 = 0.0001;

/// A line, or an arc of at most a full turn whose radius may change linearly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Curve {
    from: Point,
    pub(super) to: Point,
    arc: Option<CurveArc>,
    /// Corners of a box parallel to the axes that contains the curve, mm; it may be larger
    /// than necessary.
    low: Point,
    high: Point,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct CurveArc {
    center: Point,
    /// Radius at the middle of the arc, mm.
    radius: f64,
    /// Radius at the end minus radius at the start, mm.
    growth: f64,
    turn: f64,
}

impl Curve {
    pub(super) const fn line(from: Point, to: Point) -> Self {
        let (x, z) = (min_max(from.x, to.x), min_max(from.z, to.z));
        Self {
            from,
            to,
            arc: None,
            low: Point::new(x.0, z.0),
            high: Point::new(x.1, z.1),
        }
    }

    fn from_arc(from: Point, to: Point, arc: CurveArc) -> Self {
        let mut curve = Self {
            arc: Some(arc),
            ..Self::line(from, to)
        };
        let x = curve.extent(Point::new(1.0, 0.0), |point| point.x);
        let z = curve.extent(Point::new(0.0, 1.0), |point| point.z);
        (curve.low, curve.high) = (Point::new(x.0, z.0), Point::new(x.1, z.1));
        curve
    }

    /// The arc from `from` to `to`, mm, about the centre of `circle`, parallel to the arc of the
    /// move `piece`; a line if it is too short.
    pub(super) fn parallel_arc(
        from: Point,
        to: Point,
        circle: &Circle,
        piece: &ContourSegment,
    ) -> Self {
        if (to - from).length() < SHORT_CHORD_MM && piece.sweep() <= PI {
            return Self::line(from, to);
        }
        let (first, last) = (
            (from - circle.center).length(),
            (to - circle.center).length(),
        );
        let arc = CurveArc {
            center: circle.center,
            radius: (first + last) / 2.0,
            growth: last - first,
            turn: circle.turn,
        };
        Self::from_arc(from, to, arc)
    }

    /// The programmed surface that a move cuts, as a curve.
    pub(super) fn surface(piece: &ContourSegment) -> Self {
        match &piece.circle {
            None => Self::line(piece.start, piece.end),
            Some(circle) => Self::parallel_arc(piece.start, piece.end, circle, piece),
        }
    }

    pub(super) const fn is_line(&self) -> bool {
        self.arc.is_none()
    }

    /// Greatest distance of an arc with changing radius from the arc with its middle radius,
    /// mm; 0 for a line.
    pub(super) fn radius_deviation(&self) -> f64 {
        self.arc.as_ref().map_or(0.0, CurveArc::radius_deviation)
    }

    /// Whether a direction from the centre of the arc lies within its sweep.
    ///
    /// ```text
    ///     last .    direction       up to half a turn: after the first arm and before
    ///           `. .                the last one; of more than that the other arc is
    ///     turn ^  +------ first     after the last arm and before the first one
    /// ```
    fn spans_direction(&self, arc: &CurveArc, direction: Point) -> bool {
        let after = |one: Point, other: Point| one.cross(other) * arc.turn;
        let (first, last) = (self.from - arc.center, self.to - arc.center);
        let turned = after(first, last);
        let (after_first, before_last) = (after(first, direction), after(direction, last));
        // The same direction again means a full turn.
        let wide = turned < 0.0 || turned == 0.0 && first.dot(last) > 0.0;
        match wide {
            true => after_first >= 0.0 || before_last >= 0.0,
            false => after_first >= 0.0 && before_last >= 0.0,
        }
    }

    /// The least and the greatest coordinate of the curve along `direction`, mm times the length of
    /// `direction`. `along` computes that coordinate of a point.
    fn extent(&self, direction: Point, along: impl Fn(Point) -> f64) -> (f64, f64) {
        let (from, to) = (along(self.from), along(self.to));
        let (mut least, mut most) = min_max(from, to);
        if let Some(arc) = &self.arc {
            let (center, length) = (along(arc.center), direction.length());
            let (reach, deviation) = (
                (arc.radius + arc.radius_deviation()) * length,
                arc.radius_deviation() * length,
            );
            let spans = |direction| self.spans_direction(arc, direction);
            least = if spans(-direction) {
                center - reach
            } else {
                least - deviation
            };
            most = if spans(direction) {
                center + reach
            } else {
                most + deviation
            };
        }
        (least, most)
    }

    /// Splits the curve, whose arc is `arc`, into two halves.
    fn split_arc(&self, arc: &CurveArc) -> [Self; 2] {
        let arm = self.from - arc.center;
        let whole = match sweep(arm, self.to - arc.center, arc.turn) {
            angle if angle <= 0.0 => TAU,
            angle => angle,
        };
        let (sine, cosine) = libm::sincos(whole / 2.0 * arc.turn);
        let turned = Point::new(arm.x * cosine + arm.z * sine, arm.z * cosine - arm.x * sine);
        // A point at the centre has no direction: any one will do.
        let arm = turned.unit().unwrap_or_default() * arc.radius;
        let middle = arc.center + arm;
        let half = |from, to, quarter: f64| {
            let half = CurveArc {
                radius: arc.radius + arc.growth * quarter,
                growth: arc.growth / 2.0,
                ..*arc
            };
            Self::from_arc(from, to, half)
        };
        [half(self.from, middle, -0.25), half(middle, self.to, 0.25)]
    }
}

impl CurveArc {
    /// Greatest distance of the arc, whose radius may change, from the arc with its middle radius,
    /// mm.
    const fn radius_deviation(&self) -> f64 {
        self.growth.abs() / 2.0
    }
}

/// The smaller and the larger of two numbers, neither of which may be NaN: `min` and `max`
/// would handle NaN too, which takes time.
#[inline]
const fn min_max(one: f64, other: f64) -> (f64, f64) {
    let smaller = if one < other { one } else { other };
    let larger = if one > other { one } else { other };
    (smaller, larger)
}

/// Whether the distance of a nose path from a surface is less than `least`, mm.
pub(super) fn is_closer_than(path: &Curve, surface: &Curve, least: f64) -> bool {
    least > 0.0
        && !are_boxes_apart(path, surface, least)
        && !is_on_one_side(path, surface, least)
        && !is_on_one_side(surface, path, least)
        && is_closer_by_halving(path, surface, least)
}

/// Whether the distance of two curves is less than `least`, mm. If the change of a radius
/// decides, arcs are halved until the change is negligible.
fn is_closer_by_halving(a: &Curve, b: &Curve, least: f64) -> bool {
    let deviation = a.radius_deviation() + b.radius_deviation();
    let between = distance(a, b);
    if deviation < NEGLIGIBLE_GROWTH_MM || (between - least).abs() > deviation {
        return between < least;
    }
    let halved = if a.radius_deviation() >= b.radius_deviation() {
        a
    } else {
        b
    };
    let other = if a.radius_deviation() >= b.radius_deviation() {
        b
    } else {
        a
    };
    halved.arc.as_ref().is_some_and(|arc| {
        let mut halves = halved.split_arc(arc).into_iter();
        halves.any(|half| is_closer_by_halving(&half, other, least))
    })
}

/// Whether the bounding boxes of two curves are at least `least` apart, mm.
fn are_boxes_apart(a: &Curve, b: &Curve, least: f64) -> bool {
    let gap = |one: f64, other: f64| min_max(min_max(one, other).1, 0.0).1;
    let x = gap(a.low.x - b.high.x, b.low.x - a.high.x);
    let z = gap(a.low.z - b.high.z, b.low.z - a.high.z);
    x * x + z * z >= least * least
}

/// Whether all of `other` is at least `least`, mm, to one side of a line; false if `line` is an
/// arc. A path and the surfaces before and after it nearly always pass this test: at a corner of
/// two lines, the path is beside one surface, or the other surface is beside the path.
///
/// ```text
///    . . . . . . path           ---. path            the surface ends under
///    ------------ surface           `.               the line of the path
///                 \\             --.    `.
/// ```
fn is_on_one_side(line: &Curve, other: &Curve, least: f64) -> bool {
    if line.arc.is_some() {
        return false;
    }
    let along = line.to - line.from;
    let (right, left) = other.extent(along.left(), |point| along.cross(point - line.from));
    // Scaled by the length of the line, as the extents are. Comparing squares avoids a root.
    let square = least * least * along.dot(along);
    let is_beyond = |reach: f64| reach >= 0.0 && reach * reach >= square;
    is_beyond(right) || is_beyond(-left)
}

/// The least distance between two curves, mm. Each arc counts with its middle radius.
pub(super) fn distance(a: &Curve, b: &Curve) -> f64 {
    let between = match (&a.arc, &b.arc) {
        (None, None) => return line_distance(a, b),
        (None, Some(arc)) => line_arc_distance(a, (b, arc)),
        (Some(arc), None) => line_arc_distance(b, (a, arc)),
        (Some(first), Some(second)) => arc_distance((a, first), (b, second)),
    };
    let ends = distance_to_point(a, b.from)
        .min(distance_to_point(a, b.to))
        .min(distance_to_point(b, a.from))
        .min(distance_to_point(b, a.to));
    ends.min(between)
}

fn distance_to_point(curve: &Curve, point: Point) -> f64 {
    let ends = (point - curve.from)
        .length()
        .min((point - curve.to).length());
    match &curve.arc {
        None => foot(curve, point).map_or(ends, |foot| (point - foot).length().min(ends)),
        Some(arc) => {
            let arm = point - arc.center;
            if !curve.spans_direction(arc, arm) {
                return ends;
            }
            (arm.length() - arc.radius).abs().min(ends)
        }
    }
}

/// The foot of the perpendicular from a point to a line, mm; `None` if it is not between the ends
/// of the line.
fn foot(line: &Curve, point: Point) -> Option<Point> {
    let along = line.to - line.from;
    let square = along.dot(along);
    if square <= 0.0 {
        return None;
    }
    let part = (point - line.from).dot(along) / square;
    (0.0..=1.0)
        .contains(&part)
        .then(|| line.from + along * part)
}

/// The least distance between two lines, mm; 0 if they cross. Otherwise an end of one line is
/// closest, so that the squared distances of the ends are compared.
fn line_distance(a: &Curve, b: &Curve) -> f64 {
    if do_lines_cross(a, b) {
        return 0.0;
    }
    let square = |between: Point| between.dot(between);
    let to_foot = |line: &Curve, point: Point| {
        foot(line, point).map_or(f64::INFINITY, |foot| square(point - foot))
    };
    let ends = square(b.from - a.from)
        .min(square(b.from - a.to))
        .min(square(b.to - a.from))
        .min(square(b.to - a.to));
    let feet = to_foot(a, b.from)
        .min(to_foot(a, b.to))
        .min(to_foot(b, a.from))
        .min(to_foot(b, a.to));
    ends.min(feet).sqrt()
}

fn do_lines_cross(a: &Curve, b: &Curve) -> bool {
    let (u, v) = (a.to - a.from, b.to - b.from);
    let between = b.from - a.from;
    let area = u.cross(v);
    if area == 0.0 {
        return false;
    }
    let (on_a, on_b) = (between.cross(v) / area, between.cross(u) / area);
    (0.0..=1.0).contains(&on_a) && (0.0..=1.0).contains(&on_b)
}

fn line_arc_distance(line: &Curve, (curve, arc): (&Curve, &CurveArc)) -> f64 {
    let Some(along) = (line.to - line.from).unit() else {
        return f64::INFINITY;
    };
    let to_line = along.left() * (line.from - arc.center).dot(along.left());
    let center_distance = to_line.length();
    if center_distance < arc.radius {
        let half = (arc.radius * arc.radius - center_distance * center_distance).sqrt();
        for direction in [to_line + along * half, to_line - along * half] {
            let on_line = (arc.center + direction - line.from).dot(along);
            let within = (0.0..=(line.to - line.from).length()).contains(&on_line);
            if within && curve.spans_direction(arc, direction) {
                return 0.0;
            }
        }
        return f64::INFINITY;
    }
    match foot(line, arc.center) {
        Some(foot) if curve.spans_direction(arc, foot - arc.center) => center_distance - arc.radius,
        _ => f64::INFINITY,
    }
}

fn arc_distance((a, first): (&Curve, &CurveArc), (b, second): (&Curve, &CurveArc)) -> f64 {
    let between = second.center - first.center;
    let d = between.length();
    let Some(e) = between.unit() else {
        return f64::INFINITY;
    };
    let both = |point: Point| {
        a.spans_direction(first, point - first.center)
            && b.spans_direction(second, point - second.center)
    };
    let along = (first.radius * first.radius - second.radius * second.radius + d * d) / (2.0 * d);
    let square = first.radius * first.radius - along * along;
    if square >= 0.0 {
        let (middle, half) = (first.center + e * along, e.left() * square.sqrt());
        if both(middle + half) || both(middle - half) {
            return 0.0;
        }
    }
    let mut least = f64::INFINITY;
    for side_a in [1.0, -1.0] {
        for side_b in [1.0, -1.0] {
            let on_a = first.center + e * (side_a * first.radius);
            let on_b = second.center + e * (side_b * second.radius);
            let seen = a.spans_direction(first, on_a - first.center)
                && b.spans_direction(second, on_b - second.center);
            if seen {
                least = least.min((on_b - on_a).length());
            }
        }
    }
    least
}
