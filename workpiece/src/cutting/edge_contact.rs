//! The part of a cutting edge that is in the material.

use gsk_units::Point;

use crate::grid::{GridPoint, PER_MM};
use crate::part::TurnedPart;

/// Shift of a tested edge against the grid, grid units: no edge then lies on an edge of the
/// part, or on the border between two slabs of it.
const OFF_GRID: (f64, f64) = (0.37, 0.23);

/// Contact of a cutting edge with the material at one position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct EdgeContact {
    /// Length of the edge in the material, mm.
    pub(super) edge_mm: f64,
    /// Extent of that edge across the feed, mm: the chip area of 1 mm of feed.
    pub(super) across_mm: f64,
    /// Greatest radius of the contact, mm.
    pub(super) outer_radius_mm: f64,
    /// Least radius of the contact, mm.
    pub(super) inner_radius_mm: f64,
    /// Mean radius of the contact, weighted by the chip area, mm.
    pub(super) mean_radius_mm: f64,
    /// Mean direction from the edge into the material, weighted by the chip area: its length is
    /// below 1 if the edge is bent.
    pub(super) into_material: Point,
}

impl EdgeContact {
    /// The contact of the edges of `polygon`, counter-clockwise, that face the feed. `tip` is
    /// the position of its zero and `feed` the direction of the feed, of length 1; `None` takes
    /// all edges, for a thread, whose tool is fed into the drawn plane.
    pub(super) fn measure(
        part: &TurnedPart,
        polygon: &[GridPoint],
        tip: Point,
        feed: Option<Point>,
    ) -> Self {
        let mut contact = Self {
            inner_radius_mm: f64::INFINITY,
            ..Self::default()
        };
        let mut moment = 0.0;
        let shift = Point::new(tip.x * PER_MM + OFF_GRID.0, tip.z * PER_MM + OFF_GRID.1);
        let at = |point: &GridPoint| Point::new(f64::from(point.y), f64::from(point.x)) + shift;
        for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
            let (from, to) = (at(a), at(b));
            let along = to - from;
            let length = along.length();
            // The outside of a counter-clockwise polygon is right of its edges.
            let facing = feed.map_or(1.0, |feed| feed.cross(along) / length);
            if length <= 0.0 || facing <= 1e-9 {
                continue;
            }
            for (begin, end) in part.shares_within(from, to) {
                let edge = (end - begin) * length / PER_MM;
                let across = edge * facing;
                let (near, far) = (from + along * begin, from + along * end);
                contact.edge_mm += edge;
                contact.across_mm += across;
                moment += across * (near.x + far.x) / 2.0 / PER_MM;
                let (inner, outer) = (near.x.min(far.x) / PER_MM, near.x.max(far.x) / PER_MM);
                contact.inner_radius_mm = contact.inner_radius_mm.min(inner.max(0.0));
                contact.outer_radius_mm = contact.outer_radius_mm.max(outer);
                let outward = along.left() * (-across / length);
                contact.into_material = contact.into_material + outward;
            }
        }
        if contact.across_mm > 0.0 {
            contact.mean_radius_mm = moment / contact.across_mm;
            contact.into_material = contact.into_material * (1.0 / contact.across_mm);
        }
        contact
    }
}
