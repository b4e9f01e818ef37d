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

pub use paint::{FaceState, LcdGlass, paint, paint_part, part_state};
pub use tiny_skia::Pixmap;

use gsk_core::model::ModelId;

pub use crate::face::{PanelColour, Rect};

use crate::face::face_of;
use crate::keys::{Key, KeyRole};

/// Width and height of the panel in panel units.
pub const SIZE: (f32, f32) = (1280.0, 756.0);

/// Least width of the glass around the picture of the LCD, panel units: four dots.
pub const GLASS_MARGIN: f32 = 8.0;

/// Line height of a legend, panel units: one Unifont cell at scale 1.
pub(crate) const LINE_HEIGHT: f32 = 16.0;

/// The outline of a panel part inside its rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A rectangle whose corners are rounded with this radius, panel units.
    Rounded(f32),
    /// The outline is a circle whose diameter is the rectangle's width.
    Round,
}

/// The kind of a panel part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartKind {
    /// The part is the background of the panel.
    Housing,
    /// The part is a raised plate on which keys or print are placed.
    Plate,
    /// The part is the dark frame around the LCD.
    Bezel,
    /// The part is the picture of the LCD.
    Lcd,
    /// A lamp of the status strip, by its index in [`crate::keys::STRIP`].
    Strip(usize),
    /// The part is a key or button, with its lamp and legend.
    Key(Key),
    /// The part is the handwheel with its pointer.
    Handwheel,
    /// The part is the printed name of the control model.
    Model,
    /// Printed text, centred in the part's rectangle, and its line height in panel units.
    Text(&'static str, f32),
    /// The label that the machine is simulated. Blank for a real machine.
    Emulator,
    /// The label that the machine is real. Blank for a simulated machine.
    RealMotion,
}

/// A part of the panel: its kind, and the way and position in which it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelPart {
    /// The kind of the part, with the data that it shows.
    pub what: PartKind,
    /// Position and size of the part on the panel, panel units.
    pub rect: Rect,
    /// The outline of the part inside its rectangle.
    pub outline: Outline,
    /// Drawing order, 0 at the bottom. Parts of one layer do not overlap.
    pub layer: u8,
    /// The colour in which the part is painted.
    pub colour: PanelColour,
    /// The lines printed on a key, from the top; empty for other parts.
    pub print: &'static [&'static str],
}

impl PanelPart {
    /// Returns the key if the part is a key, otherwise `None`.
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
        let lines = self.print;
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

/// Returns all parts of a model's panel in drawing order, the lowest layer first.
pub fn parts(model: ModelId) -> &'static [PanelPart] {
    // Each is laid out at its first use: a run normally has one model.
    static PARTS: [LazyLock<Vec<PanelPart>>; 4] = [
        LazyLock::new(|| layout::parts(face_of(ModelId::Gsk980td))),
        LazyLock::new(|| layout::parts(face_of(ModelId::Gsk980mdi))),
        LazyLock::new(|| layout::parts(face_of(ModelId::Hx31))),
        LazyLock::new(|| layout::parts(face_of(ModelId::Ncb08))),
    ];
    &PARTS[model as usize]
}

/// A rectangular section of the panel that is drawn with its own housing. It can be stretched:
/// plates and keys then grow, legends, LCD and round parts keep their proportions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelArea {
    /// Position and size of the section on the panel before it is stretched, panel units.
    pub rect: Rect,
    /// Factors by which the section is wider and higher than its rectangle, from its upper left
    /// corner; at least 1.
    pub stretch: (f32, f32),
}

impl PanelArea {
    /// The area that covers the whole panel.
    pub const WHOLE: Self = Self::new(Rect::new(0.0, 0.0, SIZE.0, SIZE.1));

    /// The sections of the panel: LCD, name plate, edit keyboard, modes, directions, spindle
    /// and start, additional panel.
    pub const SECTIONS: [Self; 7] = layout::SECTIONS;

    /// Creates an area that is not stretched.
    pub const fn new(rect: Rect) -> Self {
        Self {
            rect,
            stretch: (1.0, 1.0),
        }
    }

    /// Returns the rectangle of the stretched area, panel units.
    pub const fn bounds(&self) -> Rect {
        let Rect { x, y, w, h } = self.rect;
        Rect::new(x, y, w * self.stretch.0, h * self.stretch.1)
    }

    /// Returns whether the area contains a part completely. The housing is in every area.
    pub fn contains(&self, part: &PanelPart) -> bool {
        part.what == PartKind::Housing || self.rect.encloses(&part.rect)
    }

    /// Returns the rectangle of a part in the stretched area, panel units.
    pub fn stretched_rect(&self, part: &PanelPart) -> Rect {
        let (along, up) = self.stretch;
        let Rect { x, y, w, h } = part.rect;
        let left = self.rect.x + (x - self.rect.x) * along;
        let top = self.rect.y + (y - self.rect.y) * up;
        let stretched = Rect::new(left, top, w * along, h * up);
        let around_center = |w: f32, h: f32| {
            let (x, y) = stretched.center();
            Rect::new(x - w / 2.0, y - h / 2.0, w, h)
        };
        match (part.what, part.outline) {
            (PartKind::Housing, _) => self.bounds(),
            (PartKind::Lcd, _) => around_center(w, h),
            (_, Outline::Round) => around_center(w * along.min(up), h * along.min(up)),
            _ => stretched,
        }
    }

    /// Returns the parts of a model's panel in the area in drawing order, stretched. The housing
    /// is as large as the area.
    pub fn parts(self, model: ModelId) -> impl Iterator<Item = PanelPart> {
        let held = parts(model).iter().filter(move |part| self.contains(part));
        held.map(move |part| PanelPart {
            rect: self.stretched_rect(part),
            ..*part
        })
    }

    /// Returns the topmost part of a model's panel at the point (`x`, `y`) of the stretched area,
    /// panel units; `None` outside the area.
    pub fn part_at(&self, model: ModelId, x: f32, y: f32) -> Option<&'static PanelPart> {
        let hit = |part: &&PanelPart| {
            let rect = self.stretched_rect(part);
            self.contains(part)
                && match part.outline {
                    Outline::Rounded(_) => rect.contains(x, y),
                    Outline::Round => {
                        let (cx, cy) = rect.center();
                        (x - cx).hypot(y - cy) <= rect.w / 2.0
                    }
                }
        };
        parts(model).iter().rev().find(hit)
    }
}

/// Returns the part of a model's panel that is this key; `None` if it has no such key.
pub fn part_of(model: ModelId, key: Key) -> Option<&'static PanelPart> {
    parts(model).iter().find(|part| part.key() == Some(key))
}

/// Returns the part of the panel that is the LCD; `None` on a panel without one.
pub fn lcd_part(model: ModelId) -> Option<&'static PanelPart> {
    let mut parts = parts(model).iter();
    parts.find(|part| part.what == PartKind::Lcd)
}

/// Returns the part of the panel that is the frame of the LCD; `None` on a panel without one.
pub fn frame_part(model: ModelId) -> Option<&'static PanelPart> {
    let mut parts = parts(model).iter();
    parts.find(|part| part.what == PartKind::Bezel)
}

/// Returns the width of the frame of the LCD: the same at all four sides, where the frame is
/// stretched more in one direction too. `frame` and `picture` are the sizes of the frame and of
/// the picture, in any unit.
pub fn frame_width(frame: (f32, f32), picture: (f32, f32)) -> f32 {
    let margin = ((frame.0 - picture.0) / 2.0).min((frame.1 - picture.1) / 2.0);
    margin - GLASS_MARGIN * picture.0 / lcd().w
}

/// Returns the rectangle of the picture of the LCD on the panel, panel units.
pub const fn lcd() -> Rect {
    layout::LCD
}

#[cfg(test)]
mod tests;
