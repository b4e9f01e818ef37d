//! The corner between two moves: the vectors from the programmed point to the
//! nose centre, one after the other (manual II, C compensation).
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
//! α is the angle on the side of the workpiece. The tool goes straight from one
//! vector to the next.

use serde::{Deserialize, Serialize};

use super::fault::Fault;
use super::intersection::meet;
use super::piece::Piece;
use super::plane::{cross, dot, left};
use crate::units::Point;

/// Vectors nearer than this are one, mm.
const ONE_VECTOR: f64 = 0.001;
/// Directions whose cross product is less are parallel.
const PARALLEL: f64 = 1e-9;
/// Cosine of one degree.
const COS_1_DEGREE: f64 = 0.999_847_695_156_391_3;

/// Where a start-up or a cancel ends and begins: type A has the vector square to
/// the compensated move only, type B goes round the corner as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    /// Only for machines that are set so.
    A,
    B,
}

/// The type this control has.
const START_TYPE: Type = Type::B;

/// What the two moves of a corner are to the compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// The first one starts the compensation.
    StartUp,
    /// Both are compensated.
    Both,
    /// The second one cancels it.
    Cancel,
}

/// The vectors of a corner, in order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Vectors {
    list: [Point; 4],
    count: u8,
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

/// The kind of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Angle {
    /// No turn worth a second vector.
    Straight,
    Inner,
    /// Inner, with less than one degree between the paths.
    InnerSharp,
    Obtuse,
    Acute,
    /// Outer, with less than one degree between the paths.
    OuterSharp,
}

/// The angle between two directions of travel with the nose on the left
/// (`rho` > 0) or on the right.
fn angle(exit: Point, entry: Point, rho: f64) -> Angle {
    if (exit - entry).length() * rho.abs() <= ONE_VECTOR {
        return Angle::Straight;
    }
    let along = dot(exit, entry);
    let turn = cross(exit, entry) * rho.signum();
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

/// The vectors at the end of `a`. The nose runs `rho_a` left of it and `rho_b`
/// left of `b`; right when negative.
pub(super) fn vectors(
    a: &Piece,
    rho_a: f64,
    b: &Piece,
    rho_b: f64,
    role: Role,
) -> Result<Vectors, Fault> {
    for (piece, rho) in [(a, rho_a), (b, rho_b)] {
        if let Some(circle) = &piece.circle {
            circle.offset_radius(rho)?;
        }
    }
    let vectors = if rho_a * rho_b < 0.0 {
        change_of_side(a, rho_a, b, rho_b)
    } else {
        one_side(a, b, rho_b, role)?
    };
    let finite = vectors
        .all()
        .iter()
        .all(|vector| vector.length().is_finite());
    if finite {
        Ok(vectors)
    } else {
        Err(Fault::NoResult)
    }
}

/// Square to the end of a move.
pub(super) fn square_to_end(a: &Piece, rho: f64) -> Point {
    left(a.exit) * rho
}

/// Square to the start of a move.
pub(super) fn square_to_start(b: &Piece, rho: f64) -> Point {
    left(b.entry) * rho
}

fn one_side(a: &Piece, b: &Piece, rho: f64, role: Role) -> Result<Vectors, Fault> {
    let (square_a, square_b) = (square_to_end(a, rho), square_to_start(b, rho));
    // The compensated move of a start-up or a cancel decides.
    let kept = match role {
        Role::StartUp | Role::Both => square_b,
        Role::Cancel => square_a,
    };
    let around = role != Role::Both;
    let lines = a.circle.is_none() && b.circle.is_none();
    let bow = |first: bool, last: bool| bow(a, b, rho, first, last);
    Ok(match angle(a.exit, b.entry, rho) {
        Angle::Straight => Vectors::of(&[kept]),
        Angle::Inner | Angle::InnerSharp if around => Vectors::of(&[kept]),
        Angle::InnerSharp => return Err(Fault::SharpCorner),
        Angle::OuterSharp if around && lines => Vectors::of(&[kept]),
        Angle::Obtuse | Angle::Acute | Angle::OuterSharp if around && START_TYPE == Type::A => {
            Vectors::of(&[kept])
        }
        Angle::Inner => Vectors::of(&[meet(a, rho, b, rho)?]),
        Angle::Obtuse => {
            let meeting = meet(a, rho, b, rho)?;
            match role {
                Role::StartUp => Vectors::of(&[square_a, meeting]),
                Role::Both => Vectors::of(&[meeting]),
                Role::Cancel => Vectors::of(&[meeting, square_b]),
            }
        }
        Angle::Acute | Angle::OuterSharp => match role {
            Role::StartUp => bow(true, b.circle.is_some()),
            Role::Both => bow(a.circle.is_some(), b.circle.is_some()),
            Role::Cancel => bow(a.circle.is_some(), true),
        },
    })
}

/// Round an acute corner: both paths of the nose centre go on by r.
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

/// From G41 to G42 or back: the intersection if there is one within the moves,
/// else square to both.
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
    let turns = dot(a.exit, b.entry) <= COS_1_DEGREE;
    let meeting = if turns {
        meet(a, rho_a, b, rho_b).ok()
    } else {
        None
    };
    let lines = a.circle.is_none() && b.circle.is_none();
    let within = |meeting: &Point| {
        !lines
            || (dot(*meeting - square_a, a.exit) > -a.length_of_chord()
                && dot(*meeting - square_b, b.entry) < b.length_of_chord())
    };
    match meeting.filter(within) {
        Some(meeting) => Vectors::of(&[meeting]),
        None => Vectors::of(&[square_a, square_b]),
    }
}
