//! The fonts of the window: the built-in outline fonts, and glyphs of GNU Unifont for every
//! other character. Unifont glyphs are drawn at the requested size.

use std::sync::Arc;

use super::theme;
use crate::widgets::icons;
use egui::epaint::text::{GlyphBitmap, GlyphRasterizer, GlyphRasterizerRequest, RasterizedGlyph};
use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, ColorImage, FontData, FontDefinitions, FontFamily, FontId, vec2};
use gsk_panel::fonts::{CHINESE, LATIN, MONO};

/// Height of a glyph in the font, dots.
const GLYPH_HEIGHT_DOTS: f32 = 16.0;
/// Number of rows of a glyph above the base line, dots.
const ASCENT_DOTS: f32 = 14.0;

/// Installs the fonts of the window in a context. Repeated calls are allowed.
pub fn install(context: &egui::Context) {
    let mut fonts = FontDefinitions::empty();
    for (name, file) in [("latin", LATIN), ("mono", MONO), ("chinese", CHINESE)] {
        let data = Arc::new(FontData::from_static(file));
        fonts.font_data.insert(name.to_owned(), data);
    }
    for (family, order) in [
        (FontFamily::Proportional, ["latin", "mono", "chinese"]),
        (FontFamily::Monospace, ["mono", "latin", "chinese"]),
    ] {
        let order = order.map(str::to_owned).to_vec();
        fonts.families.insert(family, order);
    }
    let icons = Arc::new(FontData::from_static(icons::FONT));
    fonts.font_data.insert(icons::FAMILY.to_owned(), icons);
    let family = FontFamily::Name(icons::FAMILY.into());
    fonts
        .families
        .insert(family, vec![icons::FAMILY.to_owned()]);
    context.set_fonts(fonts);
    context.add_glyph_rasterizer(GlyphRasterizer::new("gsk980td::unifont", rasterize));
}

/// The size at which a glyph of `size_px` is drawn, physical pixels. Near a whole multiple of
/// its dots it is that multiple, so that strokes stay sharp.
fn snap_size(size_px: f32) -> f32 {
    let nearest = (size_px / GLYPH_HEIGHT_DOTS).round() * GLYPH_HEIGHT_DOTS;
    if nearest > 0.0 && (nearest - size_px).abs() <= nearest * 0.08 {
        nearest
    } else {
        size_px
    }
}

fn rasterize(request: &GlyphRasterizerRequest<'_>) -> Option<RasterizedGlyph> {
    let mut characters = request.cluster.chars();
    let character = characters.next()?;
    if characters.next().is_some() {
        return None;
    }
    let glyph = gsk_panel::glyphs::glyph(character)?;
    let scale = snap_size(request.font_size_px) / GLYPH_HEIGHT_DOTS;
    let width = glyph.get_width() as f32 * scale;
    let size = [
        (width.ceil() as usize).max(1),
        ((GLYPH_HEIGHT_DOTS * scale).ceil() as usize).max(1),
    ];
    let coverage = |x: usize, y: usize| {
        let (x, y) = (x as f32 / scale, y as f32 / scale);
        ink_share(glyph, x, y, 1.0 / scale)
    };
    let pixels = (0..size[0] * size[1])
        .map(|index| {
            let share = coverage(index % size[0], index / size[0]);
            // Without a correction, strokes thinner than a pixel would look pale.
            let share = if scale < 1.0 {
                (share * 1.35).min(1.0)
            } else {
                share
            };
            Color32::from_white_alpha((share * 255.0).round() as u8)
        })
        .collect();
    let image = ColorImage::new(size, pixels);
    let offset_px = vec2(0.0, -(ASCENT_DOTS * scale).round());
    let bitmap = GlyphBitmap {
        image,
        offset_px,
        is_color: false,
    };
    Some(RasterizedGlyph {
        bitmap,
        advance_px: width,
    })
}

/// Share of a square of the glyph that is ink, 0–1. `left`, `top` and `side` are in dots.
fn ink_share(glyph: &unifont::Glyph, left: f32, top: f32, side: f32) -> f32 {
    let span = |start: f32, dots: usize| {
        let first = start.floor() as usize;
        let last = ((start + side).ceil() as usize).min(dots);
        first..last
    };
    let overlap = |start: f32, dot: usize| {
        let dot = dot as f32;
        ((start + side).min(dot + 1.0) - start.max(dot)).max(0.0)
    };
    let mut ink = 0.0;
    for y in span(top, GLYPH_HEIGHT_DOTS as usize) {
        for x in span(left, glyph.get_width()) {
            if glyph.get_pixel(x, y) {
                ink += overlap(left, x) * overlap(top, y);
            }
        }
    }
    (ink / (side * side)).min(1.0)
}

/// Gap between two hyphens, as a share of the font size.
const HYPHEN_GAP: f32 = 0.14;

/// Lays out a text so that two hyphens remain two. Without the gap, those of the font touch
/// and look like one long dash.
pub fn layout_text(text: &str, font_id: FontId, color: Color32) -> LayoutJob {
    let gap = HYPHEN_GAP * font_id.size;
    let format = TextFormat {
        font_id,
        color,
        ..TextFormat::default()
    };
    let mut job = LayoutJob::default();
    let (mut rest, mut space) = (text, 0.0);
    while let Some(at) = rest.find("--") {
        let (piece, after) = rest.split_at(at + 1);
        job.append(piece, space, format.clone());
        (rest, space) = (after, gap);
    }
    job.append(rest, space, format);
    job
}

/// Sets up fonts, theme and style of a context for the window, also in tests.
pub fn set_up(context: &egui::Context) {
    install(context);
    theme::install(context);
    context.set_theme(egui::Theme::Dark);
    // The window handles the zoom keys itself.
    context.options_mut(|options| options.zoom_with_keyboard = false);
    context.all_styles_mut(|style| {
        theme::set_text_style(style);
        style.spacing.button_padding = vec2(8.0, 3.0);
        // Delay of tool tips, s.
        style.interaction.tooltip_delay = 0.6;
    });
    let _: Arc<egui::Style> = context.global_style();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_hyphens_have_a_gap() {
        let context = egui::Context::default();
        set_up(&context);
        let width = |job: LayoutJob| {
            let mut width = 0.0;
            let mut output = context.run_ui(egui::RawInput::default(), |ui| {
                let job = job.clone();
                width = ui
                    .ctx()
                    .fonts_mut(|fonts| fonts.layout_job(job).rect.width());
            });
            output.textures_delta.clear();
            width
        };
        let font = || FontId::proportional(theme::TITLE_SIZE);
        let drawn = layout_text("--link", font(), theme::TEXT);
        let plain = LayoutJob::simple("--link".to_owned(), font(), theme::TEXT, 1000.0);
        assert!(width(drawn) > width(plain) + 1.0);
    }
}
