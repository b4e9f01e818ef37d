//! A corner of a body.

use glam::Vec3;

/// A corner of a body, with coordinates in the order Z, X, Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    /// Position of the corner, mm.
    pub position: Vec3,
    /// Outward direction of the surface at the corner, a vector of length 1.
    pub normal: Vec3,
    /// Direction of the turning marks, a vector of length 1; 0 without marks.
    pub marks: Vec3,
}
