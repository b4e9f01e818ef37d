//! Defines the size of the LCD in cells and dots.

/// Number of character cells in a row of the LCD.
pub const COLUMNS: usize = 40;
/// Number of rows of character cells on the LCD.
pub const ROWS: usize = 15;
/// Width of the LCD, dots.
pub const WIDTH: usize = 320;
/// Height of the LCD, dots.
pub const HEIGHT: usize = 240;

/// The two colours of an LCD at full brightness: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LcdColours {
    /// Colour of the lit background of the LCD.
    pub background: [u8; 3],
    /// Colour of text and lines on the LCD.
    pub text: [u8; 3],
}

impl LcdColours {
    /// LCD colours with pale text on blue, as on the GSK980TD.
    pub const BLUE: Self = Self {
        background: [8, 44, 212],
        text: [244, 248, 255],
    };
    /// LCD colours with dark text on green, as on the NC-B08.
    pub const GREEN: Self = Self {
        background: [172, 214, 88],
        text: [18, 40, 16],
    };
}
