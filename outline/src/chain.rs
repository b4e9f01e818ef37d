//! Joins lines and arcs end to end into one chain.
//!
//! ```text
//!   ends within the tolerance are one corner; the degree of a corner counts its pieces
//!
//!   o----o----o     1, 2, 1: an open chain       o----o----o    3: a branch
//!                                                     |
//! ```

use gsk_messages::say;
use gsk_units::Point;

use crate::drawing::{Drawing, DrawingFault, MAX_FAULTS, TracedPiece};

/// Greatest number of pieces of an outline.
pub(crate) const MAX_OUTLINE_PIECES: usize = 5_000;

/// Pieces in order, each beginning where the last one ends.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PieceChain {
    pub(crate) pieces: Vec<TracedPiece>,
    pub(crate) is_closed: bool,
    /// Number of lines between a corner and the axis that were left out: edges of the part as
    /// seen from the side.
    pub(crate) edge_lines: usize,
}

/// A line or an arc between two corners.
#[derive(Clone, Copy)]
struct JoinedPiece {
    traced: TracedPiece,
    corners: [usize; 2],
}

/// Joins the pieces, which are above the axis, into one chain.
///
/// # Errors
/// The branches, the gaps greater than `tolerance`, or several outlines.
pub(crate) fn join_pieces(
    drawing: &Drawing,
    pieces: &[TracedPiece],
    tolerance: f64,
) -> Result<PieceChain, Vec<DrawingFault>> {
    let corners = Corners::new(pieces, tolerance);
    let mut joined: Vec<JoinedPiece> = (pieces.iter().enumerate())
        .map(|(index, traced)| JoinedPiece {
            traced: *traced,
            corners: [corners.of_end[2 * index], corners.of_end[2 * index + 1]],
        })
        .filter(|it| it.corners[0] != it.corners[1])
        .collect();
    remove_doubles(&mut joined, tolerance);
    let edge_lines = remove_edge_lines(&mut joined, &corners, tolerance);
    let degrees = corners.degrees(&joined);
    let branches = (degrees.iter().enumerate()).filter(|(_, degree)| **degree > 2);
    let branches: Vec<DrawingFault> = branches
        .take(MAX_FAULTS)
        .map(|(corner, _)| branch_fault(drawing, &joined, corner, corners.at[corner]))
        .collect();
    if !branches.is_empty() {
        return Err(branches);
    }
    let mut chains = walk_chains(&joined, &corners, &degrees);
    let Some(mut chain) = chains.pop() else {
        return Err(vec![say::outline_empty().into()]);
    };
    if !chains.is_empty() {
        chains.push(chain);
        return Err(separate_faults(drawing, &chains));
    }
    chain.edge_lines = edge_lines;
    Ok(chain)
}

/// The corners at which pieces end.
struct Corners {
    /// The corner of each end: start and end of each piece in turn.
    of_end: Vec<usize>,
    /// The middle of the ends at each corner.
    at: Vec<Point>,
}

impl Corners {
    fn new(pieces: &[TracedPiece], tolerance: f64) -> Self {
        let ends: Vec<Point> = (pieces.iter())
            .flat_map(|traced| [traced.piece.start, traced.piece.end])
            .collect();
        let mut order: Vec<usize> = (0..ends.len()).collect();
        order.sort_by(|a, b| ends[*a].z.total_cmp(&ends[*b].z));
        // Each end belongs to the first corner within the tolerance.
        let mut of_end = vec![usize::MAX; ends.len()];
        let mut at = Vec::new();
        for (place, first) in order.iter().enumerate() {
            if of_end[*first] != usize::MAX {
                continue;
            }
            let origin = ends[*first];
            let near = order[place..].iter().copied();
            let near = near.take_while(|end| ends[*end].z - origin.z <= tolerance);
            let members: Vec<usize> = near
                .filter(|end| of_end[*end] == usize::MAX)
                .filter(|end| (ends[*end] - origin).length() <= tolerance)
                .collect();
            let sum = (members.iter()).fold(Point::default(), |sum, end| sum + ends[*end]);
            for end in &members {
                of_end[*end] = at.len();
            }
            let middle = sum * (1.0 / members.len() as f64);
            let is_on_axis = middle.x <= tolerance;
            at.push(if is_on_axis {
                Point::new(0.0, middle.z)
            } else {
                middle
            });
        }
        Self { of_end, at }
    }

    fn degrees(&self, joined: &[JoinedPiece]) -> Vec<usize> {
        let mut degrees = vec![0; self.at.len()];
        for corner in joined.iter().flat_map(|it| it.corners) {
            degrees[corner] += 1;
        }
        degrees
    }
}

/// Removes pieces that are drawn twice.
fn remove_doubles(joined: &mut Vec<JoinedPiece>, tolerance: f64) {
    joined.sort_by_key(|it| {
        let [a, b] = it.corners;
        (a.min(b), a.max(b), it.traced.entity)
    });
    let middle = |it: &JoinedPiece| it.traced.piece.point_at(0.5);
    joined.dedup_by(|later, earlier| {
        let [a, b] = earlier.corners;
        (later.corners == [a, b] || later.corners == [b, a])
            && (middle(later) - middle(earlier)).length() <= tolerance
    });
}

/// Removes the lines from the axis to a branch: edges of the part as seen from the side.
/// Returns their number.
fn remove_edge_lines(joined: &mut Vec<JoinedPiece>, corners: &Corners, tolerance: f64) -> usize {
    let degrees = corners.degrees(joined);
    let before = joined.len();
    joined.retain(|it| {
        let points = it.corners.map(|corner| corners.at[corner]);
        let is_vertical = (points[0].z - points[1].z).abs() <= tolerance;
        let reaches_axis = |low: usize| points[low].x == 0.0 && degrees[it.corners[1 - low]] > 2;
        it.traced.piece.is_arc() || !is_vertical || !(reaches_axis(0) || reaches_axis(1))
    });
    before - joined.len()
}

/// Follows the pieces from corner to corner; open chains first.
fn walk_chains(joined: &[JoinedPiece], corners: &Corners, degrees: &[usize]) -> Vec<PieceChain> {
    let mut at_corner: Vec<Vec<usize>> = vec![Vec::new(); degrees.len()];
    for (index, it) in joined.iter().enumerate() {
        for corner in it.corners {
            at_corner[corner].push(index);
        }
    }
    let mut is_used = vec![false; joined.len()];
    let ends = (0..degrees.len()).filter(|corner| degrees[*corner] == 1);
    let others = (0..degrees.len()).filter(|corner| degrees[*corner] == 2);
    let mut chains = Vec::new();
    for begin in ends.chain(others) {
        let mut chain = PieceChain {
            pieces: Vec::new(),
            is_closed: false,
            edge_lines: 0,
        };
        let mut corner = begin;
        let next = |corner: usize, is_used: &[bool]| {
            let indices = at_corner[corner].iter().copied();
            indices.into_iter().find(|index| !is_used[*index])
        };
        while let Some(index) = next(corner, &is_used) {
            is_used[index] = true;
            let JoinedPiece {
                traced,
                corners: ends,
            } = joined[index];
            let is_forward = ends[0] == corner;
            let mut piece = match is_forward {
                true => traced.piece,
                false => traced.piece.reversed(),
            };
            let end = ends[usize::from(is_forward)];
            piece.start = corners.at[corner];
            piece.end = corners.at[end];
            chain.pieces.push(traced.with(piece));
            corner = end;
        }
        if !chain.pieces.is_empty() {
            chain.is_closed = corner == begin;
            chains.push(chain);
        }
    }
    chains
}

fn branch_fault(
    drawing: &Drawing,
    joined: &[JoinedPiece],
    corner: usize,
    at: Point,
) -> DrawingFault {
    let here = joined.iter().filter(|it| it.corners.contains(&corner));
    let names = here.take(3).map(|it| drawing.entity_name(it.traced.entity));
    let message = say::outline_branch(at.x * 2.0, at.z, say::several(names));
    DrawingFault::new(message, at)
}

/// An end of an open chain.
#[derive(Clone, Copy)]
struct OpenChainEnd {
    chain: usize,
    at: Point,
    entity: usize,
}

/// The faults of several chains: the smallest gaps that would join the open ones, smallest
/// first, or else several outlines.
fn separate_faults(drawing: &Drawing, chains: &[PieceChain]) -> Vec<DrawingFault> {
    let open = (chains.iter().enumerate()).filter(|(_, chain)| !chain.is_closed);
    let ends: Vec<OpenChainEnd> = open
        .flat_map(|(index, chain)| {
            let end = |at: Point, it: &TracedPiece| OpenChainEnd {
                chain: index,
                at,
                entity: it.entity,
            };
            let first = chain.pieces.first().map(|it| end(it.piece.start, it));
            let last = chain.pieces.last().map(|it| end(it.piece.end, it));
            first.into_iter().chain(last)
        })
        .take(1000)
        .collect();
    let pairs = ends.iter().flat_map(|one| {
        let others = ends.iter().filter(|other| one.chain < other.chain);
        others.map(move |other| ((one.at - other.at).length(), *one, *other))
    });
    let mut pairs: Vec<(f64, OpenChainEnd, OpenChainEnd)> = pairs.collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The group of each chain, which a gap joins with another one.
    let mut groups: Vec<usize> = (0..chains.len()).collect();
    let mut faults = Vec::new();
    for (gap, one, other) in pairs {
        let (keep, join) = (groups[one.chain], groups[other.chain]);
        if keep == join {
            continue;
        }
        for group in groups.iter_mut().filter(|group| **group == join) {
            *group = keep;
        }
        let names = [one.entity, other.entity].map(|entity| drawing.entity_name(entity));
        let message = say::outline_gap(gap, one.at.x * 2.0, one.at.z, say::several(names));
        faults.push(DrawingFault::new(message, one.at));
        if faults.len() == MAX_FAULTS {
            break;
        }
    }
    if faults.is_empty() {
        let firsts = chains.iter().take(3).filter_map(|it| it.pieces.first());
        let names = firsts.map(|it| drawing.entity_name(it.entity));
        faults.push(say::outline_separate(chains.len(), say::several(names)).into());
    }
    faults
}
