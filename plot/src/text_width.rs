//! Estimates the width of a text in the font of pictures.

/// Returns the width of a text in the drawing font, picture units.
pub(super) fn text_width(text: &str) -> f64 {
    let glyphs = text.chars().filter_map(gsk_panel::glyphs::glyph);
    glyphs.map(|glyph| glyph.get_width() as f64).sum()
}
