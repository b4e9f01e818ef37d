//! Defines the size of the LCD in cells and dots.

/// Columns of cells.
pub const COLUMNS: usize = 40;
/// Rows of cells.
pub const ROWS: usize = 15;
/// Dots from left to right.
pub const WIDTH: usize = 320;
/// Dots from top to bottom.
pub const HEIGHT: usize = 240;
