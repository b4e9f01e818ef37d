//! The turned part: its half section, stored in slabs along Z.
//!
//! A cut changes only the slabs that the tool passes. Its cost does not grow with the
//! length of the part:
//!
//! ```text
//!   X ^    |    |    |  __|_   |
//!     |    |____|____|_/ P|_\__|      P: area swept by the tool
//!     |    |    |    |/   |  \ |
//!     +----+----+----+----+----+--> Z
//! ```

use std::sync::Arc;

use gsk_units::Point;

use crate::convex::{sweep, sweep_along};
use crate::grid::{GridContour, GridPoint, PER_MM, to_grid};
use crate::region::{GridBounds, Region};

/// Width of a slab of the part along Z, grid units: 2 mm.
const SLAB_UNITS: i32 = 20_000;

/// The half section of a part that tools cut, stored in slabs along Z.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedPart {
    /// Slabs in the order of Z. Copies of a part share those that neither has cut since.
    slabs: Vec<Arc<Slab>>,
    /// The number of the first slab; slab `n` begins at `n * SLAB_UNITS`.
    first: i32,
    version: u64,
}

/// A slab of the part: the material that remains between two Z, with its bounding box.
#[derive(Clone, Debug, PartialEq)]
struct Slab {
    region: Region,
    bounds: Option<GridBounds>,
}

impl Slab {
    /// Creates slab `number` from the material in it. Rounding may put a crossing one unit
    /// beside the border of the slab. Such a crossing is moved onto the border, so that
    /// neighbours neither overlap nor leave a gap.
    fn new(region: Region, number: i32) -> Self {
        let (low, high) = (number * SLAB_UNITS, (number + 1) * SLAB_UNITS);
        let on_border = |z: i32| match z {
            z if (z - low).abs() <= 1 => low,
            z if (z - high).abs() <= 1 => high,
            z => z,
        };
        let region = region.map_points(|point| GridPoint::new(on_border(point.x), point.y));
        let bounds = region.bounds();
        Self { region, bounds }
    }

    fn intersects(&self, bounds: &GridBounds) -> bool {
        self.bounds.is_some_and(|own| own.intersects(bounds))
    }
}

/// The amount of material that a cut removes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RemovedMaterial {
    /// Removed area of the half section, mm².
    pub area: f64,
    /// Removed volume of the solid of revolution, mm³.
    pub volume: f64,
}

impl RemovedMaterial {
    /// Adds the amount that another cut removed.
    pub fn add(&mut self, other: Self) {
        self.area += other.area;
        self.volume += other.volume;
    }
}

impl TurnedPart {
    /// Creates an uncut part with the given half section; its version is 0.
    pub fn new(section: &Region) -> Self {
        let Some(bounds) = section.bounds() else {
            return Self {
                slabs: Vec::new(),
                first: 0,
                version: 0,
            };
        };
        let first = bounds.low.x.div_euclid(SLAB_UNITS);
        let last = bounds.high.x.div_euclid(SLAB_UNITS);
        let slabs = (first..=last)
            .map(|number| {
                let corner = |number: i32, y| GridPoint::new(number * SLAB_UNITS, y);
                let slab = Region::rectangle(
                    corner(number, bounds.low.y),
                    corner(number + 1, bounds.high.y),
                );
                Arc::new(Slab::new(section.intersection(slab.contours()), number))
            })
            .collect();
        Self {
            slabs,
            first,
            version: 0,
        }
    }

    /// Removes the area that a convex polygon sweeps while its zero moves on a straight line
    /// from `from` to `to`, mm. Returns the amount removed.
    pub fn cut(&mut self, polygon: &[GridPoint], from: Point, to: Point) -> RemovedMaterial {
        let swept = sweep(polygon, to_grid(from), to_grid(to));
        self.remove(&[swept])
    }

    /// Removes the area that a convex polygon sweeps along a path of lines, and returns the
    /// amount removed. A path beyond the spindle axis also removes the mirror image of that
    /// area, because the part turns.
    pub fn cut_along(&mut self, polygon: &[GridPoint], path: &[GridPoint]) -> RemovedMaterial {
        self.remove(&with_mirror_image(sweep_along(polygon, path)))
    }

    /// Removes the area of polygons and returns the amount removed. The version increases if
    /// any material is removed.
    pub fn remove(&mut self, swept: &[GridContour]) -> RemovedMaterial {
        let mut removed = RemovedMaterial::default();
        let mut changed = false;
        for contour in swept {
            let Some(bounds) = GridBounds::from_points(contour) else {
                continue;
            };
            let first = self.first;
            for (index, slab) in self.slabs_near(&bounds) {
                // Only the part of a long sweep within this slab is subtracted.
                let number = first + index as i32;
                let low = number * SLAB_UNITS;
                let within = clip_to_z_range(contour, low - 1, low + SLAB_UNITS + 1);
                // Skip a sweep that misses the material left in this slab.
                let Some(material) = slab.bounds.filter(|it| {
                    GridBounds::from_points(&within).is_some_and(|bounds| bounds.intersects(it))
                }) else {
                    continue;
                };
                let near = without_far_corners(&within, &material);
                let left = slab.region.difference(&[near]);
                if left == slab.region {
                    continue;
                }
                removed.area += slab.region.area() - left.area();
                removed.volume += slab.region.volume() - left.volume();
                changed = true;
                *slab = Arc::new(Slab::new(left, number));
            }
        }
        if changed {
            self.version += 1;
        }
        removed
    }

    /// The slabs whose material may intersect a box, each with its index in the list of slabs.
    fn slabs_near(&mut self, bounds: &GridBounds) -> impl Iterator<Item = (usize, &mut Arc<Slab>)> {
        let index =
            |z: i32| (z.div_euclid(SLAB_UNITS) - self.first).clamp(0, self.slabs.len() as i32);
        let (from, to) = (
            index(bounds.low.x),
            index(bounds.high.x.saturating_add(SLAB_UNITS)),
        );
        let bounds = *bounds;
        self.slabs
            .iter_mut()
            .enumerate()
            .take(to as usize)
            .skip(from as usize)
            .filter(move |(_, slab)| slab.intersects(&bounds))
    }

    /// Returns the material of the part that is within the polygons.
    pub fn intersection(&self, contours: &[GridContour]) -> Region {
        let mut touched: Vec<GridContour> = Vec::new();
        for contour in contours {
            let Some(bounds) = GridBounds::from_points(contour) else {
                continue;
            };
            for (index, slab) in self.slabs.iter().enumerate() {
                if !slab.intersects(&bounds) {
                    continue;
                }
                let low = (self.first + index as i32) * SLAB_UNITS;
                let within = clip_to_z_range(contour, low - 1, low + SLAB_UNITS + 1);
                if GridBounds::from_points(&within).is_some_and(|bounds| slab.intersects(&bounds)) {
                    let common = slab.region.intersection(&[within]);
                    touched.extend_from_slice(common.contours());
                }
            }
        }
        if touched.is_empty() {
            return Region::default();
        }
        Region::from_contours(&touched)
    }

    /// Returns the pieces of a straight line that are in the material, each by its first and last
    /// fraction of the line. `from` and `to` are in grid units and not on the grid, so that the
    /// line runs along no edge of the part.
    pub(crate) fn shares_within(&self, from: Point, to: Point) -> Vec<(f64, f64)> {
        let along = to - from;
        let square = along.dot(along);
        let mut shares = Vec::new();
        if square <= 0.0 {
            return shares;
        }
        let slab_of =
            |z: f64| (libm::floor(z / f64::from(SLAB_UNITS)) as i32).saturating_sub(self.first);
        let (low, high) = (slab_of(from.z.min(to.z)), slab_of(from.z.max(to.z)));
        let first = low.max(0) as usize;
        let count = (high.saturating_add(1)).max(0) as usize;
        let mut crossings = Vec::new();
        for slab in self.slabs.iter().take(count).skip(first) {
            crossings.clear();
            for (a, b) in slab.region.edges() {
                let corner = |it: GridPoint| Point::new(f64::from(it.y), f64::from(it.x)) - from;
                let (a, b) = (corner(a), corner(b));
                let (left, right) = (along.cross(a), along.cross(b));
                if (left > 0.0) != (right > 0.0) {
                    let crossing = a + (b - a) * (left / (left - right));
                    crossings.push((along.dot(crossing) / square).clamp(0.0, 1.0));
                }
            }
            crossings.sort_unstable_by(f64::total_cmp);
            let pairs = crossings.chunks_exact(2).map(|pair| (pair[0], pair[1]));
            shares.extend(pairs.filter(|(begin, end)| begin < end));
        }
        shares
    }

    /// Returns the whole half section as one region.
    pub fn section(&self) -> Region {
        let contours: Vec<GridContour> = self
            .slabs
            .iter()
            .flat_map(|slab| slab.region.contours().iter().cloned())
            .collect();
        Region::from_contours(&contours)
    }

    /// Returns the volume of the part, mm³.
    pub fn volume(&self) -> f64 {
        self.slabs.iter().map(|slab| slab.region.volume()).sum()
    }

    /// Returns the area of the half section, mm².
    pub fn area(&self) -> f64 {
        self.slabs.iter().map(|slab| slab.region.area()).sum()
    }

    /// A counter that increases with each change. A part with the same version is unchanged.
    pub const fn version(&self) -> u64 {
        self.version
    }

    /// Removes and returns the pieces that are cut off: those that lie wholly in front of
    /// the jaws. `jaw_front` is the Z of the front of the jaws, mm. Removes nothing if no
    /// piece is held.
    pub fn drop_loose_pieces(&mut self, jaw_front: f64) -> Vec<Region> {
        let limit = crate::grid::grid(jaw_front);
        let section = self.section();
        let mut pieces = section.connected_areas();
        if pieces.len() < 2 {
            return Vec::new();
        }
        let is_held = |piece: &Region| piece.bounds().is_some_and(|it| it.low.x <= limit);
        let (kept, loose): (Vec<Region>, Vec<Region>) = pieces.drain(..).partition(is_held);
        if kept.is_empty() || loose.is_empty() {
            return Vec::new();
        }
        let contours: Vec<GridContour> = kept
            .iter()
            .flat_map(|piece| piece.contours().iter().cloned())
            .collect();
        let version = self.version + 1;
        *self = Self::new(&Region::from_contours(&contours));
        self.version = version;
        loose
    }

    /// The greatest radius of the part between two Z positions, mm; 0 without material.
    pub fn max_radius(&self, from: f64, to: f64) -> f64 {
        let (low, high) = (crate::grid::grid(from), crate::grid::grid(to));
        let window = Region::rectangle(GridPoint::new(low, -1), GridPoint::new(high, i32::MAX / 4));
        let common = self.intersection(window.contours());
        common
            .bounds()
            .map_or(0.0, |bounds| f64::from(bounds.high.y) / PER_MM)
    }
}

/// A contour, with its mirror image if it extends beyond the spindle axis. Because the
/// part turns, a tool beyond the axis cuts the half section, too.
pub(crate) fn with_mirror_image(contour: GridContour) -> Vec<GridContour> {
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

/// Clips a polygon to a range of Z, grid units; crossings are rounded to the grid.
fn clip_to_z_range(contour: &[GridPoint], low: i32, high: i32) -> GridContour {
    let Some(bounds) = GridBounds::from_points(contour) else {
        return GridContour::new();
    };
    if bounds.low.x >= low && bounds.high.x <= high {
        return contour.to_vec();
    }
    let right_of = clip_half_plane(contour, low, |z, limit| z >= limit);
    clip_half_plane(&right_of, high, |z, limit| z <= limit)
}

/// Leaves out the corners of a polygon whose two neighbours are beyond the same side of the
/// material `bounds` as they are themselves: the edge that replaces them is beyond it, too.
///
/// ```text
///     x---x---x        corners x are left out: most of those of an insert in a finishing cut
///    /          \
///   o            o
///  --\--material-/--
/// ```
fn without_far_corners(contour: &[GridPoint], bounds: &GridBounds) -> GridContour {
    let side = |point: &GridPoint| {
        i8::from(point.y > bounds.high.y + 1) - i8::from(point.y < bounds.low.y - 1)
    };
    let before = contour.iter().cycle().skip(contour.len().saturating_sub(1));
    let after = contour.iter().cycle().skip(1);
    let neighbours = before
        .zip(after)
        .map(|(before, after)| (side(before), side(after)));
    let corners = contour.iter().zip(neighbours);
    let near = corners.filter(|(corner, (before, after))| {
        let own = side(corner);
        own == 0 || own != *before || own != *after
    });
    near.map(|(corner, _)| *corner).collect()
}

/// Clips a polygon at the line Z = `limit`, grid units. `inside` compares a Z with the limit
/// and returns whether to keep it.
fn clip_half_plane(contour: &[GridPoint], limit: i32, inside: fn(i32, i32) -> bool) -> GridContour {
    let mut kept = GridContour::with_capacity(contour.len() + 2);
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
            let share = (i64::from(limit) - i64::from(a.x)) as f64 / dx as f64;
            let y = i64::from(a.y) + libm::round(dy as f64 * share) as i64;
            kept.push(GridPoint::new(limit, y as i32));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::convex::convex_hull;
    use crate::grid::grid;
    use crate::tool::{Tool, ToolShape};

    fn bar(diameter: f64, length: f64) -> TurnedPart {
        let corner = |z: f64, x: f64| GridPoint::new(grid(z), grid(x));
        TurnedPart::new(&Region::rectangle(
            corner(-length, 0.0),
            corner(1.0, diameter / 2.0),
        ))
    }

    #[test]
    fn turning_a_bar_leaves_the_exact_volume_of_a_cylinder() {
        let mut part = bar(50.0, 100.0);
        let tool = ToolShape::from_tool(&Tool::turning());
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
        assert_eq!(part.max_radius(-50.0, -10.0), 22.5);
    }

    #[test]
    fn a_cut_beside_the_part_changes_nothing() {
        let mut part = bar(50.0, 100.0);
        let tool = ToolShape::from_tool(&Tool::turning());
        let version = part.version();
        let removed = part.cut(
            &tool.cutting,
            Point::new(25.0, 3.0),
            Point::new(25.0, -50.0),
        );
        assert_eq!(removed, RemovedMaterial::default());
        assert_eq!(part.version(), version);
    }

    #[test]
    fn one_long_sweep_removes_as_much_as_a_hundred_short_ones() {
        let mut whole = bar(50.0, 100.0);
        let mut pieces = whole.clone();
        let tool = ToolShape::from_tool(&Tool::turning());
        let (from, to) = (Point::new(24.0, 3.0), Point::new(20.0, -80.0));
        whole.cut(&tool.cutting, from, to);
        for step in 0..100 {
            let at = |step: i32| from + (to - from) * (f64::from(step) / 100.0);
            pieces.cut(&tool.cutting, at(step), at(step + 1));
        }
        // Each of the hundred positions is rounded to the grid.
        assert!((whole.volume() - pieces.volume()).abs() < 1e-5 * whole.volume());
    }

    proptest! {
        #[test]
        fn far_corners_do_not_change_a_cut(
            corners in prop::collection::vec((-900..1900_i32, -900..1900_i32), 3..40)
        ) {
            let corners = corners.iter().map(|(z, x)| GridPoint::new(*z, *x));
            let swept = convex_hull(corners);
            let material = Region::rectangle(GridPoint::new(0, 0), GridPoint::new(1000, 1000));
            let bounds = material.bounds().unwrap_or_else(|| unreachable!());
            let near = without_far_corners(&swept, &bounds);
            prop_assert!(near.len() <= swept.len());
            prop_assert_eq!(material.difference(&[near]), material.difference(&[swept]));
        }
    }

    #[test]
    fn a_piece_that_is_cut_off_is_dropped() {
        let mut part = bar(30.0, 100.0);
        let tool = ToolShape::from_tool(&Tool::grooving(3.0));
        part.cut(
            &tool.cutting,
            Point::new(16.0, -33.0),
            Point::new(-0.5, -33.0),
        );
        let loose = part.drop_loose_pieces(-60.0);
        assert_eq!(loose.len(), 1);
        let pi = core::f64::consts::PI;
        let piece = pi * 225.0 * 31.0;
        // The corners of the insert leave a burr of their radius.
        assert!((loose[0].volume() / piece - 1.0).abs() < 1e-3);
        assert!(part.section().connected_areas().len() == 1);
        assert!(part.drop_loose_pieces(-60.0).is_empty());
    }
}
