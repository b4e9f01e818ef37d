//! The chips as one mesh.

use core::f32::consts::TAU;

use glam::{Mat4, Vec3, vec3};

use crate::chips::ChipState;
use crate::mesh::{SceneMaterial, SceneMesh};
use crate::part::material::ChipShape;

/// Number of sides of the drawn wire that forms a chip.
const WIRE_SIDES: u32 = 4;

/// Builds the mesh of one chip at the origin.
fn build_chip(shape: ChipShape) -> SceneMesh {
    let mut mesh = SceneMesh::default();
    let line = |count: u32, point: &dyn Fn(f32) -> Vec3| -> Vec<Vec3> {
        (0..count)
            .map(|at| point(at as f32 / (count - 1) as f32 - 0.5))
            .collect()
    };
    let (points, radius) = match shape {
        ChipShape::Needle => (line(3, &|t| vec3(t * 9.0, t * t * 8.0, 0.0)), 1.0),
        ChipShape::Curl => {
            let coil = |t: f32| {
                let angle = t * TAU * 2.5;
                vec3(t * 15.0, angle.sin() * 3.4, angle.cos() * 3.4)
            };
            (line(18, &coil), 0.85)
        }
        ChipShape::Ribbon => {
            let wave = |t: f32| {
                let angle = t * TAU * 1.6;
                vec3(t * 44.0, angle.sin() * 6.0, (angle * 1.7).cos() * 4.0)
            };
            (line(18, &wave), 0.75)
        }
        ChipShape::Spark => (line(2, &|t| vec3(t * 5.0, 0.0, 0.0)), 0.5),
    };
    mesh.add_tube(&points, radius, WIRE_SIDES);
    mesh
}

/// Builds one mesh of all chips.
pub fn build_mesh(chips: &[ChipState]) -> SceneMesh {
    let mut mesh = SceneMesh::default();
    let shapes = [
        ChipShape::Needle,
        ChipShape::Curl,
        ChipShape::Ribbon,
        ChipShape::Spark,
    ];
    for shape in shapes {
        let mut base = build_chip(shape);
        for chip in chips.iter().filter(|it| it.shape == shape) {
            let material = SceneMaterial {
                color: chip.color,
                roughness: 80,
                metal: if shape == ChipShape::Spark { 0 } else { 210 },
                rings: 0,
                glow: if shape == ChipShape::Spark { 255 } else { 20 },
            };
            for vertex in &mut base.vertices {
                vertex.material = material;
            }
            let frame = Mat4::from_rotation_translation(chip.turn, chip.position);
            mesh.append(&base, frame);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chips::{ChipFlow, ChipSource, MAX_CHIPS};
    use crate::part::material::PartMaterial;

    #[test]
    fn the_mesh_of_all_chips_is_bounded() {
        let mut flow = ChipFlow::default();
        for _ in 0..400 {
            let cut = ChipSource {
                at: Vec3::ZERO,
                away: Vec3::Z,
                feed: 0.2,
                speed: 100.0,
                material: PartMaterial::Steel,
                tray_y: -100.0,
            };
            flow.advance(0.05, Some(&cut));
        }
        let mesh = build_mesh(&flow.states());
        assert!(mesh.triangle_count() >= MAX_CHIPS * 8);
        assert!(
            mesh.triangle_count() < MAX_CHIPS * 180,
            "{}",
            mesh.triangle_count()
        );
        crate::mesh::checks::assert_unit_normals(&mesh);
    }
}
