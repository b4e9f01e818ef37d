//! Everything that lives in the OpenGL context, and the order in which a picture is drawn.

use glam::Mat4;

use crate::camera::OrbitCamera;
use crate::description::LatheDescription;
use crate::frame::{
    COOLANT_ALPHA, FrameInputs, HAZE_ALPHA, LIGHT, LayerInputs, PANE_ALPHA, STILL_GROUPS,
};
use crate::lathe::MeshGroup;
use crate::level::SceneLevel;
use crate::opengl::chip_objects::ChipObjects;
use crate::opengl::device::{Device, DrawTarget, SceneError, SceneProgram};
use crate::opengl::gpu_meshes::GpuMeshes;
use crate::opengl::overlay_objects::{MarkObjects, PathObjects};
use crate::opengl::part_objects::PartObjects;
use crate::opengl::shader;
use crate::opengl::targets::SceneTargets;
use crate::viewport::{SceneFigures, SceneViewport};

/// The shader programs that draw a scene.
#[derive(Debug)]
struct ScenePrograms {
    surface: SceneProgram,
    part: SceneProgram,
    surface_depth: SceneProgram,
    part_depth: SceneProgram,
    line: SceneProgram,
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
            line: device.create_program("", [shader::LINE_VERTEX, shader::LINE_FRAGMENT])?,
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
            line,
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
            line,
            ground,
            show,
            show_smooth,
        ] {
            device.delete_program(program);
        }
    }
}

/// Returns the default level of detail: half the size if the processor computes OpenGL, else the
/// full size.
const fn usual_level(is_software: bool) -> SceneLevel {
    match is_software {
        true => SceneLevel::Half,
        false => SceneLevel::Full,
    }
}

/// All OpenGL objects of a scene: shader programs, meshes and framebuffers.
#[derive(Debug)]
pub struct SceneObjects {
    programs: ScenePrograms,
    meshes: GpuMeshes,
    part: PartObjects,
    path: PathObjects,
    marks: MarkObjects,
    chips: ChipObjects,
    targets: SceneTargets,
    cover: glow::VertexArray,
    is_software: bool,
    level: SceneLevel,
    /// Lathe and camera that the current picture shows; `None` if it must be drawn again.
    drawn: Option<(LatheDescription, OrbitCamera)>,
    /// Inputs of the current picture of the stationary parts; `None` if it must be drawn again.
    layer: Option<LayerInputs>,
    has_fixed_shadow: bool,
    is_full_size: bool,
    /// Whether nothing in the next picture is left from an earlier one.
    is_thorough: bool,
    frame: u32,
}

impl SceneObjects {
    /// Creates all OpenGL objects for a lathe.
    pub fn create(device: Device<'_>, lathe: &LatheDescription) -> Result<Self, SceneError> {
        device.check_version()?;
        let is_software = device.is_software();
        let level = usual_level(is_software);
        Ok(Self {
            programs: ScenePrograms::create(device, level.has_soft_shadow(is_software))?,
            meshes: GpuMeshes::create(device, lathe)?,
            part: PartObjects::create(device)?,
            path: PathObjects::default(),
            marks: MarkObjects::default(),
            chips: ChipObjects::default(),
            targets: SceneTargets::create(device, [16, 16])?,
            cover: device.create_array()?,
            is_software,
            level,
            drawn: None,
            layer: None,
            has_fixed_shadow: false,
            is_full_size: true,
            is_thorough: true,
            frame: 0,
        })
    }

    /// Whether the OpenGL objects still exist; `false` after a loss of the context.
    pub fn is_alive(&self, device: Device<'_>) -> bool {
        device.is_alive(&self.programs.surface)
    }

    /// Draws the picture if anything has changed, and shows it in the viewport.
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

    /// Deletes all OpenGL objects of the scene.
    pub fn release(&self, device: Device<'_>) {
        self.programs.release(device);
        self.meshes.release(device);
        self.part.release(device);
        self.path.release(device);
        self.marks.release(device);
        self.chips.release(device);
        self.targets.release(device);
        device.delete_array(self.cover);
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
        if !viewport.is_moving && !self.is_thorough {
            // The first picture at rest has all shadows.
            self.drawn = None;
        }
        self.is_thorough = !viewport.is_moving;
        let size = [width, height].map(|it| (it / share).clamp(1, 8192));
        let mut is_new = self.targets.resize(device, size)?;
        if !self.meshes.is_design_of(lathe) {
            self.meshes.update(device, lathe)?;
            self.has_fixed_shadow = false;
            is_new = true;
        }
        is_new |= self.meshes.continue_bake(device)?;
        self.part.update(device, lathe)?;
        self.path.update(device, lathe.overlay.path.as_ref())?;
        self.marks.update(device, &lathe.effects.marks)?;
        self.chips.update(device, &lathe.effects.chips)?;
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
        let has_soft_shadow = level.has_soft_shadow(self.is_software);
        if has_soft_shadow != self.level.has_soft_shadow(self.is_software) {
            let programs = ScenePrograms::create(device, has_soft_shadow)?;
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
        let is_thorough = self.is_thorough || self.drawn.is_none();
        let shadow_pictures = self.level.shadow_pictures(self.is_software);
        if is_thorough || self.frame.is_multiple_of(shadow_pictures) {
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
        device.set_matrix(&self.programs.surface, "u_model", &scene.part_model);
        self.part.draw_details(device);
        device.set_matrix(&self.programs.surface, "u_model", &Mat4::IDENTITY);
        self.chips.draw(device);
        self.set_inputs(device, &self.programs.part, scene);
        device.set_matrix(&self.programs.part, "u_model", &scene.part_model);
        self.part
            .draw_revolved(device, &self.programs.part, self.level);
        let line = &self.programs.line;
        device.use_program(line);
        device.set_matrix(line, "u_projection", &scene.projection);
        device.set_matrix(line, "u_model", &scene.tool_side);
        self.path.draw(device);
        device.begin_transparent();
        self.set_inputs(device, &self.programs.surface, scene);
        for (group, alpha) in [
            (MeshGroup::Coolant, COOLANT_ALPHA),
            (MeshGroup::Pane, PANE_ALPHA),
        ] {
            device.set_number(&self.programs.surface, "u_alpha", alpha);
            self.draw_group(device, &self.programs.surface, scene, group);
        }
        self.draw_haze(device, scene);
        self.draw_marks(device, scene);
        device.bind_texture(0, None);
    }

    /// Draws the marks of collisions in front of everything: a bent bar would hide them.
    fn draw_marks(&self, device: Device<'_>, scene: &FrameInputs) {
        device.begin_cover();
        let line = &self.programs.line;
        device.use_program(line);
        device.set_matrix(line, "u_projection", &scene.projection);
        device.set_matrix(line, "u_model", &Mat4::IDENTITY);
        self.marks.draw(device);
    }

    /// Draws the blurred jaws of a fast spindle.
    fn draw_haze(&self, device: Device<'_>, scene: &FrameInputs) {
        let program = &self.programs.surface;
        device.set_number(program, "u_alpha", HAZE_ALPHA);
        if let Some(jaw) = self.meshes.get(MeshGroup::Jaw) {
            for model in scene.hazy_jaws() {
                device.set_matrix(program, "u_model", &model);
                device.draw_mesh(jaw, None);
            }
        }
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
        device.set_matrix(depth, "u_model", &scene.part_model);
        self.part.draw_details(device);
        let depth = &self.programs.part_depth;
        device.use_program(depth);
        device.set_matrix(depth, "u_projection", &scene.light_projection);
        device.set_matrix(depth, "u_model", &scene.part_model);
        device.set_sampler(depth, "u_outline", 1);
        self.part.draw_revolved(device, depth, self.level);
        device.set_depth_shift(false);
        self.has_fixed_shadow = true;
    }

    /// Draws the stationary parts again if the camera, the quill or the door has moved, or the
    /// shadows are old.
    fn draw_layer(&mut self, device: Device<'_>, scene: &FrameInputs, is_thorough: bool) {
        let layer = scene.layer();
        let is_same = self.layer.as_ref() == Some(&layer);
        let layer_pictures = self.level.layer_pictures(self.is_software);
        if is_same && !is_thorough && !self.frame.is_multiple_of(layer_pictures) {
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
    /// smoothed before it is enlarged, which costs a quarter of the time.
    fn show(&self, device: Device<'_>, viewport: SceneViewport) {
        let ScenePrograms {
            show, show_smooth, ..
        } = &self.programs;
        let SceneTargets {
            picture, smooth, ..
        } = &self.targets;
        if self.is_full_size {
            device.bind_output(viewport.output, viewport.pixels);
            // A processor smooths the edges of all pixels when they rest.
            let is_smoothed = self.is_thorough || !self.is_software;
            let program = if is_smoothed { show_smooth } else { show };
            self.show_picture(device, program, picture);
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
