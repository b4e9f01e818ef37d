//! Draws the LCD in the window.

use egui::{Color32, ColorImage, Pos2, Rect, TextureHandle, TextureOptions};
use gsk_panel::raster;
use gsk_panel::screen::{HEIGHT, Screen, WIDTH};

use crate::placement::lcd_placement::{LcdPlacement, fit};
use crate::theme;

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

    /// Draws a screen in `bounds` on the glass of the panel. `brightness` is that of the control,
    /// 0 to 15.
    pub fn paint(
        &mut self,
        painter: &egui::Painter,
        (bounds, glass): (Rect, Rect),
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
        let [red, green, blue] = raster::palette(screen.colours(), brightness).background;
        theme::fill_unthemed(painter, glass, Color32::from_rgb(red, green, blue));
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
    let palette = raster::palette(screen.colours(), level);
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
