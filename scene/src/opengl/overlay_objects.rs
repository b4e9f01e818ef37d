//! The programmed path and the marks of collisions in the memory of OpenGL.

use std::sync::Arc;

use crate::mesh::marks::{MARK_COLOR, MARK_SIDES, mark_rings};
use crate::opengl::device::{Device, GpuMesh, SceneError, VertexLayout};
use crate::tool_path::ToolPath;

/// The lines of the programmed path in the memory of OpenGL; empty while the path is hidden.
#[derive(Debug, Default)]
pub struct PathObjects {
    shown: Option<(Arc<ToolPath>, GpuMesh)>,
}

impl PathObjects {
    /// Uploads the programmed path if it has changed.
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

    /// Draws the programmed path with the shader program in use.
    pub fn draw(&self, device: Device<'_>) {
        if let Some((_, lines)) = &self.shown {
            device.draw_mesh(lines, None);
        }
    }

    /// Deletes the lines of the path from OpenGL.
    pub fn release(&self, device: Device<'_>) {
        if let Some((_, lines)) = &self.shown {
            device.delete_mesh(lines);
        }
    }
}

/// Rings around the axis that mark the positions of collisions.
#[derive(Debug, Default)]
pub struct MarkObjects {
    shown: Vec<[f32; 2]>,
    lines: Option<GpuMesh>,
}

/// Returns the vertices of the rings of all collision marks, and their indices, as bytes.
fn mark_bytes(marks: &[[f32; 2]]) -> [Vec<u8>; 2] {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    let mut first = 0_u32;
    for ring in mark_rings(marks) {
        for (at, side) in ring.into_iter().zip(0..) {
            for length in at.to_array() {
                vertices.extend_from_slice(&length.to_ne_bytes());
            }
            vertices.extend_from_slice(&MARK_COLOR);
            let ends = [first + side, first + (side + 1) % MARK_SIDES];
            indices.extend(ends.into_iter().flat_map(u32::to_ne_bytes));
        }
        first += MARK_SIDES;
    }
    [vertices, indices]
}

impl MarkObjects {
    /// Uploads the collision marks if they have changed.
    pub fn update(&mut self, device: Device<'_>, marks: &[[f32; 2]]) -> Result<(), SceneError> {
        if self.shown == marks {
            return Ok(());
        }
        self.release(device);
        self.lines = None;
        self.shown = marks.to_vec();
        if !marks.is_empty() {
            let [vertices, indices] = mark_bytes(marks);
            self.lines = Some(device.create_mesh(VertexLayout::Line, &vertices, &indices)?);
        }
        Ok(())
    }

    /// Draws the rings with the shader program in use.
    pub fn draw(&self, device: Device<'_>) {
        if let Some(lines) = &self.lines {
            device.draw_mesh(lines, None);
        }
    }

    /// Deletes the rings from OpenGL.
    pub fn release(&self, device: Device<'_>) {
        if let Some(lines) = &self.lines {
            device.delete_mesh(lines);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::marks::MAX_MARKS;
    use crate::tool_path::LINE_VERTEX_BYTES;

    #[test]
    fn marks_are_bounded_rings() {
        let marks = vec![[10.0, 20.0]; 500];
        let [vertices, indices] = mark_bytes(&marks);
        let rings = MAX_MARKS * 3 * MARK_SIDES as usize;
        assert_eq!(vertices.len(), rings * LINE_VERTEX_BYTES);
        assert_eq!(indices.len(), rings * 8);
        let [vertices, _] = mark_bytes(&[[f32::NAN, 1.0]]);
        assert!(vertices.is_empty());
    }
}
