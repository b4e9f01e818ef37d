//! Cuts a sector out of the part: the angles that remain, and the hatched cut faces.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use glam::{Vec2, vec2, vec3};

use crate::description::{LatheKind, SectionCut};
use crate::mesh::{SceneMaterial, SceneMesh};

/// Colour of cut faces between the hatch lines.
const FACE: SceneMaterial = SceneMaterial::paint(226, 208, 166);
/// Colour of the hatch lines.
const HATCH: SceneMaterial = SceneMaterial::paint(146, 96, 60);
/// Width of a hatch line as a fraction of the distance between two lines.
const LINE_SHARE: f32 = 0.24;
/// Least width of a trapezoid of a cut face, mm; narrower ones are left out.
const MIN_WIDTH_MM: f32 = 1e-4;

/// Returns the angle of the tool about the spindle axis, from y to z, radians.
pub const fn tool_angle(kind: LatheKind) -> f32 {
    match kind {
        LatheKind::FlatBed | LatheKind::Bench => FRAC_PI_2,
        LatheKind::SlantBed => -FRAC_PI_4,
    }
}

/// Returns the angles of the part that are drawn: start and extent, radians, from the plane of the
/// tool. A half is cut along the plane of the tool, on the operator's side.
pub fn kept_sweep(kind: LatheKind, cut: SectionCut) -> [f32; 2] {
    let is_rear = kind == LatheKind::SlantBed;
    match (cut, is_rear) {
        (SectionCut::Whole, _) => [0.0, TAU],
        (SectionCut::Quarter, false) => [0.0, TAU * 0.75],
        (SectionCut::Quarter, true) => [PI * 0.75, TAU * 0.75],
        (SectionCut::Half, false) => [0.0, PI],
        (SectionCut::Half, true) => [PI, PI],
    }
}

/// Splits the area within edges of (x, radius) into trapezoids with sides at constant x, each
/// counter-clockwise. Edges on the axis may be missing.
pub fn trapezoids(edges: &[[Vec2; 2]]) -> Vec<[Vec2; 4]> {
    let mut stops: Vec<f32> = edges.iter().flatten().map(|it| it.x).collect();
    stops.sort_by(f32::total_cmp);
    stops.dedup_by(|a, b| (*a - *b).abs() < MIN_WIDTH_MM);
    let mut found = Vec::new();
    for pair in stops.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let middle = (from + to) * 0.5;
        let mut sides: Vec<[f32; 2]> = edges
            .iter()
            .filter(|[a, b]| (a.x > middle) != (b.x > middle))
            .map(|[a, b]| [from, to].map(|x| a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x)))
            .collect();
        if sides.len() % 2 == 1 {
            sides.push([0.0, 0.0]);
        }
        sides.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
        for area in sides.chunks_exact(2) {
            let (inner, outer) = (area[0], area[1]);
            found.push([
                vec2(from, inner[0].max(0.0)),
                vec2(to, inner[1].max(0.0)),
                vec2(to, outer[1].max(0.0)),
                vec2(from, outer[0].max(0.0)),
            ]);
        }
    }
    found
}

/// Returns the area of a convex polygon with `x + radius` at or above (`side` 1) or at or below
/// (`side` -1) a limit.
fn clip(polygon: &[Vec2], limit: f32, side: f32) -> Vec<Vec2> {
    let distance = |it: Vec2| (it.x + it.y - limit) * side;
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (at_a, at_b) = (distance(*a), distance(*b));
        if at_a >= 0.0 {
            kept.push(*a);
        }
        if (at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0) {
            kept.push(a.lerp(*b, at_a / (at_a - at_b)));
        }
    }
    kept
}

/// Adds the hatched area within edges to the mesh, in the plane at an angle about the axis. `side`
/// 1: it faces growing angles. `spacing`: distance between two hatch lines along the axis, mm.
pub fn add_face(mesh: &mut SceneMesh, edges: &[[Vec2; 2]], angle: f32, side: f32, spacing: f32) {
    let (sine, cosine) = angle.sin_cos();
    let normal = vec3(0.0, -sine, cosine) * side;
    let add = |mesh: &mut SceneMesh, polygon: &[Vec2]| {
        if polygon.len() < 3 {
            return;
        }
        let points = polygon
            .iter()
            .map(|it| vec3(it.x, it.y * cosine, it.y * sine));
        let corners: Vec<u32> = points.map(|it| mesh.add_vertex(it, normal)).collect();
        for at in 1..corners.len() - 1 {
            mesh.add_triangle([corners[0], corners[at], corners[at + 1]]);
        }
    };
    for trapezoid in trapezoids(edges) {
        let along = trapezoid.map(|it| it.x + it.y);
        let low = along.iter().copied().fold(f32::MAX, f32::min);
        let high = along.iter().copied().fold(f32::MIN, f32::max);
        let (first, last) = ((low / spacing).floor(), (high / spacing).ceil());
        for line in first as i64..last as i64 {
            let from = line as f32 * spacing;
            let hatch = from + spacing * LINE_SHARE;
            for (material, from, to) in [(HATCH, from, hatch), (FACE, hatch, from + spacing)] {
                mesh.material = material;
                add(mesh, &clip(&clip(&trapezoid, from, 1.0), to, -1.0));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the area of a mesh, mm², and the fraction of it that is hatch.
    fn areas(mesh: &SceneMesh) -> (f32, f32) {
        let corner = |at: u32| mesh.vertices[at as usize].position;
        let (mut all, mut hatched) = (0.0, 0.0);
        for it in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [corner(it[0]), corner(it[1]), corner(it[2])];
            let area = (b - a).cross(c - a).length() * 0.5;
            all += area;
            if mesh.vertices[it[0] as usize].material == HATCH {
                hatched += area;
            }
        }
        (all, hatched / all)
    }

    #[test]
    fn a_cut_face_covers_the_half_section_with_its_bore() {
        // A tube of 60 mm with a bore of 10 mm over half its length, without its axis.
        let points = [
            (0.0, 0.0),
            (0.0, 30.0),
            (80.0, 20.0),
            (80.0, 5.0),
            (40.0, 5.0),
            (40.0, 0.0),
        ];
        let points = points.map(|(x, r)| vec2(x, r));
        let edges: Vec<[Vec2; 2]> = points.windows(2).map(|it| [it[0], it[1]]).collect();
        for (angle, side) in [(0.0, 1.0), (2.1, -1.0)] {
            let mut mesh = SceneMesh::default();
            add_face(&mut mesh, &edges, angle, side, 4.0);
            let (area, hatched) = areas(&mesh);
            assert!((area - (80.0 * 25.0 - 40.0 * 5.0)).abs() < 0.5, "{area}");
            assert!((hatched - LINE_SHARE).abs() < 0.02, "{hatched}");
            crate::mesh::checks::assert_unit_normals(&mesh);
        }
    }

    #[test]
    fn the_faces_of_a_cut_look_out_of_the_material() {
        for kind in [LatheKind::FlatBed, LatheKind::SlantBed] {
            for (cut, share) in [(SectionCut::Quarter, 0.75), (SectionCut::Half, 0.5)] {
                let [start, extent] = kept_sweep(kind, cut);
                assert!((extent / TAU - share).abs() < 1e-6);
                // The removed sector is on the side of the operator or above.
                let middle = start + extent + (TAU - extent) * 0.5 + tool_angle(kind);
                assert!(
                    middle.cos() > -1e-6 && middle.sin() > -1e-6,
                    "{kind:?} {cut:?}"
                );
            }
        }
    }

    #[test]
    fn an_empty_part_has_no_face() {
        let mut mesh = SceneMesh::default();
        add_face(&mut mesh, &[], 0.0, 1.0, 4.0);
        assert_eq!(mesh.triangle_count(), 0);
        assert!(trapezoids(&[[vec2(1.0, 0.0), vec2(1.0, 5.0)]]).is_empty());
    }
}
