//! The programmed path in the memory of OpenGL.

use std::sync::Arc;

use crate::device::{Device, GpuMesh, SceneError, VertexLayout};
use crate::tool_path::ToolPath;

/// The lines of a path; nothing while it is hidden.
#[derive(Debug, Default)]
pub struct PathObjects {
    shown: Option<(Arc<ToolPath>, GpuMesh)>,
}

impl PathObjects {
    /// Uploads the path if it has changed.
    pub fn update(
        &mut self,
        device: Device<'_>,
        path: Option<&Arc<ToolPath>>,
    ) -> Result<(), SceneError> {
        let shown = self.shown.as_ref().map(|(path, _)| path);
        if shown.map(Arc::as_ptr) == path.map(Arc::as_ptr) {
            return Ok(());
        }
        self.release(device);
        self.shown = None;
        if let Some(path) = path.filter(|it| !it.pieces().is_empty()) {
            let [vertices, indices] = path.bytes();
            let lines = device.create_mesh(VertexLayout::Line, &vertices, &indices)?;
            self.shown = Some((Arc::clone(path), lines));
        }
        Ok(())
    }

    /// Draws the lines with the program in use.
    pub fn draw(&self, device: Device<'_>) {
        if let Some((_, lines)) = &self.shown {
            device.draw_mesh(lines, None);
        }
    }

    /// Deletes the lines.
    pub fn release(&self, device: Device<'_>) {
        if let Some((_, lines)) = &self.shown {
            device.delete_mesh(lines);
        }
    }
}
