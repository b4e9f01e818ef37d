//! The four primitives from which all machines are built: chamfered box, revolve, prism and
//! tube.

use core::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Mat4, Vec2, Vec3, vec2, vec3};

use crate::mesh::SceneMesh;

/// Cosine of the angle between two pieces of a revolved outline above which they are shaded as one
/// smooth surface.
const SMOOTH_COSINE: f32 = 0.82;
/// Least distance between two points, mm, below which they count as one.
const SAME_POINT_MM: f32 = 1e-4;

/// Returns the number of equal pieces of at most `step` into which `length` is divided.
fn piece_count(length: f32, step: f32) -> u32 {
    let count = (length / step.max(1.0)).ceil();
    if count.is_finite() {
        (count as u32).clamp(1, 200)
    } else {
        1
    }
}

impl SceneMesh {
    /// Adds a rectangle from a corner along two edges. It faces along `u × v`.
    pub fn add_plate(&mut self, corner: Vec3, u: Vec3, v: Vec3) {
        let normal = u.cross(v);
        let (columns, rows) = (
            piece_count(u.length(), self.step_mm),
            piece_count(v.length(), self.step_mm),
        );
        let first = self.vertices.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let along = u * (column as f32 / columns as f32);
                let across = v * (row as f32 / rows as f32);
                self.add_vertex(corner + along + across, normal);
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let low = first + row * (columns + 1) + column;
                let high = low + columns + 1;
                self.add_triangle([low, low + 1, high + 1]);
                self.add_triangle([low, high + 1, high]);
            }
        }
    }

    /// Adds a box between two corners, with chamfers of `chamfer`, mm, whose shading blends
    /// the faces.
    pub fn add_box(&mut self, low: Vec3, high: Vec3, chamfer: f32) {
        let (low, high) = (low.min(high), low.max(high));
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let chamfer = chamfer.clamp(0.0, half.min_element() * 0.9);
        self.within(Mat4::from_translation(centre), |mesh| {
            for axis in 0..3 {
                for side in [-1.0, 1.0] {
                    mesh.add_box_face(half, chamfer, axis, side);
                }
            }
            if chamfer > 0.0 {
                mesh.add_box_chamfers(half, chamfer);
            }
        });
    }

    fn add_box_face(&mut self, half: Vec3, chamfer: f32, axis: usize, side: f32) {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let u = Vec3::AXES[next] * (half[next] - chamfer);
        let v = Vec3::AXES[last] * (half[last] - chamfer);
        let (u, v) = if side > 0.0 { (u, v) } else { (v, u) };
        let middle = Vec3::AXES[axis] * (side * half[axis]);
        self.add_plate(middle - u - v, u * 2.0, v * 2.0);
    }

    fn add_box_chamfers(&mut self, half: Vec3, chamfer: f32) {
        let inner = half - Vec3::splat(chamfer);
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let pieces = piece_count(inner[axis] * 2.0, self.step_mm);
            for (side, other) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let (n, m) = (Vec3::AXES[next] * side, Vec3::AXES[last] * other);
                let a = n * half[next] + m * inner[last];
                let b = n * inner[next] + m * half[last];
                let along = Vec3::AXES[axis] * inner[axis];
                let first = self.vertices.len() as u32;
                for piece in 0..=pieces {
                    let shift = along * (piece as f32 / pieces as f32 * 2.0 - 1.0);
                    self.add_vertex(a + shift, n);
                    self.add_vertex(b + shift, m);
                }
                for piece in 0..pieces {
                    let at = first + 2 * piece;
                    self.add_facing_quad([at, at + 1, at + 3, at + 2], side * other > 0.0);
                }
            }
        }
        for corner in 0..8 {
            let sign = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
            let signs = vec3(sign(1), sign(2), sign(4));
            let ends: [u32; 3] = core::array::from_fn(|axis| {
                let mut at = inner;
                at[axis] = half[axis];
                self.add_vertex(at * signs, Vec3::AXES[axis] * signs)
            });
            match signs.x * signs.y * signs.z > 0.0 {
                true => self.add_triangle(ends),
                false => self.add_triangle([ends[0], ends[2], ends[1]]),
            }
        }
    }

    /// Adds a quadrangle as two triangles, in the given order or reversed.
    fn add_facing_quad(&mut self, [a, b, c, d]: [u32; 4], reversed: bool) {
        if reversed {
            self.add_triangle([a, b, c]);
            self.add_triangle([a, c, d]);
        } else {
            self.add_triangle([a, c, b]);
            self.add_triangle([a, d, c]);
        }
    }

    /// Revolves an outline of (x, radius) about the x axis in `sides` flat sides. The material
    /// is to the right of the outline: from the left face over the outside to the right face.
    pub fn add_revolve(&mut self, outline: &[(f32, f32)], sides: u32) {
        let sides = sides.max(3);
        let points: Vec<Vec2> = outline.iter().map(|&(x, r)| vec2(x, r.max(0.0))).collect();
        let normals: Vec<Vec2> = points
            .windows(2)
            .map(|ends| (ends[1] - ends[0]).perp().normalize_or(Vec2::Y))
            .collect();
        for (at, ends) in points.windows(2).enumerate() {
            if ends[0].distance(ends[1]) < SAME_POINT_MM {
                continue;
            }
            let own = normals[at];
            let blend = |other: Option<&Vec2>| match other {
                Some(&other) if own.dot(other) > SMOOTH_COSINE => own + other,
                _ => own,
            };
            let shading = [
                blend(at.checked_sub(1).map(|before| &normals[before])),
                blend(normals.get(at + 1)),
            ];
            self.add_revolved_edge([ends[0], ends[1]], shading, sides);
        }
    }

    fn add_revolved_edge(&mut self, ends: [Vec2; 2], normals: [Vec2; 2], sides: u32) {
        let first = self.vertices.len() as u32;
        for side in 0..=sides {
            let (sine, cosine) = (side as f32 / sides as f32 * TAU).sin_cos();
            let out = |at: Vec2| vec3(at.x, at.y * cosine, at.y * sine);
            for (end, normal) in ends.iter().zip(normals) {
                self.add_vertex(out(*end), out(normal));
            }
        }
        for side in 0..sides {
            let at = first + 2 * side;
            if ends[0].y > 0.0 {
                self.add_triangle([at, at + 2, at + 1]);
            }
            if ends[1].y > 0.0 {
                self.add_triangle([at + 1, at + 2, at + 3]);
            }
        }
    }

    /// Revolves an outline of (height, radius) about a vertical axis through `base`.
    pub fn add_upright(&mut self, base: Vec3, outline: &[(f32, f32)], sides: u32) {
        let frame = Mat4::from_translation(base) * Mat4::from_rotation_z(FRAC_PI_2);
        self.within(frame, |mesh| mesh.add_revolve(outline, sides));
    }

    /// Revolves an outline of (distance, radius) about an axis through `base` along z.
    pub fn add_facing(&mut self, base: Vec3, outline: &[(f32, f32)], sides: u32) {
        let frame = Mat4::from_translation(base) * Mat4::from_rotation_y(-FRAC_PI_2);
        self.within(frame, |mesh| mesh.add_revolve(outline, sides));
    }

    /// Adds a prism over a simple polygon of (x, y) in any direction, from `near` to `far`
    /// along z.
    pub fn add_prism(&mut self, polygon: &[(f32, f32)], near: f32, far: f32) {
        let (near, far) = (near.min(far), near.max(far));
        let mut points: Vec<Vec2> = polygon.iter().map(|&(x, y)| vec2(x, y)).collect();
        points.dedup_by(|a, b| a.distance(*b) < SAME_POINT_MM);
        if points.len() > 2 && points[0].distance(points[points.len() - 1]) < SAME_POINT_MM {
            points.pop();
        }
        if points.len() < 3 || points.iter().any(|at| !at.is_finite()) {
            return;
        }
        if doubled_area(&points) < 0.0 {
            points.reverse();
        }
        let pieces = piece_count(far - near, self.step_mm);
        for at in 0..points.len() {
            let (a, b) = (points[at], points[(at + 1) % points.len()]);
            let normal = (a - b).perp().extend(0.0);
            let first = self.vertices.len() as u32;
            for piece in 0..=pieces {
                let depth = near + (far - near) * piece as f32 / pieces as f32;
                self.add_vertex(a.extend(depth), normal);
                self.add_vertex(b.extend(depth), normal);
            }
            for piece in 0..pieces {
                let low = first + 2 * piece;
                self.add_facing_quad([low, low + 1, low + 3, low + 2], true);
            }
        }
        let triangles = triangulate(&points);
        for (depth, normal) in [(far, Vec3::Z), (near, Vec3::NEG_Z)] {
            let first = self.vertices.len() as u32;
            for point in &points {
                self.add_vertex(point.extend(depth), normal);
            }
            for corners in &triangles {
                let [a, b, c] = corners.map(|at| first + at as u32);
                match normal.z > 0.0 {
                    true => self.add_triangle([a, b, c]),
                    false => self.add_triangle([a, c, b]),
                }
            }
        }
    }

    /// Adds a prism over a polygon of (x, z), from `low` to `high` along y.
    pub fn add_flat_prism(&mut self, polygon: &[(f32, f32)], low: f32, high: f32) {
        self.within(Mat4::from_rotation_x(FRAC_PI_2), |mesh| {
            mesh.add_prism(polygon, -high, -low);
        });
    }

    /// Adds a prism over a polygon of (z, y), from `left` to `right` along x.
    pub fn add_side_prism(&mut self, polygon: &[(f32, f32)], left: f32, right: f32) {
        let mirrored: Vec<(f32, f32)> = polygon.iter().map(|&(z, y)| (-z, y)).collect();
        self.within(Mat4::from_rotation_y(FRAC_PI_2), |mesh| {
            mesh.add_prism(&mirrored, left, right);
        });
    }

    /// Adds a closed tube of a radius along a line of points.
    pub fn add_tube(&mut self, line: &[Vec3], radius: f32, sides: u32) {
        let sides = sides.max(3);
        let mut line = line.to_vec();
        line.dedup_by(|a, b| a.distance(*b) < SAME_POINT_MM);
        if line.len() < 2 || line.iter().any(|at| !at.is_finite()) {
            return;
        }
        let last = line.len() - 1;
        let direction = |at: usize| (line[(at + 1).min(last)] - line[at.max(1) - 1]).normalize();
        let mut across = direction(0).any_orthonormal_vector();
        let first = self.vertices.len() as u32;
        for (at, point) in line.iter().enumerate() {
            let along = direction(at);
            across = (across - along * across.dot(along))
                .try_normalize()
                .unwrap_or_else(|| along.any_orthonormal_vector());
            let other = along.cross(across);
            for side in 0..sides {
                let (sine, cosine) = (side as f32 / sides as f32 * TAU).sin_cos();
                let out = across * cosine + other * sine;
                self.add_vertex(*point + out * radius, out);
            }
        }
        for at in 0..last as u32 {
            for side in 0..sides {
                let next = (side + 1) % sides;
                let ring = first + at * sides;
                let [a, b] = [ring + side, ring + next];
                self.add_triangle([a, b, a + sides]);
                self.add_triangle([b, b + sides, a + sides]);
            }
        }
        self.add_tube_end(first, line[0], -direction(0), sides, true);
        let end = first + last as u32 * sides;
        self.add_tube_end(end, line[last], direction(last), sides, false);
    }

    fn add_tube_end(&mut self, ring: u32, middle: Vec3, normal: Vec3, sides: u32, begins: bool) {
        let frame = self.frame;
        let back = frame.inverse();
        let middle = self.add_vertex(middle, normal);
        let first = self.vertices.len() as u32;
        for side in 0..sides {
            let at = self.vertices[(ring + side) as usize].position;
            self.add_vertex(back.transform_point3(at), normal);
        }
        for side in 0..sides {
            let (a, b) = (first + side, first + (side + 1) % sides);
            match begins {
                true => self.add_triangle([middle, b, a]),
                false => self.add_triangle([middle, a, b]),
            }
        }
    }

    /// Adds a ring of a round bar: a hand wheel rim about the x axis at `x`.
    pub fn add_rim(&mut self, x: f32, radius: f32, thickness: f32, sides: u32) {
        let outline: Vec<(f32, f32)> = (0..=12)
            .map(|at| {
                let (sine, cosine) = (PI - at as f32 / 12.0 * TAU).sin_cos();
                (x + cosine * thickness, radius + sine * thickness)
            })
            .collect();
        self.add_revolve(&outline, sides);
    }
}

fn doubled_area(points: &[Vec2]) -> f32 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
}

/// Cuts a counter-clockwise polygon into triangles; returns three point indices for each.
fn triangulate(points: &[Vec2]) -> Vec<[usize; 3]> {
    let turn =
        |a: usize, b: usize, c: usize| (points[b] - points[a]).perp_dot(points[c] - points[a]);
    let mut rest: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::new();
    while rest.len() > 2 {
        let count = rest.len();
        let corners = |at: usize| {
            [
                rest[(at + count - 1) % count],
                rest[at],
                rest[(at + 1) % count],
            ]
        };
        let is_ear = |&at: &usize| {
            let [a, b, c] = corners(at);
            turn(a, b, c) > 0.0
                && !rest.iter().any(|&it| {
                    ![a, b, c].contains(&it)
                        && turn(a, b, it) >= 0.0
                        && turn(b, c, it) >= 0.0
                        && turn(c, a, it) >= 0.0
                })
        };
        // Without an ear the rest is degenerate: any corner closes it.
        let ear = (0..count).find(is_ear).unwrap_or(0);
        triangles.push(corners(ear));
        rest.remove(ear);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::checks::{assert_closed, assert_unit_normals, signed_volume};

    fn check(add: impl FnOnce(&mut SceneMesh)) -> f32 {
        let mut mesh = SceneMesh::default();
        add(&mut mesh);
        assert_closed(&mesh);
        assert_unit_normals(&mesh);
        signed_volume(&mesh)
    }

    #[test]
    fn a_box_is_closed_and_faces_outwards() {
        let sharp = check(|mesh| mesh.add_box(Vec3::ZERO, vec3(100.0, 50.0, 20.0), 0.0));
        assert!((sharp - 100_000.0).abs() < 10.0, "{sharp}");
        let soft = check(|mesh| mesh.add_box(vec3(100.0, 0.0, 0.0), vec3(0.0, 50.0, 20.0), 2.0));
        assert!(soft < sharp && soft > 0.97 * sharp, "{soft}");
    }

    #[test]
    fn a_revolved_outline_is_closed() {
        let outline = [(0.0, 0.0), (0.0, 10.0), (30.0, 10.0), (30.0, 0.0)];
        let volume = check(|mesh| mesh.add_revolve(&outline, 96));
        assert!((volume / (PI * 3000.0) - 1.0).abs() < 0.01, "{volume}");
        check(|mesh| mesh.add_rim(0.0, 40.0, 5.0, 32));
    }

    #[test]
    fn a_prism_is_closed_in_both_directions_of_its_polygon() {
        let shape = [
            (0.0, 0.0),
            (40.0, 0.0),
            (40.0, 10.0),
            (10.0, 10.0),
            (10.0, 30.0),
            (0.0, 30.0),
        ];
        let reversed: Vec<(f32, f32)> = shape.iter().rev().copied().collect();
        for polygon in [&shape[..], &reversed] {
            for volume in [
                check(|mesh| mesh.add_prism(polygon, 0.0, 10.0)),
                check(|mesh| mesh.add_flat_prism(polygon, 0.0, 10.0)),
                check(|mesh| mesh.add_side_prism(polygon, 0.0, 10.0)),
            ] {
                assert!((volume - 6000.0).abs() < 1.0, "{volume}");
            }
        }
    }

    #[test]
    fn a_tube_is_closed() {
        let bend: Vec<Vec3> = (0..12)
            .map(|at| {
                let (sine, cosine) = (at as f32 * 0.2).sin_cos();
                vec3(cosine * 50.0, sine * 50.0, at as f32)
            })
            .collect();
        let volume = check(|mesh| mesh.add_tube(&bend, 4.0, 24));
        assert!(volume > 0.9 * PI * 16.0 * 110.0, "{volume}");
    }

    #[test]
    fn degenerate_input_gives_finite_vertices() {
        let mut mesh = SceneMesh::default();
        let wrong = f32::NAN;
        mesh.add_box(Vec3::ZERO, Vec3::ZERO, 3.0);
        mesh.add_box(Vec3::splat(wrong), Vec3::ONE, wrong);
        mesh.add_revolve(&[(0.0, wrong), (wrong, 5.0), (5.0, f32::INFINITY)], 0);
        mesh.add_prism(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)], 0.0, 0.0);
        mesh.add_prism(&[(0.0, wrong), (1.0, 1.0), (2.0, 2.0)], 0.0, 1.0);
        mesh.add_tube(&[Vec3::ZERO, Vec3::ZERO], 1.0, 0);
        mesh.add_tube(&[Vec3::ZERO, Vec3::splat(wrong)], 1.0, 8);
        let finite =
            |it: &crate::mesh::SceneVertex| it.position.is_finite() && it.normal.is_finite();
        assert!(mesh.vertices.iter().all(finite));
    }
}
