//! Simplifies the outline of a half section before it is turned or extruded: only visible
//! corners, with the directions of its surfaces.

use glam::{Vec2, vec2};
use gsk_workpiece::grid::{GridContour, GridPoint, from_grid};
use gsk_workpiece::region::Region;

/// Cosine of 15°: two edges that bend less than that form one smooth surface.
const SMOOTH_COSINE: f32 = 0.966;
/// Distance from the outline of the stock up to which an edge is uncut, mm.
const STOCK_TOLERANCE_MM: f32 = 0.001;
/// Distance from the spindle axis up to which a point is on it, mm.
const AXIS_TOLERANCE_MM: f32 = 0.000_5;

/// A straight piece of an outline; its coordinates are Z and X, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ProfileEdge {
    /// Start and end of the piece, Z and X, mm.
    pub ends: [Vec2; 2],
    /// Outward directions at start and end, length 1. Along a smooth curve they differ.
    pub normals: [Vec2; 2],
}

impl ProfileEdge {
    /// Whether the edge sweeps a surface when it turns about the spindle axis: an end is off
    /// the axis.
    pub(super) fn is_off_axis(&self) -> bool {
        self.ends.iter().any(|end| end.y > AXIS_TOLERANCE_MM)
    }

    /// Whether both ends of the edge are on the same line of another outline.
    pub(super) fn is_on(&self, outline: &[(Vec2, Vec2)]) -> bool {
        let on = |line: &(Vec2, Vec2)| {
            self.ends
                .iter()
                .all(|end| segment_distance(*end, line.0, line.1) <= STOCK_TOLERANCE_MM)
        };
        outline.iter().any(on)
    }
}

/// The pieces of a region's outlines. Corners whose removal moves the outline by less than
/// `tolerance`, mm, are omitted.
pub(super) fn region_edges(region: &Region, tolerance: f32) -> Vec<ProfileEdge> {
    region
        .contours()
        .iter()
        .flat_map(|contour| contour_edges(contour, tolerance))
        .collect()
}

/// Returns the lines of a region's outlines with all corners: Z and X, mm.
pub(super) fn region_lines(region: &Region) -> Vec<(Vec2, Vec2)> {
    region
        .edges()
        .map(|(a, b)| (to_vec2(a), to_vec2(b)))
        .collect()
}

/// The pieces of one closed polygon, simplified by `tolerance`, mm; the inside is on the left.
pub(super) fn contour_edges(contour: &GridContour, tolerance: f32) -> Vec<ProfileEdge> {
    let corners = simplify(contour, tolerance);
    let count = corners.len();
    if count < 3 {
        return Vec::new();
    }
    let at = |index: usize| corners[index % count];
    let along = |index: usize| at(index + 1) - at(index);
    let outward = |index: usize| {
        let along = along(index);
        vec2(along.y, -along.x)
    };
    let flat = |index: usize| outward(index).normalize_or(vec2(0.0, 1.0));
    // The longer side of a corner has more weight: a cylinder that runs into a fillet stays a
    // cylinder.
    let joint = |before: usize, after: usize, own: usize| {
        let smooth = flat(before).dot(flat(after)) > SMOOTH_COSINE;
        match smooth {
            true => (outward(before) + outward(after)).normalize_or(flat(own)),
            false => flat(own),
        }
    };
    (0..count)
        .map(|index| ProfileEdge {
            ends: [at(index), at(index + 1)],
            normals: [
                joint(index + count - 1, index, index),
                joint(index, index + 1, index),
            ],
        })
        .collect()
}

fn to_vec2(point: GridPoint) -> Vec2 {
    let point = from_grid(point);
    vec2(point.z as f32, point.x as f32)
}

/// Removes corners of a closed polygon that are not farther than `tolerance`, mm, from the
/// simpler one (Douglas and Peucker, from its first corner to the farthest one and back).
fn simplify(contour: &GridContour, tolerance: f32) -> Vec<Vec2> {
    let points: Vec<Vec2> = contour.iter().map(|it| to_vec2(*it)).collect();
    let Some(first) = points.first().copied() else {
        return points;
    };
    let from_first = |index: usize| points[index].distance_squared(first);
    let farthest = (0..points.len()).max_by(|a, b| from_first(*a).total_cmp(&from_first(*b)));
    let farthest = farthest.unwrap_or(0);
    let at = |index: usize| points[index % points.len()];
    let mut kept = vec![false; points.len()];
    let mut open = vec![(0, farthest), (farthest, points.len())];
    while let Some((from, to)) = open.pop() {
        kept[from] = true;
        let (mut most, mut corner) = (tolerance, None);
        for (index, point) in points.iter().enumerate().take(to).skip(from + 1) {
            let off = segment_distance(*point, at(from), at(to));
            if off > most {
                (most, corner) = (off, Some(index));
            }
        }
        if let Some(corner) = corner {
            open.extend([(from, corner), (corner, to)]);
        }
    }
    let kept = points.iter().zip(kept).filter(|(_, kept)| *kept);
    kept.map(|(point, _)| *point).collect()
}

/// Returns the distance of a point from a line segment, mm.
fn segment_distance(point: Vec2, from: Vec2, to: Vec2) -> f32 {
    let (along, beside) = (to - from, point - from);
    let length = along.length_squared();
    let part = if length > 0.0 {
        (beside.dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (beside - along * part).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_workpiece::grid::grid;

    fn arc(chords: i32) -> GridContour {
        let mut contour: GridContour = (0..=chords)
            .map(|index| {
                let angle = f64::from(index) / f64::from(chords) * core::f64::consts::FRAC_PI_2;
                GridPoint::new(
                    grid(10.0 * libm::cos(angle)),
                    grid(20.0 + 10.0 * libm::sin(angle)),
                )
            })
            .collect();
        contour.push(GridPoint::new(0, grid(20.0)));
        contour
    }

    #[test]
    fn arcs_are_smooth_and_corners_sharp() {
        let edges = contour_edges(&arc(400), 0.01);
        assert!((6..60).contains(&edges.len()), "{}", edges.len());
        let center = vec2(0.0, 20.0);
        for edge in &edges {
            for (end, normal) in edge.ends.iter().zip(edge.normals) {
                let radial = *end - center;
                if edge
                    .ends
                    .iter()
                    .all(|it| (it.distance(center) - 10.0).abs() < 0.01)
                {
                    assert!(normal.dot(radial.normalize()) > 0.99, "{edge:?}");
                } else {
                    assert!(normal.x < 1e-6 && normal.y < 1e-6, "{edge:?}");
                }
            }
        }
    }

    #[test]
    fn what_was_not_cut_lies_on_the_stock() {
        let corner = |z, x| GridPoint::new(grid(z), grid(x));
        let stock = Region::rectangle(corner(-60.0, 0.0), corner(0.0, 25.0));
        let turned = Region::rectangle(corner(-30.0, 20.0), corner(1.0, 30.0));
        let part = stock.difference(turned.contours());
        let outline = region_lines(&stock);
        let skin = region_edges(&part, 0.01).into_iter();
        let skin: Vec<ProfileEdge> = skin.filter(|edge| edge.is_on(&outline)).collect();
        // The axis, the bar on the far side of the cut, its back, and the remaining face.
        assert_eq!(skin.len(), 4, "{skin:?}");
    }

    #[test]
    fn no_contour_is_too_small() {
        assert!(contour_edges(&Vec::new(), 0.1).is_empty());
        assert!(contour_edges(&vec![GridPoint::new(3, 4)], 0.1).is_empty());
        let speck = [(0, 0), (1, 0), (0, 1)].map(|(z, x)| GridPoint::new(z, x));
        assert!(contour_edges(&speck.to_vec(), 1.0).is_empty());
    }
}
