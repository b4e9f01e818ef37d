//! Recolours the window for light surroundings. The window is drawn in dark colours; one rule
//! gives each colour its light counterpart, just before a frame is shown. Panel, LCD and the
//! lit part are images and look the same in both themes.

use std::cell::Cell;

use egui::epaint::shape_transform::adjust_colors;
use egui::{
    Color32, Context, FullOutput, Id, Painter, Plugin, Pos2, Rect, Shape, TextureHandle, TextureId,
    TextureOptions, pos2,
};

/// The background colour of the window in the dark theme.
const DARK_BACKGROUND: Color32 = Color32::from_gray(22);

/// Lightness in the light theme as a polynomial of the lightness in the dark theme, constant
/// term first: the darkest background (0.15) becomes white, a pale ink (0.65) half dark, white
/// (1.0) nearly black. Each ink keeps at least its contrast to the background in the dark
/// theme, or a contrast of 7.
const LIGHTNESS_POLYNOMIAL: [f32; 4] = [0.9915, 0.4878, -3.1663, 1.9369];

#[derive(Default)]
struct ThemePlugin {
    light: bool,
}

impl Plugin for ThemePlugin {
    fn debug_name(&self) -> &'static str {
        "surroundings"
    }

    fn output_hook(&mut self, _context: &Context, output: &mut FullOutput) {
        if self.light {
            for shape in &mut output.shapes {
                lighten(&mut shape.shape);
            }
        }
    }
}

/// Registers the plugin that recolours frames. The theme is dark at first.
pub fn install(context: &Context) {
    context.add_plugin(ThemePlugin::default());
}

/// Sets the theme of everything that the context draws.
pub fn set_light(context: &Context, light: bool) {
    context.with_plugin(|plugin: &mut ThemePlugin| plugin.light = light);
}

/// The background colour of a window in the light or the dark theme.
pub fn background(light: bool) -> Color32 {
    if light {
        to_light(DARK_BACKGROUND)
    } else {
        DARK_BACKGROUND
    }
}

/// Fills a rectangle with a colour that is the same in both themes, such as that of the panel.
pub fn fill_unthemed(painter: &Painter, bounds: Rect, color: Color32) {
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    painter.image(white_texture(painter.ctx()), bounds, whole, color);
}

/// A texture of one white pixel. Shapes with this texture keep their colours in both themes.
pub fn white_texture(context: &Context) -> TextureId {
    let id = Id::unique("white");
    let cached: Option<TextureHandle> = context.data(|data| data.get_temp(id));
    let texture = cached.unwrap_or_else(|| {
        let dot = egui::ColorImage::filled([1, 1], Color32::WHITE);
        let texture = context.load_texture("white", dot, TextureOptions::NEAREST);
        context.data_mut(|data| data.insert_temp(id, texture.clone()));
        texture
    });
    texture.id()
}

/// Gives a shape its light colours, unless it is an image.
fn lighten(shape: &mut Shape) {
    match shape {
        Shape::Vec(shapes) => shapes.iter_mut().for_each(lighten),
        Shape::Mesh(mesh) if mesh.texture_id != TextureId::default() => {}
        Shape::Rect(rect) if rect.brush.is_some() => {}
        shape => adjust_colors(shape, |color| *color = to_light(*color)),
    }
}

/// The light counterpart of a colour.
fn to_light(color: Color32) -> Color32 {
    thread_local! {
        /// The last conversion: neighbouring vertices usually have the same colour.
        static LAST_CONVERSION: Cell<(Color32, Color32)> =
            const { Cell::new((Color32::TRANSPARENT, Color32::TRANSPARENT)) };
    }
    // egui replaces this colour later.
    if color == Color32::PLACEHOLDER || color == Color32::TRANSPARENT {
        return color;
    }
    let (last, light) = LAST_CONVERSION.get();
    if last == color {
        return light;
    }
    let [red, green, blue, cover] = color.to_srgba_unmultiplied();
    let [red, green, blue] = to_light_rgb([red, green, blue]);
    let light = Color32::from_rgba_unmultiplied(red, green, blue, cover);
    LAST_CONVERSION.set((color, light));
    light
}

/// Maps the lightness in Oklab and keeps the hue. Equal steps in Oklab look equally large:
/// colours that differ in the dark theme differ in the light one.
fn to_light_rgb(color: [u8; 3]) -> [u8; 3] {
    let [lightness, a, b] = linear_to_oklab(color.map(gamma_to_linear));
    let [constant, first, second, third] = LIGHTNESS_POLYNOMIAL;
    let lightness = constant + (first + (second + third * lightness) * lightness) * lightness;
    // A colour outside the range of sRGB becomes paler until it is inside.
    let shades = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1];
    let colors =
        shades.map(|saturation| oklab_to_linear([lightness, a * saturation, b * saturation]));
    let displayable = colors
        .into_iter()
        .find(|color| color.iter().all(|part| (0.0..=1.0).contains(part)))
        .unwrap_or_else(|| oklab_to_linear([lightness, 0.0, 0.0]));
    displayable.map(linear_to_gamma)
}

/// Converts linear sRGB to Oklab (B. Ottosson, 2020).
fn linear_to_oklab([r, g, b]: [f32; 3]) -> [f32; 3] {
    let l = (0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b).cbrt();
    let m = (0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b).cbrt();
    let s = (0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b).cbrt();
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

/// Converts Oklab to linear sRGB.
fn oklab_to_linear([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
}

fn gamma_to_linear(part: u8) -> f32 {
    egui::ecolor::linear_f32_from_gamma_u8(part)
}

fn linear_to_gamma(part: f32) -> u8 {
    egui::ecolor::gamma_u8_from_linear_f32(part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast ratio of two colours by the W3C accessibility guidelines.
    fn contrast(one: Color32, other: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b] = [color.r(), color.g(), color.b()].map(gamma_to_linear);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (one, other) = (luminance(one) + 0.05, luminance(other) + 0.05);
        one.max(other) / one.min(other)
    }

    #[test]
    fn light_colors_keep_the_contrast() {
        let ground = to_light(DARK_BACKGROUND);
        assert!(ground.r() > 215, "{ground:?}");
        // Inks of hints and marks on the bars, the brightest backgrounds.
        for ink in [140, 150, 160, 190].map(Color32::from_gray) {
            let bar = Color32::from_gray(40);
            let (dark, light) = (contrast(ink, bar), contrast(to_light(ink), to_light(bar)));
            assert!(
                light > 4.4 && light > dark - 0.1,
                "{ink:?}: {dark}, {light}"
            );
        }
        for ink in [
            Color32::from_gray(225),
            Color32::from_gray(170),
            Color32::from_rgb(255, 196, 90),
            Color32::from_rgb(255, 120, 96),
            Color32::from_rgb(110, 230, 120),
            Color32::from_rgb(120, 190, 255),
            Color32::from_rgb(255, 255, 140),
        ] {
            let light = to_light(ink);
            assert!(contrast(light, ground) > 4.5, "{ink:?} becomes {light:?}");
        }
    }

    #[test]
    fn hues_are_kept() {
        let [red, green, blue] = to_light_rgb([255, 110, 96]);
        assert!(red > green + 60 && red > blue + 60, "{red} {green} {blue}");
        let [red, green, blue] = to_light_rgb([110, 180, 255]);
        assert!(blue > green + 40 && green > red, "{red} {green} {blue}");
    }

    #[test]
    fn placeholder_colors_are_kept() {
        for color in [Color32::PLACEHOLDER, Color32::TRANSPARENT] {
            assert_eq!(to_light(color), color);
        }
    }

    #[test]
    fn images_keep_their_colors() {
        let mut mesh = egui::Mesh::with_texture(TextureId::User(1));
        mesh.add_rect_with_uv(Rect::ZERO, Rect::ZERO, Color32::WHITE);
        let mut shape = Shape::Vec(vec![Shape::mesh(mesh)]);
        lighten(&mut shape);
        let Shape::Vec(shapes) = &shape else {
            panic!("{shape:?}")
        };
        let Some(Shape::Mesh(mesh)) = shapes.first() else {
            panic!("{shapes:?}")
        };
        assert_eq!(mesh.vertices.first().unwrap().color, Color32::WHITE);
    }
}
