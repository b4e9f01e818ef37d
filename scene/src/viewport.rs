//! Where a picture is drawn, and its figures.

use crate::level::SceneLevel;

/// Where a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneViewport {
    /// Left, bottom, width and height, pixels.
    pub pixels: [i32; 4],
    /// The framebuffer of the caller.
    pub output: Option<glow::Framebuffer>,
    /// Whether something moves: low levels then draw a smaller picture.
    pub is_moving: bool,
    /// How much is drawn; `None`: what suits the renderer of OpenGL by its name.
    pub level: Option<SceneLevel>,
}

/// Figures of the last picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneFigures {
    /// Triangles of the machine.
    pub triangles: usize,
    /// Size of the drawn picture before it is scaled to the viewport, pixels.
    pub size: [i32; 2],
    /// Whether the processor draws.
    pub is_software: bool,
    /// Whether the next pictures will be better without any change of the description.
    pub is_refining: bool,
    /// Number of objects of OpenGL.
    pub objects: i64,
    /// Bytes of their contents.
    pub bytes: i64,
}
