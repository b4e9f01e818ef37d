//! Draws a text as a QR code.

use egui::{ColorImage, Image, TextureHandle, TextureOptions, Ui, Vec2};
use qrcodegen::{QrCode, QrCodeEcc};

use crate::theme;

/// Width of a module, points.
const MODULE_SIZE: f32 = 4.0;
/// Free modules at each side, as the standard requires.
const QUIET_MODULES: i32 = 4;

/// A text as a QR code. It is an image: the light theme would exchange dark and light.
#[derive(Default)]
pub struct QrPicture {
    text: String,
    /// `None` before the first text, and for one that is too long.
    texture: Option<TextureHandle>,
}

impl QrPicture {
    /// Draws the code of a text. `name` is its description for a screen reader.
    pub fn show(&mut self, ui: &mut Ui, text: &str, name: &str) {
        if self.text != text {
            text.clone_into(&mut self.text);
            let image = render(text);
            let options = TextureOptions::NEAREST;
            let load = |image| ui.ctx().load_texture("qr code", image, options);
            self.texture = image.map(load);
        }
        if let Some(texture) = &self.texture {
            let size = texture.size_vec2() * MODULE_SIZE;
            let image = Image::new((texture.id(), size)).alt_text(name);
            ui.add(image.fit_to_exact_size(Vec2::splat(size.x)));
        }
    }
}

/// The code with a pixel for each module; `None` for a text that is too long.
fn render(text: &str) -> Option<ColorImage> {
    let code = QrCode::encode_text(text, QrCodeEcc::Medium).ok()?;
    let side = code.size() + 2 * QUIET_MODULES;
    let modules = (0..side * side).map(|index| {
        let (x, y) = (index % side - QUIET_MODULES, index / side - QUIET_MODULES);
        match code.get_module(x, y) {
            true => theme::TEXT_ON_BRIGHT,
            false => theme::NO_TINT,
        }
    });
    let size = [side as usize; 2];
    Some(ColorImage::new(size, modules.collect()))
}
