//! The drawing of a task: the outline of the finished part with the dimensions that are marked,
//! as lines and texts that a window paints or a file contains.
//!
//! ```text
//!             | ⌀40 ±0.05 |
//!   ____      v           |
//!       |_____________    |
//!   -.-.-.-.-.-.-.-.-.|   |
//!       |‾‾‾‾‾‾‾‾‾‾‾‾‾    |
//!   ‾‾‾‾      ^
//!       |<--- 40 ---->|
//! ```

mod hatch;
mod layout;
mod outline_check;
mod svg;

#[cfg(test)]
mod tests;

pub use layout::draw_task;
pub(crate) use outline_check::check_outline;
pub(crate) use svg::escape_markup;
pub use svg::write_svg;

/// A point of a drawing: to the right and down from its upper left corner, in its units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PaperPoint {
    /// Distance from the left edge.
    pub right: f64,
    /// Distance from the upper edge.
    pub down: f64,
}

/// What a line of a drawing means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingPen {
    /// A visible edge of the part.
    Edge,
    /// The root of a thread, or where the part is broken off.
    Thin,
    /// The spindle axis.
    Axis,
    /// The cut material of a section.
    Hatch,
    /// The dimension of the criterion with this index in the task.
    Dimension(usize),
}

/// A line of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingLine {
    /// What it means.
    pub pen: DrawingPen,
    /// Two points or more.
    pub points: Vec<PaperPoint>,
}

/// The arrowhead of a dimension, a filled triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingArrow {
    /// Index of the criterion in the task.
    pub criterion: usize,
    /// The tip, then the other corners.
    pub corners: [PaperPoint; 3],
}

/// The text of a dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingLabel {
    /// Index of the criterion in the task.
    pub criterion: usize,
    /// Middle of the text.
    pub middle: PaperPoint,
    /// Whether the text reads from below to above.
    pub is_upright: bool,
    /// The text.
    pub text: String,
}

/// The drawing of a task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskDrawing {
    /// Width, units.
    pub width: f64,
    /// Height, units.
    pub height: f64,
    /// Height of the texts, units.
    pub text_height: f64,
    /// Lines of the part and of its dimensions.
    pub lines: Vec<DrawingLine>,
    /// Arrowheads of the dimensions.
    pub arrows: Vec<DrawingArrow>,
    /// Texts of the dimensions.
    pub labels: Vec<DrawingLabel>,
}
