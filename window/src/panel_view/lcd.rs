//! Draws the LCD in the window, with whole pixels per dot wherever a whole zoom fits.

use egui::{Color32, ColorImage, Pos2, Rect, TextureHandle, TextureOptions, vec2};
use gsk_panel::raster;
use gsk_panel::screen::{HEIGHT, Screen, WIDTH};

use crate::theme;

/// Minimum ratio of a zoom by whole pixels to the greatest zoom that fits; below this ratio the
/// image uses the greatest zoom.
const MIN_FILL: f32 = 0.88;

/// Position and resolution of the image of the LCD.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LcdPlacement {
    /// Rectangle of the image, on whole pixels, points.
    pub rect: Rect,
    /// Texture pixels per dot. If no whole zoom fits, the texture is larger than the image,
    /// and the graphics card reduces it.
    pub pixels_per_dot: u32,
    /// Whether each dot is a square of whole physical pixels.
    pub is_crisp: bool,
}

/// Fits the image of the LCD into `bounds`, points.
pub fn fit(bounds: Rect, pixels_per_point: f32) -> LcdPlacement {
    let zoom = (bounds.width() * pixels_per_point / WIDTH as f32)
        .min(bounds.height() * pixels_per_point / HEIGHT as f32)
        .max(0.05);
    let whole = (zoom + 0.01).floor();
    let is_crisp = whole >= 1.0 && whole / zoom >= MIN_FILL;
    let used_zoom = if is_crisp { whole } else { zoom };
    let size = vec2(WIDTH as f32, HEIGHT as f32) * used_zoom;
    let size = vec2(size.x.round(), size.y.round());
    let corner = bounds.center() * pixels_per_point;
    let corner = Pos2::new(
        (corner.x - size.x / 2.0).round(),
        (corner.y - size.y / 2.0).round(),
    );
    let rect = Rect::from_min_size(
        Pos2::new(corner.x / pixels_per_point, corner.y / pixels_per_point),
        size / pixels_per_point,
    );
    let pixels_per_dot = if is_crisp {
        1
    } else {
        (zoom.ceil() as u32).clamp(1, 8)
    };
    LcdPlacement {
        rect,
        pixels_per_dot,
        is_crisp,
    }
}

/// The texture of the LCD, which is made again only when the screen has changed.
#[derive(Default)]
pub struct Lcd {
    texture: Option<TextureHandle>,
    shown_state: Option<(Screen, u8, u32)>,
    bounds: Option<Rect>,
}

impl Lcd {
    /// The rectangle in which the LCD was drawn last; `None` if the LCD is not visible.
    pub const fn bounds(&self) -> Option<Rect> {
        self.bounds
    }

    /// Marks the LCD as not visible.
    pub const fn hide(&mut self) {
        self.bounds = None;
    }

    /// Draws a screen in `bounds`. `brightness` is that of the control, 0 to 15.
    pub fn paint(
        &mut self,
        painter: &egui::Painter,
        bounds: Rect,
        screen: &Screen,
        brightness: u8,
    ) {
        self.bounds = Some(bounds);
        let placement = fit(bounds, painter.pixels_per_point());
        let same = |(shown, level, dots): &(Screen, u8, u32)| {
            shown == screen && *level == brightness && *dots == placement.pixels_per_dot
        };
        if !self.shown_state.as_ref().is_some_and(same) {
            self.upload(painter.ctx(), screen, brightness, placement);
            self.shown_state = Some((screen.clone(), brightness, placement.pixels_per_dot));
        }
        let Some(texture) = &self.texture else { return };
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        let [red, green, blue] = raster::palette(brightness).background;
        if !placement.rect.expand(0.01).contains_rect(bounds) {
            theme::fill_unthemed(painter, bounds, Color32::from_rgb(red, green, blue));
        }
        painter.image(texture.id(), placement.rect, whole, theme::NO_TINT);
    }

    fn upload(
        &mut self,
        context: &egui::Context,
        screen: &Screen,
        level: u8,
        placement: LcdPlacement,
    ) {
        let image = to_image(screen, level, placement.pixels_per_dot as usize);
        let options = if placement.is_crisp {
            TextureOptions::NEAREST
        } else {
            TextureOptions::LINEAR
        };
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(context.load_texture("lcd", image, options)),
        }
    }
}

/// Converts the screen to an image with a square of `pixels_per_dot` texture pixels per dot.
/// Each pixel is written once, because every change of the LCD makes a new image.
fn to_image(screen: &Screen, level: u8, pixels_per_dot: usize) -> ColorImage {
    let palette = raster::palette(level);
    let [dark, lit] = [palette.background, palette.text]
        .map(|[red, green, blue]| Color32::from_rgb(red, green, blue));
    let bitmap = raster::bitmap(screen);
    let width = WIDTH * pixels_per_dot;
    let mut pixels = Vec::with_capacity(width * HEIGHT * pixels_per_dot);
    for y in 0..HEIGHT {
        let begin = pixels.len();
        for byte in bitmap.row(y) {
            for bit in (0..8).rev() {
                let colour = if byte >> bit & 1 == 1 { lit } else { dark };
                pixels.extend(core::iter::repeat_n(colour, pixels_per_dot));
            }
        }
        for _ in 1..pixels_per_dot {
            pixels.extend_from_within(begin..begin + width);
        }
    }
    ColorImage::new([width, HEIGHT * pixels_per_dot], pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_zooms_are_used_where_they_nearly_fill() {
        let room = Rect::from_min_size(Pos2::new(28.3, 60.1), vec2(640.0, 480.0));
        for (pixels_per_point, zoom) in [(1.0, 2.0), (1.5, 3.0), (2.0, 4.0), (1.05, 2.0)] {
            let placement = fit(room, pixels_per_point);
            let physical = placement.rect.width() * pixels_per_point;
            assert!(
                placement.is_crisp && (physical - 320.0 * zoom).abs() < 0.01,
                "{placement:?}"
            );
            let left = placement.rect.left() * pixels_per_point;
            assert!((left - left.round()).abs() < 0.01);
        }
        let between = fit(room, 1.25);
        assert!(!between.is_crisp && between.pixels_per_dot == 3);
        assert!((between.rect.width() * 1.25 - 800.0).abs() < 0.01);
        let tiny = fit(Rect::from_min_size(Pos2::ZERO, vec2(100.0, 75.0)), 1.0);
        assert!(!tiny.is_crisp && tiny.pixels_per_dot == 1);
    }
}
