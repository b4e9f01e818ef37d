//! Everything that lives in the OpenGL context, and the order in which a picture is drawn.

use std::sync::Arc;

use crate::camera::OrbitCamera;
use crate::description::LatheDescription;
use crate::device::{Device, DrawTarget, GpuMesh, SceneError, SceneProgram, VertexLayout};
use crate::frame::{FrameInputs, LIGHT, LayerInputs};
use crate::gpu_meshes::GpuMeshes;
use crate::lathe::MeshGroup;
use crate::level::SceneLevel;
use crate::part_outline::{MAX_EDGES, PartOutline};
use crate::shader;
use crate::targets::SceneTargets;
use crate::viewport::{SceneFigures, SceneViewport};

/// Frames after which the layer of what stands still is drawn again, for the shadows of what
/// moves.
const LAYER_FRAMES: u32 = 15;
/// Opacity of panes, 0–1.
pub const PANE_ALPHA: f32 = 0.10;
/// Opacity of coolant, 0–1.
pub const COOLANT_ALPHA: f32 = 0.42;

/// The groups that stand still while a program runs.
pub const STILL_GROUPS: [MeshGroup; 5] = [
    MeshGroup::Floor,
    MeshGroup::Fixed,
    MeshGroup::Tailstock,
    MeshGroup::Quill,
    MeshGroup::Door,
];

/// The programs.
#[derive(Debug)]
struct ScenePrograms {
    surface: SceneProgram,
    part: SceneProgram,
    surface_depth: SceneProgram,
    part_depth: SceneProgram,
    ground: SceneProgram,
    show: SceneProgram,
    show_smooth: SceneProgram,
}

impl ScenePrograms {
    fn create(device: Device<'_>, has_soft_shadow: bool) -> Result<Self, SceneError> {
        let soft = if has_soft_shadow {
            shader::SOFT_SHADOW
        } else {
            ""
        };
        let part = format!("{soft}{}", shader::PART);
        let lit = [shader::VERTEX, shader::LIT_FRAGMENT];
        let depth = [shader::VERTEX, shader::DEPTH_FRAGMENT];
        let show = [shader::COVER_VERTEX, shader::SHOW_FRAGMENT];
        Ok(Self {
            surface: device.create_program(soft, lit)?,
            part: device.create_program(&part, lit)?,
            surface_depth: device.create_program("", depth)?,
            part_depth: device.create_program(shader::PART, depth)?,
            ground: device.create_program("", [shader::COVER_VERTEX, shader::GROUND_FRAGMENT])?,
            show: device.create_program("", show)?,
            show_smooth: device.create_program(shader::SMOOTH, show)?,
        })
    }

    fn release(&self, device: Device<'_>) {
        let Self {
            surface,
            part,
            surface_depth,
            part_depth,
            ..
        } = self;
        let Self {
            ground,
            show,
            show_smooth,
            ..
        } = self;
        for program in [
            surface,
            part,
            surface_depth,
            part_depth,
            ground,
            show,
            show_smooth,
        ] {
            device.delete_program(program);
        }
    }
}

/// The revolved part: a fixed grid, and the texture of its outline.
#[derive(Debug)]
struct PartObjects {
    grid: GpuMesh,
    /// The same with half the sides.
    coarse_grid: GpuMesh,
    texture: glow::Texture,
    outline: Arc<PartOutline>,
    edges: i32,
}

impl PartObjects {
    fn create(device: Device<'_>) -> Result<Self, SceneError> {
        let sides = shader::PART_SIDES;
        let ends = (0..2 * MAX_EDGES as u16)
            .flat_map(|end| (0..=sides as u16).flat_map(move |side| [end, side]));
        let vertices: Vec<u8> = ends.flat_map(u16::to_ne_bytes).collect();
        let create = |level: SceneLevel| {
            let step = level.sides_per_side();
            let quads = (0..MAX_EDGES as u32).flat_map(|edge| {
                let row = move |end: u32| (2 * edge + end) * (sides + 1);
                (0..sides / step).flat_map(move |side| {
                    let [a, b] = [row(0) + side * step, row(1) + side * step];
                    [a, a + step, b, b, a + step, b + step]
                })
            });
            let indices: Vec<u8> = quads.flat_map(u32::to_ne_bytes).collect();
            device.create_mesh(VertexLayout::Edge, &vertices, &indices)
        };
        Ok(Self {
            grid: create(SceneLevel::Full)?,
            coarse_grid: create(SceneLevel::Coarse)?,
            texture: device.create_outline()?,
            outline: Arc::default(),
            edges: 0,
        })
    }

    fn update(&mut self, device: Device<'_>, outline: &Arc<PartOutline>) {
        if Arc::ptr_eq(&self.outline, outline) {
            return;
        }
        self.outline = Arc::clone(outline);
        self.edges = outline.edges().len() as i32;
        if self.edges > 0 {
            device.write_outline(self.texture, &outline.texels());
        }
    }

    fn draw(&self, device: Device<'_>, level: SceneLevel) {
        if self.edges > 0 {
            device.bind_texture(1, Some(self.texture));
            let step = level.sides_per_side();
            let indices = self.edges * (shader::PART_SIDES / step) as i32 * 6;
            let grid = if step > 1 {
                &self.coarse_grid
            } else {
                &self.grid
            };
            device.draw_mesh(grid, Some(indices));
            device.bind_texture(1, None);
        }
    }
}

/// The level of a renderer by its name alone.
const fn usual_level(is_software: bool) -> SceneLevel {
    match is_software {
        true => SceneLevel::Half,
        false => SceneLevel::Full,
    }
}

/// Everything that lives in the context.
#[derive(Debug)]
pub struct SceneObjects {
    programs: ScenePrograms,
    meshes: GpuMeshes,
    part: PartObjects,
    targets: SceneTargets,
    cover: glow::VertexArray,
    is_software: bool,
    level: SceneLevel,
    /// What the picture shows; `None` if it must be drawn.
    drawn: Option<(LatheDescription, OrbitCamera)>,
    /// What the layer of what stands still shows; `None` if it must be drawn.
    layer: Option<LayerInputs>,
    has_fixed_shadow: bool,
    is_full_size: bool,
    frame: u32,
}

impl SceneObjects {
    /// Creates everything for a lathe.
    pub fn create(device: Device<'_>, lathe: &LatheDescription) -> Result<Self, SceneError> {
        device.check_version()?;
        let is_software = device.is_software();
        let level = usual_level(is_software);
        Ok(Self {
            programs: ScenePrograms::create(device, level.has_soft_shadow())?,
            meshes: GpuMeshes::create(device, lathe)?,
            part: PartObjects::create(device)?,
            targets: SceneTargets::create(device, [16, 16])?,
            cover: device.create_array()?,
            is_software,
            level,
            drawn: None,
            layer: None,
            has_fixed_shadow: false,
            is_full_size: true,
            frame: 0,
        })
    }

    /// Whether the context still has the objects.
    pub fn is_alive(&self, device: Device<'_>) -> bool {
        device.is_alive(&self.programs.surface)
    }

    /// Draws what has changed, and shows the picture.
    pub fn paint(
        &mut self,
        device: Device<'_>,
        lathe: &LatheDescription,
        camera: &OrbitCamera,
        viewport: SceneViewport,
    ) -> Result<SceneFigures, SceneError> {
        self.update(device, lathe, viewport)?;
        if self.needs_drawing(lathe, camera) {
            let scene = FrameInputs::new(lathe, camera, self.targets.picture.size);
            self.draw(device, &scene);
            self.drawn = Some((lathe.clone(), *camera));
        }
        self.show(device, viewport);
        Ok(SceneFigures {
            triangles: self.meshes.triangle_count(),
            size: self.targets.picture.size,
            is_software: self.is_software,
            is_refining: self.meshes.is_baking(),
            objects: device.tally().objects(),
            bytes: device.tally().bytes(),
        })
    }

    /// Deletes everything.
    pub fn release(&self, device: Device<'_>) {
        self.programs.release(device);
        self.meshes.release(device);
        device.delete_mesh(&self.part.grid);
        device.delete_mesh(&self.part.coarse_grid);
        self.targets.release(device);
        device.delete_rest(self.cover, self.part.texture);
    }

    fn update(
        &mut self,
        device: Device<'_>,
        lathe: &LatheDescription,
        viewport: SceneViewport,
    ) -> Result<(), SceneError> {
        let [_, _, width, height] = viewport.pixels;
        self.update_level(device, viewport.level)?;
        let share = match viewport.is_moving {
            true => self.level.moving_share(),
            false => 1,
        };
        self.is_full_size = share == 1;
        let size = [width, height].map(|it| (it / share).clamp(1, 8192));
        let mut is_new = self.targets.resize(device, size)?;
        if !self.meshes.is_design_of(lathe) {
            let meshes = GpuMeshes::create(device, lathe)?;
            core::mem::replace(&mut self.meshes, meshes).release(device);
            self.has_fixed_shadow = false;
            is_new = true;
        }
        is_new |= self.meshes.continue_bake(device)?;
        self.part.update(device, &lathe.part);
        if is_new {
            self.drawn = None;
            self.layer = None;
        }
        Ok(())
    }

    fn update_level(
        &mut self,
        device: Device<'_>,
        level: Option<SceneLevel>,
    ) -> Result<(), SceneError> {
        let level = level.unwrap_or(usual_level(self.is_software));
        if level.has_soft_shadow() != self.level.has_soft_shadow() {
            let programs = ScenePrograms::create(device, level.has_soft_shadow())?;
            core::mem::replace(&mut self.programs, programs).release(device);
            self.drawn = None;
        }
        self.level = level;
        Ok(())
    }

    fn needs_drawing(&self, lathe: &LatheDescription, camera: &OrbitCamera) -> bool {
        let drawn = self.drawn.as_ref();
        !drawn.is_some_and(|(shown, from)| shown == lathe && from == camera)
    }

    fn draw(&mut self, device: Device<'_>, scene: &FrameInputs) {
        self.frame = self.frame.wrapping_add(1);
        let is_thorough = self.is_full_size || self.drawn.is_none();
        if is_thorough || self.frame.is_multiple_of(self.level.shadow_pictures()) {
            self.draw_shadows(device, scene);
        }
        device.bind_texture(0, Some(self.targets.shadow.texture));
        self.draw_layer(device, scene, is_thorough);
        device.copy_target(&self.targets.fixed, &self.targets.picture);
        device.bind_target(&self.targets.picture, false);
        device.begin_surfaces(true);
        self.set_inputs(device, &self.programs.surface, scene);
        for group in MeshGroup::ALL {
            if !group.is_transparent() && !STILL_GROUPS.contains(&group) {
                self.draw_group(device, &self.programs.surface, scene, group);
            }
        }
        device.begin_surfaces(false);
        self.set_inputs(device, &self.programs.part, scene);
        device.set_matrix(&self.programs.part, "u_model", &scene.placement.spindle);
        self.part.draw(device, self.level);
        device.begin_transparent();
        self.set_inputs(device, &self.programs.surface, scene);
        for (group, alpha) in [
            (MeshGroup::Coolant, COOLANT_ALPHA),
            (MeshGroup::Pane, PANE_ALPHA),
        ] {
            device.set_number(&self.programs.surface, "u_alpha", alpha);
            self.draw_group(device, &self.programs.surface, scene, group);
        }
        device.bind_texture(0, None);
    }

    fn draw_shadows(&mut self, device: Device<'_>, scene: &FrameInputs) {
        let SceneTargets {
            fixed_shadow,
            shadow,
            ..
        } = &self.targets;
        let depth = &self.programs.surface_depth;
        device.bind_texture(0, None);
        device.begin_surfaces(false);
        device.set_depth_shift(true);
        device.use_program(depth);
        device.set_matrix(depth, "u_projection", &scene.light_projection);
        if !self.has_fixed_shadow {
            device.bind_target(fixed_shadow, true);
            self.draw_group(device, depth, scene, MeshGroup::Fixed);
        }
        device.copy_target(fixed_shadow, shadow);
        device.bind_target(shadow, false);
        for group in MeshGroup::ALL {
            let is_cast =
                !group.is_transparent() && group != MeshGroup::Fixed && group != MeshGroup::Floor;
            if is_cast {
                self.draw_group(device, depth, scene, group);
            }
        }
        let depth = &self.programs.part_depth;
        device.use_program(depth);
        device.set_matrix(depth, "u_projection", &scene.light_projection);
        device.set_matrix(depth, "u_model", &scene.placement.spindle);
        device.set_sampler(depth, "u_outline", 1);
        self.part.draw(device, self.level);
        device.set_depth_shift(false);
        self.has_fixed_shadow = true;
    }

    /// Draws what stands still, if the camera or something of it has moved, or its shadows are
    /// old.
    fn draw_layer(&mut self, device: Device<'_>, scene: &FrameInputs, is_thorough: bool) {
        let layer = scene.layer();
        let is_same = self.layer.as_ref() == Some(&layer);
        if is_same && !is_thorough && !self.frame.is_multiple_of(LAYER_FRAMES) {
            return;
        }
        self.layer = Some(layer);
        device.begin_surfaces(true);
        device.bind_target(&self.targets.fixed, true);
        device.begin_cover();
        let ground = &self.programs.ground;
        device.use_program(ground);
        device.set_vector(ground, "u_low", scene.ground[0]);
        device.set_vector(ground, "u_high", scene.ground[1]);
        device.draw_cover(self.cover);
        device.begin_surfaces(true);
        self.set_inputs(device, &self.programs.surface, scene);
        for group in STILL_GROUPS {
            self.draw_group(device, &self.programs.surface, scene, group);
        }
    }

    fn draw_group(
        &self,
        device: Device<'_>,
        program: &SceneProgram,
        scene: &FrameInputs,
        group: MeshGroup,
    ) {
        let Some(mesh) = self.meshes.get(group) else {
            return;
        };
        for model in scene.models(group) {
            device.set_matrix(program, "u_model", &model);
            device.draw_mesh(mesh, None);
        }
    }

    fn set_inputs(&self, device: Device<'_>, program: &SceneProgram, scene: &FrameInputs) {
        device.use_program(program);
        device.set_matrix(program, "u_projection", &scene.projection);
        device.set_matrix(program, "u_light_projection", &scene.light_projection);
        device.set_vector(program, "u_eye", scene.eye);
        device.set_vector(program, "u_light", LIGHT.normalize());
        device.set_vector(program, "u_low", scene.ground[0]);
        device.set_vector(program, "u_high", scene.ground[1]);
        device.set_vector(program, "u_centre", scene.centre);
        device.set_pair(program, "u_fade", scene.fade);
        device.set_number(program, "u_alpha", 1.0);
        device.set_number(program, "u_rows", scene.rows);
        device.set_number(program, "u_sky", scene.sky);
        device.set_sampler(program, "u_shadow", 0);
        device.set_sampler(program, "u_outline", 1);
    }

    /// Shows the picture in the viewport of the caller, with smoothed edges. A small picture is
    /// smoothed before it is enlarged, which costs a quarter.
    fn show(&self, device: Device<'_>, viewport: SceneViewport) {
        let ScenePrograms {
            show, show_smooth, ..
        } = &self.programs;
        let SceneTargets {
            picture, smooth, ..
        } = &self.targets;
        if self.is_full_size {
            device.bind_output(viewport.output, viewport.pixels);
            self.show_picture(device, show_smooth, picture);
            return;
        }
        device.begin_surfaces(false);
        device.begin_cover();
        device.bind_target(smooth, false);
        self.show_picture(device, show_smooth, picture);
        device.bind_output(viewport.output, viewport.pixels);
        self.show_picture(device, show, smooth);
    }

    fn show_picture(&self, device: Device<'_>, program: &SceneProgram, picture: &DrawTarget) {
        device.use_program(program);
        device.bind_texture(0, Some(picture.texture));
        device.set_sampler(program, "u_picture", 0);
        let texel = picture.size.map(|it| 1.0 / it as f32);
        device.set_pair(program, "u_texel", texel);
        device.draw_cover(self.cover);
        device.bind_texture(0, None);
    }
}
