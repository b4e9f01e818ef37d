//! Defines the size of the LCD in cells and dots.

/// Cells in a row of the LCD.
pub const COLUMNS: usize = 40;
/// Rows of cells on the LCD.
pub const ROWS: usize = 15;
/// Width of the LCD, dots.
pub const WIDTH: usize = 320;
/// Height of the LCD, dots.
pub const HEIGHT: usize = 240;
