//! The edge of a half section as it is turned or drawn out into space: no more corners
//! than are seen, with the directions in which it faces.

use glam::{Vec2, vec2};
use gsk_workpiece::grid::{GridContour, GridPoint, from_grid};
use gsk_workpiece::region::Region;

/// Edges that turn less are one smooth surface: the cosine of 15°.
const SMOOTH: f32 = 0.966;
/// What lies so near to the stock's outline was not cut, mm.
const ON_STOCK: f32 = 0.001;
/// Nearer to the axis is on it, mm.
const ON_AXIS: f32 = 0.000_5;

/// A piece of the outline; Z and X, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// Where it begins and ends.
    pub ends: [Vec2; 2],
    /// Which way it faces there, length 1; on arcs another one at each end.
    pub normals: [Vec2; 2],
}

impl Edge {
    /// Whether it turns into a surface at all.
    pub(super) fn is_off_axis(&self) -> bool {
        self.ends.iter().any(|end| end.y > ON_AXIS)
    }

    /// Whether it lies on one of the lines of another outline.
    pub(super) fn lies_on(&self, outline: &[(Vec2, Vec2)]) -> bool {
        let on = |line: &(Vec2, Vec2)| {
            self.ends
                .iter()
                .all(|end| distance(*end, line.0, line.1) <= ON_STOCK)
        };
        outline.iter().any(on)
    }
}

/// The pieces of a region's outlines, with corners left out that move it by less than a
/// tolerance, mm.
pub(super) fn edges(region: &Region, tolerance: f32) -> Vec<Edge> {
    region
        .contours()
        .iter()
        .flat_map(|contour| of_contour(contour, tolerance))
        .collect()
}

/// The lines of a region's outlines as they are.
pub(super) fn lines(region: &Region) -> Vec<(Vec2, Vec2)> {
    region.edges().map(|(a, b)| (point(a), point(b))).collect()
}

/// The pieces of one closed polygon; its inside is on the left.
pub(super) fn of_contour(contour: &GridContour, tolerance: f32) -> Vec<Edge> {
    let corners = simplified(contour, tolerance);
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
    // The longer side of a corner has more of a say: a cylinder that runs into a fillet
    // stays a cylinder.
    let joint = |before: usize, after: usize, own: usize| {
        let smooth = flat(before).dot(flat(after)) > SMOOTH;
        match smooth {
            true => (outward(before) + outward(after)).normalize_or(flat(own)),
            false => flat(own),
        }
    };
    (0..count)
        .map(|index| Edge {
            ends: [at(index), at(index + 1)],
            normals: [
                joint(index + count - 1, index, index),
                joint(index, index + 1, index),
            ],
        })
        .collect()
}

fn point(point: GridPoint) -> Vec2 {
    let point = from_grid(point);
    vec2(point.z as f32, point.x as f32)
}

/// A closed polygon with fewer corners, none of the others farther than a tolerance
/// from it (Douglas and Peucker, from its first corner to the farthest one and back).
fn simplified(contour: &GridContour, tolerance: f32) -> Vec<Vec2> {
    let points: Vec<Vec2> = contour.iter().map(|it| point(*it)).collect();
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
            let off = distance(*point, at(from), at(to));
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

/// How far a point is from a piece of line.
fn distance(point: Vec2, from: Vec2, to: Vec2) -> f32 {
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
        let edges = of_contour(&arc(400), 0.01);
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
        let outline = lines(&stock);
        let skin = edges(&part, 0.01).into_iter();
        let skin: Vec<Edge> = skin.filter(|edge| edge.lies_on(&outline)).collect();
        // The axis, the bar behind, its back, and what is left of its face.
        assert_eq!(skin.len(), 4, "{skin:?}");
    }

    #[test]
    fn no_contour_is_too_small() {
        assert!(of_contour(&Vec::new(), 0.1).is_empty());
        assert!(of_contour(&vec![GridPoint::new(3, 4)], 0.1).is_empty());
        let speck = [(0, 0), (1, 0), (0, 1)].map(|(z, x)| GridPoint::new(z, x));
        assert!(of_contour(&speck.to_vec(), 1.0).is_empty());
    }
}
