//! A corner of a body.

use glam::Vec3;

/// A corner of a body; Z, X, Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    /// Where it is, mm.
    pub at: Vec3,
    /// Which way the surface faces, length 1.
    pub normal: Vec3,
    /// Which way the marks of turning go, length 1; 0 where there are none.
    pub marks: Vec3,
}
