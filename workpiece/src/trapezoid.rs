//! Half sections as triangles: cut into slabs between the Z of their corners, each a
//! stack of trapezoids.

use crate::grid::{GridPoint, mm};
use crate::region::Region;

/// What of a section is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    /// Its material.
    Material,
    /// What is seen from outside: up to its outermost edge.
    Outside,
}

/// A trapezoid: two Z, and at each of them the lower and the upper X, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    /// Left and right side: Z, least and greatest X.
    pub sides: [(f32, f32, f32); 2],
}

impl Trapezoid {
    /// Its corners, Z and X in mm, in the order of a strip of triangles.
    pub const fn corners(&self) -> [(f32, f32); 4] {
        let [(left, low, high), (right, lower, higher)] = self.sides;
        [(left, low), (left, high), (right, lower), (right, higher)]
    }
}

/// The trapezoids of a section, from left to right.
pub fn trapezoids(region: &Region, filled: Filled) -> Vec<Trapezoid> {
    let mut edges: Vec<(GridPoint, GridPoint)> = region
        .edges()
        .filter(|(a, b)| a.x != b.x)
        .map(|(a, b)| if a.x < b.x { (a, b) } else { (b, a) })
        .collect();
    edges.sort_by_key(|(left, _)| left.x);
    let mut stations: Vec<i32> = edges.iter().flat_map(|(a, b)| [a.x, b.x]).collect();
    stations.sort_unstable();
    stations.dedup();
    let mut coming = edges.into_iter().peekable();
    let mut active: Vec<(GridPoint, GridPoint)> = Vec::new();
    let mut made = Vec::new();
    for pair in stations.windows(2) {
        let (left, right) = (pair[0], pair[1]);
        active.retain(|(_, end)| end.x > left);
        while let Some(edge) = coming.next_if(|(begin, _)| begin.x <= left) {
            active.push(edge);
        }
        let mut crossed: Vec<(f64, f64)> = active
            .iter()
            .map(|edge| (height(edge, left), height(edge, right)))
            .collect();
        crossed.sort_by(|one, other| (one.0 + one.1).total_cmp(&(other.0 + other.1)));
        let side = |z: i32, low: f64, high: f64| (mm(z) as f32, low as f32, high as f32);
        let mut add = |low: (f64, f64), high: (f64, f64)| {
            made.push(Trapezoid {
                sides: [side(left, low.0, high.0), side(right, low.1, high.1)],
            });
        };
        match filled {
            Filled::Material => {
                for pair in crossed.chunks_exact(2) {
                    add(pair[0], pair[1]);
                }
            }
            Filled::Outside => {
                if let Some(outermost) = crossed.last() {
                    add((0.0, 0.0), *outermost);
                }
            }
        }
    }
    made
}

/// X of an edge at a Z, mm.
fn height((left, right): &(GridPoint, GridPoint), z: i32) -> f64 {
    let share = (f64::from(z) - f64::from(left.x)) / (f64::from(right.x) - f64::from(left.x));
    mm(left.y) + (mm(right.y) - mm(left.y)) * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::grid;

    fn area(made: &[Trapezoid]) -> f32 {
        let one = |it: &Trapezoid| {
            let [(left, a, b), (right, c, d)] = it.sides;
            (right - left) * (b - a + d - c) / 2.0
        };
        made.iter().map(one).sum()
    }

    #[test]
    fn material_leaves_holes_free_and_the_outside_does_not() {
        let corner = |z, x| GridPoint::new(grid(z), grid(x));
        let bar = Region::rectangle(corner(-60.0, 0.0), corner(0.0, 25.0));
        let bored = bar.without(&[vec![
            corner(-40.0, 0.0),
            corner(-10.0, 0.0),
            corner(-10.0, 10.0),
        ]]);
        let grooved = bored.without(&[vec![
            corner(-30.0, 20.0),
            corner(-25.0, 20.0),
            corner(-25.0, 30.0),
            corner(-30.0, 30.0),
        ]]);
        let material = area(&trapezoids(&grooved, Filled::Material));
        assert!(
            (material - 60.0 * 25.0 + 150.0 + 25.0).abs() < 0.1,
            "{material}"
        );
        let outside = area(&trapezoids(&grooved, Filled::Outside));
        assert!((outside - 60.0 * 25.0 + 25.0).abs() < 0.1, "{outside}");
        assert!(trapezoids(&Region::default(), Filled::Material).is_empty());
    }
}
