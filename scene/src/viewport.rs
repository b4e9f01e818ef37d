//! Where a picture is drawn, and its figures.

use crate::level::SceneLevel;

/// Size and framebuffer of the area in which a picture is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneViewport {
    /// Left, bottom, width and height, pixels.
    pub pixels: [i32; 4],
    /// The framebuffer of the caller; `None` for the window.
    pub output: Option<glow::Framebuffer>,
    /// Whether anything moves: low levels of detail then draw a smaller picture.
    pub is_moving: bool,
    /// Level of detail; `None` for the default of the OpenGL renderer.
    pub level: Option<SceneLevel>,
}

/// Statistics of the last picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneFigures {
    /// Number of triangles of the machine.
    pub triangles: usize,
    /// Size of the drawn picture before it is scaled to the viewport, pixels.
    pub size: [i32; 2],
    /// Whether the processor computes the picture and not a graphics card.
    pub is_software: bool,
    /// Whether the next pictures of the same description will be better.
    pub is_refining: bool,
    /// Number of existing OpenGL objects.
    pub objects: i64,
    /// Size of the contents of the OpenGL objects, bytes.
    pub bytes: i64,
}
