//! Vectors of the corner between two moves: from the programmed point to the nose centre, in
//! order (manual II, C compensation).
//!
//! ```text
//!  inner (α ≥ 180°)       outer, obtuse (90° ≤ α)      outer, acute (α < 90°)
//!
//!   B |   |                       .---V                  V1----.
//!     |   |                     .'   / \                 |      \
//!     |   V------ path      ---'   .P   \             ---|-.P    V2
//!     |  / r              A ------'  \ B \          A ---' /    /
//!     P---------- A                   \   \            B  /    /
//! ```
//!
//! α is the angle on the side of the workpiece. The tool moves straight from one vector to
//! the next.

use serde::{Deserialize, Serialize};

use super::fault::CompensationFault;
use super::intersection::intersect;
use super::segment::ContourSegment;
use super::settings::{COS_1_DEGREE, CompensationSettings, StartUpType};

use crate::units::Point;

/// Vectors whose ends are closer than this count as equal, mm.
const SAME_VECTOR_MM: f64 = 0.001;
/// Two moves count as tangent if their nose centres are closer than this at the corner, mm;
/// such a distance comes from rounded ends and centres.
const TANGENT_MM: f64 = 0.004;
/// Limit instead of [`TANGENT_MM`], mm, if one of the moves is so short that rounding turns it
/// more.
const SHORT_MOVE_TANGENT_MM: f64 = 0.02;
/// Length, mm, below which rounding the ends to 0.001 mm turns a move by more than 0.002 rad.
const SHORT_MOVE_MM: f64 = 0.35;
/// Cross product of two unit vectors below which their directions count as parallel.
const PARALLEL: f64 = 1e-9;

/// The role of the two moves of a corner in the compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CornerRole {
    /// The first move starts the compensation, the second one is compensated.
    StartUp,
    /// Both moves of the corner are compensated.
    Both,
    /// The first move is compensated, the second one cancels the compensation.
    Cancel,
}

/// Up to four vectors of a corner, from the programmed point to the nose centre, in the order
/// in which the nose centre reaches their ends, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct CornerVectors {
    list: [Point; 4],
    count: u8,
    /// Whether the corner has a single vector, to the point where the offset paths of both moves
    /// meet.
    pub(super) meets: bool,
}

impl CornerVectors {
    pub(super) fn from_points(points: &[Point]) -> Self {
        let mut vectors = Self::default();
        for (slot, point) in vectors.list.iter_mut().zip(points) {
            *slot = *point;
            vectors.count += 1;
        }
        vectors
    }

    /// A corner with one vector, `point`, mm, to the point where the offset paths of both moves
    /// meet.
    fn at_meeting(point: Point) -> Self {
        Self {
            meets: true,
            ..Self::from_points(&[point])
        }
    }

    pub(super) fn as_slice(&self) -> &[Point] {
        self.list.get(..usize::from(self.count)).unwrap_or(&[])
    }

    pub(super) fn first(&self) -> Point {
        self.as_slice().first().copied().unwrap_or_default()
    }

    pub(super) fn last(&self) -> Point {
        self.as_slice().last().copied().unwrap_or_default()
    }

    pub(super) const fn is_single(&self) -> bool {
        self.count <= 1
    }

    pub(super) fn drop_last(&mut self) {
        self.count = self.count.saturating_sub(1);
    }

    pub(super) fn drop_first(&mut self) {
        self.list.rotate_left(1);
        self.count = self.count.saturating_sub(1);
    }
}

/// The shape of a corner, seen from the side of the nose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CornerKind {
    /// The direction changes so little that the two perpendicular vectors count as equal.
    Straight,
    Inner,
    /// An inner corner whose paths count as opposite.
    InnerSharp,
    Obtuse,
    Acute,
    /// An outer corner whose paths count as opposite.
    OuterSharp,
}

/// Classifies the corner between two moves from the unit vectors of travel at the end of the first
/// (`exit`) and at the start of the second (`entry`). The nose centre is `rho` to the left, mm;
/// negative values mean right. `reversal` is the cosine below which the paths count as opposite.
fn classify_corner(exit: Point, entry: Point, rho: f64, reversal: f64) -> CornerKind {
    let turned = (exit - entry) * rho;
    if turned.dot(turned) <= SAME_VECTOR_MM * SAME_VECTOR_MM {
        return CornerKind::Straight;
    }
    let along = exit.dot(entry);
    let turn = exit.cross(entry) * rho.signum();
    let is_opposite = along < 0.0 && turn.abs() < PARALLEL;
    let sharp = along < reversal;
    if turn > -PARALLEL && !is_opposite {
        return if sharp {
            CornerKind::InnerSharp
        } else {
            CornerKind::Inner
        };
    }
    if sharp {
        return CornerKind::OuterSharp;
    }
    if along < -PARALLEL {
        return CornerKind::Acute;
    }
    CornerKind::Obtuse
}

/// Computes the vectors of the corner between the moves `a` and `b`, mm. The nose centre is `rho_a`
/// to the left of `a` and `rho_b` to the left of `b`, mm; negative values mean right.
///
/// # Errors
/// The nose is too large for an inner arc, the nose paths do not meet, or the corner is too sharp.
pub(super) fn corner_vectors(
    (a, rho_a): (&ContourSegment, f64),
    (b, rho_b): (&ContourSegment, f64),
    role: CornerRole,
    settings: &CompensationSettings,
) -> Result<CornerVectors, CompensationFault> {
    for (piece, rho) in [(a, rho_a), (b, rho_b)] {
        if let Some(circle) = &piece.circle {
            circle.check_radius(rho)?;
        }
    }
    let vectors = if rho_a * rho_b < 0.0 {
        Ok(side_change_vectors(a, rho_a, b, rho_b))
    } else {
        same_side_vectors(a, b, rho_b, role, settings)
    };
    let is_finite = |vector: &Point| vector.x.is_finite() && vector.z.is_finite();
    match &vectors {
        Ok(computed) if !computed.as_slice().iter().all(is_finite) => {
            Err(CompensationFault::NoResult)
        }
        _ => vectors,
    }
}

/// The vector from the end of a move to the nose centre, perpendicular to the move. `rho` is
/// its length, mm, positive to the left.
pub(super) fn perpendicular_at_end(a: &ContourSegment, rho: f64) -> Point {
    a.exit.left() * rho
}

/// The vector from the start of a move to the nose centre, perpendicular to the move. `rho` is
/// its length, mm, positive to the left.
pub(super) fn perpendicular_at_start(b: &ContourSegment, rho: f64) -> Point {
    b.entry.left() * rho
}

#[inline(always)]
fn same_side_vectors(
    a: &ContourSegment,
    b: &ContourSegment,
    rho: f64,
    role: CornerRole,
    settings: &CompensationSettings,
) -> Result<CornerVectors, CompensationFault> {
    let (square_a, square_b) = (perpendicular_at_end(a, rho), perpendicular_at_start(b, rho));
    // The compensated move of a start-up or a cancel determines the vector.
    let kept = match role {
        CornerRole::StartUp | CornerRole::Both => square_b,
        CornerRole::Cancel => square_a,
    };
    let around = role != CornerRole::Both;
    let lines = a.circle.is_none() && b.circle.is_none();
    let bow = |first: bool, last: bool| extended_vectors(a, b, rho, first, last);
    let apart = square_a - square_b;
    let is_within = |distance: f64| apart.dot(apart) <= distance * distance;
    if role == CornerRole::Both
        && is_within(TANGENT_MM)
        && let Some(rests) = rest_vectors(a, b, rho)
    {
        return Ok(rests);
    }
    let meeting = || {
        let met = intersect(a, rho, b, rho);
        if role == CornerRole::Both && is_within(SHORT_MOVE_TANGENT_MM) {
            near_tangent_vectors(a, b, rho, met)
        } else {
            met.map(CornerVectors::at_meeting)
        }
    };
    // Between two compensated lines the meeting point is as near, and does not cut in.
    let kind = match around && lines && settings.is_straight(a.exit, b.entry) {
        true => CornerKind::Straight,
        false => classify_corner(a.exit, b.entry, rho, settings.reversal_cosine),
    };
    Ok(match kind {
        CornerKind::Straight => CornerVectors::from_points(&[kept]),
        CornerKind::Inner | CornerKind::InnerSharp if around => CornerVectors::from_points(&[kept]),
        CornerKind::InnerSharp => return Err(CompensationFault::SharpCorner),
        CornerKind::OuterSharp if around && lines => CornerVectors::from_points(&[kept]),
        CornerKind::Obtuse | CornerKind::Acute | CornerKind::OuterSharp
            if around && settings.start_up == StartUpType::A =>
        {
            CornerVectors::from_points(&[kept])
        }
        CornerKind::Inner => return meeting(),
        CornerKind::Obtuse => match role {
            CornerRole::StartUp => {
                CornerVectors::from_points(&[square_a, intersect(a, rho, b, rho)?])
            }
            CornerRole::Both => return meeting(),
            CornerRole::Cancel => {
                CornerVectors::from_points(&[intersect(a, rho, b, rho)?, square_b])
            }
        },
        CornerKind::Acute | CornerKind::OuterSharp => match role {
            CornerRole::StartUp => bow(true, b.circle.is_some()),
            CornerRole::Both => bow(a.circle.is_some(), b.circle.is_some()),
            CornerRole::Cancel => bow(a.circle.is_some(), true),
        },
    })
}

/// The vectors, mm, to the positions of the nose centre at a corner with inner arcs that the nose
/// fills; `None` if it fills neither arc. `rho` is the nose radius, positive on the left, mm.
fn rest_vectors(a: &ContourSegment, b: &ContourSegment, rho: f64) -> Option<CornerVectors> {
    let center = |piece: &ContourSegment| piece.rest_center(rho).map(|center| center - b.start);
    match (center(a), center(b)) {
        (Some(one), Some(other)) => Some(CornerVectors::from_points(&[one, other])),
        (Some(one), None) | (None, Some(one)) => Some(CornerVectors::from_points(&[one])),
        (None, None) => None,
    }
}

/// Vectors of a corner that would be tangent except for rounding. The paths of the nose centre
/// meet at `met`, at a grazing angle, so that rounding may move `met` past the end of a short
/// move. Then one vector between the two perpendicular ones is used instead.
///
/// ```text
///   offset of a ----------*---.___        * square to a, + square to b
///                          V +    `---.__ V between them
///   offset of b  ------------------------`-- meeting
/// ```
fn near_tangent_vectors(
    a: &ContourSegment,
    b: &ContourSegment,
    rho: f64,
    met: Result<Point, CompensationFault>,
) -> Result<CornerVectors, CompensationFault> {
    let (square_a, square_b) = (perpendicular_at_end(a, rho), perpendicular_at_start(b, rho));
    let shorter = a.chord_length().min(b.chord_length());
    let is_short = shorter < SHORT_MOVE_MM;
    // Beside an arc that the nose fills, the rest of its path is a circle of the size of
    // rounding: a meeting point means nothing.
    if is_short && let Some(rests) = rest_vectors(a, b, rho) {
        return Ok(rests);
    }
    let between = || CornerVectors::from_points(&[(square_a + square_b) * 0.5]);
    match met {
        Ok(meeting) => {
            let off = (meeting - square_a)
                .length()
                .min((meeting - square_b).length());
            Ok(if is_short && off > shorter / 2.0 {
                between()
            } else {
                CornerVectors::at_meeting(meeting)
            })
        }
        Err(
            CompensationFault::NoMeetingLineArc
            | CompensationFault::NoMeetingArcLine
            | CompensationFault::NoMeetingOfArcs,
        ) if is_short => Ok(between()),
        Err(fault) => Err(fault),
    }
}

/// Vectors around an acute outer corner, mm: both paths of the nose centre continue by the nose
/// radius. `with_first` and `with_last` include the vectors perpendicular to `a` and to `b`.
fn extended_vectors(
    a: &ContourSegment,
    b: &ContourSegment,
    rho: f64,
    with_first: bool,
    with_last: bool,
) -> CornerVectors {
    let (square_a, square_b) = (perpendicular_at_end(a, rho), perpendicular_at_start(b, rho));
    let r = rho.abs();
    let points = [
        square_a,
        square_a + a.exit * r,
        square_b - b.entry * r,
        square_b,
    ];
    let (from, to) = (usize::from(!with_first), 3 + usize::from(with_last));
    CornerVectors::from_points(points.get(from..to).unwrap_or(&[]))
}

/// Vectors of a change between G41 and G42, mm: one to the intersection of the nose paths if it is
/// within the moves, otherwise one perpendicular to each move.
///
/// ```text
///    A -----P            A ------P
///   --------*  offset       -----* ρA nA
///           | \ B            B   |  straight from one to the other
///           |  \         *-------- ρB nB
/// ```
fn side_change_vectors(
    a: &ContourSegment,
    rho_a: f64,
    b: &ContourSegment,
    rho_b: f64,
) -> CornerVectors {
    let (square_a, square_b) = (
        perpendicular_at_end(a, rho_a),
        perpendicular_at_start(b, rho_b),
    );
    if (square_a - square_b).length() <= SAME_VECTOR_MM {
        return CornerVectors::from_points(&[square_b]);
    }
    let turns = a.exit.dot(b.entry) <= COS_1_DEGREE;
    let meeting = if turns {
        intersect(a, rho_a, b, rho_b).ok()
    } else {
        None
    };
    let lines = a.circle.is_none() && b.circle.is_none();
    let within = |meeting: &Point| {
        !lines
            || ((*meeting - square_a).dot(a.exit) > -a.chord_length()
                && (*meeting - square_b).dot(b.entry) < b.chord_length())
    };
    match meeting.filter(within) {
        Some(meeting) => CornerVectors::from_points(&[meeting]),
        None => CornerVectors::from_points(&[square_a, square_b]),
    }
}
