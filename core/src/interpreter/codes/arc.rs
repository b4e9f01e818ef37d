//! Finds the centre of a circular cut, G02 and G03 (manual I-3.2.2.3).
//!
//! ```text
//!            X ^        G02 turns clockwise as drawn, G03 the other way.
//!              |  S     With R the centre M lies on the right of the travel
//!              | /:\    S -> E for G02, on the left for G03, arc <= 180°:
//!              |/ :c\
//!     h = √(R²-c²)---M  c half the chord, M = middle of the chord + h·normal
//!              |\ : /
//!              | \:/    With I, K: M = S + (I, K), I a radius value.
//!              |  E
//!     ---------+-----------------> Z
//! ```
//!
//! On the NC-B08 a negative R commands the arc of 180° and more, with the centre on the other
//! side. A full circle needs I and K there.

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::words::ArcWords;
use crate::model::{GCode, Record};
use crate::units::Point;

/// Greatest distance of the end point from the programmed circle that leaves the centre as
/// programmed, in half units of [`Exact`] (0.002 mm).
const FIT: f64 = 4000.0;

/// Half units of [`Exact`] in a millimetre. X radii are whole numbers of half units.
const HALF_UNITS: f64 = 2_000_000.0;

/// Direction of an arc, and what its R and I mean on a control model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    clockwise: bool,
    /// Whether a negative R commands an arc of 180° and more.
    long: bool,
    /// Whether I is a difference of diameters instead of a radius.
    diameters: bool,
}

impl Turn {
    /// The direction and the meaning of R and I in programs of a model.
    pub(crate) fn of(record: &Record, clockwise: bool) -> Self {
        let code = record.g_code(2);
        let diameters = code == Some(GCode::DiameterArcClockwise);
        Self {
            clockwise,
            long: diameters || code == Some(GCode::LongArcClockwise),
            diameters,
        }
    }
}

/// The centre of an arc, in programmed coordinates (mm, X as a radius); `None` if it has no
/// length (R and equal end points).
///
/// # Errors
/// 013 without a centre or radius, or with a radius that is too small; 023 for a negative R
/// and 433 for a full circle by R where the model excludes them.
pub(crate) fn center(
    start: Exact,
    end: Exact,
    words: ArcWords,
    turn: Turn,
) -> Result<Option<Point>, Alarm> {
    if let Some(r) = words.r {
        return by_radius(start, end, r, turn);
    }
    if words.i.is_none() && words.k.is_none() {
        return Err(fault(say::arc_radius_or_center_missing()));
    }
    let (i, k) = (words.i.unwrap_or(0), words.k.unwrap_or(0));
    // Doubled, because half of a diameter need not be a whole number.
    let double_i = i128::from(i) * if turn.diameters { 1 } else { 2 };
    by_vector(start, end, double_i, 2 * i128::from(k)).map(Some)
}

fn by_radius(start: Exact, end: Exact, r: i64, turn: Turn) -> Result<Option<Point>, Alarm> {
    if r < 0 && !turn.long {
        return Err(Alarm::new(number::NEGATIVE_RADIUS).because(say::arc_radius_negative()));
    }
    let chord = Chord::new(start, end);
    if chord.square == 0 {
        if turn.long {
            let rule = say::arc_full_circle_by_radius();
            return Err(Alarm::new(number::CIRCLE_BY_RADIUS).because(rule));
        }
        return Ok(None);
    }
    let diameter = 4 * i128::from(r);
    let Some(ratio) = chord.height_ratio(diameter * diameter) else {
        return Err(too_far(&chord, diameter as f64 / 2.0));
    };
    let right = turn.clockwise == (r >= 0);
    let side = if right { ratio } else { -ratio };
    Ok(Some(chord.beside(side)))
}

fn by_vector(start: Exact, end: Exact, x: i128, z: i128) -> Result<Point, Alarm> {
    let square = x * x + z * z;
    if square == 0 {
        return Err(fault(say::arc_vector_zero()));
    }
    let (center_x, center_z) = (i128::from(start.x) + x, 2 * i128::from(start.z) + z);
    let programmed = Point::new(float(center_x) / HALF_UNITS, float(center_z) / HALF_UNITS);
    let (to_x, to_z) = (
        i128::from(end.x) - center_x,
        2 * i128::from(end.z) - center_z,
    );
    let radius = float(square).sqrt();
    let at_end = float(to_x * to_x + to_z * to_z).sqrt();
    if (at_end - radius).abs() <= FIT {
        return Ok(programmed);
    }
    // The programmed centre does not fit the end: keep the radius and move the centre.
    let chord = Chord::new(start, end);
    let Some(ratio) = chord.height_ratio(4 * square) else {
        return Err(too_far(&chord, radius));
    };
    let (one, other) = (chord.beside(ratio), chord.beside(-ratio));
    let nearer = (one - programmed).length() <= (other - programmed).length();
    Ok(if nearer { one } else { other })
}

/// The straight connection of start and end, in half units of [`Exact`].
struct Chord {
    start_x: i128,
    start_z: i128,
    dx: i128,
    dz: i128,
    /// Square of its length.
    square: i128,
}

impl Chord {
    fn new(start: Exact, end: Exact) -> Self {
        let (dx, dz) = (
            i128::from(end.x) - i128::from(start.x),
            2 * (i128::from(end.z) - i128::from(start.z)),
        );
        Self {
            start_x: i128::from(start.x),
            start_z: 2 * i128::from(start.z),
            dx,
            dz,
            square: dx * dx + dz * dz,
        }
    }

    /// Distance of the centre from the chord as a multiple of its length; `None` if the chord
    /// is longer than the diameter.
    fn height_ratio(&self, diameter_square: i128) -> Option<f64> {
        let rest = diameter_square - self.square;
        if rest < 0 || self.square == 0 {
            return None;
        }
        Some((float(rest) / float(4 * self.square)).sqrt())
    }

    /// The point at `ratio` chord lengths to the right of the chord's middle, mm.
    fn beside(&self, ratio: f64) -> Point {
        let middle_x = float(2 * self.start_x + self.dx) / 2.0;
        let middle_z = float(2 * self.start_z + self.dz) / 2.0;
        Point::new(
            (middle_x - float(self.dz) * ratio) / HALF_UNITS,
            (middle_z + float(self.dx) * ratio) / HALF_UNITS,
        )
    }
}

/// The nearest floating-point number. Most values fit into 64 bits, whose conversion is fast.
fn float(value: i128) -> f64 {
    // A separate function, so that the compiler does not convert all values this way.
    #[cold]
    #[inline(never)]
    const fn wide(value: i128) -> f64 {
        value as f64
    }
    i64::try_from(value).map_or_else(|_| wide(value), |value| value as f64)
}

fn too_far(chord: &Chord, radius: f64) -> Alarm {
    let length = float(chord.square).sqrt() / HALF_UNITS;
    fault(say::arc_ends_too_far_apart(length, radius / HALF_UNITS))
}

fn fault(detail: Message) -> Alarm {
    Alarm::new(number::ARC_DATA).because(detail)
}
