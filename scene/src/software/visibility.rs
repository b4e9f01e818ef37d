//! A rasteriser with a depth buffer: the surface that each pixel sees.

use glam::{Mat4, Vec2, Vec3, Vec4};

/// Index that means: the pixel shows no triangle.
const NO_TRIANGLE: u32 = u32::MAX;

/// A corner of a triangle in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCorner {
    /// Position of the corner in the scene, mm.
    pub position: Vec3,
    /// Outward normal of the surface at the corner.
    pub normal: Vec3,
    /// Colour as sRGB, 0 to 1; then the share of the sky that is visible from the corner, 0 to 1.
    pub color: Vec4,
    /// Roughness, metallic reflection, turning marks and glow, each 0 to 1.
    pub finish: Vec4,
}

impl SurfaceCorner {
    /// Interpolates three corners with weights whose sum is 1.
    fn weighted([a, b, c]: &[Self; 3], weights: Vec3) -> Self {
        let Vec3 { x, y, z } = weights;
        Self {
            position: a.position * x + b.position * y + c.position * z,
            normal: a.normal * x + b.normal * y + c.normal * z,
            color: a.color * x + b.color * y + c.color * z,
            finish: a.finish * x + b.finish * y + c.finish * z,
        }
    }

    fn mix(&self, other: &Self, share: f32) -> Self {
        Self::weighted(&[*self, *other, *other], Vec3::new(1.0 - share, share, 0.0))
    }
}

/// A triangle projected to the picture.
#[derive(Clone, Copy, Debug)]
struct ScreenTriangle {
    /// Column, row, depth and reciprocal of w of each corner; pixels from the upper left.
    screen: [Vec4; 3],
    surface: [SurfaceCorner; 3],
}

impl ScreenTriangle {
    /// Returns twice the signed area, pixels²; negative for a triangle that is seen from outside.
    fn doubled_area(&self) -> f32 {
        let [a, b, c] = self.screen.map(|it| Vec2::new(it.x, it.y));
        (b - a).perp_dot(c - a)
    }

    /// Returns the surface at a point of the triangle, interpolated with the weights of its
    /// corners.
    fn surface_at(&self, weights: Vec3) -> SurfaceCorner {
        let [a, b, c] = self.screen.map(|it| it.w);
        let weights = weights * Vec3::new(a, b, c);
        let sum = weights.element_sum();
        SurfaceCorner::weighted(&self.surface, weights / sum)
    }

    /// Calls `visit` with pixel index, depth and weights for each pixel whose centre is inside the
    /// triangle.
    fn scan(&self, size: [usize; 2], mut visit: impl FnMut(usize, f32, Vec3)) {
        let area = self.doubled_area();
        if !(area.abs() > 1e-9 && area.is_finite()) {
            return;
        }
        let [a, b, c] = self.screen;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let [columns, rows] = size;
        let first = |at: f32| (at - 0.5).ceil().max(0.0) as usize;
        let end =
            |at: f32, count: usize| ((at - 0.5).floor() + 1.0).clamp(0.0, count as f32) as usize;
        let [ab, ac] = [b - a, c - a];
        for row in first(low.y)..end(high.y, rows) {
            let y = row as f32 + 0.5 - a.y;
            for column in first(low.x)..end(high.x, columns) {
                let x = column as f32 + 0.5 - a.x;
                let v = (x * ac.y - y * ac.x) / area;
                let w = (ab.x * y - ab.y * x) / area;
                if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
                    let weights = Vec3::new(1.0 - v - w, v, w);
                    visit(row * columns + column, a.z + ab.z * v + ac.z * w, weights);
                }
            }
        }
    }
}

/// For each pixel the nearest triangle, with its depth.
#[derive(Clone, Debug, Default)]
pub struct VisibilityBuffer {
    size: [usize; 2],
    depth: Vec<f32>,
    owner: Vec<u32>,
    triangles: Vec<ScreenTriangle>,
}

impl VisibilityBuffer {
    /// Creates an empty buffer of `size` pixels.
    pub fn new(size: [usize; 2]) -> Self {
        let count = size[0] * size[1];
        Self {
            size,
            depth: vec![f32::MAX; count],
            owner: vec![NO_TRIANGLE; count],
            triangles: Vec::new(),
        }
    }

    /// Returns the depths of all pixels, row by row from above; `f32::MAX` where no triangle is.
    pub fn depths(&self) -> &[f32] {
        &self.depth
    }

    /// Replaces the depths by those of a finished picture of the same size.
    pub fn set_depths(&mut self, depths: &[f32]) {
        self.depth.copy_from_slice(depths);
    }

    /// Adds a triangle. If `culls`, a triangle seen from inside is left out.
    pub fn add(&mut self, projection: &Mat4, corners: [SurfaceCorner; 3], culls: bool) {
        for triangle in to_screen(self.size, projection, corners) {
            if culls && triangle.doubled_area() >= 0.0 {
                continue;
            }
            let number = self.triangles.len() as u32;
            let (depths, owners) = (&mut self.depth, &mut self.owner);
            let mut is_seen = false;
            triangle.scan(self.size, |at, depth, _| {
                if depth < depths[at] {
                    depths[at] = depth;
                    owners[at] = number;
                    is_seen = true;
                }
            });
            if is_seen {
                self.triangles.push(triangle);
            }
        }
    }

    /// Calls `visit` with pixel index and surface for each pixel where a triangle is nearer than
    /// all triangles in the buffer; does not add the triangle.
    pub fn visit_nearer(
        &self,
        projection: &Mat4,
        corners: [SurfaceCorner; 3],
        mut visit: impl FnMut(usize, SurfaceCorner),
    ) {
        for triangle in to_screen(self.size, projection, corners) {
            triangle.scan(self.size, |at, depth, weights| {
                if depth < self.depth[at] {
                    visit(at, triangle.surface_at(weights));
                }
            });
        }
    }

    /// Returns the surface at the pixel with index `at`; `None` if no triangle is there.
    pub fn surface(&self, at: usize) -> Option<SurfaceCorner> {
        let owner = *self.owner.get(at)?;
        let triangle = self.triangles.get(owner as usize)?;
        let (column, row) = (at % self.size[0], at / self.size[0]);
        let [a, b, c] = triangle.screen;
        let (x, y) = (column as f32 + 0.5 - a.x, row as f32 + 0.5 - a.y);
        let [ab, ac] = [b - a, c - a];
        let area = triangle.doubled_area();
        let v = (x * ac.y - y * ac.x) / area;
        let w = (ab.x * y - ab.y * x) / area;
        Some(triangle.surface_at(Vec3::new(1.0 - v - w, v, w)))
    }
}

/// Projects a triangle to the picture; cuts off what is nearer than the near plane.
fn to_screen(
    size: [usize; 2],
    projection: &Mat4,
    corners: [SurfaceCorner; 3],
) -> impl Iterator<Item = ScreenTriangle> {
    let mut kept: Vec<(Vec4, SurfaceCorner)> = Vec::with_capacity(4);
    let clip = corners.map(|it| *projection * it.position.extend(1.0));
    let inside = |at: Vec4| at.z + at.w;
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let (near, far) = (inside(clip[from]), inside(clip[to]));
        if near > 0.0 {
            kept.push((clip[from], corners[from]));
        }
        if (near > 0.0) != (far > 0.0) {
            let share = near / (near - far);
            kept.push((
                clip[from].lerp(clip[to], share),
                corners[from].mix(&corners[to], share),
            ));
        }
    }
    let [width, height] = size.map(|it| it as f32);
    let placed: Vec<(Vec4, SurfaceCorner)> = kept
        .into_iter()
        .map(|(at, corner)| {
            let share = 1.0 / at.w.max(1e-6);
            let (x, y) = (at.x * share * 0.5 + 0.5, 0.5 - at.y * share * 0.5);
            (
                Vec4::new(x * width, y * height, at.z * share, share),
                corner,
            )
        })
        .collect();
    (2..placed.len()).map(move |last| {
        let chosen = [placed[0], placed[last - 1], placed[last]];
        ScreenTriangle {
            screen: chosen.map(|it| it.0),
            surface: chosen.map(|it| it.1),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;

    fn corner(x: f32, y: f32, z: f32) -> SurfaceCorner {
        SurfaceCorner {
            position: vec3(x, y, z),
            normal: Vec3::Z,
            color: Vec4::ONE,
            finish: Vec4::ZERO,
        }
    }

    fn plate(z: f32, half: f32) -> [[SurfaceCorner; 3]; 2] {
        let at = |x: f32, y: f32| corner(x * half, y * half, z);
        let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn the_nearest_plate_is_seen_and_one_that_faces_away_is_not() {
        let mut buffer = VisibilityBuffer::new([10, 10]);
        for triangle in plate(0.5, 1.0) {
            buffer.add(&Mat4::IDENTITY, triangle, true);
        }
        for triangle in plate(0.2, 0.4) {
            buffer.add(&Mat4::IDENTITY, triangle, true);
        }
        for [a, b, c] in plate(0.0, 1.0) {
            buffer.add(&Mat4::IDENTITY, [a, c, b], true);
        }
        let depth = |column: usize, row: usize| buffer.surface(row * 10 + column).unwrap();
        assert!(depth(0, 0).position.distance(vec3(-0.9, 0.9, 0.5)) < 1e-5);
        assert!((depth(5, 5).position.z - 0.2).abs() < 1e-5);
        let near = buffer.depths().iter().filter(|it| **it < 0.3).count();
        assert_eq!(near, 16);
    }

    #[test]
    fn what_is_nearer_than_the_near_plane_is_cut_off() {
        let projection = Mat4::from_cols(
            vec3(1.0, 0.0, 0.0).extend(0.0),
            vec3(0.0, 1.0, 0.0).extend(0.0),
            vec3(0.0, 0.0, -1.02).extend(-1.0),
            vec3(0.0, 0.0, -0.2).extend(0.0),
        );
        let mut buffer = VisibilityBuffer::new([20, 20]);
        let floor = [
            corner(-50.0, -1.0, -10.0),
            corner(50.0, -1.0, -10.0),
            corner(0.0, -1.0, 30.0),
        ];
        buffer.add(&projection, floor, false);
        let seen = (0..400).filter(|at| buffer.surface(*at).is_some());
        let rows: Vec<usize> = seen.map(|at| at / 20).collect();
        // The floor is one unit below the eye: never above the middle.
        assert!(rows.len() > 100 && rows.iter().all(|row| *row >= 10));
    }
}
