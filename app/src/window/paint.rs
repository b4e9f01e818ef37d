//! Painting the faceplate: every part of the panel's table at the size of the
//! window, in physical pixels.

mod button;
mod wheel;

use egui::epaint::{CornerRadius, RectShape, StrokeKind};
use egui::{
    Align2, Color32, ColorImage, FontId, Painter, Pos2, Rect, Stroke, TextureHandle,
    TextureOptions, pos2, vec2,
};
use gsk_panel::faceplate::{self, Colour, LINE_HEIGHT, Outline, Part, What};
use gsk_panel::glyphs::text_columns;
use gsk_panel::keys::{Bit, Key, Role, STRIP};

use super::backdrop::Sheet;

/// The smallest legend that is still drawn, physical pixels.
const SMALLEST_TEXT: f32 = 5.0;

/// Where the panel lies in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Upper left corner of the panel, points.
    pub corner: Pos2,
    /// Points a panel unit.
    pub scale: f32,
    /// Physical pixels a point.
    pub pixels_per_point: f32,
}

impl View {
    /// The largest panel that fits into a room, in its middle, on whole pixels.
    pub fn fit(room: Rect, pixels_per_point: f32) -> Self {
        let (width, height) = faceplate::SIZE;
        let scale = (room.width() / width).min(room.height() / height).max(0.01);
        let corner = room.center() - vec2(width, height) * scale / 2.0;
        let snap = |at: f32| (at * pixels_per_point).round() / pixels_per_point;
        Self {
            corner: pos2(snap(corner.x), snap(corner.y)),
            scale,
            pixels_per_point,
        }
    }

    /// A rectangle of the panel in the window, its edges on whole pixels.
    pub fn rect(&self, rect: faceplate::Rect) -> Rect {
        let snap = |at: f32| (at * self.pixels_per_point).round() / self.pixels_per_point;
        let x = |units: f32| snap(self.corner.x + units * self.scale);
        let y = |units: f32| snap(self.corner.y + units * self.scale);
        Rect::from_min_max(
            pos2(x(rect.x), y(rect.y)),
            pos2(x(rect.x + rect.w), y(rect.y + rect.h)),
        )
    }

    /// A place of the window in panel units.
    pub fn units(&self, at: Pos2) -> (f32, f32) {
        let way = (at - self.corner) / self.scale;
        (way.x, way.y)
    }

    /// A length of the panel in points.
    pub fn length(&self, units: f32) -> f32 {
        units * self.scale
    }
}

/// What changes on the panel.
pub struct Look<'a> {
    /// The Y memory: lamps.
    pub y: &'a [u8],
    /// Whether a key is down.
    pub pressed: &'a dyn Fn(Key) -> bool,
    /// Position of the handwheel, graduations.
    pub wheel: i32,
}

/// The keys and the wheel that are not as the picture with every key up shows
/// them.
fn differs(part: &Part, look: &Look<'_>) -> bool {
    match part.what {
        What::Key(key) => (look.pressed)(key),
        What::Handwheel => look.wheel.rem_euclid(wheel::GRADUATIONS) != 0,
        _ => false,
    }
}

/// Paints the panel.
pub struct Faceplate<'a> {
    painter: &'a Painter,
    view: View,
    shade: egui::TextureId,
}

/// The shade from light to dark that gives keys and plates their depth.
#[derive(Default)]
pub struct Shade(Option<TextureHandle>);

impl Shade {
    /// The texture; made at the first call.
    pub fn texture(&mut self, context: &egui::Context) -> egui::TextureId {
        let handle = self.0.get_or_insert_with(|| {
            let pixels = (0..64u8)
                .map(|step| Color32::from_gray(255 - step))
                .collect();
            context.load_texture(
                "shade",
                ColorImage::new([1, 64], pixels),
                TextureOptions::LINEAR,
            )
        });
        handle.id()
    }
}

impl<'a> Faceplate<'a> {
    /// A painter for one picture.
    pub const fn new(painter: &'a Painter, view: View, shade: egui::TextureId) -> Self {
        Self {
            painter,
            view,
            shade,
        }
    }

    /// Paints one part; the LCD's picture is drawn by its owner.
    pub fn part(&self, part: &Part, look: &Look<'_>) {
        let rect = self.view.rect(part.rect);
        match part.what {
            What::Housing => {
                self.shaded(rect, part.outline, lighter(part.colour.rgb(), 0.10));
                self.frame(rect, part.outline, faint(255, 0.25));
            }
            What::Plate => {
                self.shaded(rect, part.outline, lighter(part.colour.rgb(), 0.02));
                self.frame(rect, part.outline, faint(0, 0.40));
            }
            What::Bezel => {
                self.shaded(rect, part.outline, part.colour.rgb());
                self.frame(rect, part.outline, faint(0, 0.6));
            }
            What::Lcd => {
                let around = rect.expand(self.view.length(2.0));
                self.flat(around, Outline::Rounded(2.0), faint(0, 0.9));
                self.flat(rect, part.outline, opaque(part.colour.rgb()));
            }
            What::Strip(index) => self.strip(part, index, look),
            What::Key(key) => self.key(part, key, look),
            What::Handwheel => self.handwheel(part, look.wheel),
            What::Text(text, size) => self.text(text, size, rect, opaque(part.colour.rgb())),
        }
    }

    /// Paints what a part adds to the picture with every key up: a key that is
    /// down, a lamp that is on, a turned wheel.
    pub fn change(&self, part: &Part, look: &Look<'_>, down: Option<&Sheet>) {
        let differs = differs(part, look);
        match (part.what, down) {
            (What::Key(key), Some(down)) => {
                if differs {
                    down.paint_part(self.painter, self.view, around(part.rect));
                }
                self.key_lamp(part, key, look);
            }
            (What::Key(key), None) if !differs => self.key_lamp(part, key, look),
            (What::Strip(index), _) => self.strip_lamp(part, index, look),
            _ if differs => self.part(part, look),
            _ => {}
        }
    }

    /// The lamp of a key, if it is on.
    fn key_lamp(&self, part: &Part, key: Key, look: &Look<'_>) {
        if let (Some(lamp), Some(bit)) = (part.lamp(), key.row().lamp)
            && bit.of(look.y)
        {
            let sunk = if (look.pressed)(key) { 2.0 } else { 0.0 };
            let lamp = faceplate::Rect {
                y: lamp.y + sunk,
                ..lamp
            };
            let colour = lamp_colour(bit, Some(key), look.y);
            self.bulb(self.view.rect(lamp), Outline::Rounded(2.5), colour);
        }
    }

    /// A lamp of the strip, if it is on.
    fn strip_lamp(&self, part: &Part, index: usize, look: &Look<'_>) {
        if let Some(lamp) = STRIP.get(index)
            && lamp.fitted
            && lamp.lamp.of(look.y)
        {
            let (x, middle) = (part.rect.x + 13.0, part.rect.center().1);
            let bulb = self.view.rect(faceplate::Rect::around(x, middle, 10.0));
            self.bulb(bulb, Outline::Round, lamp_colour(lamp.lamp, None, look.y));
        }
    }

    fn strip(&self, part: &Part, index: usize, look: &Look<'_>) {
        let Some(lamp) = STRIP.get(index) else { return };
        let (x, middle) = (part.rect.x + 13.0, part.rect.center().1);
        if !lamp.fitted {
            return;
        }
        let bulb = self.view.rect(faceplate::Rect::around(x, middle, 11.0));
        self.bulb(bulb, Outline::Round, lamp_colour(lamp.lamp, None, look.y));
        let width = text_columns(lamp.label) as f32 * LINE_HEIGHT / 2.0;
        let label = faceplate::Rect::new(part.rect.x + 22.0, part.rect.y, width, part.rect.h);
        let ink = opaque(part.colour.rgb());
        self.text(lamp.label, LINE_HEIGHT, self.view.rect(label), ink);
    }

    /// A lamp with its setting, and its glow when it is on.
    fn bulb(&self, rect: Rect, outline: Outline, colour: Colour) {
        if colour != Colour::LampOff {
            for (reach, strength) in [(4.0, 0.16), (2.0, 0.26)] {
                let around = rect.expand(self.view.length(reach));
                let outline = match outline {
                    Outline::Rounded(radius) => Outline::Rounded(radius + reach),
                    Outline::Round => Outline::Round,
                };
                self.flat(around, outline, with_alpha(colour.rgb(), strength));
            }
        }
        self.flat(rect, outline, opaque(colour.rgb()));
        self.frame(rect, outline, faint(0, 0.5));
    }

    fn key(&self, part: &Part, key: Key, look: &Look<'_>) {
        let down = (look.pressed)(key);
        match key.row().role {
            Role::EmergencyStop => return self.mushroom(part, down),
            Role::OvertravelRelease => return self.round_button(part, down),
            _ => {}
        }
        let base = part.colour.rgb();
        let rect = self.view.rect(part.rect);
        let pixel = 1.0 / self.view.pixels_per_point;
        let travel = self.view.length(3.0).max(pixel);
        self.flat(
            rect.expand(self.view.length(1.5)),
            Outline::Rounded(7.0),
            faint(0, 0.3),
        );
        self.flat(rect, part.outline, opaque(lighter(base, -0.42)));
        let sunk = if down {
            self.view.length(2.0).max(pixel)
        } else {
            0.0
        };
        let mut cap = rect;
        cap.max.y -= travel;
        cap = cap.translate(vec2(0.0, sunk));
        let light = if down { -0.14 } else { 0.14 };
        self.shaded(cap, part.outline, lighter(base, light));
        self.frame(cap, part.outline, faint(255, if down { 0.1 } else { 0.3 }));
        if let (Some(lamp), Some(bit)) = (part.lamp(), key.row().lamp) {
            let lamp = self.view.rect(lamp).translate(vec2(0.0, sunk));
            self.bulb(
                lamp,
                Outline::Rounded(2.5),
                lamp_colour(bit, Some(key), look.y),
            );
        }
        let fitted = !matches!(key, Key::YMinus | Key::YPlus | Key::WheelY);
        let ink = if fitted {
            opaque(part.colour.ink())
        } else {
            opaque(lighter(base, -0.30))
        };
        for (line, place) in part.legend() {
            // Larger single letters, as the panel's own painter has them.
            let height = LINE_HEIGHT + (place.h - LINE_HEIGHT) * 0.6;
            let place = self
                .view
                .rect(place)
                .translate(vec2(0.0, sunk - self.view.length(1.0)));
            self.text(line, height, place, ink);
        }
    }

    /// Writes a text centred in a rectangle; `size` is the line height in panel
    /// units.
    fn text(&self, text: &str, size: f32, rect: Rect, ink: Color32) {
        let points = self.view.length(size);
        if points * self.view.pixels_per_point < SMALLEST_TEXT {
            return;
        }
        // Legends are Unifont where Chinese is among them; pure Latin in the
        // proportional font looks larger at the same size.
        let latin = text.is_ascii();
        let font = FontId::proportional(if latin { points * 0.95 } else { points });
        let galley = self.painter.layout_no_wrap(text.to_owned(), font, ink);
        let room = rect.width() * 0.96;
        let galley = if galley.size().x > room && room > 0.0 {
            let size = points * room / galley.size().x;
            self.painter
                .layout_no_wrap(text.to_owned(), FontId::proportional(size), ink)
        } else {
            galley
        };
        let place = Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size());
        let snap = |at: f32| (at * self.view.pixels_per_point).round() / self.view.pixels_per_point;
        self.painter
            .galley(pos2(snap(place.min.x), snap(place.min.y)), galley, ink);
    }

    fn corners(&self, rect: Rect, outline: Outline) -> f32 {
        match outline {
            Outline::Rounded(radius) => self.view.length(radius),
            Outline::Round => rect.width() / 2.0,
        }
    }

    fn flat(&self, rect: Rect, outline: Outline, colour: Color32) {
        if outline == Outline::Round {
            self.painter
                .circle_filled(rect.center(), rect.width() / 2.0, colour);
            return;
        }
        self.painter
            .rect_filled(rect, self.corners(rect, outline), colour);
    }

    /// Filled with a colour that darkens towards the bottom.
    fn shaded(&self, rect: Rect, outline: Outline, top: [u8; 3]) {
        let corners = CornerRadius::same(self.corners(rect, outline).clamp(0.0, 255.0) as u8);
        let shape = RectShape::filled(rect, corners, opaque(top));
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        self.painter.add(shape.with_texture(self.shade, whole));
    }

    fn frame(&self, rect: Rect, outline: Outline, colour: Color32) {
        let stroke = Stroke::new(
            self.view.length(1.0).max(1.0 / self.view.pixels_per_point),
            colour,
        );
        if outline == Outline::Round {
            self.painter
                .circle_stroke(rect.center(), rect.width() / 2.0, stroke);
            return;
        }
        self.painter.rect_stroke(
            rect,
            self.corners(rect, outline),
            stroke,
            StrokeKind::Inside,
        );
    }
}

/// A part with its shadow.
const fn around(rect: faceplate::Rect) -> faceplate::Rect {
    let reach = 2.0;
    faceplate::Rect::new(
        rect.x - reach,
        rect.y - reach,
        rect.w + 2.0 * reach,
        rect.h + 2.0 * reach,
    )
}

fn lamp_colour(bit: Bit, key: Option<Key>, y: &[u8]) -> Colour {
    match (bit.of(y), key) {
        (false, _) => Colour::LampOff,
        (true, Some(Key::FeedHold)) => Colour::LampHold,
        (true, _) => Colour::LampOn,
    }
}

/// A colour made lighter (towards white) or darker (towards black).
fn lighter(colour: [u8; 3], by: f32) -> [u8; 3] {
    let target = if by > 0.0 { 255.0 } else { 0.0 };
    colour.map(|part| (f32::from(part) + (target - f32::from(part)) * by.abs()) as u8)
}

const fn opaque([red, green, blue]: [u8; 3]) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

fn faint(grey: u8, alpha: f32) -> Color32 {
    with_alpha([grey; 3], alpha)
}

fn with_alpha([red, green, blue]: [u8; 3], alpha: f32) -> Color32 {
    Color32::from_rgba_unmultiplied(red, green, blue, (alpha * 255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_panel_fits_and_stands_in_the_middle() {
        for (width, height) in [
            (1280.0, 756.0),
            (640.0, 480.0),
            (400.0, 900.0),
            (3840.0, 800.0),
        ] {
            let room = Rect::from_min_size(pos2(0.0, 26.0), vec2(width, height));
            let view = View::fit(room, 2.0);
            let (w, h) = faceplate::SIZE;
            let whole = view.rect(faceplate::Rect::new(0.0, 0.0, w, h));
            assert!(room.expand(0.51).contains_rect(whole), "{whole:?}");
            assert!((whole.center() - room.center()).length() < 1.0);
            let (x, y) = view.units(whole.center());
            assert!((x - w / 2.0).abs() < 2.0 && (y - h / 2.0).abs() < 2.0);
        }
    }
}
