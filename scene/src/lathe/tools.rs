//! Tools, from the polygons of their inserts and holders.

use glam::{Mat4, vec3};

use super::palette::{BRIGHT_STEEL, CARBIDE, DRILL_STEEL, HOLDER_STEEL};
use crate::description::{MountedTool, MountedToolForm};
use crate::mesh::SceneMesh;

/// Thickness of an insert, mm.
const INSERT_THICKNESS_MM: f32 = 4.8;

/// Adds a tool in the tilted frame of the tools: its tip at the origin, its rake face up.
pub fn add_tool(mesh: &mut SceneMesh, tool: &MountedTool) {
    mesh.step_mm = 25.0;
    match tool.form {
        MountedToolForm::Shank => add_holder(mesh, tool),
        MountedToolForm::Bar => add_bar(mesh, tool),
        MountedToolForm::Drill {
            diameter,
            point,
            reach,
        } => {
            add_drill(mesh, diameter, point, reach);
            return;
        }
    }
    mesh.material = CARBIDE;
    for polygon in &tool.insert {
        mesh.add_flat_prism(&points(polygon), -INSERT_THICKNESS_MM, 0.0);
    }
    if let Some((x, out)) = middle(&tool.insert) {
        mesh.material = HOLDER_STEEL;
        mesh.add_upright(
            vec3(x, -0.4, out),
            &[(0.0, 2.2), (0.9, 1.6), (0.9, 0.0)],
            12,
        );
    }
}

fn points(polygon: &[[f32; 2]]) -> Vec<(f32, f32)> {
    polygon.iter().map(|&[x, out]| (x, out)).collect()
}

/// Returns the middle of the bounding box of polygons; `None` if there are none.
fn middle(polygons: &[Vec<[f32; 2]>]) -> Option<(f32, f32)> {
    let all: Vec<[f32; 2]> = polygons.iter().flatten().copied().collect();
    let count = all.len() as f32;
    let sum = all
        .iter()
        .fold((0.0, 0.0), |sum, it| (sum.0 + it[0], sum.1 + it[1]));
    (count > 0.0).then(|| (sum.0 / count, sum.1 / count))
}

/// Returns the least and greatest coordinates of a polygon: along the axis, and away from it.
fn extent(polygon: &[[f32; 2]]) -> [(f32, f32); 2] {
    [0, 1].map(|axis| {
        let values = polygon.iter().map(|it| it[axis]);
        values.fold((f32::MAX, f32::MIN), |(low, high), it| {
            (low.min(it), high.max(it))
        })
    })
}

fn add_holder(mesh: &mut SceneMesh, tool: &MountedTool) {
    mesh.material = HOLDER_STEEL;
    for polygon in &tool.holder {
        let [(left, right), _] = extent(polygon);
        let height = (right - left).clamp(6.0, 40.0);
        // The top of the shank is level with the edge.
        mesh.add_flat_prism(&points(polygon), -height, -0.6);
    }
}

fn add_bar(mesh: &mut SceneMesh, tool: &MountedTool) {
    mesh.material = BRIGHT_STEEL;
    for polygon in &tool.holder {
        let [(left, right), (near, far)] = extent(polygon);
        let radius = (far - near) * 0.5;
        let frame = Mat4::from_translation(vec3(0.0, 0.0, (near + far) * 0.5));
        mesh.within(frame, |mesh| {
            let outline = [
                (left, 0.0),
                (left, radius * 0.85),
                (left + radius * 0.15, radius),
                (right + 12.0, radius),
                (right + 12.0, 0.0),
            ];
            mesh.add_revolve(&outline, 32);
        });
    }
}

fn add_drill(mesh: &mut SceneMesh, diameter: f32, point: f32, reach: f32) {
    let radius = (diameter * 0.5).clamp(0.2, 100.0);
    let reach = reach.clamp(5.0, 400.0);
    let half = (point.clamp(60.0, 179.0) * 0.5).to_radians();
    let cone = radius / half.tan();
    mesh.material = DRILL_STEEL;
    let mut outline = vec![(0.0, 0.0), (cone, radius)];
    // Grooves stand for the flutes.
    let mut x = cone + radius * 0.9;
    while x + radius < reach - 4.0 {
        outline.extend([
            (x, radius),
            (x + radius * 0.15, radius * 0.82),
            (x + radius * 0.45, radius * 0.82),
            (x + radius * 0.6, radius),
        ]);
        x += radius * 1.7;
    }
    outline.extend([(reach, radius), (reach, 0.0)]);
    mesh.add_revolve(&outline, 24);
    mesh.material = HOLDER_STEEL;
    let sleeve = (radius * 1.7).max(9.0);
    let outline = [
        (reach - 2.0, 0.0),
        (reach - 2.0, sleeve - 2.0),
        (reach, sleeve),
        (reach + 26.0, sleeve),
        (reach + 26.0, 0.0),
    ];
    mesh.add_revolve(&outline, 32);
}
