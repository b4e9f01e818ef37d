//! The outline of the finished part, from which its drawing is made.
//!
//! ```text
//!   Line(50, -40)
//!        |____  Line(40, -40)        pieces run from the front (z = 0) to the back;
//!             |                      x is a diameter, z is negative
//!             |____ Line(40, 0)
//!   -.-.-.-.-.-.-.-| Line(0, 0)
//! ```

mod locate;

use gsk_core::units::{Diameter, Point};
use gsk_messages::{Message, say};
use serde::Deserialize;

use crate::criterion::PartSurface;
pub use locate::{DimensionPlace, locate};

/// Greatest coordinate of an outline, mm.
const MAX_SIZE: f64 = 10_000.0;
/// Number of straight lines by which an arc is drawn.
const ARC_STEPS: u32 = 16;
/// Length by which an arc may be too short for its chord, mm: sizes on a drawing are rounded.
const ARC_TOLERANCE: f64 = 0.01;

/// The outline as written in a task file: a list of points, the first of which is the start.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutlineFile {
    outside: Vec<OutlineEnd>,
    #[serde(default)]
    bore: Vec<OutlineEnd>,
}

/// The end of an outline piece as written in a task file: diameter and z, then the radius of an arc
/// or the pitch of a thread.
#[derive(Clone, Copy, Debug, Deserialize)]
enum OutlineEnd {
    Line(f64, f64),
    Arc(f64, f64, f64),
    Thread(f64, f64, f64),
}

impl OutlineEnd {
    const fn point(self) -> Point {
        let (Self::Line(x, z) | Self::Arc(x, z, _) | Self::Thread(x, z, _)) = self;
        Point::from_diameter(Diameter(x), z)
    }
}

/// The form of an outline piece: line, arc or thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PieceForm {
    /// A straight line.
    Line,
    /// An arc with this radius, mm; negative if it is concave.
    Arc(f64),
    /// A thread with this pitch, mm.
    Thread(f64),
}

/// A piece of an outline, from the front to the back. X is a radius; z is 0 at the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlinePiece {
    /// The end of the piece nearer to the front of the part.
    pub from: Point,
    /// The end of the piece nearer to the back of the part.
    pub to: Point,
    /// Whether the piece is a line, an arc or a thread.
    pub form: PieceForm,
}

impl OutlinePiece {
    /// Returns whether the piece is a face, perpendicular to the axis.
    pub fn is_face(&self) -> bool {
        self.from.z == self.to.z
    }

    /// Returns whether the piece is parallel to the axis.
    pub fn is_cylinder(&self) -> bool {
        self.from.x == self.to.x && !matches!(self.form, PieceForm::Arc(_))
    }

    /// Returns the point halfway along the piece on the outside or bore surface.
    pub fn middle(&self, surface: PartSurface) -> Point {
        let points = self.points(surface);
        match self.form {
            PieceForm::Arc(_) => points.get((points.len() / 2).saturating_sub(1)).copied(),
            PieceForm::Line | PieceForm::Thread(_) => None,
        }
        .unwrap_or((self.from + self.to) * 0.5)
    }

    /// Returns the points along the piece without its first one; an arc is split into lines.
    fn points(&self, surface: PartSurface) -> Vec<Point> {
        let PieceForm::Arc(radius) = self.form else {
            return vec![self.to];
        };
        let chord = self.to - self.from;
        let half = chord.length() / 2.0;
        let Some(along) = chord.unit() else {
            return vec![self.to];
        };
        let distance = (radius * radius - half * half).max(0.0).sqrt();
        // Left of the way to the back lies the axis: the material outside, the air in a bore.
        let is_left = (radius > 0.0) == (surface == PartSurface::Outside);
        let to_centre = along.left() * if is_left { 1.0 } else { -1.0 };
        let centre = (self.from + self.to) * 0.5 + to_centre * distance;
        let (start, end) = (self.from - centre, self.to - centre);
        let angle = start.cross(end).atan2(start.dot(end));
        let turned = (1..ARC_STEPS).map(|step| {
            let turn = angle * f64::from(step) / f64::from(ARC_STEPS);
            let (sin, cos) = turn.sin_cos();
            centre + start * cos + start.left() * sin
        });
        turned.chain([self.to]).collect()
    }
}

/// The outline of the finished part: its outside and its bore.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskOutline {
    outside: Vec<OutlinePiece>,
    bore: Vec<OutlinePiece>,
}

impl TaskOutline {
    /// Checks an outline of a task file.
    ///
    /// # Errors
    ///
    /// The message names the rule that the outline breaks.
    pub fn read(raw: &OutlineFile) -> Result<Self, Message> {
        if raw.outside.len() < 2 {
            return Err(say::exercise_outline_short());
        }
        Ok(Self {
            outside: read_pieces(&raw.outside)?,
            bore: read_pieces(&raw.bore)?,
        })
    }

    /// Returns the pieces of the outside or of the bore, from the front to the back.
    pub fn pieces(&self, surface: PartSurface) -> &[OutlinePiece] {
        match surface {
            PartSurface::Outside => &self.outside,
            PartSurface::Bore => &self.bore,
        }
    }

    /// Returns the points of the outside or of the bore, from the front to the back; X is a radius,
    /// mm.
    pub fn points(&self, surface: PartSurface) -> Vec<Point> {
        let pieces = self.pieces(surface);
        let first = pieces.first().map(|piece| piece.from);
        let rest = pieces.iter().flat_map(|piece| piece.points(surface));
        first.into_iter().chain(rest).collect()
    }

    /// Returns length and greatest radius of the outline, mm.
    pub fn extent(&self) -> (f64, f64) {
        let length = self.outside.last().map_or(0.0, |piece| -piece.to.z);
        let points = self.points(PartSurface::Outside);
        let radius = points.iter().map(|point| point.x).fold(0.0, f64::max);
        (length, radius)
    }
}

fn read_pieces(ends: &[OutlineEnd]) -> Result<Vec<OutlinePiece>, Message> {
    for end in ends {
        let point = end.point();
        let is_inside = (0.0..=MAX_SIZE).contains(&point.x) && (-MAX_SIZE..=0.0).contains(&point.z);
        if !is_inside {
            return Err(say::exercise_outline_point(point.diameter().0, point.z));
        }
    }
    let mut pieces = Vec::new();
    for pair in ends.windows(2) {
        let [from, to] = [pair[0].point(), pair[1].point()];
        if to.z > from.z {
            return Err(say::exercise_outline_forward(to.diameter().0, to.z));
        }
        let form = match pair[1] {
            OutlineEnd::Line(..) => PieceForm::Line,
            OutlineEnd::Arc(_, _, radius) => {
                let least = (to - from).length() / 2.0;
                if !(least - ARC_TOLERANCE..=MAX_SIZE).contains(&radius.abs()) {
                    return Err(say::exercise_outline_arc(radius, least));
                }
                PieceForm::Arc(radius)
            }
            OutlineEnd::Thread(_, _, pitch) => {
                if !(0.01..=100.0).contains(&pitch) {
                    return Err(say::exercise_outline_pitch(pitch));
                }
                PieceForm::Thread(pitch)
            }
        };
        pieces.push(OutlinePiece { from, to, form });
    }
    if ends.first().is_some_and(|end| end.point().z != 0.0) {
        return Err(say::exercise_outline_front());
    }
    Ok(pieces)
}
