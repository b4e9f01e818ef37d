//! Paints the panel, or a part of it, for the window, `screen --panel` and the documentation.

mod additional;

use gsk_core::model::ModelId;
use gsk_messages::{Language, say};
use tiny_skia::{
    Color, FillRule, FilterQuality, GradientStop, IntRect, LinearGradient, Paint, Path,
    PathBuilder, Pixmap, PixmapPaint, PixmapRef, Point, RadialGradient, Shader, SpreadMode, Stroke,
    Transform,
};

use super::layout::{LAMP_NAME_HEIGHT, LAMP_NAME_LEFT, LCD, PLATE_PRINT};
use super::text::{draw, opaque, width};
use super::{Outline, PanelArea, PanelColour, PanelPart, PartKind, Rect, frame_width};
use crate::keys::{Bit, Key, KeyRole, STRIP, StripLamp};
use additional::GRADUATIONS;

/// Both languages, in which the panel is printed.
const BOTH: [Language; 2] = [Language::Zh, Language::En];

/// Line height of the control's name on the name plate, panel units.
const NAME_SIZE: f32 = 32.0;

/// Line height below which the label that the machine is simulated is left out, pixels.
const MIN_PRINT_HEIGHT: f32 = 9.0;

/// Greatest `scale` of [`paint`], pixels per panel unit.
const MAX_SCALE: f32 = 8.0;
/// Distance that a part paints beyond its rectangle (shadow, glow), panel units.
const REACH: f32 = 3.0;
const REACH_OF_WHEEL: f32 = 8.0;
/// Margin painted around a section of the picture and cut off, pixels.
const MARGIN: u32 = 4;

/// The state of the panel that a picture shows: lamps, keys, LCD, handwheel.
#[derive(Clone, Copy, Default)]
pub struct FaceState<'a> {
    /// The Y memory of the PLC, whose bits light the lamps.
    pub y: &'a [u8],
    /// Keys drawn as pressed: those held down, and the mushroom button while it is latched.
    pub pressed: &'a [Key],
    /// The picture of the LCD; `None` draws the LCD dark.
    pub lcd: Option<LcdGlass<'a>>,
    /// Position of the handwheel, graduations, clockwise positive.
    pub wheel: i32,
    /// Whether the keys move a real machine; the panel then shows the label that says it.
    pub real: bool,
    /// The control model, whose name is printed on the name plate.
    pub model: ModelId,
}

/// What the LCD shows: its dots and the glass around them.
#[derive(Clone, Copy)]
pub struct LcdGlass<'a> {
    /// The dots, 320x240 or an integer multiple.
    pub dots: PixmapRef<'a>,
    /// Colour of the glass around the dots.
    pub ground: [u8; 3],
}

/// Returns a value that changes whenever the picture of `part` changes, so that unchanged
/// parts need no repainting.
pub fn part_state(part: &PanelPart, state: &FaceState<'_>) -> u32 {
    match part.what {
        PartKind::Key(key) => {
            let lit = key.row().lamp.is_some_and(|bit| bit.is_set_in(state.y));
            u32::from(lit) << 1 | u32::from(state.pressed.contains(&key))
        }
        PartKind::Strip(index) => {
            let lit = |lamp: &StripLamp| lamp.fitted && lamp.lamp.is_set_in(state.y);
            u32::from(STRIP.get(index).is_some_and(lit))
        }
        PartKind::Handwheel => state.wheel.rem_euclid(GRADUATIONS).unsigned_abs(),
        PartKind::Emulator | PartKind::RealMotion => u32::from(state.real),
        PartKind::Model => state.model as u32,
        _ => 0,
    }
}

/// Paints an area of the panel at `scale` pixels a panel unit. Returns `None` if the picture
/// does not fit into memory.
pub fn paint(area: PanelArea, state: &FaceState<'_>, scale: f32) -> Option<Pixmap> {
    let scale = scale.clamp(0.1, MAX_SCALE);
    let size = |units: f32| (units * scale).round() as u32;
    let mut painter = Painter {
        pixmap: Pixmap::new(size(area.bounds().w), size(area.bounds().h))?,
        scale,
        corner: corner(area, scale),
    };
    for part in area.parts(state.model) {
        painter.part(&part, state);
    }
    Some(painter.pixmap)
}

/// Paints the rectangle of [`paint`]'s picture that contains `part`. Returns it and its upper
/// left corner in that picture, pixels; `None` if it does not fit into memory.
pub fn paint_part(
    area: PanelArea,
    part: &PanelPart,
    state: &FaceState<'_>,
    scale: f32,
) -> Option<(Pixmap, [u32; 2])> {
    let scale = scale.clamp(0.1, MAX_SCALE);
    let available = painted_rect(part);
    let first = |units: f32| (units * scale).floor();
    let end = |units: f32| (units * scale).ceil();
    let (left, top) = (first(available.x), first(available.y));
    let width = (end(available.x + available.w) - left) as u32;
    let height = (end(available.y + available.h) - top) as u32;
    // Outlines that cross the edge of a pixmap are drawn wrongly there.
    let mut painter = Painter {
        pixmap: Pixmap::new(width + 2 * MARGIN, height + 2 * MARGIN)?,
        scale,
        corner: (left - MARGIN as f32, top - MARGIN as f32),
    };
    for other in area.parts(state.model) {
        if painted_rect(&other).overlaps(&available) {
            painter.part(&other, state);
        }
    }
    let margin = MARGIN as i32;
    let inside = IntRect::from_xywh(margin, margin, width, height)?;
    let section = painter.pixmap.clone_rect(inside)?;
    let (x, y) = corner(area, scale);
    Some((section, [(left - x) as u32, (top - y) as u32]))
}

/// Returns the pixel of the whole panel's picture where the picture of an area begins.
fn corner(area: PanelArea, scale: f32) -> (f32, f32) {
    ((area.rect.x * scale).round(), (area.rect.y * scale).round())
}

fn painted_rect(part: &PanelPart) -> Rect {
    let reach = match part.what {
        PartKind::Handwheel => REACH_OF_WHEEL,
        _ => REACH,
    };
    inset(part.rect, -reach)
}

struct Painter {
    pixmap: Pixmap,
    scale: f32,
    /// The pixel of the whole panel's picture that is the pixmap's upper left corner.
    corner: (f32, f32),
}

impl Painter {
    /// Returns the transform from panel units to pixels of the pixmap.
    fn transform(&self) -> Transform {
        let (left, top) = self.corner;
        Transform::from_row(self.scale, 0.0, 0.0, self.scale, -left, -top)
    }

    fn part(&mut self, part: &PanelPart, state: &FaceState<'_>) {
        match part.what {
            PartKind::Housing => self.housing(part),
            PartKind::Plate => self.plate(part),
            PartKind::Bezel => self.bezel(part, state.lcd),
            PartKind::Lcd => self.lcd(part, state.lcd),
            PartKind::Strip(index) => self.strip_lamp(part, index, state.y),
            PartKind::Key(key) => self.key(part, key, state),
            PartKind::Handwheel => self.handwheel(part, state.wheel),
            PartKind::Text(text, size) => self.text(text, size, part.rect, part.colour.rgb()),
            PartKind::Model => {
                let name = state.model.plate_name();
                let available = part.rect.w;
                // A long name is smaller.
                let size = NAME_SIZE * (available / width(name, NAME_SIZE)).min(1.0);
                self.text(name, size, part.rect, part.colour.rgb());
            }
            PartKind::Emulator if !state.real && PLATE_PRINT * self.scale >= MIN_PRINT_HEIGHT => {
                let text = BOTH.map(|language| say::panel_emulator().text(language));
                self.text(&text.join("  "), PLATE_PRINT, part.rect, part.colour.rgb());
            }
            PartKind::RealMotion if state.real => self.real_motion(part),
            PartKind::Emulator | PartKind::RealMotion => {}
        }
    }

    fn text(&mut self, text: &str, size: f32, rect: Rect, ink: [u8; 3]) {
        draw(
            &mut self.pixmap,
            self.corner,
            self.scale,
            text,
            size,
            rect,
            ink,
        );
    }

    /// Paints the label that the machine is real: a red plate with white print.
    fn real_motion(&mut self, part: &PanelPart) {
        let Rect { x, y, w, h } = part.rect;
        if let Some(path) = outline(part.rect, part.outline) {
            self.fill_flat(&path, opaque(part.colour.rgb()));
            self.line(&path, faint(255, 0.8), 1.5);
        }
        let texts = BOTH.map(|language| say::window_real_motion().text(language));
        for (line, text) in texts.iter().enumerate() {
            let half = Rect::new(x, y + line as f32 * h / 2.0, w, h / 2.0);
            self.text(text, h / 2.0, half, part.colour.ink());
        }
    }

    fn fill(&mut self, path: &Path, shader: Shader<'_>) {
        let paint = Paint {
            shader,
            anti_alias: true,
            ..Paint::default()
        };
        let transform = self.transform();
        self.pixmap
            .fill_path(path, &paint, FillRule::Winding, transform, None);
    }

    fn fill_flat(&mut self, path: &Path, colour: Color) {
        self.fill(path, Shader::SolidColor(colour));
    }

    fn line(&mut self, path: &Path, colour: Color, width: f32) {
        let paint = Paint {
            shader: Shader::SolidColor(colour),
            anti_alias: true,
            ..Paint::default()
        };
        let stroke = Stroke {
            width,
            ..Stroke::default()
        };
        let transform = self.transform();
        self.pixmap
            .stroke_path(path, &paint, &stroke, transform, None);
    }

    fn housing(&mut self, part: &PanelPart) {
        let base = part.colour.rgb();
        let Some(path) = outline(part.rect, part.outline) else {
            return;
        };
        self.fill(
            &path,
            vertical(part.rect, lighter(base, 0.10), lighter(base, -0.14)),
        );
        let inner = inset(part.rect, 1.0);
        if let Some(path) = outline(inner, part.outline) {
            self.line(&path, faint(255, 0.22), 1.5);
        }
    }

    fn plate(&mut self, part: &PanelPart) {
        let base = part.colour.rgb();
        let shade = Rect {
            y: part.rect.y + 1.0,
            ..part.rect
        };
        if let Some(path) = outline(shade, part.outline) {
            self.fill_flat(&path, faint(255, 0.20));
        }
        if let Some(path) = outline(part.rect, part.outline) {
            self.fill(
                &path,
                vertical(part.rect, lighter(base, -0.08), lighter(base, 0.04)),
            );
            self.line(&path, faint(0, 0.35), 1.0);
        }
    }

    /// Paints the frame of the LCD and the glass in it.
    fn bezel(&mut self, part: &PanelPart, picture: Option<LcdGlass<'_>>) {
        let base = part.colour.rgb();
        if let Some(path) = outline(part.rect, part.outline) {
            self.fill(
                &path,
                vertical(part.rect, lighter(base, -0.2), lighter(base, 0.12)),
            );
            self.line(&path, faint(0, 0.5), 1.5);
        }
        let width = frame_width((part.rect.w, part.rect.h), (LCD.w, LCD.h));
        let glass = inset(part.rect, width);
        if let Some(path) = outline(inset(glass, -2.0), Outline::Rounded(2.0)) {
            self.fill_flat(&path, faint(0, 0.9));
        }
        let ground = picture.map_or(PanelColour::Lcd.rgb(), |picture| picture.ground);
        if let Some(path) = outline(glass, Outline::Rounded(0.0)) {
            self.fill_flat(&path, opaque(ground));
        }
    }

    fn lcd(&mut self, part: &PanelPart, picture: Option<LcdGlass<'_>>) {
        let Some(LcdGlass { dots: picture, .. }) = picture else {
            return;
        };
        let zoom = part.rect.w * self.scale / picture.width() as f32;
        let paint = PixmapPaint {
            quality: if zoom.fract() == 0.0 {
                FilterQuality::Nearest
            } else {
                FilterQuality::Bilinear
            },
            ..PixmapPaint::default()
        };
        let x = part.rect.x * self.scale - self.corner.0;
        let y = part.rect.y * self.scale - self.corner.1;
        let transform = Transform::from_row(zoom, 0.0, 0.0, zoom, x, y);
        self.pixmap
            .draw_pixmap(0, 0, picture, &paint, transform, None);
    }

    fn strip_lamp(&mut self, part: &PanelPart, index: usize, y: &[u8]) {
        let Some(lamp) = STRIP.get(index) else {
            return;
        };
        if !lamp.fitted {
            return;
        }
        let wide = width(lamp.label, LAMP_NAME_HEIGHT);
        let margin = (part.rect.w - LAMP_NAME_LEFT - wide).max(0.0) / 2.0;
        let (x, middle) = (part.rect.x + margin + 9.0, part.rect.center().1);
        let bulb = Rect::around(x, middle, 11.0);
        self.bulb(bulb, Outline::Round, lamp_colour(lamp.lamp, None, y));
        let left = part.rect.x + margin + LAMP_NAME_LEFT;
        let label = Rect::new(left, part.rect.y, wide, part.rect.h);
        self.text(lamp.label, LAMP_NAME_HEIGHT, label, part.colour.rgb());
    }

    /// Paints a lamp in a colour, with a glow when it is lit.
    fn bulb(&mut self, rect: Rect, shape: Outline, colour: PanelColour) {
        if colour != PanelColour::LampOff {
            for (reach, strength) in [(4.0, 0.14), (2.0, 0.22)] {
                let shape = match shape {
                    Outline::Rounded(radius) => Outline::Rounded(radius + reach),
                    Outline::Round => Outline::Round,
                };
                if let Some(path) = outline(inset(rect, -reach), shape) {
                    self.fill_flat(&path, with_alpha(colour.rgb(), strength));
                }
            }
        }
        if let Some(path) = outline(rect, shape) {
            let base = colour.rgb();
            self.fill(
                &path,
                vertical(rect, lighter(base, 0.18), lighter(base, -0.12)),
            );
            self.line(&path, faint(0, 0.45), 0.8);
        }
    }

    fn key(&mut self, part: &PanelPart, key: Key, state: &FaceState<'_>) {
        let down = state.pressed.contains(&key);
        match key.row().role {
            KeyRole::EmergencyStop => return self.mushroom(part, down),
            KeyRole::OvertravelRelease => return self.round_button(part, down),
            _ => {}
        }
        let base = part.colour.rgb();
        let sunk = if down { 2.0 } else { 0.0 };
        let cap = Rect {
            y: part.rect.y + sunk,
            h: part.rect.h - 3.0,
            ..part.rect
        };
        if let Some(path) = outline(inset(part.rect, -1.5), Outline::Rounded(7.0)) {
            self.fill_flat(&path, faint(0, 0.30));
        }
        if let Some(path) = outline(part.rect, part.outline) {
            self.fill_flat(&path, opaque(lighter(base, -0.42)));
        }
        let (top, bottom) = if down { (-0.14, -0.06) } else { (0.16, -0.07) };
        if let Some(path) = outline(cap, part.outline) {
            self.fill(
                &path,
                vertical(cap, lighter(base, top), lighter(base, bottom)),
            );
        }
        if let Some(path) = outline(inset(cap, 1.0), Outline::Rounded(5.0)) {
            self.line(&path, faint(255, if down { 0.10 } else { 0.34 }), 1.0);
        }
        if let (Some(lamp), Some(bit)) = (part.lamp(), key.row().lamp) {
            let lamp = Rect {
                y: lamp.y + sunk,
                ..lamp
            };
            self.bulb(
                lamp,
                Outline::Rounded(2.5),
                lamp_colour(bit, Some(key), state.y),
            );
        }
        let fitted = !matches!(key, Key::YMinus | Key::YPlus | Key::WheelY);
        let ink = if fitted {
            part.colour.ink()
        } else {
            lighter(base, -0.30)
        };
        for (line, rect) in part.legend() {
            let rect = Rect {
                y: rect.y + sunk - 1.0,
                ..rect
            };
            self.text(line, rect.h, rect, ink);
        }
    }
}

fn lamp_colour(bit: Bit, key: Option<Key>, y: &[u8]) -> PanelColour {
    match (bit.is_set_in(y), key) {
        (false, _) => PanelColour::LampOff,
        (true, Some(Key::FeedHold)) => PanelColour::LampHold,
        (true, _) => PanelColour::LampOn,
    }
}

fn inset(rect: Rect, by: f32) -> Rect {
    Rect::new(
        rect.x + by,
        rect.y + by,
        rect.w - 2.0 * by,
        rect.h - 2.0 * by,
    )
}

fn circle(x: f32, y: f32, radius: f32) -> Option<Path> {
    PathBuilder::from_circle(x, y, radius)
}

fn outline(rect: Rect, shape: Outline) -> Option<Path> {
    let Outline::Rounded(radius) = shape else {
        let (x, y) = rect.center();
        return circle(x, y, rect.w / 2.0);
    };
    let Rect { x, y, w, h } = rect;
    let r = radius.min(w / 2.0).min(h / 2.0).max(0.0);
    // A quarter of a circle as a cubic Bézier curve.
    let c = r * (1.0 - 0.552_285);
    let mut path = PathBuilder::new();
    path.move_to(x + r, y);
    path.line_to(x + w - r, y);
    path.cubic_to(x + w - c, y, x + w, y + c, x + w, y + r);
    path.line_to(x + w, y + h - r);
    path.cubic_to(x + w, y + h - c, x + w - c, y + h, x + w - r, y + h);
    path.line_to(x + r, y + h);
    path.cubic_to(x + c, y + h, x, y + h - c, x, y + h - r);
    path.line_to(x, y + r);
    path.cubic_to(x, y + c, x + c, y, x + r, y);
    path.close();
    path.finish()
}

/// Returns a colour mixed with white (`by` from 0 to 1) or with black (`by` from 0 to -1).
fn lighter(colour: [u8; 3], by: f32) -> [u8; 3] {
    let target = if by > 0.0 { 255.0 } else { 0.0 };
    colour.map(|part| (f32::from(part) + (target - f32::from(part)) * by.abs()) as u8)
}

fn faint(grey: u8, alpha: f32) -> Color {
    with_alpha([grey; 3], alpha)
}

fn with_alpha([red, green, blue]: [u8; 3], alpha: f32) -> Color {
    Color::from_rgba8(red, green, blue, (alpha * 255.0) as u8)
}

fn stops(from: [u8; 3], to: [u8; 3]) -> Vec<GradientStop> {
    vec![
        GradientStop::new(0.0, opaque(from)),
        GradientStop::new(1.0, opaque(to)),
    ]
}

fn vertical(rect: Rect, top: [u8; 3], bottom: [u8; 3]) -> Shader<'static> {
    LinearGradient::new(
        Point::from_xy(rect.x, rect.y),
        Point::from_xy(rect.x, rect.y + rect.h),
        stops(top, bottom),
        SpreadMode::Pad,
        Transform::identity(),
    )
    .unwrap_or_else(|| Shader::SolidColor(opaque(top)))
}

fn radial((x, y): (f32, f32), radius: f32, inner: [u8; 3], outer: [u8; 3]) -> Shader<'static> {
    RadialGradient::new(
        Point::from_xy(x, y),
        0.0,
        Point::from_xy(x, y),
        radius,
        stops(inner, outer),
        SpreadMode::Pad,
        Transform::identity(),
    )
    .unwrap_or_else(|| Shader::SolidColor(opaque(inner)))
}
