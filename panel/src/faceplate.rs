//! Contains the geometry of the panel: a table of parts in panel units (manual III-1.2). The
//! window and the painter draw it, and the pointer is looked up in it. In a narrow window the
//! panel is split into [sections](PanelArea::SECTIONS).
//!
//! One panel unit is half a dot of the LCD. At every scale that is a multiple of one half, LCD
//! dots are whole pixels.

mod layout;
mod paint;
mod text;

use std::sync::LazyLock;

pub use paint::{FaceState, paint, paint_part, part_state};
pub use tiny_skia::Pixmap;

use crate::keys::{Key, KeyRole};

/// Width and height of the panel in panel units.
pub const SIZE: (f32, f32) = (1280.0, 756.0);

/// Line height of a legend, panel units: one Unifont cell at scale 1.
pub(crate) const LINE_HEIGHT: f32 = 16.0;

/// A rectangle in panel units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// X of the left edge, panel units, increasing to the right.
    pub x: f32,
    /// Y of the top edge, panel units, increasing downwards.
    pub y: f32,
    /// Width, panel units.
    pub w: f32,
    /// Height, panel units.
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

/// The outline of a panel part inside its rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A rectangle whose corners are rounded with this radius, panel units.
    Rounded(f32),
    /// The circle whose diameter is the rectangle's width.
    Round,
}

/// The kind of a panel part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartKind {
    /// The background of the panel.
    Housing,
    /// A raised plate on which keys or print are placed.
    Plate,
    /// The dark frame around the LCD.
    Bezel,
    /// The LCD's picture.
    Lcd,
    /// A lamp of the status strip, by its index in [`crate::keys::STRIP`].
    Strip(usize),
    /// A key or button, with its lamp and legend.
    Key(Key),
    /// The handwheel with its pointer.
    Handwheel,
    /// The printed name of the control model.
    Model,
    /// Printed text, centred in the part's rectangle, and its line height in panel units.
    Text(&'static str, f32),
    /// The label that the machine is simulated. Blank for a real machine.
    Emulator,
    /// The label that the machine is real. Blank for a simulated machine.
    RealMotion,
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

/// A part of the panel: its kind, and the way and position in which it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelPart {
    /// The kind of the part, with the data that it shows.
    pub what: PartKind,
    /// Position and size on the panel, panel units.
    pub rect: Rect,
    /// The outline inside the rectangle.
    pub outline: Outline,
    /// Drawing order, 0 at the bottom. Parts of one layer do not overlap.
    pub layer: u8,
    /// The colour in which the part is painted.
    pub colour: PanelColour,
}

impl PanelPart {
    /// Returns the key if the part is one, otherwise `None`.
    pub const fn key(&self) -> Option<Key> {
        match self.what {
            PartKind::Key(key) => Some(key),
            _ => None,
        }
    }

    /// Returns the rectangle of the lamp in a key, panel units; `None` if the part has no
    /// lamp.
    pub fn lamp(&self) -> Option<Rect> {
        let key = self.key()?;
        key.row().lamp?;
        let width = 18.0;
        let x = self.rect.center().0 - width / 2.0;
        Some(Rect::new(x, self.rect.y + 4.0, width, 5.0))
    }

    /// Returns the lines of the key's legend, each with its rectangle (panel units), in which
    /// it is centred and whose height is its line height. Empty if the part is not a key.
    pub fn legend(&self) -> Vec<(&'static str, Rect)> {
        let Some(key) = self.key() else {
            return Vec::new();
        };
        if matches!(
            key.row().role,
            KeyRole::EmergencyStop | KeyRole::OvertravelRelease
        ) {
            return Vec::new(); // Printed beside the button.
        }
        let lines = key.row().legend;
        let arrow = matches!(key, Key::Up | Key::Down | Key::Left | Key::Right);
        let height = match (key.row().role, lines.len()) {
            _ if arrow => 32.0,
            _ if self.colour == PanelColour::Direction && key != Key::Rapid => 21.0,
            (KeyRole::Character(..), 1) => 32.0,
            (KeyRole::Character(..), _) => 24.0,
            _ => LINE_HEIGHT,
        };
        let top = if self.lamp().is_some() { 9.0 } else { 0.0 };
        let height_left = self.rect.h - top;
        let first = self.rect.y + top + (height_left - lines.len() as f32 * height) / 2.0;
        let line_rect = |(index, line): (usize, &&'static str)| {
            let y = (first + index as f32 * height).round();
            (*line, Rect::new(self.rect.x, y, self.rect.w, height))
        };
        lines.iter().enumerate().map(line_rect).collect()
    }
}

/// Returns all parts of the panel in drawing order, the lowest layer first.
pub fn parts() -> &'static [PanelPart] {
    static PARTS: LazyLock<Vec<PanelPart>> = LazyLock::new(layout::parts);
    &PARTS
}

/// A rectangular section of the panel that is drawn with its own housing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelArea {
    /// Position and size of the section on the panel, panel units.
    pub rect: Rect,
}

impl PanelArea {
    /// The area of the whole panel.
    pub const WHOLE: Self = Self {
        rect: Rect::new(0.0, 0.0, SIZE.0, SIZE.1),
    };

    /// The sections of the panel: LCD, name plate, edit keyboard, modes, directions, spindle
    /// and start, additional panel.
    pub const SECTIONS: [Self; 7] = layout::SECTIONS;

    /// Returns whether the area contains a part completely. The housing is in every area.
    pub fn contains(&self, part: &PanelPart) -> bool {
        part.what == PartKind::Housing || self.rect.encloses(&part.rect)
    }

    /// Returns the parts in the area in drawing order. The housing is as large as the area.
    pub fn parts(self) -> impl Iterator<Item = PanelPart> {
        let held = parts().iter().filter(move |part| self.contains(part));
        held.map(move |part| PanelPart {
            rect: match part.what {
                PartKind::Housing => self.rect,
                _ => part.rect,
            },
            ..*part
        })
    }
}

/// Returns the panel part that is this key; `None` if the panel has no such key.
pub fn part_of(key: Key) -> Option<&'static PanelPart> {
    parts().iter().find(|part| part.key() == Some(key))
}

/// Returns the rectangle of the LCD on the panel, panel units.
pub const fn lcd() -> Rect {
    layout::LCD
}

/// Returns the topmost part at the point (`x`, `y`), panel units; `None` outside the panel.
pub fn part_at(x: f32, y: f32) -> Option<&'static PanelPart> {
    let hit = |part: &&PanelPart| match part.outline {
        Outline::Rounded(_) => part.rect.contains(x, y),
        Outline::Round => {
            let (cx, cy) = part.rect.center();
            (x - cx).hypot(y - cy) <= part.rect.w / 2.0
        }
    };
    parts().iter().rev().find(hit)
}

#[cfg(test)]
mod tests;
