//! Draws a description of a lathe without OpenGL: the same meshes, camera and light, computed
//! by the processor.

mod part;
mod shading;
mod visibility;

use glam::{Mat4, Vec3, Vec4, vec4};

use crate::camera::OrbitCamera;
use crate::description::LatheDescription;
use crate::frame::{FrameInputs, LayerInputs};
use crate::lathe::{MeshDesign, MeshGroup};
use crate::mesh::SceneMesh;
use crate::objects::{COOLANT_ALPHA, PANE_ALPHA, STILL_GROUPS};
use crate::occlusion::OcclusionBake;
use shading::{ShadowMap, ground, shade};
use visibility::{SurfaceCorner, VisibilityBuffer};

/// Greatest width and height of a picture, pixels.
const MAX_SIDE: usize = 8192;
/// Triangles of depth pictures that one picture may draw for ambient occlusion.
const TRIANGLES_PER_PICTURE: usize = 130_000;
/// Pictures after which the shadows are computed again.
const SHADOW_PICTURES: u32 = 3;

/// How much work a picture may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoftwareQuality {
    /// For a window: one sample for each pixel, old shadows, ambient occlusion after a while.
    Quick,
    /// For a file: four samples for each pixel, everything complete.
    Thorough,
}

impl SoftwareQuality {
    /// Samples along a side of a pixel.
    const fn samples(self) -> usize {
        match self {
            Self::Quick => 1,
            Self::Thorough => 2,
        }
    }

    /// Flat sides of the revolved part.
    const fn part_sides(self) -> u32 {
        match self {
            Self::Quick => 48,
            Self::Thorough => 192,
        }
    }
}

/// A picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SoftwarePicture {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Red, green, blue and 255 of each pixel, row by row from above.
    pub pixels: Vec<u8>,
    /// Whether the next picture will be better without any change of the description.
    pub is_refining: bool,
}

/// A group of triangles; `bake`: its ambient occlusion until it is complete.
#[derive(Debug)]
struct SoftwareGroup {
    group: MeshGroup,
    mesh: SceneMesh,
    bake: Option<OcclusionBake>,
}

/// The layer of what stands still.
#[derive(Debug)]
struct StillLayer {
    inputs: LayerInputs,
    size: [usize; 2],
    depths: Vec<f32>,
    colors: Vec<Vec3>,
}

/// Draws lathes with the processor.
#[derive(Debug, Default)]
pub struct SoftwareRenderer {
    design: Option<MeshDesign>,
    groups: Vec<SoftwareGroup>,
    layer: Option<StillLayer>,
    shadow: Option<ShadowMap>,
    picture: u32,
}

impl SoftwareRenderer {
    /// Draws a lathe in a size, pixels.
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
        let sides = quality.part_sides();
        for triangle in part::triangles(&lathe.part, sides, scene.placement.spindle) {
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
        let sides = quality.part_sides();
        for triangle in part::triangles(&lathe.part, sides, scene.placement.spindle) {
            buffer.add(&scene.projection, triangle, false);
        }
        let shadow = self.shadow.as_ref();
        shade_buffer(&buffer, scene, shadow, size, &mut colors);
        for (group, alpha) in [
            (MeshGroup::Coolant, COOLANT_ALPHA),
            (MeshGroup::Pane, PANE_ALPHA),
        ] {
            for it in self.groups.iter().filter(|it| it.group == group) {
                for triangle in group_triangles(it, scene) {
                    buffer.visit_nearer(&scene.projection, triangle, |at, surface| {
                        let height = pixel_height(at, size);
                        let over = shade(&surface, scene, shadow, height, alpha);
                        colors[at] = over.truncate() + colors[at] * (1.0 - over.w);
                    });
                }
            }
        }
        colors
    }

    /// Draws what stands still, unless it is drawn already.
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

/// Height of a pixel in the picture, 0 (below) to 1.
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

/// The triangles of a group wherever it is drawn.
fn group_triangles<'a>(
    it: &'a SoftwareGroup,
    scene: &FrameInputs,
) -> impl Iterator<Item = [SurfaceCorner; 3]> + 'a {
    let models = scene.models(it.group);
    models.into_iter().flat_map(|model| {
        let corners = move_corners(&it.mesh, model);
        it.mesh.indices.chunks_exact(3).filter_map(move |three| {
            let corner = |at: usize| corners.get(three[at] as usize).copied();
            Some([corner(0)?, corner(1)?, corner(2)?])
        })
    })
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

/// Averages the samples of each pixel.
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
