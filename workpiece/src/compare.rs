//! Compares the half section of a part with the wanted one.
//!
//! ```text
//!        wanted ─────────┐   distance > 0: material is left
//!   part ────────.       │   distance < 0: the cut is too deep
//!                 `──────┘
//! ```

use gsk_units::Point;

use crate::grid::{GridPoint, from_grid, mm};
use crate::region::Region;

/// Greatest distance between two sample points on an edge, mm.
const SAMPLE_SPACING_MM: f64 = 0.1;
/// Maximum number of sample points on one edge.
const MAX_EDGE_SAMPLES: f64 = 2000.0;
/// Width of the columns along Z that index the edges of a region, grid units: 0.5 mm.
const COLUMN_UNITS: i32 = 5_000;

/// A point of a surface with its distance from the intended surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDeviation {
    /// The point on the surface, mm; X is a radius.
    pub at: Point,
    /// Signed distance to the wanted surface, mm: positive where material is left,
    /// negative where the cut is too deep.
    pub distance: f64,
}

/// Samples the closed outlines of a part and measures the deviation of each point.
///
/// Points on the spindle axis and points at a Z of `clamped` or less, mm, get distance 0:
/// the tool cannot reach them. If `wanted` is empty the other distances are infinite.
pub fn deviations(part: &Region, wanted: &Region, clamped: f64) -> Vec<Vec<SurfaceDeviation>> {
    let edges = Edges::new(wanted);
    let outlines = part.contours().iter().map(|contour| {
        let next = contour.iter().cycle().skip(1);
        let each = contour.iter().zip(next);
        each.flat_map(|(a, b)| edge_samples(*a, *b))
            .map(|at| SurfaceDeviation {
                at,
                distance: if at.x <= 0.0 || at.z <= clamped {
                    0.0
                } else {
                    edges.signed_distance(at)
                },
            })
            .collect()
    });
    outlines.collect()
}

/// Returns evenly spaced points of an edge without its last point, mm.
fn edge_samples(a: GridPoint, b: GridPoint) -> impl Iterator<Item = Point> {
    let (from, to) = (from_grid(a), from_grid(b));
    let count = ((to - from).length() / SAMPLE_SPACING_MM).clamp(1.0, MAX_EDGE_SAMPLES);
    let count = libm::ceil(count) as u32;
    (0..count).map(move |index| from + (to - from) * (f64::from(index) / f64::from(count)))
}

/// The edges of a region, indexed by the columns along Z that they cross.
struct Edges {
    first_column: i32,
    columns: Vec<Vec<(Point, Point)>>,
}

impl Edges {
    fn new(region: &Region) -> Self {
        let Some(bounds) = region.bounds() else {
            return Self {
                first_column: 0,
                columns: Vec::new(),
            };
        };
        let first = bounds.low.x.div_euclid(COLUMN_UNITS);
        let last = bounds.high.x.div_euclid(COLUMN_UNITS);
        let mut columns = vec![Vec::new(); (last - first + 1).max(0) as usize];
        for (a, b) in region.edges() {
            let edge = (from_grid(a), from_grid(b));
            let from = a.x.min(b.x).div_euclid(COLUMN_UNITS) - first;
            let to = a.x.max(b.x).div_euclid(COLUMN_UNITS) - first;
            for column in columns.iter_mut().take(to as usize + 1).skip(from as usize) {
                column.push(edge);
            }
        }
        Self {
            first_column: first,
            columns,
        }
    }

    /// Returns the distance of a point from the outline of the region, mm, negative inside.
    fn signed_distance(&self, at: Point) -> f64 {
        let column = libm::floor(at.z / mm(COLUMN_UNITS)) as i32 - self.first_column;
        let distance = self.distance_to_nearest(at, column);
        if self.contains(at, column) {
            -distance
        } else {
            distance
        }
    }

    /// Distance of a point from the nearest edge, mm. The search starts at `column`, goes
    /// outwards, and stops when the remaining columns are too far away to hold a nearer edge.
    fn distance_to_nearest(&self, at: Point, column: i32) -> f64 {
        let mut nearest = f64::INFINITY;
        let reach = self.columns.len() as i32;
        let farthest = column.abs().max((column - reach).abs()) + 1;
        for away in 0..=farthest {
            if f64::from(away - 1) * mm(COLUMN_UNITS) > nearest {
                break;
            }
            let both = [column - away, column + away];
            let sides = if away == 0 { &both[..1] } else { &both[..] };
            for index in sides {
                let edges = usize::try_from(*index).ok();
                let edges = edges.and_then(|index| self.columns.get(index));
                for edge in edges.into_iter().flatten() {
                    nearest = nearest.min(distance_to_edge(at, *edge));
                }
            }
        }
        nearest
    }

    /// Whether a point in `column` is inside the region: a ray away from the axis crosses an
    /// odd number of edges.
    fn contains(&self, at: Point, column: i32) -> bool {
        let edges = usize::try_from(column).ok();
        let Some(edges) = edges.and_then(|index| self.columns.get(index)) else {
            return false;
        };
        let above = |&&(a, b): &&(Point, Point)| {
            (a.z > at.z) != (b.z > at.z) && {
                let share = (at.z - a.z) / (b.z - a.z);
                a.x + (b.x - a.x) * share > at.x
            }
        };
        edges.iter().filter(above).count() % 2 == 1
    }
}

/// Returns the distance of a point from an edge, mm.
fn distance_to_edge(at: Point, (a, b): (Point, Point)) -> f64 {
    let (along, beside) = (b - a, at - a);
    let length = along.dot(along);
    let share = if length > 0.0 {
        (beside.dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (beside - along * share).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::grid;

    fn region(corners: &[(f64, f64)]) -> Region {
        let corner = |(x, z): &(f64, f64)| GridPoint::new(grid(*z), grid(*x));
        Region::from_contours(&[corners.iter().map(corner).collect()])
    }

    /// Returns the least and greatest signed distance, mm.
    fn range(deviations: &[Vec<SurfaceDeviation>]) -> (f64, f64) {
        let all = deviations.iter().flatten().map(|it| it.distance);
        all.fold((0.0, 0.0), |(low, high): (f64, f64), distance| {
            (low.min(distance), high.max(distance))
        })
    }

    #[test]
    fn material_left_is_positive_and_a_deep_cut_is_negative() {
        let wanted = region(&[(0.0, -40.0), (0.0, 0.0), (10.0, 0.0), (10.0, -40.0)]);
        let same = deviations(&wanted, &wanted, -100.0);
        assert_eq!(range(&same), (0.0, 0.0));
        let thick = region(&[(0.0, -40.0), (0.0, 0.0), (10.02, 0.0), (10.02, -40.0)]);
        let (low, high) = range(&deviations(&thick, &wanted, -100.0));
        assert!(low > -1e-12 && (high - 0.02).abs() < 1e-9, "{low} {high}");
        let grooved = region(&[
            (0.0, -40.0),
            (0.0, 0.0),
            (10.0, 0.0),
            (10.0, -20.0),
            (9.7, -20.0),
            (9.7, -23.0),
            (10.0, -23.0),
            (10.0, -40.0),
        ]);
        let (low, high) = range(&deviations(&grooved, &wanted, -100.0));
        assert!((low + 0.3).abs() < 1e-9 && high < 1e-12, "{low} {high}");
        let clamped = deviations(&grooved, &wanted, -10.0);
        assert_eq!(
            range(&clamped),
            (0.0, 0.0),
            "the clamped length is not compared"
        );
    }

    #[test]
    fn empty_regions_are_compared_without_a_panic() {
        let bar = region(&[(0.0, -4.0), (0.0, 0.0), (10.0, 0.0), (10.0, -4.0)]);
        assert!(deviations(&Region::default(), &bar, -9.0).is_empty());
        let all = deviations(&bar, &Region::default(), -9.0);
        assert!(all.iter().flatten().any(|it| it.distance.is_infinite()));
    }

    #[test]
    fn the_distance_to_a_surface_many_columns_away_is_found() {
        let bar = region(&[(0.0, -4.0), (0.0, 0.0), (10.0, 0.0), (10.0, -4.0)]);
        let far = region(&[(0.0, 50.0), (0.0, 60.0), (10.0, 60.0), (10.0, 50.0)]);
        let (low, high) = range(&deviations(&far, &bar, -9.0));
        assert!(low == 0.0 && (high - 60.0).abs() < 1e-9, "{low} {high}");
    }
}
