//! Ambient occlusion: the share of the sky that each vertex sees, from depth pictures of the
//! mesh in many directions.

use glam::{Vec3, vec3};

use crate::mesh::SceneMesh;

/// Width and height of a depth picture, pixels.
const PICTURE_SIDE: usize = 288;
/// Number of directions from which ambient occlusion is sampled.
pub const DIRECTIONS: usize = 48;
/// Depth tolerance within which a vertex counts as visible, pixels: surfaces do not occlude
/// themselves.
const BIAS_PIXELS: f32 = 2.5;
/// The golden angle, radians. Directions at its multiples are spread evenly.
const GOLDEN_ANGLE: f32 = 2.399_963;
/// Least exposure of a vertex, 0 to 1, so that no corner is black.
const MIN_EXPOSURE: f32 = 0.10;

/// Computes the ambient occlusion of one mesh, one direction per step, so that no frame waits for
/// it.
#[derive(Clone, Debug)]
pub struct OcclusionBake {
    centre: Vec3,
    pixels_per_mm: f32,
    /// For each vertex, the summed weight of the directions that see it, and of all directions.
    sums: Vec<(f32, f32)>,
    projected: Vec<Vec3>,
    depth: Vec<f32>,
    next_direction: usize,
}

impl OcclusionBake {
    /// Prepares the computation of ambient occlusion for a mesh.
    pub fn new(mesh: &SceneMesh) -> Self {
        let (mut low, mut high) = (Vec3::MAX, Vec3::MIN);
        for vertex in &mesh.vertices {
            low = low.min(vertex.position);
            high = high.max(vertex.position);
        }
        let is_empty = mesh.vertices.is_empty();
        let radius = if is_empty {
            1.0
        } else {
            (high - low).length() * 0.5 + 1.0
        };
        Self {
            centre: if is_empty {
                Vec3::ZERO
            } else {
                (low + high) * 0.5
            },
            pixels_per_mm: (PICTURE_SIDE as f32 - 2.0) * 0.5 / radius,
            sums: vec![(0.0, 0.0); mesh.vertices.len()],
            projected: vec![Vec3::ZERO; mesh.vertices.len()],
            depth: vec![f32::MIN; PICTURE_SIDE * PICTURE_SIDE],
            next_direction: 0,
        }
    }

    /// Whether all directions have been added.
    pub const fn is_complete(&self) -> bool {
        self.next_direction >= DIRECTIONS
    }

    /// Adds the next direction. Returns true once all directions are added.
    pub fn add_direction(&mut self, mesh: &SceneMesh) -> bool {
        if self.is_complete() {
            return true;
        }
        let share = (self.next_direction as f32 + 0.5) / DIRECTIONS as f32;
        let up = 1.0 - share * 1.75;
        let (sine, cosine) = (self.next_direction as f32 * GOLDEN_ANGLE).sin_cos();
        let flat = (1.0 - up * up).max(0.0).sqrt();
        let direction = vec3(flat * cosine, up, flat * sine);
        self.next_direction += 1;
        let across = direction.any_orthonormal_vector();
        let other = direction.cross(across);
        let middle = PICTURE_SIDE as f32 * 0.5;
        for (projected, vertex) in self.projected.iter_mut().zip(&mesh.vertices) {
            let at = (vertex.position - self.centre) * self.pixels_per_mm;
            *projected = vec3(
                at.dot(across) + middle,
                at.dot(other) + middle,
                at.dot(direction),
            );
        }
        self.draw_depth(mesh);
        for ((vertex, at), sum) in mesh
            .vertices
            .iter()
            .zip(&self.projected)
            .zip(&mut self.sums)
        {
            let facing = vertex.normal.dot(direction);
            if facing <= 0.02 {
                continue;
            }
            // Light from above counts more.
            let weight = facing * (0.6 + 0.4 * up);
            let column = (at.x + vertex.normal.dot(across) * 1.5).round() as usize;
            let row = (at.y + vertex.normal.dot(other) * 1.5).round() as usize;
            let (column, row) = (column.min(PICTURE_SIDE - 1), row.min(PICTURE_SIDE - 1));
            sum.1 += weight;
            if self.depth[row * PICTURE_SIDE + column] <= at.z + BIAS_PIXELS {
                sum.0 += weight;
            }
        }
        self.is_complete()
    }

    fn draw_depth(&mut self, mesh: &SceneMesh) {
        self.depth.fill(f32::MIN);
        for corners in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [corners[0], corners[1], corners[2]]
                .map(|at| self.projected.get(at as usize).copied().unwrap_or_default());
            let (ab, ac) = (b - a, c - a);
            let area = ab.x * ac.y - ab.y * ac.x;
            if area.abs() < 1e-6 {
                continue;
            }
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let last = PICTURE_SIDE - 1;
            for row in low.y.ceil() as usize..=(high.y as usize).min(last) {
                for column in low.x.ceil() as usize..=(high.x as usize).min(last) {
                    let (x, y) = (column as f32 - a.x, row as f32 - a.y);
                    let u = (x * ac.y - y * ac.x) / area;
                    let v = (ab.x * y - ab.y * x) / area;
                    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
                        let depth = &mut self.depth[row * PICTURE_SIDE + column];
                        *depth = depth.max(a.z + ab.z * u + ac.z * v);
                    }
                }
            }
        }
    }

    /// Writes the exposure into the vertices of the mesh.
    pub fn apply(&self, mesh: &mut SceneMesh) {
        for (vertex, (seen, all)) in mesh.vertices.iter_mut().zip(&self.sums) {
            let share = if *all > 0.0 { seen / all } else { MIN_EXPOSURE };
            vertex.exposure = (share.clamp(MIN_EXPOSURE, 1.0) * 255.0) as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_floor_under_a_roof_is_darker_than_the_roof() {
        let mut mesh = SceneMesh::default();
        mesh.add_plate(
            vec3(-200.0, 0.0, 200.0),
            vec3(400.0, 0.0, 0.0),
            vec3(0.0, 0.0, -400.0),
        );
        let floor = mesh.vertices.len();
        mesh.add_box(vec3(-150.0, 40.0, -150.0), vec3(150.0, 60.0, 150.0), 2.0);
        let mut bake = OcclusionBake::new(&mesh);
        while !bake.add_direction(&mesh) {}
        bake.apply(&mut mesh);
        let at = |x: f32, z: f32, from: usize| {
            let wanted = |it: &&crate::mesh::SceneVertex| {
                (it.position.x - x).abs() < 25.0
                    && (it.position.z - z).abs() < 25.0
                    && it.normal.y > 0.9
            };
            let vertex = mesh.vertices[from..].iter().find(wanted);
            vertex.map(|it| it.exposure).expect("a vertex")
        };
        assert!(at(0.0, 0.0, 0) < 90, "{}", at(0.0, 0.0, 0));
        assert!(at(0.0, 0.0, floor) > 230, "{}", at(0.0, 0.0, floor));
    }

    #[test]
    fn an_empty_mesh_is_complete_after_all_directions() {
        let mesh = SceneMesh::default();
        let mut bake = OcclusionBake::new(&mesh);
        let calls = (0..100).take_while(|_| !bake.add_direction(&mesh)).count();
        assert_eq!(calls, DIRECTIONS - 1);
    }
}
