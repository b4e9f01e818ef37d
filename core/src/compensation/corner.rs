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

use super::fault::Fault;
use super::intersection::meet;
use super::piece::Piece;

use crate::units::Point;

/// Vectors closer than this count as one, mm.
const ONE_VECTOR: f64 = 0.001;
/// Two moves whose nose centres are closer than this at their corner are tangent except for
/// rounded ends and centres, mm.
const TANGENT: f64 = 0.004;
/// The same limit where one of the moves is so short that rounding turns it more, mm.
const TANGENT_IF_SHORT: f64 = 0.02;
/// Rounding the ends of a shorter move to 0.001 mm turns it by more than 0.002 rad, mm.
const SHORT: f64 = 0.35;
/// Directions with a smaller cross product are parallel.
const PARALLEL: f64 = 1e-9;
/// Cosine of one degree.
const COS_1_DEGREE: f64 = 0.999_847_695_156_391_3;

/// How a start-up begins and a cancel ends. Type A has one vector perpendicular to the
/// compensated move; type B goes around the corner too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    /// Only for machines set to type A.
    A,
    B,
}

/// This control uses type B.
const START_TYPE: Type = Type::B;

/// The role of the two moves of a corner in the compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// The first move starts the compensation.
    StartUp,
    /// Both moves are compensated.
    Both,
    /// The second move cancels the compensation.
    Cancel,
}

/// Up to four vectors of a corner, in order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Vectors {
    list: [Point; 4],
    count: u8,
    /// There is one vector: to the point where the offset paths of both moves meet.
    pub(super) meets: bool,
}

impl Vectors {
    pub(super) fn of(points: &[Point]) -> Self {
        let mut vectors = Self::default();
        for (place, point) in vectors.list.iter_mut().zip(points) {
            *place = *point;
            vectors.count += 1;
        }
        vectors
    }

    /// One vector to the point where the offset paths of both moves meet.
    fn meeting(point: Point) -> Self {
        Self {
            meets: true,
            ..Self::of(&[point])
        }
    }

    pub(super) fn all(&self) -> &[Point] {
        self.list.get(..usize::from(self.count)).unwrap_or(&[])
    }

    pub(super) fn first(&self) -> Point {
        self.all().first().copied().unwrap_or_default()
    }

    pub(super) fn last(&self) -> Point {
        self.all().last().copied().unwrap_or_default()
    }

    pub(super) const fn single(&self) -> bool {
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

/// The geometry of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Angle {
    /// The turn is too small for a second vector.
    Straight,
    Inner,
    /// Inner, with less than one degree between the paths.
    InnerSharp,
    Obtuse,
    Acute,
    /// Outer, with less than one degree between the paths.
    OuterSharp,
}

/// Classifies the angle between two directions of travel. The nose is on the left for a
/// positive `rho`, else on the right.
fn angle(exit: Point, entry: Point, rho: f64) -> Angle {
    let turned = (exit - entry) * rho;
    if turned.dot(turned) <= ONE_VECTOR * ONE_VECTOR {
        return Angle::Straight;
    }
    let along = exit.dot(entry);
    let turn = exit.cross(entry) * rho.signum();
    let reversal = along < 0.0 && turn.abs() < PARALLEL;
    let sharp = along < -COS_1_DEGREE;
    if turn > -PARALLEL && !reversal {
        return if sharp {
            Angle::InnerSharp
        } else {
            Angle::Inner
        };
    }
    if sharp {
        return Angle::OuterSharp;
    }
    if along < -PARALLEL {
        return Angle::Acute;
    }
    Angle::Obtuse
}

/// The vectors at the end of `a`. The nose runs `rho_a` left of `a` and `rho_b` left of `b`,
/// mm; negative values mean right.
pub(super) fn vectors(
    a: &Piece,
    rho_a: f64,
    b: &Piece,
    rho_b: f64,
    role: Role,
) -> Result<Vectors, Fault> {
    for (piece, rho) in [(a, rho_a), (b, rho_b)] {
        if let Some(circle) = &piece.circle {
            circle.check_room(rho)?;
        }
    }
    let vectors = if rho_a * rho_b < 0.0 {
        Ok(change_of_side(a, rho_a, b, rho_b))
    } else {
        one_side(a, b, rho_b, role)
    };
    let is_finite = |vector: &Point| vector.x.is_finite() && vector.z.is_finite();
    match &vectors {
        Ok(found) if !found.all().iter().all(is_finite) => Err(Fault::NoResult),
        _ => vectors,
    }
}

/// The vector perpendicular to the end of a move.
pub(super) fn square_to_end(a: &Piece, rho: f64) -> Point {
    a.exit.left() * rho
}

/// The vector perpendicular to the start of a move.
pub(super) fn square_to_start(b: &Piece, rho: f64) -> Point {
    b.entry.left() * rho
}

#[inline(always)]
fn one_side(a: &Piece, b: &Piece, rho: f64, role: Role) -> Result<Vectors, Fault> {
    let (square_a, square_b) = (square_to_end(a, rho), square_to_start(b, rho));
    // The compensated move of a start-up or a cancel determines the vector.
    let kept = match role {
        Role::StartUp | Role::Both => square_b,
        Role::Cancel => square_a,
    };
    let around = role != Role::Both;
    let lines = a.circle.is_none() && b.circle.is_none();
    let bow = |first: bool, last: bool| bow(a, b, rho, first, last);
    let apart = square_a - square_b;
    let is_within = |distance: f64| apart.dot(apart) <= distance * distance;
    if role == Role::Both
        && is_within(TANGENT)
        && let Some(rests) = rests(a, b, rho)
    {
        return Ok(rests);
    }
    let meeting = || {
        let met = meet(a, rho, b, rho);
        if role == Role::Both && is_within(TANGENT_IF_SHORT) {
            near_tangent(a, b, rho, met)
        } else {
            met.map(Vectors::meeting)
        }
    };
    Ok(match angle(a.exit, b.entry, rho) {
        Angle::Straight => Vectors::of(&[kept]),
        Angle::Inner | Angle::InnerSharp if around => Vectors::of(&[kept]),
        Angle::InnerSharp => return Err(Fault::SharpCorner),
        Angle::OuterSharp if around && lines => Vectors::of(&[kept]),
        Angle::Obtuse | Angle::Acute | Angle::OuterSharp if around && START_TYPE == Type::A => {
            Vectors::of(&[kept])
        }
        Angle::Inner => return meeting(),
        Angle::Obtuse => match role {
            Role::StartUp => Vectors::of(&[square_a, meet(a, rho, b, rho)?]),
            Role::Both => return meeting(),
            Role::Cancel => Vectors::of(&[meet(a, rho, b, rho)?, square_b]),
        },
        Angle::Acute | Angle::OuterSharp => match role {
            Role::StartUp => bow(true, b.circle.is_some()),
            Role::Both => bow(a.circle.is_some(), b.circle.is_some()),
            Role::Cancel => bow(a.circle.is_some(), true),
        },
    })
}

/// The position where the nose rests at a corner with an inner arc that it fills.
fn rests(a: &Piece, b: &Piece, rho: f64) -> Option<Vectors> {
    let center = |piece: &Piece| piece.rest(rho).map(|center| center - b.start);
    match (center(a), center(b)) {
        (Some(one), Some(other)) => Some(Vectors::of(&[one, other])),
        (Some(one), None) | (None, Some(one)) => Some(Vectors::of(&[one])),
        (None, None) => None,
    }
}

/// A corner that would be tangent except for rounding. The paths of the nose centre then
/// meet at a grazing angle. A micrometre moves their meeting point by a multiple, past the
/// end of a short move, or there is no meeting point. The nose centre goes between the two
/// perpendicular vectors instead: their distance is below the effect of rounding.
///
/// ```text
///   offset of a ----------*---.___        * square to a, + square to b
///                          V +    `---.__ V between them
///   offset of b  ------------------------`-- meeting
/// ```
fn near_tangent(
    a: &Piece,
    b: &Piece,
    rho: f64,
    met: Result<Point, Fault>,
) -> Result<Vectors, Fault> {
    let (square_a, square_b) = (square_to_end(a, rho), square_to_start(b, rho));
    let shorter = a.length_of_chord().min(b.length_of_chord());
    let is_short = shorter < SHORT;
    // Beside an arc that the nose fills, the rest of its path is a circle of the size of
    // rounding: a meeting point means nothing.
    if is_short && let Some(rests) = rests(a, b, rho) {
        return Ok(rests);
    }
    let between = || Vectors::of(&[(square_a + square_b) * 0.5]);
    match met {
        Ok(meeting) => {
            let off = (meeting - square_a)
                .length()
                .min((meeting - square_b).length());
            Ok(if is_short && off > shorter / 2.0 {
                between()
            } else {
                Vectors::meeting(meeting)
            })
        }
        Err(Fault::NoMeetingLineArc | Fault::NoMeetingArcLine | Fault::NoMeetingOfArcs)
            if is_short =>
        {
            Ok(between())
        }
        Err(fault) => Err(fault),
    }
}

/// Goes around an acute corner: both paths of the nose centre continue by r.
fn bow(a: &Piece, b: &Piece, rho: f64, with_first: bool, with_last: bool) -> Vectors {
    let (square_a, square_b) = (square_to_end(a, rho), square_to_start(b, rho));
    let r = rho.abs();
    let points = [
        square_a,
        square_a + a.exit * r,
        square_b - b.entry * r,
        square_b,
    ];
    let (from, to) = (usize::from(!with_first), 3 + usize::from(with_last));
    Vectors::of(points.get(from..to).unwrap_or(&[]))
}

/// Change between G41 and G42: the intersection if it is within the moves, else one vector
/// perpendicular to each move.
///
/// ```text
///    A -----P            A ------P
///   --------*  offset       -----* ρA nA
///           | \ B            B   |  straight from one to the other
///           |  \         *-------- ρB nB
/// ```
fn change_of_side(a: &Piece, rho_a: f64, b: &Piece, rho_b: f64) -> Vectors {
    let (square_a, square_b) = (square_to_end(a, rho_a), square_to_start(b, rho_b));
    if (square_a - square_b).length() <= ONE_VECTOR {
        return Vectors::of(&[square_b]);
    }
    let turns = a.exit.dot(b.entry) <= COS_1_DEGREE;
    let meeting = if turns {
        meet(a, rho_a, b, rho_b).ok()
    } else {
        None
    };
    let lines = a.circle.is_none() && b.circle.is_none();
    let within = |meeting: &Point| {
        !lines
            || ((*meeting - square_a).dot(a.exit) > -a.length_of_chord()
                && (*meeting - square_b).dot(b.entry) < b.length_of_chord())
    };
    match meeting.filter(within) {
        Some(meeting) => Vectors::of(&[meeting]),
        None => Vectors::of(&[square_a, square_b]),
    }
}
