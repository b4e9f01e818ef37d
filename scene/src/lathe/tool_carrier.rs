//! Tool posts of four tools and turrets of eight, with their tools.

use core::f32::consts::{FRAC_PI_4, PI, TAU};

use glam::{Mat4, Vec3, vec3};

use super::palette::{BLACK, BRIGHT_STEEL, HOLDER_STEEL, TURNED_STEEL};
use super::tools::add_tool;
use crate::description::{LatheDimensions, LatheKind, MountedTool, MountedToolForm};
use crate::mesh::{SceneMaterial, SceneMesh};
use crate::placement::{carrier_radius, mounted_tip, station_turn, tool_scale};

/// Steel of the tool post.
const POST_STEEL: SceneMaterial = SceneMaterial::steel(122, 84);

/// Adds the tool post or turret with station 0 in the working position, centred on its axis.
pub fn add_carrier(
    mesh: &mut SceneMesh,
    kind: LatheKind,
    dimensions: &LatheDimensions,
    tools: &[Option<MountedTool>],
) {
    match kind {
        LatheKind::SlantBed => add_turret(mesh, dimensions),
        LatheKind::FlatBed | LatheKind::Bench => add_post(mesh, kind, dimensions),
    }
    for station in 0..kind.station_count() {
        let Some(tool) = tools.get(station).and_then(Option::as_ref) else {
            continue;
        };
        let tip = mounted_tip(kind, dimensions, Some(tool));
        mesh.within(station_turn(kind, station), |mesh| {
            add_clamped_shank(mesh, kind, dimensions, tool);
            mesh.within(Mat4::from_translation(tip), |mesh| add_tool(mesh, tool));
        });
    }
}

/// Adds the part of the holder that is inside the tool post or turret, or the block that holds a
/// boring bar.
fn add_clamped_shank(
    mesh: &mut SceneMesh,
    kind: LatheKind,
    dimensions: &LatheDimensions,
    tool: &MountedTool,
) {
    let tip = mounted_tip(kind, dimensions, Some(tool));
    let radius = carrier_radius(kind, dimensions);
    mesh.material = HOLDER_STEEL;
    if tool.form == MountedToolForm::Shank {
        let x = tool.holder.iter().flatten().map(|it| it[0]);
        let (low, high) = x.fold((f32::MAX, f32::MIN), |(low, high), it| {
            (low.min(it), high.max(it))
        });
        if low < high && kind != LatheKind::SlantBed {
            let height = (high - low).clamp(6.0, 40.0);
            let far = radius * 0.55;
            mesh.add_box(
                vec3(tip.x + low, -height, -radius - 1.0),
                vec3(tip.x + high, -0.6, far),
                0.8,
            );
        }
    } else if kind == LatheKind::SlantBed {
        let middle = vec3(0.0, 0.0, tip.z);
        mesh.add_box(
            middle - vec3(26.0, 24.0, 20.0),
            middle + vec3(2.0, 24.0, 24.0),
            4.0,
        );
    } else {
        let middle = vec3(-radius, 0.0, tip.z);
        mesh.add_box(
            middle - vec3(16.0, 22.0, 20.0),
            middle + vec3(8.0, 18.0, 20.0),
            3.0,
        );
    }
}

fn add_post(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let (half, scale) = (carrier_radius(kind, dimensions), tool_scale(dimensions));
    let shank = (26.0 * scale).max(21.0);
    let top = 30.0 * scale;
    mesh.step_mm = 24.0;
    mesh.material = POST_STEEL;
    let inner = half - shank;
    mesh.add_box(
        vec3(-half, -shank - 22.0 * scale, -half),
        vec3(half, -shank, half),
        3.0,
    );
    mesh.add_box(vec3(-inner, -shank, -inner), vec3(inner, 2.0, inner), 0.0);
    mesh.add_box(vec3(-half, 2.0, -half), vec3(half, top, half), 3.0);
    for side in 0..4 {
        mesh.within(Mat4::from_rotation_y(side as f32 * PI / 2.0), |mesh| {
            for at in [-0.68, 0.0, 0.68] {
                let bolt = 4.8 * scale;
                let base = vec3(-half + shank * 0.45, top, at * half);
                mesh.material = HOLDER_STEEL;
                mesh.add_upright(
                    base,
                    &[
                        (0.0, bolt * 1.5),
                        (1.5, bolt * 1.5),
                        (1.5, bolt),
                        (11.0 * scale, bolt),
                        (12.0 * scale, bolt * 0.8),
                        (12.0 * scale, 0.0),
                    ],
                    12,
                );
            }
        });
    }
    mesh.material = BRIGHT_STEEL;
    let boss = 17.0 * scale;
    mesh.add_upright(
        vec3(0.0, top, 0.0),
        &[
            (0.0, boss * 1.2),
            (4.0, boss * 1.2),
            (6.0, boss),
            (20.0 * scale, boss),
            (23.0 * scale, boss * 0.7),
            (23.0 * scale, 0.0),
        ],
        40,
    );
    // The clamping lever.
    mesh.material = BRIGHT_STEEL;
    let lever: Vec<Vec3> = (0..14)
        .map(|at| {
            let t = at as f32 / 13.0;
            let reach = t * 82.0 * scale;
            vec3(
                reach * 0.80,
                top + (14.0 + t * t * 26.0) * scale,
                reach * 0.6,
            )
        })
        .collect();
    mesh.add_tube(&lever, 4.2 * scale, 14);
    mesh.material = BLACK;
    if let Some(end) = lever.last() {
        let ball: Vec<(f32, f32)> = (0..=12)
            .map(|at| {
                let (sine, cosine) = (PI - at as f32 / 12.0 * PI).sin_cos();
                (cosine * 10.0 * scale, sine.max(0.0) * 10.0 * scale)
            })
            .collect();
        mesh.add_upright(*end, &ball, 20);
    }
}

fn add_turret(mesh: &mut SceneMesh, dimensions: &LatheDimensions) {
    let radius = carrier_radius(LatheKind::SlantBed, dimensions);
    let thickness = 58.0 * tool_scale(dimensions);
    let corners = |radius: f32| -> Vec<(f32, f32)> {
        let turned = |at: usize| {
            let angle = (at as f32 + 0.5) * FRAC_PI_4;
            let corner = radius / (FRAC_PI_4 * 0.5).cos();
            (corner * angle.cos(), corner * angle.sin())
        };
        (0..8).map(turned).collect()
    };
    mesh.step_mm = 24.0;
    mesh.material = POST_STEEL;
    mesh.add_side_prism(&corners(radius), 0.0, thickness);
    mesh.add_side_prism(&corners(radius - 5.0), -3.0, 0.0);
    mesh.material = TURNED_STEEL;
    let (hub, ring) = (radius * 0.36, radius * 0.50);
    mesh.add_revolve(
        &[
            (-14.0, 0.0),
            (-14.0, hub - 3.0),
            (-11.0, hub),
            (-7.0, hub),
            (-7.0, ring),
            (-3.0, ring),
        ],
        56,
    );
    for station in 0..8 {
        let turn = Mat4::from_rotation_x(station as f32 * TAU / 8.0);
        mesh.within(turn, |mesh| {
            // Clamping wedges of the shanks on the rim, and a bore in the face.
            mesh.material = HOLDER_STEEL;
            mesh.add_box(
                vec3(thickness - 26.0, -13.0, -radius - 5.0),
                vec3(thickness - 6.0, 13.0, -radius + 1.0),
                2.0,
            );
            mesh.material = BLACK;
            let bore = radius * 0.085;
            mesh.within(
                Mat4::from_translation(vec3(-3.0, 0.0, -radius * 0.72)),
                |mesh| {
                    mesh.add_revolve(
                        &[(-1.0, 0.0), (-1.0, bore * 0.75), (-1.6, bore), (0.5, bore)],
                        20,
                    );
                },
            );
        });
    }
}
