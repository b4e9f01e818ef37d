//! The path of the imaginary tip along an outline, so that the nose of the insert leaves the
//! outline exactly, or the outline itself for G41 and G42.
//!
//! The tip is the centre of the nose moved by the nose radius along X and Z. Along cylinders
//! and faces the path of the tip is therefore the outline itself. Inside a hole X is mirrored:
//! the tool is always to the right of its travel.

use gsk_messages::{Message, say};
use gsk_outline::{
    ArcFormat, CutRule, OutlineBlocks, ProfilePiece, end_clearance, find_gouge, follow_outline,
};
use gsk_units::Point;
use libm::fabs;

use crate::contour::{CornerShape, OutlineSolution, SolvedPiece, round_corners};
use crate::thousandths::Thousandths;

/// Lines shorter than this are left out, mm.
const SHORTEST_MM: f64 = 1e-6;
/// Length by which the first line begins in front of the part, beyond twice the nose radius,
/// mm.
const LEAD_IN_MM: f64 = 0.2;
/// Length of the block that cancels G41 and G42, beyond twice the nose radius, mm.
const CANCEL_MM: f64 = 1.0;

/// The side of the part that is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CutSide {
    Outside,
    Inside,
}

impl CutSide {
    /// 1 outside, −1 inside.
    pub(crate) const fn sign(self) -> f64 {
        match self {
            Self::Outside => 1.0,
            Self::Inside => -1.0,
        }
    }
}

/// How the outline is cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContourCut {
    pub(crate) side: CutSide,
    /// Nose radius of the insert, mm.
    pub(crate) nose: f64,
    /// Z in front of the part where the cut begins, mm.
    pub(crate) start_z: f64,
    /// Diameter at which the cut ends, outside the stock or within the hole, mm.
    pub(crate) end_diameter: f64,
    /// Corner angle of the insert that cuts undercuts, degrees; `None`: undercuts are refused.
    pub(crate) insert: Option<f64>,
    /// Whether the control allows for the nose, with G41 or G42.
    pub(crate) is_compensated: bool,
}

impl ContourCut {
    /// The outline with its corners, X mirrored inside, up to the end diameter.
    pub(crate) fn finished(&self, outline: &OutlineSolution) -> Result<Vec<ProfilePiece>, Message> {
        let pieces = finished_outline(outline, self.side, Some(self.end_x()))?;
        self.check_direction(&pieces)?;
        Ok(pieces)
    }

    /// X at which the cut ends, mirrored inside, mm.
    fn end_x(&self) -> f64 {
        self.side.sign() * self.end_diameter / 2.0 + self.nose
    }

    /// Refuses lines away from the chuck, and those that the insert cannot follow.
    fn check_direction(&self, pieces: &[ProfilePiece]) -> Result<(), Message> {
        let rule = match self.insert {
            None => CutRule::Roughing,
            insert => CutRule::Finishing { insert },
        };
        let Some(fault) = rule.find_fault(pieces) else {
            return Ok(());
        };
        let x = Thousandths::round(fault.at.x * self.side.sign() * 2.0);
        let z = Thousandths::round(fault.at.z);
        Err(match (fault.descent.zip(self.insert), self.side) {
            (Some((descent, insert)), _) => {
                say::form_outline_insert(x, z, descent, insert, end_clearance(insert))
            }
            (None, CutSide::Outside) => say::form_outline_undercut(x, z),
            (None, CutSide::Inside) => say::form_outline_undercut_inside(x, z),
        })
    }

    /// The path of the tip, X mirrored inside: the first piece goes along Z.
    pub(crate) fn tip_path(&self, finished: &[ProfilePiece]) -> Result<Vec<ProfilePiece>, Message> {
        let led_in = self.with_lead_in(finished);
        if self.is_compensated {
            return Ok(self.with_cancel_block(led_in));
        }
        let too_small = |at: Point| {
            let x = Thousandths::round(at.x * self.side.sign() * 2.0);
            let nose = Thousandths::round(self.nose);
            say::form_corner_below_nose(x, Thousandths::round(at.z), nose)
        };
        let center = follow_outline(&led_in, self.nose).map_err(too_small)?;
        if self.insert.is_some()
            && let Some(at) = find_gouge(&center, finished, self.nose)
        {
            return Err(too_small(at));
        }
        let to_tip = Point::new(-self.nose, -self.nose);
        Ok((center.iter())
            .map(|piece| piece.placed(1.0, to_tip))
            .collect())
    }

    /// Begins the first line in front of the part, and the whole cut at `start_z`.
    fn with_lead_in(&self, finished: &[ProfilePiece]) -> Vec<ProfilePiece> {
        let mut path = Vec::new();
        let Some(first) = finished.first() else {
            return path;
        };
        let lead_in = match self.nose > 0.0 {
            true => 2.0 * self.nose + LEAD_IN_MM,
            false => 0.0,
        };
        let direction = first.direction_at(0.0);
        let begin = first.start - direction * lead_in;
        let front = Point::new(begin.x, self.start_z);
        push_line(&mut path, ProfilePiece::line(front, begin));
        push_line(&mut path, ProfilePiece::line(begin, first.start));
        for piece in finished {
            match piece.is_arc() {
                true => path.push(*piece),
                false => push_line(&mut path, *piece),
            }
        }
        path
    }

    /// Adds the block in which the control cancels the compensation, away from the part.
    fn with_cancel_block(&self, mut path: Vec<ProfilePiece>) -> Vec<ProfilePiece> {
        if let Some(last) = path.last() {
            let away = Point::new(2.0 * self.nose + CANCEL_MM, 0.0);
            path.push(ProfilePiece::line(last.end, last.end + away));
        }
        path
    }

    /// The blocks of a path, with X mirrored back.
    pub(crate) fn blocks(&self, path: &[ProfilePiece]) -> Result<OutlineBlocks, Message> {
        let one_way = self.insert.is_none();
        let blocks = OutlineBlocks::from_pieces(path, ArcFormat::RadiusOrCenter, one_way);
        let blocks = blocks.map_err(|index| {
            let at = path[index].start;
            let x = Thousandths::round(at.x * self.side.sign() * 2.0);
            say::form_arc_not_exact(x, Thousandths::round(at.z))
        })?;
        Ok(match self.side {
            CutSide::Outside => blocks,
            CutSide::Inside => blocks.mirrored(),
        })
    }
}

/// The outline with its corners, X mirrored inside; with `end_x` up to this X.
pub(crate) fn finished_outline(
    outline: &OutlineSolution,
    side: CutSide,
    end_x: Option<f64>,
) -> Result<Vec<ProfilePiece>, Message> {
    let sign = side.sign();
    let mut pieces: Vec<SolvedPiece> = (outline.pieces.iter())
        .map(|solved| SolvedPiece {
            piece: match side {
                CutSide::Outside => solved.piece,
                CutSide::Inside => solved.piece.mirrored(),
            },
            ..*solved
        })
        .collect();
    let (Some(first), Some(last)) = (pieces.first().copied(), pieces.last().copied()) else {
        return Ok(Vec::new());
    };
    // The face in front of an edge, which its corner shortens.
    let start = first.piece.start;
    let face_length = match outline.first_corner {
        CornerShape::Sharp => 0.0,
        CornerShape::Radius(size) | CornerShape::Chamfer(size) => 4.0 * size.value(),
    };
    if face_length > 0.0 {
        let face = ProfilePiece::line(Point::new(start.x - face_length, start.z), start);
        pieces.insert(
            0,
            SolvedPiece {
                piece: face,
                corner: outline.first_corner,
                number: 1,
            },
        );
    }
    let end = last.piece.end;
    if let Some(end_x) = end_x.filter(|end_x| end_x - end.x > SHORTEST_MM) {
        pieces.push(SolvedPiece {
            piece: ProfilePiece::line(end, Point::new(end_x, end.z)),
            corner: CornerShape::Sharp,
            number: last.number,
        });
    }
    let mut finished = round_corners(&pieces, sign)?;
    if face_length > 0.0 && !finished.is_empty() {
        finished.remove(0);
    }
    Ok(finished)
}

/// Adds a line, to the line before it if both have one direction.
fn push_line(path: &mut Vec<ProfilePiece>, line: ProfilePiece) {
    if line.length() < SHORTEST_MM {
        return;
    }
    let direction = line.direction_at(0.0);
    match path.last_mut() {
        Some(last)
            if !last.is_arc()
                && fabs(last.direction_at(0.0).cross(direction)) < 1e-9
                && last.direction_at(0.0).dot(direction) > 0.0 =>
        {
            last.end = line.end;
        }
        _ => path.push(line),
    }
}
