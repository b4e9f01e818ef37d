//! Regions of the half section: polygons with holes, and boolean operations on them.

use core::f64::consts::TAU;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::{Precision, Solver};
use i_overlay::i_shape::int::shape::IntShapes;

use crate::grid::{GridContour, GridPoint, PER_MM};

/// An area of the half section, bounded by polygons that do not overlap. Outlines are
/// counter-clockwise, holes clockwise.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Region {
    contours: Vec<GridContour>,
}

/// A rectangle parallel to the axes in grid units, including its border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridBounds {
    /// The corner with the least Z and X.
    pub low: GridPoint,
    /// The corner with the greatest Z and X.
    pub high: GridPoint,
}

impl GridBounds {
    /// Returns the smallest box around points; `None` without points.
    pub fn from_points<'a>(points: impl IntoIterator<Item = &'a GridPoint>) -> Option<Self> {
        points.into_iter().fold(None, |bounds, point| {
            let Self { low, high } = bounds.unwrap_or(Self {
                low: *point,
                high: *point,
            });
            Some(Self {
                low: GridPoint::new(low.x.min(point.x), low.y.min(point.y)),
                high: GridPoint::new(high.x.max(point.x), high.y.max(point.y)),
            })
        })
    }

    /// Whether two boxes have any point in common.
    pub const fn intersects(&self, other: &Self) -> bool {
        self.low.x <= other.high.x
            && other.low.x <= self.high.x
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
    }
}

impl Region {
    /// The region in which the winding number of the polygons is not 0. Polygons may overlap;
    /// a clockwise polygon within a counter-clockwise one is a hole.
    pub fn from_contours(contours: &[GridContour]) -> Self {
        Self::default().overlay(contours, OverlayRule::Clip)
    }

    /// The rectangle between two corners; empty if `high` is not above and right of `low`.
    pub fn rectangle(low: GridPoint, high: GridPoint) -> Self {
        if low.x >= high.x || low.y >= high.y {
            return Self::default();
        }
        let corner = GridPoint::new;
        Self {
            contours: vec![vec![
                low,
                corner(high.x, low.y),
                high,
                corner(low.x, high.y),
            ]],
        }
    }

    /// Returns the polygons of the region: outlines and holes.
    pub fn contours(&self) -> &[GridContour] {
        &self.contours
    }

    /// Whether the region has no polygon.
    pub const fn is_empty(&self) -> bool {
        self.contours.is_empty()
    }

    /// Returns the region without the area of polygons.
    #[must_use]
    pub fn difference(&self, others: &[GridContour]) -> Self {
        self.overlay(others, OverlayRule::Difference)
    }

    /// Returns the region joined with the area of polygons.
    #[must_use]
    pub fn union(&self, others: &[GridContour]) -> Self {
        self.overlay(others, OverlayRule::Union)
    }

    /// Returns the part of the region that is inside polygons.
    #[must_use]
    pub fn intersection(&self, others: &[GridContour]) -> Self {
        self.overlay(others, OverlayRule::Intersect)
    }

    /// Moves each point by the function `moved`. Equal neighbours become one point; polygons
    /// with fewer than three points are dropped.
    #[must_use]
    pub(crate) fn map_points(mut self, moved: impl Fn(GridPoint) -> GridPoint) -> Self {
        for contour in &mut self.contours {
            for point in contour.iter_mut() {
                *point = moved(*point);
            }
            contour.dedup();
        }
        self.contours.retain(|contour| contour.len() > 2);
        self
    }

    /// Returns the connected areas of the region, each with its holes.
    pub fn connected_areas(&self) -> Vec<Self> {
        shapes(&self.contours, &[], OverlayRule::Subject)
            .into_iter()
            .map(|contours| Self { contours })
            .collect()
    }

    fn overlay(&self, others: &[GridContour], rule: OverlayRule) -> Self {
        let contours = shapes(&self.contours, others, rule);
        Self {
            contours: contours.into_iter().flatten().collect(),
        }
    }

    /// Returns the bounding box of the region; `None` if the region is empty.
    pub fn bounds(&self) -> Option<GridBounds> {
        GridBounds::from_points(self.contours.iter().flatten())
    }

    /// Returns the area of the region, mm².
    pub fn area(&self) -> f64 {
        self.edges().map(|(a, b)| cross(a, b)).sum::<f64>() / 2.0
    }

    /// The volume of the solid of revolution about the spindle axis, mm³.
    ///
    /// ```text
    ///   V = 2π ∬ x dA     (Pappus), summed over triangles (0, a, b)
    /// ```
    pub fn volume(&self) -> f64 {
        let thirds = |(a, b): (GridPoint, GridPoint)| {
            cross(a, b) * (f64::from(a.y) + f64::from(b.y)) / PER_MM
        };
        TAU * self.edges().map(thirds).sum::<f64>() / 6.0
    }

    /// Whether a point is inside. The result for a point on an edge is not defined.
    pub fn contains(&self, point: GridPoint) -> bool {
        let crosses = |&(a, b): &(GridPoint, GridPoint)| {
            (a.y > point.y) != (b.y > point.y) && {
                let (lower, upper) = if a.y < b.y { (a, b) } else { (b, a) };
                crate::grid::orientation(lower, upper, point) > 0
            }
        };
        self.edges().filter(crosses).count() % 2 == 1
    }

    /// Returns the edges of all polygons, each from a point to the next.
    pub fn edges(&self) -> impl Iterator<Item = (GridPoint, GridPoint)> + '_ {
        self.contours.iter().flat_map(|contour| {
            let next = contour.iter().cycle().skip(1);
            contour.iter().copied().zip(next.copied())
        })
    }
}

/// Returns the cross product of two grid points as vectors, mm².
fn cross(a: GridPoint, b: GridPoint) -> f64 {
    let wide = i64::from(a.x) * i64::from(b.y) - i64::from(a.y) * i64::from(b.x);
    wide as f64 / (PER_MM * PER_MM)
}

fn shapes(subject: &[GridContour], clip: &[GridContour], rule: OverlayRule) -> IntShapes<i32> {
    let edges = subject.iter().chain(clip).map(Vec::len).sum();
    // High precision snaps crossings to corners within one grid unit, and within a little
    // more for each pass in which split edges cross again. Without it edges that almost
    // coincide take seconds and give wrong results.
    let solver = Solver::with_precision(Precision::HIGH);
    let mut overlay = Overlay::new_custom(edges, IntOverlayOptions::default(), solver);
    overlay.add_source(subject, ShapeType::Subject);
    overlay.add_source(clip, ShapeType::Clip);
    overlay.overlay(rule, FillRule::NonZero)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::grid;

    fn rectangle(z: (f64, f64), x: (f64, f64)) -> Region {
        let corner = |z, x| GridPoint::new(grid(z), grid(x));
        Region::rectangle(corner(z.0, x.0), corner(z.1, x.1))
    }

    #[test]
    fn volumes_of_a_bar_and_of_a_tube_are_exact() {
        let bar = rectangle((-60.0, 0.0), (0.0, 25.0));
        let cylinder = core::f64::consts::PI * 25.0 * 25.0 * 60.0;
        assert!((bar.volume() / cylinder - 1.0).abs() < 1e-12);
        assert!((bar.area() - 1500.0).abs() < 1e-9);
        let bore = rectangle((-70.0, 10.0), (-1.0, 10.0));
        let tube = bar.difference(bore.contours());
        let ring = core::f64::consts::PI * (25.0 * 25.0 - 100.0) * 60.0;
        assert!((tube.volume() / ring - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_groove_to_the_axis_leaves_two_connected_areas() {
        let bar = rectangle((-60.0, 0.0), (0.0, 25.0));
        let cut = rectangle((-30.0, -27.0), (-1.0, 26.0));
        let rest = bar.difference(cut.contours());
        assert_eq!(rest.connected_areas().len(), 2);
        assert!(rest.contains(GridPoint::new(grid(-5.0), grid(3.0))));
        assert!(!rest.contains(GridPoint::new(grid(-28.0), grid(3.0))));
    }
}
