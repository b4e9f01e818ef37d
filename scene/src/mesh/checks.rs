//! What the tests of meshes measure.

use std::collections::BTreeMap;

use crate::mesh::SceneMesh;

/// Panics unless each edge of a triangle is shared with another triangle that has it in the
/// opposite direction.
pub fn assert_closed(mesh: &SceneMesh) {
    let weld = |at: u32| {
        let position = mesh.vertices[at as usize].position;
        position.to_array().map(|it| (it * 100.0).round() as i32)
    };
    let mut balance: BTreeMap<([i32; 3], [i32; 3]), i32> = BTreeMap::new();
    for corners in mesh.indices.chunks_exact(3) {
        let points = [weld(corners[0]), weld(corners[1]), weld(corners[2])];
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (points[from], points[to]);
            if a < b {
                *balance.entry((a, b)).or_default() += 1;
            } else if b < a {
                *balance.entry((b, a)).or_default() -= 1;
            }
        }
    }
    let open: Vec<_> = balance.iter().filter(|(_, it)| **it != 0).collect();
    assert!(open.is_empty(), "{} open edges: {:?}", open.len(), open[0]);
    assert!(!balance.is_empty(), "an empty mesh");
}

/// Panics unless all normals of the mesh have length 1.
pub fn assert_unit_normals(mesh: &SceneMesh) {
    for vertex in &mesh.vertices {
        let length = vertex.normal.length();
        assert!((length - 1.0).abs() < 1e-3, "{vertex:?}");
    }
}

/// Returns the volume inside a closed mesh, mm³; positive if its triangles face outwards.
pub fn signed_volume(mesh: &SceneMesh) -> f32 {
    let corner = |at: u32| mesh.vertices[at as usize].position;
    let tetrahedra = mesh.indices.chunks_exact(3).map(|it| {
        let (a, b, c) = (corner(it[0]), corner(it[1]), corner(it[2]));
        a.dot(b.cross(c)) / 6.0
    });
    tetrahedra.sum()
}
