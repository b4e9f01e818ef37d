//! Geometry of two moves that meet in a corner: lines and arcs, and what a chamfer or a corner arc
//! between them touches.

use core::f64::consts::{PI, TAU};

/// A point or direction: X as a radius, then Z; millionths of a millimetre.
pub(crate) type Vector = [f64; 2];

/// Greatest distance by which a computed point may be beyond a move, millionths of a millimetre.
const REACH_TOLERANCE: f64 = 1.0;
/// Least sine of the angle between two moves that form a corner.
const LEAST_SINE: f64 = 1e-4;
/// Least remaining length of an arc, millionths of a millimetre: a shorter one has no written
/// direction.
const LEAST_ARC: f64 = 2_000.0;

/// A line or an arc.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContourMove {
    pub from: Vector,
    pub to: Vector,
    /// The centre and direction of an arc; `None` for a line.
    pub turn: Option<MoveArc>,
}

/// Centre and direction of an arc.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MoveArc {
    pub center: Vector,
    /// Whether the arc is counter-clockwise with Z to the right and X up (G03).
    pub is_left: bool,
}

/// The two points between which a corner block moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerPoints {
    pub before: Vector,
    pub after: Vector,
    /// Whether a corner arc is counter-clockwise (G03).
    pub is_left: bool,
}

/// The curve at a distance from a move on which the centre of a corner arc is.
#[derive(Clone, Copy, Debug)]
enum CenterCurve {
    Line(Vector, Vector),
    Circle(Vector, f64),
}

fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1]]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn scale(a: Vector, by: f64) -> Vector {
    a.map(|it| it * by)
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Above 0 if `b` is to the left of `a`, with Z to the right and X up.
fn cross(a: Vector, b: Vector) -> f64 {
    a[1] * b[0] - a[0] * b[1]
}

fn length(a: Vector) -> f64 {
    a[0].hypot(a[1])
}

/// The direction at right angles to the left.
fn left_of(a: Vector) -> Vector {
    [a[1], -a[0]]
}

/// The angle of a direction from Z+ towards X+, radians.
fn heading(a: Vector) -> f64 {
    a[0].atan2(a[1])
}

impl MoveArc {
    /// The turn of an arc with a radius of at most half a turn; `None` between equal points.
    pub fn from_radius(from: Vector, to: Vector, radius: f64, is_left: bool) -> Option<Self> {
        let chord = minus(to, from);
        let half = length(chord) / 2.0;
        if half < 1.0 {
            return None;
        }
        let height = (radius * radius - half * half).max(0.0).sqrt();
        let side = if is_left { height } else { -height };
        let middle = scale(add(from, to), 0.5);
        Some(Self {
            center: add(middle, scale(left_of(chord), side / (2.0 * half))),
            is_left,
        })
    }

    /// The angle from one point to another in the direction of the arc, radians, 0 to a turn.
    fn angle(&self, from: Vector, to: Vector) -> f64 {
        let [from, to] = [from, to].map(|it| heading(minus(it, self.center)));
        let turned = if self.is_left { to - from } else { from - to };
        turned.rem_euclid(TAU)
    }

    fn rotate(&self, point: Vector, angle: f64) -> Vector {
        let radial = minus(point, self.center);
        let (sin, cos) = if self.is_left { angle } else { -angle }.sin_cos();
        let turned = [
            radial[0] * cos + radial[1] * sin,
            radial[1] * cos - radial[0] * sin,
        ];
        add(self.center, turned)
    }
}

impl ContourMove {
    /// Length of the whole move.
    fn whole_length(&self) -> f64 {
        match self.turn {
            Some(turn) => {
                let angle = turn.angle(self.from, self.to);
                length(minus(self.from, turn.center)) * angle
            }
            None => length(minus(self.to, self.from)),
        }
    }

    /// Distance along the move from its start to a point on it; negative before the start.
    fn distance_to(&self, point: Vector) -> f64 {
        let Some(turn) = self.turn else {
            let whole = minus(self.to, self.from);
            return dot(minus(point, self.from), whole) / length(whole).max(1.0);
        };
        let angle = turn.angle(self.from, point);
        // A point just before the start is almost a whole turn after it.
        let angle = if angle > (TAU + turn.angle(self.from, self.to)) / 2.0 {
            angle - TAU
        } else {
            angle
        };
        length(minus(self.from, turn.center)) * angle
    }

    /// Direction of travel at a point on the move.
    fn direction(&self, point: Vector) -> Vector {
        let along = match self.turn {
            Some(MoveArc { center, is_left }) => {
                let left = left_of(minus(point, center));
                scale(left, if is_left { 1.0 } else { -1.0 })
            }
            None => minus(self.to, self.from),
        };
        scale(along, 1.0 / length(along).max(f64::MIN_POSITIVE))
    }

    /// The point at a straight distance from an end of the move, on the move or its continuation;
    /// `None` if an arc is smaller than the distance.
    fn point_at(&self, distance: f64, is_before_end: bool) -> Option<Vector> {
        let (corner, sign) = if is_before_end {
            (self.to, -1.0)
        } else {
            (self.from, 1.0)
        };
        let Some(turn) = self.turn else {
            return Some(add(corner, scale(self.direction(corner), sign * distance)));
        };
        let half_share = distance / (2.0 * length(minus(corner, turn.center)));
        (half_share < 1.0).then(|| turn.rotate(corner, sign * 2.0 * half_share.asin()))
    }

    /// The curve of the points at a distance to one side of the move; `None` inside an arc that is
    /// too small.
    fn center_curve(&self, distance: f64, is_left: bool) -> Option<CenterCurve> {
        let Some(turn) = self.turn else {
            let along = self.direction(self.from);
            let side = scale(left_of(along), if is_left { distance } else { -distance });
            return Some(CenterCurve::Line(add(self.from, side), along));
        };
        let radius = length(minus(self.from, turn.center));
        let inside = turn.is_left == is_left;
        let radius = if inside {
            radius - distance
        } else {
            radius + distance
        };
        (radius > 1.0).then_some(CenterCurve::Circle(turn.center, radius))
    }

    /// The point of the move next to the centre of a corner arc.
    fn touching_point(&self, center: Vector) -> Vector {
        match self.turn {
            Some(turn) => {
                let out = minus(center, turn.center);
                let radius = length(minus(self.from, turn.center));
                add(turn.center, scale(out, radius / length(out).max(1.0)))
            }
            None => {
                let along = self.direction(self.from);
                add(
                    self.from,
                    scale(along, dot(minus(center, self.from), along)),
                )
            }
        }
    }

    /// Whether the part of the move between two distances along it is long enough to be written.
    fn has_rest(&self, from: f64, to: f64) -> bool {
        let least = match self.turn {
            Some(_) => LEAST_ARC,
            None => -REACH_TOLERANCE,
        };
        to - from >= least
    }
}

/// The points of a chamfer at a straight distance from the corner on both moves, or of a tangent
/// arc, between `first`, on which the tool is at `position`, and `second`. `None` if they do not
/// fit, if more than one arc does, or if the moves form no corner.
pub(crate) fn corner_points(
    first: &ContourMove,
    position: Vector,
    second: &ContourMove,
    size: f64,
    is_round: bool,
) -> Option<CornerPoints> {
    let corner = first.to;
    let turn = cross(first.direction(corner), second.direction(corner));
    let is_left = turn > 0.0;
    if turn.abs() < LEAST_SINE {
        return None;
    }
    let taken = first.distance_to(position);
    let (one, two) = (first.whole_length(), second.whole_length());
    let fits = |points: &CornerPoints| {
        let before = first.distance_to(points.before);
        let after = second.distance_to(points.after);
        before <= one + REACH_TOLERANCE
            && after >= -REACH_TOLERANCE
            && first.has_rest(taken, before)
            && second.has_rest(after, two)
    };
    if !is_round {
        let points = CornerPoints {
            before: first.point_at(size, true)?,
            after: second.point_at(size, false)?,
            is_left,
        };
        return fits(&points).then_some(points);
    }
    let centers = meet(
        first.center_curve(size, is_left)?,
        second.center_curve(size, is_left)?,
    );
    let mut found = centers.into_iter().flatten().filter_map(|center| {
        let points = CornerPoints {
            before: first.touching_point(center),
            after: second.touching_point(center),
            is_left,
        };
        let swept = MoveArc { center, is_left }.angle(points.before, points.after);
        (fits(&points) && swept < PI).then_some(points)
    });
    let points = found.next()?;
    found.next().is_none().then_some(points)
}

/// The points where two curves meet.
fn meet(one: CenterCurve, two: CenterCurve) -> [Option<Vector>; 2] {
    match (one, two) {
        (CenterCurve::Line(a, along), CenterCurve::Line(b, other)) => {
            let sine = cross(along, other);
            let distance = cross(minus(b, a), other) / sine;
            let point = add(a, scale(along, distance));
            [distance.is_finite().then_some(point), None]
        }
        (CenterCurve::Line(a, along), CenterCurve::Circle(center, radius))
        | (CenterCurve::Circle(center, radius), CenterCurve::Line(a, along)) => {
            let foot = add(a, scale(along, dot(minus(center, a), along)));
            let height = length(minus(foot, center));
            both_sides(foot, along, radius * radius - height * height)
        }
        (CenterCurve::Circle(a, one), CenterCurve::Circle(b, two)) => {
            let between = minus(b, a);
            let distance = length(between);
            if distance < 1.0 {
                return [None, None];
            }
            let along = scale(between, 1.0 / distance);
            let share = (distance * distance + one * one - two * two) / (2.0 * distance);
            let foot = add(a, scale(along, share));
            both_sides(foot, left_of(along), one * one - share * share)
        }
    }
}

/// The points at the root of a squared distance on both sides of `foot`.
fn both_sides(foot: Vector, along: Vector, squared: f64) -> [Option<Vector>; 2] {
    if squared < 0.0 {
        return [None, None];
    }
    let half = squared.sqrt();
    [half, -half].map(|by| Some(add(foot, scale(along, by))))
}
