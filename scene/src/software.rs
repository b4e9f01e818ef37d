//! Draws a description of a lathe without OpenGL: the same meshes, camera and light, computed
//! by the processor.

mod lines;
mod part;
mod shading;
mod visibility;

use core::f32::consts::TAU;

use glam::{Mat4, Vec3, Vec4, vec4};

use crate::camera::OrbitCamera;
use crate::chip_mesh::build_mesh;
use crate::description::LatheDescription;
use crate::frame::{COOLANT_ALPHA, FrameInputs, HAZE_ALPHA, LayerInputs, PANE_ALPHA, STILL_GROUPS};
use crate::lathe::{MeshDesign, MeshGroup};
use crate::mesh::SceneMesh;
use crate::mesh::occlusion::OcclusionBake;
use crate::part::outline::PartOutline;
use crate::part_details::build_details;
use crate::section_cut::kept_sweep;
use lines::draw_lines;
use shading::{ShadowMap, ground, shade};
use visibility::{SurfaceCorner, VisibilityBuffer};

/// Greatest width and height of a picture, pixels.
const MAX_SIDE: usize = 8192;
/// Triangles of depth pictures that one picture may draw for ambient occlusion.
const TRIANGLES_PER_PICTURE: usize = 130_000;
/// Number of pictures after which the shadows are computed again.
const SHADOW_PICTURES: u32 = 3;

/// The quality of a picture that the processor draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftwareQuality {
    /// Fast, for a window: one sample per pixel, shadows of earlier pictures, ambient occlusion
    /// after some pictures.
    Quick,
    /// Complete, for a file: four samples per pixel, new shadows and ambient occlusion.
    Thorough,
}

impl SoftwareQuality {
    /// Returns the number of samples along one side of a pixel.
    const fn samples(self) -> usize {
        match self {
            Self::Quick => 1,
            Self::Thorough => 2,
        }
    }

    /// Returns the number of flat sides with which the part is revolved.
    const fn part_sides(self) -> u32 {
        match self {
            Self::Quick => 48,
            Self::Thorough => 192,
        }
    }
}

/// A finished picture of a lathe.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SoftwarePicture {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Red, green, blue and 255 of each pixel, row by row from above.
    pub pixels: Vec<u8>,
    /// Whether the next picture of the same description will be better.
    pub is_refining: bool,
}

/// Returns the triangles of the revolved part, three corners each, mm.
pub fn part_triangles(part: &PartOutline, sides: u32) -> Vec<[[f32; 3]; 3]> {
    let triangles = part::triangles(part, sides, [0.0, TAU], Mat4::IDENTITY);
    let corners = triangles.map(|it| it.map(|corner| corner.position.to_array()));
    corners.collect()
}

/// A mesh group; `bake` is the computation of its ambient occlusion until it is complete.
#[derive(Debug)]
struct SoftwareGroup {
    group: MeshGroup,
    mesh: SceneMesh,
    bake: Option<OcclusionBake>,
}

/// The finished picture of the stationary parts.
#[derive(Debug)]
struct StillLayer {
    inputs: LayerInputs,
    size: [usize; 2],
    depths: Vec<f32>,
    colors: Vec<Vec3>,
}

/// Draws lathes with the processor, without OpenGL.
#[derive(Debug, Default)]
pub struct SoftwareRenderer {
    design: Option<MeshDesign>,
    groups: Vec<SoftwareGroup>,
    layer: Option<StillLayer>,
    shadow: Option<ShadowMap>,
    picture: u32,
}

impl SoftwareRenderer {
    /// Draws a lathe in a picture of `size` pixels.
    pub fn draw(
        &mut self,
        lathe: &LatheDescription,
        camera: &OrbitCamera,
        size: [usize; 2],
        quality: SoftwareQuality,
    ) -> SoftwarePicture {
        let size = size.map(|it| it.clamp(1, MAX_SIDE));
        let samples = quality.samples();
        let fine = size.map(|it| it * samples);
        self.update_meshes(lathe, quality);
        let scene = FrameInputs::new(lathe, camera, fine.map(|it| it as i32));
        if self.shadow.is_none()
            || quality == SoftwareQuality::Thorough
            || self.picture.is_multiple_of(SHADOW_PICTURES)
        {
            self.shadow = Some(self.make_shadow(lathe, &scene, quality));
        }
        self.picture = self.picture.wrapping_add(1);
        let colors = self.draw_colors(lathe, &scene, fine, quality);
        SoftwarePicture {
            size,
            pixels: average(&colors, size, samples),
            is_refining: self.groups.iter().any(|it| it.bake.is_some()),
        }
    }

    fn update_meshes(&mut self, lathe: &LatheDescription, quality: SoftwareQuality) {
        let is_same = self.design.as_ref();
        if !is_same.is_some_and(|design| design.is_design_of(lathe)) {
            let design = MeshDesign::new(lathe);
            let groups = MeshGroup::ALL.into_iter().map(|group| {
                let mesh = design.build(group);
                let needs_bake = !group.is_transparent() && group != MeshGroup::Floor;
                let bake = needs_bake.then(|| OcclusionBake::new(&mesh));
                SoftwareGroup { group, mesh, bake }
            });
            self.groups = groups.collect();
            self.groups.sort_by_key(|it| it.mesh.triangle_count());
            self.design = Some(design);
            self.layer = None;
            self.shadow = None;
        }
        let mut budget = match quality {
            SoftwareQuality::Quick => TRIANGLES_PER_PICTURE,
            SoftwareQuality::Thorough => usize::MAX,
        };
        for SoftwareGroup { mesh, bake, .. } in &mut self.groups {
            while let Some(running) = bake {
                if budget == 0 {
                    return;
                }
                budget = budget.saturating_sub(mesh.triangle_count());
                if running.add_direction(mesh) {
                    running.apply(mesh);
                    *bake = None;
                    self.layer = None;
                }
            }
        }
    }

    fn make_shadow(
        &self,
        lathe: &LatheDescription,
        scene: &FrameInputs,
        quality: SoftwareQuality,
    ) -> ShadowMap {
        let projection = scene.light_projection;
        let mut buffer = VisibilityBuffer::new(ShadowMap::SIZE);
        for it in &self.groups {
            if !it.group.is_transparent() && it.group != MeshGroup::Floor {
                for triangle in group_triangles(it, scene) {
                    buffer.add(&projection, triangle, false);
                }
            }
        }
        for triangle in part_surfaces(lathe, scene, quality) {
            buffer.add(&projection, triangle, false);
        }
        ShadowMap::new(buffer.depths(), projection)
    }

    fn draw_colors(
        &mut self,
        lathe: &LatheDescription,
        scene: &FrameInputs,
        size: [usize; 2],
        quality: SoftwareQuality,
    ) -> Vec<Vec3> {
        let (mut buffer, mut colors) = self.draw_still(scene, size);
        let moving =
            |it: &&SoftwareGroup| !it.group.is_transparent() && !STILL_GROUPS.contains(&it.group);
        for it in self.groups.iter().filter(moving) {
            for triangle in group_triangles(it, scene) {
                buffer.add(&scene.projection, triangle, true);
            }
        }
        let chips = build_mesh(&lathe.effects.chips);
        let chips = mesh_triangles(&chips, Mat4::IDENTITY);
        for triangle in part_surfaces(lathe, scene, quality)
            .into_iter()
            .chain(chips)
        {
            buffer.add(&scene.projection, triangle, false);
        }
        let shadow = self.shadow.as_ref();
        shade_buffer(&buffer, scene, shadow, size, &mut colors);
        draw_lines(lathe, scene, &buffer, size, &mut colors);
        let mut blend = |triangle, alpha| {
            buffer.visit_nearer(&scene.projection, triangle, |at, surface| {
                let height = pixel_height(at, size);
                let over = shade(&surface, scene, shadow, height, alpha);
                colors[at] = over.truncate() + colors[at] * (1.0 - over.w);
            });
        };
        for it in &self.groups {
            match it.group {
                MeshGroup::Coolant | MeshGroup::Pane => {
                    let alpha = match it.group {
                        MeshGroup::Coolant => COOLANT_ALPHA,
                        _ => PANE_ALPHA,
                    };
                    group_triangles(it, scene).for_each(|it| blend(it, alpha));
                }
                MeshGroup::Jaw => {
                    for model in scene.hazy_jaws() {
                        mesh_triangles(&it.mesh, model).for_each(|it| blend(it, HAZE_ALPHA));
                    }
                }
                _ => {}
            }
        }
        colors
    }

    /// Draws the stationary parts, unless their picture is current.
    fn draw_still(
        &mut self,
        scene: &FrameInputs,
        size: [usize; 2],
    ) -> (VisibilityBuffer, Vec<Vec3>) {
        let inputs = scene.layer();
        let mut buffer = VisibilityBuffer::new(size);
        let layer = self.layer.take();
        let layer = layer.filter(|it| it.inputs == inputs && it.size == size);
        let layer = match layer {
            Some(layer) => layer,
            None => {
                let mut still = VisibilityBuffer::new(size);
                for it in &self.groups {
                    if STILL_GROUPS.contains(&it.group) {
                        for triangle in group_triangles(it, scene) {
                            still.add(&scene.projection, triangle, true);
                        }
                    }
                }
                let rows = (0..size[0] * size[1]).map(|at| ground(scene, pixel_height(at, size)));
                let mut colors: Vec<Vec3> = rows.collect();
                shade_buffer(&still, scene, self.shadow.as_ref(), size, &mut colors);
                StillLayer {
                    inputs,
                    size,
                    depths: still.depths().to_vec(),
                    colors,
                }
            }
        };
        buffer.set_depths(&layer.depths);
        let colors = layer.colors.clone();
        self.layer = Some(layer);
        (buffer, colors)
    }
}

/// Returns the height of a pixel in the picture, 0 (below) to 1.
fn pixel_height(at: usize, [columns, rows]: [usize; 2]) -> f32 {
    1.0 - ((at / columns) as f32 + 0.5) / rows as f32
}

fn shade_buffer(
    buffer: &VisibilityBuffer,
    scene: &FrameInputs,
    shadow: Option<&ShadowMap>,
    size: [usize; 2],
    colors: &mut [Vec3],
) {
    for (at, color) in colors.iter_mut().enumerate() {
        if let Some(surface) = buffer.surface(at) {
            *color = shade(&surface, scene, shadow, pixel_height(at, size), 1.0).truncate();
        }
    }
}

/// Returns the triangles of a mesh group, for each copy that is drawn.
fn group_triangles<'a>(
    it: &'a SoftwareGroup,
    scene: &FrameInputs,
) -> impl Iterator<Item = [SurfaceCorner; 3]> + 'a {
    let models = scene.models(it.group);
    models
        .into_iter()
        .flat_map(|model| mesh_triangles(&it.mesh, model))
}

/// Returns the triangles of a mesh, moved by a model matrix.
fn mesh_triangles(mesh: &SceneMesh, model: Mat4) -> impl Iterator<Item = [SurfaceCorner; 3]> + '_ {
    let corners = move_corners(mesh, model);
    mesh.indices.chunks_exact(3).filter_map(move |three| {
        let corner = |at: usize| corners.get(three[at] as usize).copied();
        Some([corner(0)?, corner(1)?, corner(2)?])
    })
}

/// Returns the triangles of the part: revolved surfaces, threads and cut faces.
fn part_surfaces(
    lathe: &LatheDescription,
    scene: &FrameInputs,
    quality: SoftwareQuality,
) -> Vec<[SurfaceCorner; 3]> {
    let (part, cut) = (&lathe.part, lathe.overlay.section_cut);
    let sweep = kept_sweep(lathe.kind, cut);
    let details = build_details(part, lathe.kind, cut);
    let details = mesh_triangles(&details, scene.part_model);
    let revolved = part::triangles(part, quality.part_sides(), sweep, scene.part_model);
    revolved.chain(details).collect()
}

fn move_corners(mesh: &SceneMesh, model: Mat4) -> Vec<SurfaceCorner> {
    let share = |byte: u8| f32::from(byte) / 255.0;
    let corners = mesh.vertices.iter().map(|vertex| {
        let it = &vertex.material;
        let [red, green, blue] = it.color.map(share);
        SurfaceCorner {
            position: model.transform_point3(vertex.position),
            normal: model.transform_vector3(vertex.normal),
            color: vec4(red, green, blue, share(vertex.exposure)),
            finish: Vec4::from_array([it.roughness, it.metal, it.rings, it.glow].map(share)),
        }
    });
    corners.collect()
}

/// Averages the samples of each pixel; returns red, green, blue and alpha bytes.
fn average(colors: &[Vec3], [columns, rows]: [usize; 2], samples: usize) -> Vec<u8> {
    let mut pixels = Vec::with_capacity(columns * rows * 4);
    let weight = 1.0 / (samples * samples) as f32;
    for row in 0..rows {
        for column in 0..columns {
            let mut sum = Vec3::ZERO;
            for line in 0..samples {
                let first = ((row * samples + line) * columns + column) * samples;
                sum += colors.iter().skip(first).take(samples).sum::<Vec3>();
            }
            let bytes = (sum * weight).to_array().map(|it| (it * 255.0 + 0.5) as u8);
            pixels.extend(bytes);
            pixels.push(255);
        }
    }
    pixels
}

#[cfg(test)]
mod silhouette_tests;
#[cfg(test)]
mod tests;
