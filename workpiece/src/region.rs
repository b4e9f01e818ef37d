//! A region of the half section: closed polygons without overlap, holes among them.

use core::f64::consts::TAU;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::{Precision, Solver};
use i_overlay::i_shape::int::shape::IntShapes;

use crate::grid::{Contour, GridPoint, PER_MM};

/// Polygons of a half section. Outlines go counter-clockwise, holes clockwise.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Region {
    contours: Vec<Contour>,
}

/// A box with sides along the axes, grid units; both ends belong to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Least Z and X.
    pub low: GridPoint,
    /// Greatest Z and X.
    pub high: GridPoint,
}

impl Bounds {
    /// Around points; `None` without any.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a GridPoint>) -> Option<Self> {
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

    /// Whether two boxes have a point in common.
    pub const fn meets(&self, other: &Self) -> bool {
        self.low.x <= other.high.x
            && other.low.x <= self.high.x
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
    }
}

impl Region {
    /// The region inside polygons that may overlap and go round either way.
    pub fn of(contours: &[Contour]) -> Self {
        Self::default().overlay(contours, OverlayRule::Clip)
    }

    /// A box.
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

    /// Its polygons.
    pub fn contours(&self) -> &[Contour] {
        &self.contours
    }

    /// Whether there is nothing in it.
    pub const fn is_empty(&self) -> bool {
        self.contours.is_empty()
    }

    /// What polygons leave of it.
    #[must_use]
    pub fn without(&self, others: &[Contour]) -> Self {
        self.overlay(others, OverlayRule::Difference)
    }

    /// It and polygons together.
    #[must_use]
    pub fn with(&self, others: &[Contour]) -> Self {
        self.overlay(others, OverlayRule::Union)
    }

    /// What it has in common with polygons.
    #[must_use]
    pub fn common(&self, others: &[Contour]) -> Self {
        self.overlay(others, OverlayRule::Intersect)
    }

    /// With every point moved a little; what falls together becomes one point.
    #[must_use]
    pub(crate) fn mapped(mut self, moved: impl Fn(GridPoint) -> GridPoint) -> Self {
        for contour in &mut self.contours {
            for point in contour.iter_mut() {
                *point = moved(*point);
            }
            contour.dedup();
        }
        self.contours.retain(|contour| contour.len() > 2);
        self
    }

    /// Its shapes that hang together, each with its holes.
    pub fn pieces(&self) -> Vec<Self> {
        shapes(&self.contours, &[], OverlayRule::Subject)
            .into_iter()
            .map(|contours| Self { contours })
            .collect()
    }

    fn overlay(&self, others: &[Contour], rule: OverlayRule) -> Self {
        let contours = shapes(&self.contours, others, rule);
        Self {
            contours: contours.into_iter().flatten().collect(),
        }
    }

    /// The box around it.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.contours.iter().flatten())
    }

    /// Its area, mm².
    pub fn area(&self) -> f64 {
        self.edges().map(|(a, b)| cross(a, b)).sum::<f64>() / 2.0
    }

    /// The volume that it sweeps over in a turn around the spindle axis, mm³.
    ///
    /// ```text
    ///   V = 2π ∬ x dA     (Pappus), a triangle (0, a, b) at a time
    /// ```
    pub fn volume(&self) -> f64 {
        let thirds = |(a, b): (GridPoint, GridPoint)| {
            cross(a, b) * (f64::from(a.y) + f64::from(b.y)) / PER_MM
        };
        TAU * self.edges().map(thirds).sum::<f64>() / 6.0
    }

    /// Whether a point lies in it. Points on its edge may lie on either side.
    pub fn contains(&self, point: GridPoint) -> bool {
        let crosses = |&(a, b): &(GridPoint, GridPoint)| {
            (a.y > point.y) != (b.y > point.y) && {
                let (lower, upper) = if a.y < b.y { (a, b) } else { (b, a) };
                crate::grid::turn(lower, upper, point) > 0
            }
        };
        self.edges().filter(crosses).count() % 2 == 1
    }

    /// Its edges, each from a point to the next.
    pub fn edges(&self) -> impl Iterator<Item = (GridPoint, GridPoint)> + '_ {
        self.contours.iter().flat_map(|contour| {
            let next = contour.iter().cycle().skip(1);
            contour.iter().copied().zip(next.copied())
        })
    }
}

/// The cross product of two points, mm².
fn cross(a: GridPoint, b: GridPoint) -> f64 {
    let wide = i64::from(a.x) * i64::from(b.y) - i64::from(a.y) * i64::from(b.x);
    wide as f64 / (PER_MM * PER_MM)
}

fn shapes(subject: &[Contour], clip: &[Contour], rule: OverlayRule) -> IntShapes<i32> {
    let edges = subject.iter().chain(clip).map(Vec::len).sum();
    // Crossings are snapped to corners within a unit of the grid, and within a little
    // more each time the split edges cross anew: without that, edges that lie almost on
    // each other are split for seconds and come out wrong.
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
    fn a_bar_has_the_volume_of_a_cylinder_and_a_tube_that_of_a_ring() {
        let bar = rectangle((-60.0, 0.0), (0.0, 25.0));
        let cylinder = core::f64::consts::PI * 25.0 * 25.0 * 60.0;
        assert!((bar.volume() / cylinder - 1.0).abs() < 1e-12);
        assert!((bar.area() - 1500.0).abs() < 1e-9);
        let bore = rectangle((-70.0, 10.0), (-1.0, 10.0));
        let tube = bar.without(bore.contours());
        let ring = core::f64::consts::PI * (25.0 * 25.0 - 100.0) * 60.0;
        assert!((tube.volume() / ring - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_groove_parts_a_bar_into_pieces() {
        let bar = rectangle((-60.0, 0.0), (0.0, 25.0));
        let cut = rectangle((-30.0, -27.0), (-1.0, 26.0));
        let parted = bar.without(cut.contours());
        assert_eq!(parted.pieces().len(), 2);
        assert!(parted.contains(GridPoint::new(grid(-5.0), grid(3.0))));
        assert!(!parted.contains(GridPoint::new(grid(-28.0), grid(3.0))));
    }
}
