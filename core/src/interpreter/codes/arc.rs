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
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::words::ArcWords;
use crate::model::{GCode, ModelRecord};
use crate::units::Point;

/// Greatest distance of the end point from the programmed circle that leaves the centre as
/// programmed, in half units of [`ExactPoint`] (0.002 mm).
const CENTER_TOLERANCE: f64 = 4000.0;

/// Number of half units of [`ExactPoint`] in a millimetre. X radii are whole numbers of half
/// units.
const HALF_UNITS_PER_MM: f64 = 2_000_000.0;

/// Direction of an arc, and the meaning of its R and I on a control model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArcTurn {
    clockwise: bool,
    /// Whether a negative R commands an arc of 180° and more; if not, it raises alarm 023.
    allows_long_arc: bool,
    /// Whether I is a difference of diameters instead of a radius.
    is_i_diameter: bool,
}

impl ArcTurn {
    /// Combines the direction of an arc with the meaning of R and I on the model of `record`.
    pub(crate) fn from_record(record: &ModelRecord, clockwise: bool) -> Self {
        Self {
            clockwise,
            allows_long_arc: allows_long_arc(record),
            is_i_diameter: record.g_code(2) == Some(GCode::DiameterArcClockwise),
        }
    }
}

/// Whether R of either sign commands an arc on the model of `record`: then R without an end
/// point is a full circle, and alarm 433.
pub(crate) fn allows_long_arc(record: &ModelRecord) -> bool {
    matches!(
        record.g_code(2),
        Some(GCode::DiameterArcClockwise | GCode::LongArcClockwise)
    )
}

/// Finds the centre of an arc, in programmed coordinates (mm, X as a radius). Returns `None`
/// if the arc has no length (R and equal end points).
///
/// # Errors
/// 013 without a centre or radius, or with a radius that is too small; 023 for a negative R
/// and 433 for a full circle by R where the model excludes them.
pub(crate) fn find_center(
    start: ExactPoint,
    end: ExactPoint,
    words: ArcWords,
    turn: ArcTurn,
) -> Result<Option<Point>, Alarm> {
    if let Some(r) = words.r {
        return find_center_by_radius(start, end, r, turn);
    }
    if words.i.is_none() && words.k.is_none() {
        return Err(arc_alarm(say::arc_radius_or_center_missing()));
    }
    let (i, k) = (words.i.unwrap_or(0), words.k.unwrap_or(0));
    // Doubled, because half of a diameter need not be a whole number.
    let double_i = i128::from(i) * if turn.is_i_diameter { 1 } else { 2 };
    find_center_by_vector(start, end, double_i, 2 * i128::from(k)).map(Some)
}

fn find_center_by_radius(
    start: ExactPoint,
    end: ExactPoint,
    r: i64,
    turn: ArcTurn,
) -> Result<Option<Point>, Alarm> {
    if r < 0 && !turn.allows_long_arc {
        return Err(Alarm::new(number::NEGATIVE_RADIUS).with_detail(say::arc_radius_negative()));
    }
    let chord = Chord::new(start, end);
    if chord.length_square == 0 {
        if turn.allows_long_arc {
            let rule = say::arc_full_circle_by_radius();
            return Err(Alarm::new(number::CIRCLE_BY_RADIUS).with_detail(rule));
        }
        return Ok(None);
    }
    let diameter = 4 * i128::from(r);
    let Some(ratio) = chord.height_ratio(diameter * diameter) else {
        return Err(too_far_alarm(&chord, diameter as f64 / 2.0));
    };
    let is_right = turn.clockwise == (r >= 0);
    let side = if is_right { ratio } else { -ratio };
    Ok(Some(chord.point_beside(side)))
}

fn find_center_by_vector(
    start: ExactPoint,
    end: ExactPoint,
    x: i128,
    z: i128,
) -> Result<Point, Alarm> {
    let radius_square = x * x + z * z;
    if radius_square == 0 {
        return Err(arc_alarm(say::arc_vector_zero()));
    }
    let (center_x, center_z) = (i128::from(start.x) + x, 2 * i128::from(start.z) + z);
    let programmed = Point::new(
        to_f64(center_x) / HALF_UNITS_PER_MM,
        to_f64(center_z) / HALF_UNITS_PER_MM,
    );
    let (to_x, to_z) = (
        i128::from(end.x) - center_x,
        2 * i128::from(end.z) - center_z,
    );
    let radius = to_f64(radius_square).sqrt();
    let end_distance = to_f64(to_x * to_x + to_z * to_z).sqrt();
    if (end_distance - radius).abs() <= CENTER_TOLERANCE {
        return Ok(programmed);
    }
    // The programmed centre does not fit the end: keep the radius and move the centre.
    let chord = Chord::new(start, end);
    let Some(ratio) = chord.height_ratio(4 * radius_square) else {
        return Err(too_far_alarm(&chord, radius));
    };
    let (right_center, left_center) = (chord.point_beside(ratio), chord.point_beside(-ratio));
    let is_right_nearer =
        (right_center - programmed).length() <= (left_center - programmed).length();
    Ok(if is_right_nearer {
        right_center
    } else {
        left_center
    })
}

/// The straight line from the start to the end of an arc, in half units of [`ExactPoint`].
struct Chord {
    start_x: i128,
    start_z: i128,
    dx: i128,
    dz: i128,
    /// Square of the chord's length, in squared half units.
    length_square: i128,
}

impl Chord {
    fn new(start: ExactPoint, end: ExactPoint) -> Self {
        let (dx, dz) = (
            i128::from(end.x) - i128::from(start.x),
            2 * (i128::from(end.z) - i128::from(start.z)),
        );
        Self {
            start_x: i128::from(start.x),
            start_z: 2 * i128::from(start.z),
            dx,
            dz,
            length_square: dx * dx + dz * dz,
        }
    }

    /// Distance of the centre from the chord as a multiple of the chord's length; `None` if
    /// the chord is longer than the diameter or has no length.
    fn height_ratio(&self, diameter_square: i128) -> Option<f64> {
        let height_square = diameter_square - self.length_square;
        if height_square < 0 || self.length_square == 0 {
            return None;
        }
        Some((to_f64(height_square) / to_f64(4 * self.length_square)).sqrt())
    }

    /// The point at `ratio` chord lengths to the right of the chord's middle, mm, X as a
    /// radius.
    fn point_beside(&self, ratio: f64) -> Point {
        let middle_x = to_f64(2 * self.start_x + self.dx) / 2.0;
        let middle_z = to_f64(2 * self.start_z + self.dz) / 2.0;
        Point::new(
            (middle_x - to_f64(self.dz) * ratio) / HALF_UNITS_PER_MM,
            (middle_z + to_f64(self.dx) * ratio) / HALF_UNITS_PER_MM,
        )
    }
}

/// Converts to the nearest floating-point number. Most values fit into 64 bits, whose
/// conversion is fast.
fn to_f64(value: i128) -> f64 {
    // A separate function, so that the compiler does not convert all values this way.
    #[cold]
    #[inline(never)]
    const fn convert_wide(value: i128) -> f64 {
        value as f64
    }
    i64::try_from(value).map_or_else(|_| convert_wide(value), |value| value as f64)
}

fn too_far_alarm(chord: &Chord, radius: f64) -> Alarm {
    let length = to_f64(chord.length_square).sqrt() / HALF_UNITS_PER_MM;
    arc_alarm(say::arc_ends_too_far_apart(
        length,
        radius / HALF_UNITS_PER_MM,
    ))
}

fn arc_alarm(detail: Message) -> Alarm {
    Alarm::new(number::ARC_DATA).with_detail(detail)
}
