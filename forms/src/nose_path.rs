//! The path of the imaginary tip along an outline, so that the nose of the insert leaves the
//! outline exactly.
//!
//! ```text
//!      centre of the nose: the outline, moved by the nose radius
//!   . - - - - .                       an arc keeps its centre: its radius grows
//!   ___________\  outline             outside and shrinks inside
//!               \
//! ```
//!
//! The tip is the centre moved by the nose radius along X and Z. Along cylinders and faces the
//! path of the tip is therefore the outline itself.

use gsk_messages::{Message, say};
use libm::{fabs, hypot, tan};

use crate::outline::{CornerShape, OutlineVertex};
use crate::thousandths::Thousandths;

/// Lines shorter than this are left out, mm.
const SHORTEST_MM: f64 = 1e-6;
/// Tolerance of a length that must not be negative, mm.
const TOLERANCE_MM: f64 = 1e-6;
/// Length by which the first line begins in front of the part, beyond twice the nose radius,
/// mm.
const LEAD_IN_MM: f64 = 0.2;

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

/// A block of the path: its end, X as a diameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PathBlock {
    pub(crate) x: Thousandths,
    pub(crate) z: Thousandths,
    /// Radius of the arc, and whether it is clockwise; `None` for a line.
    pub(crate) arc: Option<(Thousandths, bool)>,
}

/// How the outline is cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoseCut {
    pub(crate) side: CutSide,
    /// Nose radius of the insert, mm.
    pub(crate) nose: f64,
    /// Z in front of the part where the cut begins, mm.
    pub(crate) start_z: f64,
    /// Diameter at which the cut ends, outside the stock or within the hole, mm.
    pub(crate) end_diameter: f64,
}

/// A corner of the path and the radius of its arc.
#[derive(Clone, Copy, Debug)]
struct PathVertex {
    x: f64,
    z: f64,
    radius: f64,
    chamfer: f64,
}

#[derive(Clone, Copy, Debug)]
struct Direction {
    x: f64,
    z: f64,
    length: f64,
}

impl PathVertex {
    fn to(&self, next: &Self) -> Direction {
        let (x, z) = (next.x - self.x, next.z - self.z);
        let length = hypot(x, z);
        let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
        Direction {
            x: x * scale,
            z: z * scale,
            length,
        }
    }

    const fn moved(&self, direction: &Direction, distance: f64) -> Self {
        Self {
            x: self.x + direction.x * distance,
            z: self.z + direction.z * distance,
            radius: 0.0,
            chamfer: 0.0,
        }
    }
}

impl Direction {
    /// Length of the tangent from the corner to a touching arc of radius 1.
    fn tangent_factor(&self, next: &Self) -> f64 {
        let cosine = (self.x * next.x + self.z * next.z).clamp(-1.0, 1.0);
        let sine = self.turn(next);
        if cosine <= -1.0 {
            return f64::INFINITY;
        }
        fabs(sine) / (1.0 + cosine)
    }

    /// Sine of the turn; positive counter-clockwise with Z to the right and X up.
    const fn turn(&self, next: &Self) -> f64 {
        self.z * next.x - self.x * next.z
    }
}

impl NoseCut {
    /// The blocks of the path: the first is the approach along X, the second goes along Z.
    pub(crate) fn blocks(self, outline: &[OutlineVertex]) -> Result<Vec<PathBlock>, Message> {
        let corners = self.corners(outline)?;
        self.check_direction(&corners)?;
        let corners = self.with_lead_in(&corners);
        let tips = self.tips(&corners)?;
        Ok(self.emit(&tips))
    }

    /// The outline with X mirrored inside, front face and end added, chamfers as lines.
    fn corners(self, outline: &[OutlineVertex]) -> Result<Vec<PathVertex>, Message> {
        let sign = self.side.sign();
        let mut raw: Vec<PathVertex> = outline
            .iter()
            .map(|vertex| {
                let (radius, chamfer) = match vertex.corner {
                    CornerShape::Sharp => (0.0, 0.0),
                    CornerShape::Radius(radius) => (radius.value(), 0.0),
                    CornerShape::Chamfer(length) => (0.0, length.value()),
                };
                PathVertex {
                    x: vertex.x * sign,
                    z: vertex.z,
                    radius,
                    chamfer,
                }
            })
            .collect();
        let (first, second) = (raw[0], raw[1]);
        if first.radius > 0.0 || first.chamfer > 0.0 {
            let face = Direction {
                x: 1.0,
                z: 0.0,
                length: 1.0,
            };
            let factor = face.tangent_factor(&first.to(&second));
            let back = first.radius * factor + first.chamfer;
            raw.insert(0, first.moved(&face, -back));
        }
        let last = raw[raw.len() - 1];
        let end_x = sign * self.end_diameter / 2.0 + self.nose;
        if end_x - last.x > SHORTEST_MM {
            raw.push(PathVertex {
                x: end_x,
                radius: 0.0,
                chamfer: 0.0,
                ..last
            });
        }
        let mut corners: Vec<PathVertex> = Vec::new();
        for (index, vertex) in raw.iter().enumerate() {
            let neighbours = (
                index.checked_sub(1).and_then(|at| raw.get(at)),
                raw.get(index + 1),
            );
            let (Some(before), Some(after)) = neighbours else {
                push_apart(&mut corners, *vertex);
                continue;
            };
            let (arriving, leaving) = (before.to(vertex), vertex.to(after));
            if vertex.chamfer > 0.0 {
                push_apart(&mut corners, vertex.moved(&arriving, -vertex.chamfer));
                push_apart(&mut corners, vertex.moved(&leaving, vertex.chamfer));
            } else {
                push_apart(&mut corners, *vertex);
            }
            let next_radius = after.radius;
            let at_end = vertex.chamfer + vertex.radius * arriving.tangent_factor(&leaving);
            let at_next = after.chamfer
                + raw.get(index + 2).map_or(0.0, |beyond| {
                    next_radius * leaving.tangent_factor(&after.to(beyond))
                });
            if at_end + at_next > leaving.length + TOLERANCE_MM
                || at_end > arriving.length + TOLERANCE_MM
            {
                return Err(say::form_corner_too_large(
                    Thousandths::round(vertex.x * sign * 2.0),
                    Thousandths::round(vertex.z),
                ));
            }
        }
        Ok(corners)
    }

    /// Refuses lines away from the chuck and back towards the axis (outside).
    fn check_direction(self, corners: &[PathVertex]) -> Result<(), Message> {
        for pair in corners.windows(2) {
            let back = pair[1].z > pair[0].z + TOLERANCE_MM || pair[1].x < pair[0].x - TOLERANCE_MM;
            if back {
                let x = Thousandths::round(pair[1].x * self.side.sign() * 2.0);
                let z = Thousandths::round(pair[1].z);
                return Err(match self.side {
                    CutSide::Outside => say::form_outline_undercut(x, z),
                    CutSide::Inside => say::form_outline_undercut_inside(x, z),
                });
            }
        }
        Ok(())
    }

    /// Begins the first line in front of the part, and the whole cut at `start_z`.
    fn with_lead_in(self, corners: &[PathVertex]) -> Vec<PathVertex> {
        let mut path = Vec::new();
        let mut rest = corners;
        if let [first, second, ..] = corners {
            let line = first.to(second);
            let lead_in = match self.nose > 0.0 {
                true => 2.0 * self.nose + LEAD_IN_MM,
                false => 0.0,
            };
            let begin = first.moved(&line, -lead_in);
            let front = PathVertex {
                z: self.start_z,
                ..begin
            };
            push_apart(&mut path, front);
            // Along a cylinder the lead-in is a piece of the approach.
            if fabs(line.x) > 1e-9 {
                push_apart(&mut path, begin);
            }
            rest = &corners[1..];
        }
        for corner in rest {
            push_apart(&mut path, *corner);
        }
        path
    }

    /// Moves the path by the nose radius, then to the imaginary tip.
    fn tips(self, path: &[PathVertex]) -> Result<Vec<PathVertex>, Message> {
        let nose = self.nose;
        let too_small = |vertex: &PathVertex| {
            let x = Thousandths::round(vertex.x * self.side.sign() * 2.0);
            say::form_corner_below_nose(x, Thousandths::round(vertex.z), Thousandths::round(nose))
        };
        let lines: Vec<Direction> = path.windows(2).map(|pair| pair[0].to(&pair[1])).collect();
        let mut tips = Vec::new();
        for (index, vertex) in path.iter().enumerate() {
            let arriving = index.checked_sub(1).and_then(|at| lines.get(at));
            let (one, two) = match (arriving, lines.get(index)) {
                (Some(one), Some(two)) => (one, two),
                (Some(only), None) | (None, Some(only)) => (only, only),
                (None, None) => continue,
            };
            // The normal to the right of the travel, towards the tool.
            let (n1, n2) = ((one.x, -one.z), (two.x, -two.z));
            let scale = nose / (1.0 + n1.0 * n2.0 + n1.1 * n2.1).max(1e-9);
            let turn = one.turn(two);
            let radius = if vertex.radius > 0.0 {
                vertex.radius + if turn < 0.0 { -nose } else { nose }
            } else {
                0.0
            };
            if radius < -TOLERANCE_MM {
                return Err(too_small(vertex));
            }
            tips.push(PathVertex {
                z: vertex.z + (n1.0 + n2.0) * scale - nose,
                x: vertex.x + (n1.1 + n2.1) * scale - nose,
                radius: radius.max(0.0),
                chamfer: 0.0,
            });
        }
        for (index, line) in lines.iter().enumerate() {
            let moved = tips[index].to(&tips[index + 1]);
            let factor = |one: Option<&Direction>, two: Option<&Direction>| {
                one.zip(two)
                    .map_or(0.0, |(one, two)| one.tangent_factor(two))
            };
            let before = index.checked_sub(1).and_then(|at| lines.get(at));
            let used = tips[index].radius * factor(before, Some(line))
                + tips[index + 1].radius * factor(Some(line), lines.get(index + 1));
            let along = (moved.x * line.x + moved.z * line.z) * moved.length;
            if along < used - TOLERANCE_MM {
                return Err(too_small(&path[index + 1]));
            }
        }
        Ok(tips)
    }

    /// Lines and arcs, with X as a diameter and mirrored back.
    fn emit(self, tips: &[PathVertex]) -> Vec<PathBlock> {
        let sign = self.side.sign();
        let mut blocks: Vec<PathBlock> = Vec::new();
        let mut add = |point: &PathVertex, arc: Option<(f64, bool)>| {
            let block = PathBlock {
                x: Thousandths::round(point.x * sign * 2.0),
                z: Thousandths::round(point.z),
                arc: arc.map(|(radius, clockwise)| (Thousandths::round(radius), clockwise)),
            };
            let is_same = |last: &PathBlock| last.x == block.x && last.z == block.z;
            if !blocks.last().is_some_and(is_same) {
                blocks.push(block);
            }
        };
        for (index, vertex) in tips.iter().enumerate() {
            let neighbours = (
                index.checked_sub(1).and_then(|at| tips.get(at)),
                tips.get(index + 1),
            );
            let (Some(before), Some(after)) = neighbours else {
                add(vertex, None);
                continue;
            };
            let (arriving, leaving) = (before.to(vertex), vertex.to(after));
            let tangent = vertex.radius * arriving.tangent_factor(&leaving);
            if tangent < 0.000_5 {
                add(vertex, None);
                continue;
            }
            let clockwise = arriving.turn(&leaving) * sign < 0.0;
            add(&vertex.moved(&arriving, -tangent), None);
            add(
                &vertex.moved(&leaving, tangent),
                Some((vertex.radius, clockwise)),
            );
        }
        blocks
    }
}

fn push_apart(corners: &mut Vec<PathVertex>, vertex: PathVertex) {
    match corners.last_mut() {
        Some(last) if fabs(last.x - vertex.x) + fabs(last.z - vertex.z) < SHORTEST_MM => {
            *last = vertex;
        }
        _ => corners.push(vertex),
    }
}

/// Half the cotangent of half an angle, degrees: length of a cone for each mm of its diameter.
pub(crate) fn cone_length_factor(angle: f64) -> f64 {
    0.5 / tan((angle / 2.0).to_radians())
}
