//! The part as it is being cut: its half section in slabs along Z.
//!
//! A cut touches only the slabs that the tool passes, so that what it costs does not
//! grow with the part:
//!
//! ```text
//!   X ^    |    |    |  __|_   |
//!     |    |____|____|_/ P|_\__|      P: what the tool sweeps over
//!     |    |    |    |/   |  \ |
//!     +----+----+----+----+----+--> Z
//! ```

use gsk_units::Point;

use crate::convex::{sweep, sweep_along};
use crate::grid::{Contour, GridPoint, PER_MM, to_grid};
use crate::region::{Bounds, Region};

/// Width of a slab, grid units: 2 mm.
const SLAB: i32 = 20_000;

/// A part, and what it was before the first cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Slabs by their number along Z; the first one's is `first`.
    slabs: Vec<Slab>,
    first: i32,
    /// Grows with every change.
    version: u64,
}

/// A slab and the box around what is left in it.
#[derive(Clone, Debug, PartialEq)]
struct Slab {
    region: Region,
    bounds: Option<Bounds>,
}

impl Slab {
    /// A crossing with its border may be rounded a unit off it: it is put back, so that
    /// neighbours neither overlap nor part.
    fn new(region: Region, number: i32) -> Self {
        let (low, high) = (number * SLAB, (number + 1) * SLAB);
        let on_border = |z: i32| match z {
            z if (z - low).abs() <= 1 => low,
            z if (z - high).abs() <= 1 => high,
            z => z,
        };
        let region = region.mapped(|point| GridPoint::new(on_border(point.x), point.y));
        let bounds = region.bounds();
        Self { region, bounds }
    }

    fn meets(&self, bounds: &Bounds) -> bool {
        self.bounds.is_some_and(|own| own.meets(bounds))
    }
}

/// What a cut took away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Removed {
    /// Area of the half section, mm².
    pub area: f64,
    /// Volume of the whole turn, mm³.
    pub volume: f64,
}

impl Removed {
    /// Another cut comes to it.
    pub fn add(&mut self, other: Self) {
        self.area += other.area;
        self.volume += other.volume;
    }
}

impl Part {
    /// A part of this half section.
    pub fn new(section: &Region) -> Self {
        let Some(bounds) = section.bounds() else {
            return Self {
                slabs: Vec::new(),
                first: 0,
                version: 0,
            };
        };
        let first = bounds.low.x.div_euclid(SLAB);
        let last = bounds.high.x.div_euclid(SLAB);
        let slabs = (first..=last)
            .map(|number| {
                let corner = |number: i32, y| GridPoint::new(number * SLAB, y);
                let slab = Region::rectangle(
                    corner(number, bounds.low.y),
                    corner(number + 1, bounds.high.y),
                );
                Slab::new(section.common(slab.contours()), number)
            })
            .collect();
        Self {
            slabs,
            first,
            version: 0,
        }
    }

    /// Takes away what a convex polygon covers on a straight way between two
    /// positions of its zero.
    pub fn cut(&mut self, polygon: &[GridPoint], from: Point, to: Point) -> Removed {
        let swept = sweep(polygon, to_grid(from), to_grid(to));
        self.remove(&[swept])
    }

    /// Takes away what a convex polygon covers on a path of straight pieces, and on its
    /// mirror image beyond the spindle axis: the part turns.
    pub fn cut_along(&mut self, polygon: &[GridPoint], path: &[GridPoint]) -> Removed {
        self.remove(&both_sides(sweep_along(polygon, path)))
    }

    /// Takes away what polygons cover.
    pub fn remove(&mut self, swept: &[Contour]) -> Removed {
        let mut removed = Removed::default();
        let mut changed = false;
        for contour in swept {
            let Some(bounds) = Bounds::of(contour) else {
                continue;
            };
            let first = self.first;
            for (index, slab) in self.passed(&bounds) {
                // A long sweep in a slab of its own: the rest of it costs nothing.
                let number = first + index as i32;
                let low = number * SLAB;
                let within = clipped(contour, low - 1, low + SLAB + 1);
                // Beside what is left in the slab the sweep is in the air.
                if !Bounds::of(&within).is_some_and(|bounds| slab.meets(&bounds)) {
                    continue;
                }
                let left = slab.region.without(&[within]);
                if left == slab.region {
                    continue;
                }
                removed.area += slab.region.area() - left.area();
                removed.volume += slab.region.volume() - left.volume();
                changed = true;
                *slab = Slab::new(left, number);
            }
        }
        if changed {
            self.version += 1;
        }
        removed
    }

    /// The slabs that a box may touch, each with its index.
    fn passed(&mut self, bounds: &Bounds) -> impl Iterator<Item = (usize, &mut Slab)> {
        let index = |z: i32| (z.div_euclid(SLAB) - self.first).clamp(0, self.slabs.len() as i32);
        let (from, to) = (
            index(bounds.low.x),
            index(bounds.high.x.saturating_add(SLAB)),
        );
        let bounds = *bounds;
        self.slabs
            .iter_mut()
            .enumerate()
            .take(to as usize)
            .skip(from as usize)
            .filter(move |(_, slab)| slab.meets(&bounds))
    }

    /// What polygons have in common with the part.
    pub fn touched(&self, contours: &[Contour]) -> Region {
        let mut touched: Vec<Contour> = Vec::new();
        for contour in contours {
            let Some(bounds) = Bounds::of(contour) else {
                continue;
            };
            for (index, slab) in self.slabs.iter().enumerate() {
                if !slab.meets(&bounds) {
                    continue;
                }
                let low = (self.first + index as i32) * SLAB;
                let within = clipped(contour, low - 1, low + SLAB + 1);
                if Bounds::of(&within).is_some_and(|bounds| slab.meets(&bounds)) {
                    let common = slab.region.common(&[within]);
                    touched.extend_from_slice(common.contours());
                }
            }
        }
        if touched.is_empty() {
            return Region::default();
        }
        Region::of(&touched)
    }

    /// Its half section in one.
    pub fn section(&self) -> Region {
        let contours: Vec<Contour> = self
            .slabs
            .iter()
            .flat_map(|slab| slab.region.contours().iter().cloned())
            .collect();
        Region::of(&contours)
    }

    /// Its volume, mm³.
    pub fn volume(&self) -> f64 {
        self.slabs.iter().map(|slab| slab.region.volume()).sum()
    }

    /// Area of its half section, mm².
    pub fn area(&self) -> f64 {
        self.slabs.iter().map(|slab| slab.region.area()).sum()
    }

    /// A number that grows with every change.
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// What was parted off: pieces that do not reach as far back as `clamped`, mm of
    /// Z. They fall, and are no more part of it.
    pub fn drop_loose(&mut self, clamped: f64) -> Vec<Region> {
        let limit = crate::grid::grid(clamped);
        let section = self.section();
        let mut pieces = section.pieces();
        if pieces.len() < 2 {
            return Vec::new();
        }
        let held = |piece: &Region| piece.bounds().is_some_and(|it| it.low.x <= limit);
        let (kept, loose): (Vec<Region>, Vec<Region>) = pieces.drain(..).partition(held);
        if kept.is_empty() || loose.is_empty() {
            return Vec::new();
        }
        let contours: Vec<Contour> = kept
            .iter()
            .flat_map(|piece| piece.contours().iter().cloned())
            .collect();
        let version = self.version + 1;
        *self = Self::new(&Region::of(&contours));
        self.version = version;
        loose
    }

    /// Greatest radius of the part between two positions of Z, mm; 0 where there is
    /// none.
    pub fn greatest_radius(&self, from: f64, to: f64) -> f64 {
        let (low, high) = (crate::grid::grid(from), crate::grid::grid(to));
        let window = Region::rectangle(GridPoint::new(low, -1), GridPoint::new(high, i32::MAX / 4));
        let common = self.touched(window.contours());
        common
            .bounds()
            .map_or(0.0, |bounds| f64::from(bounds.high.y) / PER_MM)
    }
}

/// A contour, and its mirror image if it reaches beyond the spindle axis: the half
/// section stands for the other half, too.
pub(crate) fn both_sides(contour: Contour) -> Vec<Contour> {
    if contour.iter().all(|point| point.y >= 0) {
        return vec![contour];
    }
    let mirrored = contour
        .iter()
        .rev()
        .map(|point| GridPoint::new(point.x, -point.y))
        .collect();
    vec![contour, mirrored]
}

/// A polygon between two positions of Z, grid units; crossings are rounded.
fn clipped(contour: &[GridPoint], low: i32, high: i32) -> Contour {
    let Some(bounds) = Bounds::of(contour) else {
        return Contour::new();
    };
    if bounds.low.x >= low && bounds.high.x <= high {
        return contour.to_vec();
    }
    let right_of = half(contour, low, |z, limit| z >= limit);
    half(&right_of, high, |z, limit| z <= limit)
}

/// The part of a polygon on one side of a line of Z.
fn half(contour: &[GridPoint], limit: i32, inside: fn(i32, i32) -> bool) -> Contour {
    let mut kept = Contour::with_capacity(contour.len() + 2);
    let next = contour.iter().cycle().skip(1);
    for (a, b) in contour.iter().zip(next) {
        if inside(a.x, limit) {
            kept.push(*a);
        }
        if inside(a.x, limit) != inside(b.x, limit) && a.x != limit && b.x != limit {
            let (dx, dy) = (
                i64::from(b.x) - i64::from(a.x),
                i64::from(b.y) - i64::from(a.y),
            );
            let part = (i64::from(limit) - i64::from(a.x)) as f64 / dx as f64;
            let y = i64::from(a.y) + libm::round(dy as f64 * part) as i64;
            kept.push(GridPoint::new(limit, y as i32));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::grid;
    use crate::tool::{Shape, Tool};

    fn bar(diameter: f64, length: f64) -> Part {
        let corner = |z: f64, x: f64| GridPoint::new(grid(z), grid(x));
        Part::new(&Region::rectangle(
            corner(-length, 0.0),
            corner(1.0, diameter / 2.0),
        ))
    }

    #[test]
    fn turning_a_bar_down_leaves_a_cylinder_to_a_billionth() {
        let mut part = bar(50.0, 100.0);
        let tool = Shape::of(&Tool::turning());
        let before = part.volume();
        let removed = part.cut(
            &tool.cutting,
            Point::new(22.5, 3.0),
            Point::new(22.5, -200.0),
        );
        let pi = core::f64::consts::PI;
        let ring = pi * (25.0 * 25.0 - 22.5 * 22.5) * 101.0;
        assert!((removed.volume / ring - 1.0).abs() < 1e-9, "{removed:?}");
        assert!((before - part.volume() - ring).abs() < 1e-6 * ring);
        let cylinder = pi * 22.5 * 22.5 * 101.0;
        assert!((part.volume() / cylinder - 1.0).abs() < 1e-9);
        assert_eq!(part.greatest_radius(-50.0, -10.0), 22.5);
    }

    #[test]
    fn a_cut_in_the_air_changes_nothing() {
        let mut part = bar(50.0, 100.0);
        let tool = Shape::of(&Tool::turning());
        let version = part.version();
        let removed = part.cut(
            &tool.cutting,
            Point::new(25.0, 3.0),
            Point::new(25.0, -50.0),
        );
        assert_eq!(removed, Removed::default());
        assert_eq!(part.version(), version);
    }

    #[test]
    fn a_long_sweep_costs_each_slab_its_own_piece_only() {
        let mut whole = bar(50.0, 100.0);
        let mut pieces = whole.clone();
        let tool = Shape::of(&Tool::turning());
        let (from, to) = (Point::new(24.0, 3.0), Point::new(20.0, -80.0));
        whole.cut(&tool.cutting, from, to);
        for step in 0..100 {
            let at = |step: i32| from + (to - from) * (f64::from(step) / 100.0);
            pieces.cut(&tool.cutting, at(step), at(step + 1));
        }
        // A hundred positions are rounded to the grid each.
        assert!((whole.volume() - pieces.volume()).abs() < 1e-5 * whole.volume());
    }

    #[test]
    fn what_is_parted_off_falls() {
        let mut part = bar(30.0, 100.0);
        let tool = Shape::of(&Tool::grooving(3.0));
        part.cut(
            &tool.cutting,
            Point::new(16.0, -33.0),
            Point::new(-0.5, -33.0),
        );
        let loose = part.drop_loose(-60.0);
        assert_eq!(loose.len(), 1);
        let pi = core::f64::consts::PI;
        let piece = pi * 225.0 * 31.0;
        // The corners of the insert leave a burr of their radius.
        assert!((loose[0].volume() / piece - 1.0).abs() < 1e-3);
        assert!(part.section().pieces().len() == 1);
        assert!(part.drop_loose(-60.0).is_empty());
    }
}
