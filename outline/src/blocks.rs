//! The outline as blocks: ends on the grid of the control, arcs by R or by I and K.
//!
//! The control keeps a centre by I and K if the end is within 0.002 mm of the circle, and finds
//! it from both ends with R (at most half a turn). Of both forms, and of the values around the
//! rounded ones, the arc nearest to the drawn one is written. An arc that none of them meets is
//! halved.

use gsk_messages::{Message, say};
use gsk_units::Point;

use crate::piece::ProfilePiece;
use crate::profile::TurnedProfile;

/// Greatest distance of a written arc from the drawn one, mm.
const ARC_TOLERANCE_MM: f64 = 0.001;
/// Greatest distance at which R is written though I and K may be nearer, mm.
const GOOD_ARC_MM: f64 = 0.000_6;
/// Greatest difference of the radii at both ends of an arc by I and K, mm.
const MAX_RADIUS_DIFFERENCE_MM: f64 = 0.000_8;
/// How often an arc is halved at most.
const MAX_DEPTH: u32 = 8;
/// Number of points at which arcs are compared.
const SAMPLES: u32 = 16;
/// Greatest R, I and K, thousandths of a millimetre.
const MAX_VALUE: i64 = 9_999_999;

/// A point on the grid of the control, thousandths of a millimetre; X is a diameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridEnd {
    /// X as a diameter.
    pub x: i64,
    /// Z.
    pub z: i64,
}

impl GridEnd {
    fn round(point: Point) -> Self {
        let round = |value: f64| libm::round(value * 1000.0) as i64;
        Self {
            x: round(point.x * 2.0),
            z: round(point.z),
        }
    }

    fn to_point(self) -> Point {
        Point::new(self.x as f64 / 2000.0, self.z as f64 / 1000.0)
    }
}

/// How a block reaches its end; values in thousandths of a millimetre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockShape {
    /// G01.
    Line,
    /// G02 or G03 with R.
    Radius {
        /// G02 instead of G03.
        clockwise: bool,
        /// The radius.
        r: i64,
    },
    /// G02 or G03 with I and K.
    Center {
        /// G02 instead of G03.
        clockwise: bool,
        /// From the start to the centre along X, a radius.
        i: i64,
        /// From the start to the centre along Z.
        k: i64,
    },
}

/// A block of the outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutlineBlock {
    /// Where the block ends.
    pub end: GridEnd,
    /// Its path.
    pub shape: BlockShape,
}

/// The outline on the grid of the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutlineBlocks {
    /// Where the outline begins.
    pub start: GridEnd,
    /// Its blocks in order.
    pub blocks: Vec<OutlineBlock>,
}

/// The words that an arc may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcFormat {
    /// R, or I and K where they are nearer to the arc.
    RadiusOrCenter,
    /// R alone; an arc that R does not keep is split.
    RadiusOnly,
}

impl OutlineBlocks {
    /// The blocks of pieces of which each begins where the last one ends. With `one_way`
    /// rounding never makes X smaller or Z greater than before.
    ///
    /// # Errors
    /// The index of an arc that cannot be written within 0.001 mm.
    pub fn from_pieces(
        pieces: &[ProfilePiece],
        words: ArcFormat,
        one_way: bool,
    ) -> Result<Self, usize> {
        let first = pieces.first().map(|piece| piece.start);
        let start = GridEnd::round(first.unwrap_or_default());
        let mut writer = BlockWriter {
            at: start,
            words,
            one_way,
            blocks: Vec::new(),
        };
        for (index, piece) in pieces.iter().enumerate() {
            if !writer.add_piece(piece, MAX_DEPTH) {
                return Err(index);
            }
        }
        Ok(Self {
            start,
            blocks: writer.blocks,
        })
    }
}

impl OutlineBlocks {
    /// The blocks mirrored in the spindle axis.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mirror = |end: GridEnd| GridEnd { x: -end.x, ..end };
        let blocks = self.blocks.iter().map(|block| OutlineBlock {
            end: mirror(block.end),
            shape: match block.shape {
                BlockShape::Line => BlockShape::Line,
                BlockShape::Radius { clockwise, r } => BlockShape::Radius {
                    clockwise: !clockwise,
                    r,
                },
                BlockShape::Center { clockwise, i, k } => BlockShape::Center {
                    clockwise: !clockwise,
                    i: -i,
                    k,
                },
            },
        });
        Self {
            start: mirror(self.start),
            blocks: blocks.collect(),
        }
    }
}

impl TurnedProfile {
    /// The blocks of the outline. With `one_way` rounding never makes X smaller or Z greater
    /// than before.
    ///
    /// # Errors
    /// An arc cannot be written within 0.001 mm.
    pub fn write_blocks(&self, words: ArcFormat, one_way: bool) -> Result<OutlineBlocks, Message> {
        let pieces: Vec<ProfilePiece> = self.pieces().copied().collect();
        OutlineBlocks::from_pieces(&pieces, words, one_way).map_err(|index| {
            let traced = &self.traced[index];
            let at = traced.piece.start;
            say::outline_arc_not_exact(self.entity_name(traced), at.x * 2.0, at.z)
        })
    }
}

struct BlockWriter {
    at: GridEnd,
    words: ArcFormat,
    one_way: bool,
    blocks: Vec<OutlineBlock>,
}

impl BlockWriter {
    /// Adds the blocks of a piece. Returns false for an arc that no form meets.
    fn add_piece(&mut self, piece: &ProfilePiece, depth: u32) -> bool {
        let mut end = GridEnd::round(piece.end);
        if self.one_way {
            end = GridEnd {
                x: end.x.max(self.at.x),
                z: end.z.min(self.at.z),
            };
        }
        if end == self.at && piece.length() < 0.002 {
            return true;
        }
        if let Some(shape) = self.best_shape(end, piece) {
            self.blocks.push(OutlineBlock { end, shape });
            self.at = end;
            return true;
        }
        let (first, second) = piece.split_at(0.5);
        depth > 0 && self.add_piece(&first, depth - 1) && self.add_piece(&second, depth - 1)
    }

    /// The form of a block that is nearest to the piece; `None` if an arc must be halved.
    fn best_shape(&self, end: GridEnd, piece: &ProfilePiece) -> Option<BlockShape> {
        let start = self.at;
        let Some(center) = piece.center() else {
            return Some(BlockShape::Line);
        };
        let sagitta = piece.radius() * (1.0 - libm::cos(piece.sweep() / 2.0));
        if sagitta < ARC_TOLERANCE_MM / 4.0 {
            return Some(BlockShape::Line);
        }
        if start == end {
            return None;
        }
        let clockwise = piece.bulge < 0.0;
        let by_radius = best_radius(start, end, piece, clockwise);
        if let Some((shape, distance)) = by_radius
            && distance <= GOOD_ARC_MM
        {
            return Some(shape);
        }
        let by_center = match self.words {
            ArcFormat::RadiusOnly => None,
            ArcFormat::RadiusOrCenter => best_center(start, end, piece, center, clockwise),
        };
        let forms = by_radius.into_iter().chain(by_center);
        let nearest = forms.min_by(|a, b| a.1.total_cmp(&b.1));
        let (shape, distance) = nearest?;
        (distance <= ARC_TOLERANCE_MM).then_some(shape)
    }
}

fn best_radius(
    start: GridEnd,
    end: GridEnd,
    piece: &ProfilePiece,
    clockwise: bool,
) -> Option<(BlockShape, f64)> {
    let (from, to) = (start.to_point(), end.to_point());
    let rounded = libm::round(piece.radius() * 1000.0) as i64;
    let candidates = [rounded, rounded - 1, rounded + 1];
    let candidates = candidates
        .into_iter()
        .filter(|r| (1..=MAX_VALUE).contains(r));
    let mut arcs = candidates.filter_map(|r| {
        let radius = r as f64 / 1000.0;
        let half = (to - from).length() / 2.0;
        let square = radius * radius - half * half;
        if square < 0.0 || half == 0.0 {
            return None;
        }
        let side = if clockwise { -1.0 } else { 1.0 };
        let height = square.sqrt() * side / (2.0 * half);
        let center = (from + to) * 0.5 + (to - from).left() * height;
        let distance = greatest_distance(piece, center, (radius, radius));
        Some((BlockShape::Radius { clockwise, r }, distance))
    });
    let first = arcs.next();
    if first.is_some_and(|(shape, distance)| {
        // The radius of the drawing is what a reader looks for.
        shape
            == (BlockShape::Radius {
                clockwise,
                r: rounded,
            })
            && distance <= GOOD_ARC_MM
    }) {
        return first;
    }
    first
        .into_iter()
        .chain(arcs)
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

fn best_center(
    start: GridEnd,
    end: GridEnd,
    piece: &ProfilePiece,
    center: Point,
    clockwise: bool,
) -> Option<(BlockShape, f64)> {
    let (from, to) = (start.to_point(), end.to_point());
    let vector = center - from;
    let round = |value: f64| libm::round(value * 1000.0) as i64;
    let (near_i, near_k) = (round(vector.x), round(vector.z));
    let candidates =
        (near_i - 1..=near_i + 1).flat_map(|i| (near_k - 1..=near_k + 1).map(move |k| (i, k)));
    let is_valid =
        |(i, k): &(i64, i64)| i.abs() <= MAX_VALUE && k.abs() <= MAX_VALUE && (*i, *k) != (0, 0);
    let arcs = candidates.filter(is_valid).filter_map(|(i, k)| {
        let center = from + Point::new(i as f64 / 1000.0, k as f64 / 1000.0);
        let radii = ((from - center).length(), (to - center).length());
        if (radii.0 - radii.1).abs() > MAX_RADIUS_DIFFERENCE_MM {
            return None;
        }
        let distance = greatest_distance(piece, center, radii);
        Some((BlockShape::Center { clockwise, i, k }, distance))
    });
    arcs.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The greatest distance of a drawn arc from one about `center` whose radius changes from the
/// first to the second of `radii`.
fn greatest_distance(piece: &ProfilePiece, center: Point, radii: (f64, f64)) -> f64 {
    let samples = (0..=SAMPLES).map(|index| f64::from(index) / f64::from(SAMPLES));
    let distances = samples.map(|at| {
        let radius = radii.0 + (radii.1 - radii.0) * at;
        ((piece.point_at(at) - center).length() - radius).abs()
    });
    distances.fold(0.0, f64::max)
}
