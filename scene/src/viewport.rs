//! Where a picture is drawn, and its figures.

/// Where a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneViewport {
    /// Left, bottom, width and height, pixels.
    pub pixels: [i32; 4],
    /// The framebuffer of the caller.
    pub output: Option<glow::Framebuffer>,
    /// Whether something moves: a software renderer then draws at half the size.
    pub is_moving: bool,
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
}
