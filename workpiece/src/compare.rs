//! Comparing two half sections: where the surface of a part stands off a wanted one.
//!
//! ```text
//!        wanted ─────────┐   off > 0: material was left
//!   part ────────.       │   off < 0: it was cut too deep
//!                 `──────┘
//! ```

use gsk_units::Point;

use crate::grid::{GridPoint, from_grid, mm};
use crate::region::Region;

/// Longest piece of an edge that has one deviation, mm.
const PIECE: f64 = 0.1;
/// Pieces of an edge, at most.
const MOST_PIECES: f64 = 2000.0;
/// Width of the columns along Z by which edges are found, grid units: 0.5 mm.
const COLUMN: i32 = 5_000;

/// A point of a surface, and how far it stands off the wanted one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The point, mm; X a radius.
    pub at: Point,
    /// Distance to the wanted surface, mm: greater than 0 where material is left, less
    /// than 0 where the cut went too deep.
    pub off: f64,
}

/// The outlines of a part, closed, each of its points with its deviation. The spindle
/// axis and edges behind `clamped`, mm of Z, are no surface: they stand off nothing.
pub fn deviations(part: &Region, wanted: &Region, clamped: f64) -> Vec<Vec<Deviation>> {
    let edges = Edges::new(wanted);
    let outlines = part.contours().iter().map(|contour| {
        let next = contour.iter().cycle().skip(1);
        let each = contour.iter().zip(next);
        each.flat_map(|(a, b)| pieces(*a, *b))
            .map(|at| Deviation {
                at,
                off: if at.x <= 0.0 || at.z <= clamped {
                    0.0
                } else {
                    edges.off(at)
                },
            })
            .collect()
    });
    outlines.collect()
}

/// The points of an edge but for its last.
fn pieces(a: GridPoint, b: GridPoint) -> impl Iterator<Item = Point> {
    let (from, to) = (from_grid(a), from_grid(b));
    let count = ((to - from).length() / PIECE).clamp(1.0, MOST_PIECES);
    let count = libm::ceil(count) as u32;
    (0..count).map(move |index| from + (to - from) * (f64::from(index) / f64::from(count)))
}

/// The edges of a region by the columns along Z that they pass.
struct Edges {
    first: i32,
    columns: Vec<Vec<(Point, Point)>>,
}

impl Edges {
    fn new(region: &Region) -> Self {
        let Some(bounds) = region.bounds() else {
            return Self {
                first: 0,
                columns: Vec::new(),
            };
        };
        let first = bounds.low.x.div_euclid(COLUMN);
        let last = bounds.high.x.div_euclid(COLUMN);
        let mut columns = vec![Vec::new(); (last - first + 1).max(0) as usize];
        for (a, b) in region.edges() {
            let edge = (from_grid(a), from_grid(b));
            let from = a.x.min(b.x).div_euclid(COLUMN) - first;
            let to = a.x.max(b.x).div_euclid(COLUMN) - first;
            for column in columns.iter_mut().take(to as usize + 1).skip(from as usize) {
                column.push(edge);
            }
        }
        Self { first, columns }
    }

    /// How far a point stands off the region: less than 0 inside it.
    fn off(&self, at: Point) -> f64 {
        let column = libm::floor(at.z / mm(COLUMN)) as i32 - self.first;
        let distance = self.distance(at, column);
        if self.contains(at, column) {
            -distance
        } else {
            distance
        }
    }

    /// To the nearest edge: column by column away from the point, as long as a nearer
    /// one may come.
    fn distance(&self, at: Point, column: i32) -> f64 {
        let mut nearest = f64::INFINITY;
        let reach = self.columns.len() as i32;
        let farthest = column.abs().max((column - reach).abs()) + 1;
        for away in 0..=farthest {
            if f64::from(away - 1) * mm(COLUMN) > nearest {
                break;
            }
            let both = [column - away, column + away];
            let sides = if away == 0 { &both[..1] } else { &both[..] };
            for index in sides {
                let edges = usize::try_from(*index).ok();
                let edges = edges.and_then(|index| self.columns.get(index));
                for edge in edges.into_iter().flatten() {
                    nearest = nearest.min(to_edge(at, *edge));
                }
            }
        }
        nearest
    }

    /// Whether a line from the point away from the axis leaves the region.
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

/// The distance of a point from an edge, mm.
fn to_edge(at: Point, (a, b): (Point, Point)) -> f64 {
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
        Region::of(&[corners.iter().map(corner).collect()])
    }

    /// Least and greatest deviation.
    fn range(found: &[Vec<Deviation>]) -> (f64, f64) {
        let all = found.iter().flatten().map(|it| it.off);
        all.fold((0.0, 0.0), |(low, high): (f64, f64), off| {
            (low.min(off), high.max(off))
        })
    }

    #[test]
    fn a_part_stands_off_by_what_was_left_and_what_was_cut_too_deep() {
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
        assert_eq!(range(&clamped), (0.0, 0.0), "behind the clamping");
    }

    #[test]
    fn nothing_wanted_and_nothing_there_are_no_trouble() {
        let bar = region(&[(0.0, -4.0), (0.0, 0.0), (10.0, 0.0), (10.0, -4.0)]);
        assert!(deviations(&Region::default(), &bar, -9.0).is_empty());
        let all = deviations(&bar, &Region::default(), -9.0);
        assert!(all.iter().flatten().any(|it| it.off.is_infinite()));
    }

    #[test]
    fn a_surface_far_in_front_of_the_wanted_one_finds_it() {
        let bar = region(&[(0.0, -4.0), (0.0, 0.0), (10.0, 0.0), (10.0, -4.0)]);
        let far = region(&[(0.0, 50.0), (0.0, 60.0), (10.0, 60.0), (10.0, 50.0)]);
        let (low, high) = range(&deviations(&far, &bar, -9.0));
        assert!(low == 0.0 && (high - 60.0).abs() < 1e-9, "{low} {high}");
    }
}
