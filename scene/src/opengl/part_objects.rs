//! The part in the memory of OpenGL: the grid that the vertex shader revolves, and a mesh of
//! its threads and cut faces.

use std::sync::Arc;

use crate::description::{LatheDescription, LatheKind, SectionCut};
use crate::level::SceneLevel;
use crate::opengl::device::{Device, GpuMesh, SceneError, SceneProgram, VertexLayout};
use crate::opengl::shader;
use crate::part::outline::{MAX_EDGES, PartOutline};
use crate::part_details::build_details;
use crate::section_cut::kept_sweep;

/// The part in the memory of OpenGL: a fixed grid, the texture of its outline, and its threads and
/// cut faces.
#[derive(Debug)]
pub struct PartObjects {
    grid: GpuMesh,
    /// A grid of the revolved part with half the sides.
    coarse_grid: GpuMesh,
    texture: glow::Texture,
    outline: Arc<PartOutline>,
    edges: i32,
    /// Mesh of the threads and cut faces; `None` if the part has neither.
    details: Option<GpuMesh>,
    cut: (LatheKind, SectionCut),
    /// Whether chalk marks show that the part turns.
    has_marks: bool,
}

impl PartObjects {
    /// Creates the grid, before a part is known.
    pub fn create(device: Device<'_>) -> Result<Self, SceneError> {
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
            details: None,
            cut: (LatheKind::default(), SectionCut::Whole),
            has_marks: false,
        })
    }

    /// Uploads the outline, threads and cut faces if they have changed.
    pub fn update(
        &mut self,
        device: Device<'_>,
        lathe: &LatheDescription,
    ) -> Result<(), SceneError> {
        let cut = (lathe.kind, lathe.overlay.section_cut);
        self.has_marks = cut.1 == SectionCut::Whole && !lathe.effects.is_spindle_blurred;
        let is_same = Arc::ptr_eq(&self.outline, &lathe.part);
        if is_same && self.cut == cut {
            return Ok(());
        }
        if !is_same {
            self.outline = Arc::clone(&lathe.part);
            self.edges = self.outline.edges().len() as i32;
            if self.edges > 0 {
                device.write_outline(self.texture, &self.outline.texels());
            }
        }
        self.cut = cut;
        if let Some(details) = self.details.take() {
            device.delete_mesh(&details);
        }
        let mesh = build_details(&self.outline, cut.0, cut.1);
        if mesh.triangle_count() > 0 {
            let (vertices, indices) = (mesh.vertex_bytes(), mesh.index_bytes());
            let details = device.create_mesh(VertexLayout::Surface, &vertices, &indices)?;
            self.details = Some(details);
        }
        Ok(())
    }

    /// Draws the revolved surfaces with `program`, a shader variant `PART` that is in use.
    pub fn draw_revolved(&self, device: Device<'_>, program: &SceneProgram, level: SceneLevel) {
        if self.edges == 0 {
            return;
        }
        device.set_pair(program, "u_sweep", kept_sweep(self.cut.0, self.cut.1));
        let marks = if self.has_marks { 1.0 } else { 0.0 };
        device.set_number(program, "u_marks", marks);
        let material = self.outline.material();
        let [cut, skin] = material.colors();
        device.set_vector(program, "u_cut", cut);
        device.set_vector(program, "u_skin", skin);
        device.set_number(program, "u_metal", material.metal());
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

    /// Draws threads and cut faces with the shader program in use.
    pub fn draw_details(&self, device: Device<'_>) {
        if let Some(details) = &self.details {
            device.draw_mesh(details, None);
        }
    }

    /// Deletes all OpenGL objects of the part.
    pub fn release(&self, device: Device<'_>) {
        device.delete_mesh(&self.grid);
        device.delete_mesh(&self.coarse_grid);
        device.delete_outline(self.texture);
        if let Some(details) = &self.details {
            device.delete_mesh(details);
        }
    }
}
