//! Splits half sections into trapezoids for drawing: vertical lines through all corners
//! cut the section into slabs, each a stack of trapezoids.

use crate::grid::{GridPoint, mm};
use crate::region::Region;

/// The area of a section that trapezoids fill: the material, or also bores and grooves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionFill {
    /// The trapezoids fill the material without bores and grooves.
    Material,
    /// The trapezoids fill everything between the spindle axis and the outermost edge.
    Outside,
}

/// A trapezoid with two sides perpendicular to Z, mm; X is a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    /// The left and the right side, each with Z, least X and greatest X, mm.
    pub sides: [(f32, f32, f32); 2],
}

impl Trapezoid {
    /// The corners as Z and X, mm, in the order of a triangle strip.
    pub const fn corners(&self) -> [(f32, f32); 4] {
        let [(left, low, high), (right, lower, higher)] = self.sides;
        [(left, low), (left, high), (right, lower), (right, higher)]
    }
}

/// Splits a section into trapezoids, from left to right along Z.
pub fn trapezoids(region: &Region, filled: SectionFill) -> Vec<Trapezoid> {
    let mut edges: Vec<(GridPoint, GridPoint)> = region
        .edges()
        .filter(|(a, b)| a.x != b.x)
        .map(|(a, b)| if a.x < b.x { (a, b) } else { (b, a) })
        .collect();
    edges.sort_by_key(|(left, _)| left.x);
    let mut borders: Vec<i32> = edges.iter().flat_map(|(a, b)| [a.x, b.x]).collect();
    borders.sort_unstable();
    borders.dedup();
    let mut pending = edges.into_iter().peekable();
    let mut active: Vec<(GridPoint, GridPoint)> = Vec::new();
    let mut trapezoids = Vec::new();
    for pair in borders.windows(2) {
        let (left, right) = (pair[0], pair[1]);
        active.retain(|(_, end)| end.x > left);
        while let Some(edge) = pending.next_if(|(begin, _)| begin.x <= left) {
            active.push(edge);
        }
        let mut crossed: Vec<(f64, f64)> = active
            .iter()
            .map(|edge| (radius_at(edge, left), radius_at(edge, right)))
            .collect();
        crossed.sort_by(|one, other| (one.0 + one.1).total_cmp(&(other.0 + other.1)));
        let side = |z: i32, low: f64, high: f64| (mm(z) as f32, low as f32, high as f32);
        let mut add = |low: (f64, f64), high: (f64, f64)| {
            trapezoids.push(Trapezoid {
                sides: [side(left, low.0, high.0), side(right, low.1, high.1)],
            });
        };
        match filled {
            SectionFill::Material => {
                for pair in crossed.chunks_exact(2) {
                    add(pair[0], pair[1]);
                }
            }
            SectionFill::Outside => {
                if let Some(outermost) = crossed.last() {
                    add((0.0, 0.0), *outermost);
                }
            }
        }
    }
    trapezoids
}

/// Returns X of an edge at a Z in grid units, mm.
fn radius_at((left, right): &(GridPoint, GridPoint), z: i32) -> f64 {
    let share = (f64::from(z) - f64::from(left.x)) / (f64::from(right.x) - f64::from(left.x));
    mm(left.y) + (mm(right.y) - mm(left.y)) * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::grid;

    fn area(trapezoids: &[Trapezoid]) -> f32 {
        let one = |it: &Trapezoid| {
            let [(left, a, b), (right, c, d)] = it.sides;
            (right - left) * (b - a + d - c) / 2.0
        };
        trapezoids.iter().map(one).sum()
    }

    #[test]
    fn material_leaves_out_holes_and_outside_fills_them() {
        let corner = |z, x| GridPoint::new(grid(z), grid(x));
        let bar = Region::rectangle(corner(-60.0, 0.0), corner(0.0, 25.0));
        let bored = bar.difference(&[vec![
            corner(-40.0, 0.0),
            corner(-10.0, 0.0),
            corner(-10.0, 10.0),
        ]]);
        let grooved = bored.difference(&[vec![
            corner(-30.0, 20.0),
            corner(-25.0, 20.0),
            corner(-25.0, 30.0),
            corner(-30.0, 30.0),
        ]]);
        let material = area(&trapezoids(&grooved, SectionFill::Material));
        assert!(
            (material - 60.0 * 25.0 + 150.0 + 25.0).abs() < 0.1,
            "{material}"
        );
        let outside = area(&trapezoids(&grooved, SectionFill::Outside));
        assert!((outside - 60.0 * 25.0 + 25.0).abs() < 0.1, "{outside}");
        assert!(trapezoids(&Region::default(), SectionFill::Material).is_empty());
    }
}
