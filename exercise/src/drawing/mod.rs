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

/// A point of a drawing, in drawing units from its upper left corner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PaperPoint {
    /// Distance from the left edge, drawing units.
    pub right: f64,
    /// Distance from the upper edge, drawing units.
    pub down: f64,
}

/// The kind of a line in a drawing, which determines its width and dashes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingPen {
    /// A visible edge of the part.
    Edge,
    /// A thin line: the root of a thread, or the break of the part.
    Thin,
    /// The spindle axis, a dash-dotted line.
    Axis,
    /// The hatching of cut material in a section.
    Hatch,
    /// A dimension line; the value is the index of its criterion in the task.
    Dimension(usize),
}

/// A line of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingLine {
    /// The kind of the line: edge, thin line, axis, hatching or dimension.
    pub pen: DrawingPen,
    /// Points of the line, at least two.
    pub points: Vec<PaperPoint>,
}

/// The arrowhead of a dimension line, a filled triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingArrow {
    /// Index of the criterion in the task to which the arrow belongs.
    pub criterion: usize,
    /// Corners of the triangle, the tip first.
    pub corners: [PaperPoint; 3],
}

/// The text of a dimension with its position.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingLabel {
    /// Index of the criterion in the task to which the text belongs.
    pub criterion: usize,
    /// Middle of the text on the paper.
    pub middle: PaperPoint,
    /// Whether the text is vertical and reads upwards.
    pub is_upright: bool,
    /// The text of the dimension, such as `⌀40 ±0.05`.
    pub text: String,
}

/// The drawing of a task: lines, arrowheads and texts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskDrawing {
    /// Width of the drawing, drawing units.
    pub width: f64,
    /// Height of the drawing, drawing units.
    pub height: f64,
    /// Height of the texts, drawing units.
    pub text_height: f64,
    /// Lines of the part and of its dimensions.
    pub lines: Vec<DrawingLine>,
    /// Arrowheads of the dimensions.
    pub arrows: Vec<DrawingArrow>,
    /// Texts of the dimensions.
    pub labels: Vec<DrawingLabel>,
}
