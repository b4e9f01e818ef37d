//! Defines rectangles and colours of a faceplate.

/// A rectangle in panel units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// X of the left edge, panel units, increasing to the right.
    pub x: f32,
    /// Y of the top edge, panel units, increasing downwards.
    pub y: f32,
    /// Width of the rectangle, panel units.
    pub w: f32,
    /// Height of the rectangle, panel units.
    pub h: f32,
}

impl Rect {
    /// Creates a rectangle from its upper left corner (`x`, `y`), width and height, all in
    /// panel units.
    pub const fn new(x: f32, y: f32, w: f32, h: f32) -> Self {
        Self { x, y, w, h }
    }

    /// Creates the square around a circle with centre (`x`, `y`); all lengths in panel units.
    pub const fn around(x: f32, y: f32, diameter: f32) -> Self {
        Self::new(x - diameter / 2.0, y - diameter / 2.0, diameter, diameter)
    }

    /// Returns the centre (x, y) of the rectangle.
    pub const fn center(&self) -> (f32, f32) {
        (self.x + self.w / 2.0, self.y + self.h / 2.0)
    }

    /// Returns whether the point (`x`, `y`) is inside the rectangle. The right and lower edges
    /// are outside.
    pub fn contains(&self, x: f32, y: f32) -> bool {
        (self.x..self.x + self.w).contains(&x) && (self.y..self.y + self.h).contains(&y)
    }

    /// Returns whether all of `inner` is inside this rectangle. Edges may touch.
    pub fn encloses(&self, inner: &Self) -> bool {
        self.x <= inner.x
            && self.y <= inner.y
            && inner.x + inner.w <= self.x + self.w
            && inner.y + inner.h <= self.y + self.h
    }

    /// Returns whether this rectangle overlaps `other`. Touching edges do not overlap.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.x < other.x + other.w
            && other.x < self.x + self.w
            && self.y < other.y + other.h
            && other.y < self.y + self.h
    }
}

/// A colour of the panel, named by the parts that have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelColour {
    /// Background colour of the panel.
    Housing,
    /// Colour of the plates on which keys are placed.
    Plate,
    /// Colour of the frame of the LCD.
    Bezel,
    /// Colour of the LCD while it shows no picture.
    Lcd,
    /// Colour of printed text on plates.
    Print,
    /// Colour of printed text that is fainter than [`Self::Print`].
    Hint,
    /// Colour of the address keys.
    Address,
    /// Colour of the number keys.
    Number,
    /// Colour of the function keys of the edit keyboard.
    Function,
    /// Colour of the page keys.
    Page,
    /// Colour of the reset key and the mushroom button.
    Danger,
    /// Colour of the machine keys without a colour for their function.
    Machine,
    /// Colour of the machine keys that select a mode.
    Mode,
    /// Colour of the axis direction keys.
    Direction,
    /// Colour of the cycle start key.
    Start,
    /// Colour of the feed hold key.
    Hold,
    /// Colour of the dark parts: handwheel, release button, screws.
    Dark,
    /// Colour of a lit lamp.
    LampOn,
    /// Colour of the lit lamp of feed hold.
    LampHold,
    /// Colour of a lamp that is not lit.
    LampOff,
}

impl PanelColour {
    /// Returns the red, green and blue of the colour.
    pub const fn rgb(self) -> [u8; 3] {
        match self {
            Self::Housing => [98, 116, 134],
            Self::Plate => [62, 76, 91],
            Self::Bezel => [28, 33, 40],
            Self::Lcd => [10, 22, 74],
            Self::Print => [222, 230, 238],
            Self::Hint => [158, 174, 190],
            Self::Address => [214, 220, 226],
            Self::Number => [243, 244, 242],
            Self::Function => [92, 119, 146],
            Self::Page => [48, 99, 150],
            Self::Danger => [198, 48, 42],
            Self::Machine => [208, 215, 221],
            Self::Mode => [184, 203, 221],
            Self::Direction => [188, 208, 196],
            Self::Start => [42, 134, 78],
            Self::Hold => [226, 168, 44],
            Self::Dark => [42, 49, 58],
            Self::LampOn => [88, 244, 104],
            Self::LampHold => [255, 196, 56],
            Self::LampOff => [86, 98, 92],
        }
    }

    /// Returns the red, green and blue of print on a part that has this colour.
    pub const fn ink(self) -> [u8; 3] {
        match self {
            Self::Address
            | Self::Number
            | Self::Machine
            | Self::Mode
            | Self::Direction
            | Self::Hold => [30, 38, 48],
            _ => [246, 249, 252],
        }
    }
}
