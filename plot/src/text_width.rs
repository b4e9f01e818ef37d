//! Estimates the width of a text in the font of pictures.

/// Width of the glyphs of a text, picture units.
pub(super) fn text_width(text: &str) -> f64 {
    let glyphs = text.chars().filter_map(gsk_panel::glyphs::glyph);
    glyphs.map(|glyph| glyph.get_width() as f64).sum()
}
