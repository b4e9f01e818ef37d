//! The chips as one mesh in the memory of OpenGL.

use crate::chip_mesh::build_mesh;
use crate::chips::ChipState;
use crate::opengl::device::{Device, GpuMesh, SceneError, VertexLayout};

/// The mesh of all chips in the memory of OpenGL; empty without chips.
#[derive(Debug, Default)]
pub struct ChipObjects {
    shown: Vec<ChipState>,
    mesh: Option<GpuMesh>,
}

impl ChipObjects {
    /// Uploads the mesh of the chips if they have moved.
    pub fn update(&mut self, device: Device<'_>, chips: &[ChipState]) -> Result<(), SceneError> {
        if self.shown == chips {
            return Ok(());
        }
        self.release(device);
        self.mesh = None;
        self.shown = chips.to_vec();
        if !chips.is_empty() {
            let mesh = build_mesh(chips);
            let (vertices, indices) = (mesh.vertex_bytes(), mesh.index_bytes());
            self.mesh = Some(device.create_mesh(VertexLayout::Surface, &vertices, &indices)?);
        }
        Ok(())
    }

    /// Draws the chips with the shader program in use.
    pub fn draw(&self, device: Device<'_>) {
        if let Some(mesh) = &self.mesh {
            device.draw_mesh(mesh, None);
        }
    }

    /// Deletes the mesh of the chips from OpenGL.
    pub fn release(&self, device: Device<'_>) {
        if let Some(mesh) = &self.mesh {
            device.delete_mesh(mesh);
        }
    }
}
