//! A corner of a body.

use glam::Vec3;

/// A corner of a body; the axes are Z, X, Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    /// Position, mm.
    pub position: Vec3,
    /// Direction of the surface, length 1.
    pub normal: Vec3,
    /// Direction of the turning marks, length 1; 0 without marks.
    pub marks: Vec3,
}
