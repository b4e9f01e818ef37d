//! The half section of the part as edges with normals, for a texture that the vertex shader
//! revolves.

use glam::{Vec2, vec2};

use crate::mesh::polyline::simplify;
use crate::part::material::PartMaterial;
use crate::part::threads::{SectionSampler, ThreadDescription, ThreadSurface};

/// Greatest number of edges; an outline with more is simplified.
pub const MAX_EDGES: usize = 384;
/// Number of floats of an edge in the texture: two ends, each with x, radius and a normal.
pub const EDGE_FLOATS: usize = 8;
/// Cosine of the angle between two edges above which they are shaded as one smooth surface.
const SMOOTH_COSINE: f32 = 0.93;
/// Length of the stored normal that marks an uncut edge: the shader draws it as bar surface.
const SKIN_NORMAL_LENGTH: f32 = 2.0;
/// Difference from the radius of the stock within which a surface counts as uncut, mm.
const SKIN_TOLERANCE_MM: f32 = 0.01;
/// First tolerance with which an outline is simplified, mm; doubled until the edges fit.
const FIRST_TOLERANCE_MM: f32 = 0.002;

/// An edge of the half section, which forms a surface when it is revolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineEdge {
    /// Both ends as (x, radius), mm. The material is to the left.
    pub ends: [Vec2; 2],
    /// Outward normals at both ends.
    pub normals: [Vec2; 2],
    /// Whether the edge is the uncut surface of the stock.
    pub is_skin: bool,
}

/// The surfaces of the part: edges that are revolved, and threads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartOutline {
    edges: Vec<OutlineEdge>,
    threads: Vec<ThreadSurface>,
    material: PartMaterial,
}

impl PartOutline {
    /// Creates the surfaces of a half section: closed polygons of (x, radius), mm, with holes in
    /// the opposite direction. `stock_radius` is the radius of the stock, mm.
    pub fn from_polygons(polygons: &[Vec<[f32; 2]>], stock_radius: f32) -> Self {
        Self::with_threads(polygons, stock_radius, &[])
    }

    /// Creates the surfaces of a half section with threads, whose grooves run helically around the
    /// axis. Where two threads overlap, the later one is valid.
    pub fn with_threads(
        polygons: &[Vec<[f32; 2]>],
        stock_radius: f32,
        threads: &[ThreadDescription],
    ) -> Self {
        let mut lines: Vec<Vec<Vec2>> = polygons
            .iter()
            .map(|polygon| {
                let points = polygon.iter().map(|&[x, r]| vec2(x, r.max(0.0)));
                let mut points: Vec<Vec2> = points.filter(|it| it.is_finite()).collect();
                points.dedup();
                points
            })
            .filter(|points| points.len() > 2)
            .collect();
        let exact = if threads.is_empty() {
            Vec::new()
        } else {
            lines.clone()
        };
        let section = SectionSampler::new(&exact);
        let mut surfaces: Vec<ThreadSurface> = Vec::new();
        for thread in threads.iter().rev() {
            let Some(surface) = ThreadSurface::from_section(&section, thread) else {
                continue;
            };
            let overlaps = |other: &ThreadSurface| {
                other.is_internal == surface.is_internal
                    && other.low < surface.high
                    && other.high > surface.low
            };
            if !surfaces.iter().any(overlaps) {
                surfaces.push(surface);
            }
        }
        let mut tolerance = FIRST_TOLERANCE_MM;
        while lines.iter().map(Vec::len).sum::<usize>() > MAX_EDGES && tolerance < 1000.0 {
            for points in &mut lines {
                *points = simplify(points, tolerance);
            }
            tolerance *= 2.0;
        }
        // Material is to the left of a counter-clockwise polygon: the largest one decides.
        let area = |points: &Vec<Vec2>| doubled_area(points);
        let largest = lines
            .iter()
            .map(area)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let side = if largest.unwrap_or(1.0) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let edges = lines
            .iter()
            .flat_map(|points| polygon_edges(points, side, stock_radius));
        let mut edges: Vec<OutlineEdge> = edges.collect();
        for surface in &surfaces {
            let pieces = edges
                .iter()
                .flat_map(|edge| split_edge(edge, [surface.low, surface.high]));
            edges = pieces
                .filter(|edge| {
                    let [a, b] = edge.ends;
                    !surface.replaces(&section, a, b, tolerance + 0.01)
                })
                .collect();
        }
        edges.truncate(MAX_EDGES);
        Self {
            edges,
            threads: surfaces,
            material: PartMaterial::default(),
        }
    }

    /// Returns the same part with the material `material`.
    #[must_use]
    pub fn with_material(self, material: PartMaterial) -> Self {
        Self { material, ..self }
    }

    /// Returns the material of the part.
    pub const fn material(&self) -> PartMaterial {
        self.material
    }

    /// Returns the threads of the part; no revolved edge covers them.
    pub fn threads(&self) -> &[ThreadSurface] {
        &self.threads
    }

    /// Returns the half section at an angle of the part as lines; lines on the axis are left out.
    pub fn section_lines(&self, angle: f32) -> Vec<[Vec2; 2]> {
        let mut lines: Vec<[Vec2; 2]> = self.edges.iter().map(|edge| edge.ends).collect();
        for thread in &self.threads {
            let profile = thread.profile(angle);
            lines.extend(profile.windows(2).map(|pair| [pair[0], pair[1]]));
        }
        lines
    }

    /// Returns the edges that form surfaces when they are revolved.
    pub fn edges(&self) -> &[OutlineEdge] {
        &self.edges
    }

    /// Returns the edges as texels: two per edge, each with x, radius and normal.
    pub fn texels(&self) -> Vec<f32> {
        let mut texels = Vec::with_capacity(self.edges.len() * EDGE_FLOATS);
        for edge in &self.edges {
            let length = if edge.is_skin {
                SKIN_NORMAL_LENGTH
            } else {
                1.0
            };
            for (end, normal) in edge.ends.iter().zip(edge.normals) {
                let normal = normal * length;
                texels.extend([end.x, end.y, normal.x, normal.y]);
            }
        }
        texels
    }

    /// Returns the greatest radius at x, mm; `None` without material there.
    pub fn radius_at(&self, x: f32) -> Option<f32> {
        let edges = self.edges.iter().map(|edge| edge.ends);
        let crossed = edges.filter(|[a, b]| (a.x <= x) != (b.x <= x));
        let radii = crossed.map(|[a, b]| a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x));
        let threads = self.threads.iter().filter(|it| it.low <= x && x < it.high);
        let crests = threads.flat_map(|it| it.corners().into_iter().map(|corner| corner.y));
        radii.chain(crests).reduce(f32::max)
    }

    /// Returns least x, greatest x and greatest radius, mm; `None` without a part.
    pub fn bounds(&self) -> Option<(f32, f32, f32)> {
        let threads = self.threads.iter().flat_map(ThreadSurface::corners);
        let edges = self.edges.iter().flat_map(|edge| edge.ends);
        let mut ends = edges.chain(threads);
        let first = ends.next()?;
        Some(
            ends.fold((first.x, first.x, first.y), |(low, high, radius), it| {
                (low.min(it.x), high.max(it.x), radius.max(it.y))
            }),
        )
    }
}

/// Splits an edge where it crosses one of the two x in `stops`.
fn split_edge(edge: &OutlineEdge, stops: [f32; 2]) -> Vec<OutlineEdge> {
    let mut pieces = vec![*edge];
    for stop in stops {
        let mut split = Vec::with_capacity(pieces.len() + 1);
        for piece in pieces {
            let [a, b] = piece.ends;
            let share = (stop - a.x) / (b.x - a.x);
            if !(share > 0.0 && share < 1.0) {
                split.push(piece);
                continue;
            }
            let middle = a.lerp(b, share);
            let normal = piece.normals[0].lerp(piece.normals[1], share);
            let normal = normal.normalize_or(piece.normals[0]);
            split.push(OutlineEdge {
                ends: [a, middle],
                normals: [piece.normals[0], normal],
                ..piece
            });
            split.push(OutlineEdge {
                ends: [middle, b],
                normals: [normal, piece.normals[1]],
                ..piece
            });
        }
        pieces = split;
    }
    pieces
}

fn doubled_area(points: &[Vec2]) -> f32 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
}

fn polygon_edges(points: &[Vec2], side: f32, stock_radius: f32) -> Vec<OutlineEdge> {
    let count = points.len();
    let end = |at: usize| points[at % count];
    // To the right of the direction is outside of a counter-clockwise polygon.
    let normal = |at: usize| -(end(at + 1) - end(at)).perp().normalize_or(Vec2::NEG_Y) * side;
    let mut edges = Vec::new();
    for at in 0..count {
        let ends = [end(at), end(at + 1)];
        if ends[0].y <= 0.0 && ends[1].y <= 0.0 {
            continue;
        }
        let own = normal(at);
        let blend = |other: Vec2| match own.dot(other) > SMOOTH_COSINE {
            true => (own + other).normalize_or(own),
            false => own,
        };
        let is_skin = ends
            .iter()
            .all(|it| (it.y - stock_radius).abs() < SKIN_TOLERANCE_MM);
        edges.push(OutlineEdge {
            ends,
            normals: [blend(normal(at + count - 1)), blend(normal(at + 1))],
            is_skin,
        });
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    const TUBE: [[f32; 2]; 4] = [[0.0, 10.0], [80.0, 10.0], [80.0, 25.0], [0.0, 25.0]];

    #[test]
    fn a_tube_has_a_bore_that_faces_the_axis() {
        let mut reversed = TUBE.to_vec();
        reversed.reverse();
        for polygon in [TUBE.to_vec(), reversed] {
            let part = PartOutline::from_polygons(&[polygon], 25.0);
            assert_eq!(part.edges().len(), 4);
            for edge in part.edges() {
                let is_bore = edge.ends.iter().all(|it| it.y == 10.0);
                let is_outside = edge.ends.iter().all(|it| it.y == 25.0);
                assert_eq!(edge.is_skin, is_outside);
                let expected = match (is_bore, is_outside) {
                    (true, _) => Vec2::NEG_Y,
                    (_, true) => Vec2::Y,
                    _ if edge.ends[0].x == 0.0 => Vec2::NEG_X,
                    _ => Vec2::X,
                };
                assert_eq!(edge.normals, [expected; 2]);
            }
            assert_eq!(part.bounds(), Some((0.0, 80.0, 25.0)));
            assert_eq!(part.texels().len(), 4 * EDGE_FLOATS);
            assert_eq!(part.radius_at(40.0), Some(25.0));
            assert_eq!(part.radius_at(81.0), None);
        }
    }

    #[test]
    fn a_solid_bar_has_no_surface_on_the_axis() {
        let bar = vec![[0.0, 0.0], [60.0, 0.0], [60.0, 20.0], [0.0, 20.0]];
        assert_eq!(PartOutline::from_polygons(&[bar], 20.0).edges().len(), 3);
    }

    #[test]
    fn a_long_outline_is_simplified_and_keeps_its_extent() {
        let mut points: Vec<[f32; 2]> = (0..100_000)
            .map(|at| {
                let x = at as f32 * 0.002;
                [x, 20.0 + (x * 0.2).sin() * 3.0]
            })
            .collect();
        points.extend([[199.998, 0.0], [0.0, 0.0]]);
        points.reverse();
        let part = PartOutline::from_polygons(&[points], 40.0);
        assert!(part.edges().len() > 40 && part.edges().len() <= MAX_EDGES);
        let (low, high, radius) = part.bounds().unwrap();
        assert!(low == 0.0 && (high - 199.998).abs() < 1e-3 && (radius - 23.0).abs() < 0.05);
    }

    #[test]
    fn a_thread_replaces_its_edges_and_leaves_no_gap_in_the_section() {
        let mut points = vec![[0.0, 0.0], [60.0, 0.0], [60.0, 10.0]];
        for groove in (0..10).rev() {
            let x = 21.0 + 2.0 * groove as f32;
            points.extend([[x + 0.6, 10.0], [x, 9.0], [x - 0.6, 10.0]]);
        }
        points.push([0.0, 10.0]);
        let thread = ThreadDescription {
            low: 21.0,
            high: 39.0,
            lead: -2.0,
            is_internal: false,
        };
        let part = PartOutline::with_threads(&[points], 10.0, &[thread]);
        assert_eq!((part.threads().len(), part.edges().len()), (1, 4));
        assert_eq!(part.bounds(), Some((0.0, 60.0, 10.0)));
        for angle in [0.0, 1.0, 4.0] {
            let lines = part.section_lines(angle);
            let area: f32 = crate::section_cut::trapezoids(&lines)
                .iter()
                .map(|it| doubled_area(it) * 0.5)
                .sum();
            // Ten grooves of 0.6 mm², up to one of them over the end at other angles.
            assert!((area - 594.0).abs() < 0.7, "{angle}: {area}");
        }
    }

    #[test]
    fn degenerate_outlines_are_empty_or_finite() {
        let wrong = f32::NAN;
        for polygon in [
            vec![],
            vec![[0.0, 0.0]],
            vec![[wrong, 1.0], [2.0, wrong], [3.0, 3.0], [4.0, 4.0]],
            vec![[0.0, 5.0], [10.0, 5.0], [20.0, 5.0]],
            vec![[1.0, 1.0]; 500],
        ] {
            let part = PartOutline::from_polygons(&[polygon], wrong);
            assert!(part.texels().iter().all(|it| it.is_finite()));
        }
    }
}
