//! Loads the outline fonts of key legends and the window: Noto Sans with the characters of the
//! program's own texts. `tools/font.py` writes them. The LCD, and other texts of a user, have
//! dots ([`crate::glyphs`]).

use std::sync::LazyLock;

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};

/// Noto Sans with letters, digits and signs, as a TrueType file.
pub static LATIN: &[u8] = include_bytes!("../../assets/fonts/latin.ttf");
/// Noto Sans Mono with letters, digits and more signs, all equally wide, as a TrueType file.
pub static MONO: &[u8] = include_bytes!("../../assets/fonts/mono.ttf");
/// Noto Sans with Chinese characters and their punctuation, as an OpenType file.
pub static CHINESE: &[u8] = include_bytes!("../../assets/fonts/chinese.otf");

/// Returns the fonts in the order in which a character is searched.
fn faces() -> &'static [FontRef<'static>] {
    static FACES: LazyLock<Vec<FontRef<'static>>> = LazyLock::new(|| {
        let files = [LATIN, MONO, CHINESE].into_iter();
        files.filter_map(|file| FontRef::new(file).ok()).collect()
    });
    &FACES
}

/// Returns a character's glyph in the first font that has one; `None` if none has.
fn find(character: char) -> Option<(&'static FontRef<'static>, GlyphId)> {
    let mut faces = faces().iter();
    faces.find_map(|face| Some((face, face.charmap().map(character)?)))
}

/// Returns whether one of the outline fonts has a glyph for this character.
pub fn has(character: char) -> bool {
    find(character).is_some()
}

/// Returns the width of a character whose em is `size` high, in the same unit; 0 if no font
/// has a glyph for it.
pub fn advance(character: char, size: f32) -> f32 {
    let metrics = |(face, glyph): (&FontRef<'_>, GlyphId)| {
        let metrics = face.glyph_metrics(Size::new(size), LocationRef::default());
        metrics.advance_width(glyph)
    };
    find(character).and_then(metrics).unwrap_or_default()
}

/// Draws the outline of a character whose em is `size` high into `pen`, from its origin on the
/// base line, y upwards. Draws nothing if no font has a glyph for it.
pub(crate) fn outline(character: char, size: f32, pen: &mut impl OutlinePen) {
    let Some((face, glyph)) = find(character) else {
        return;
    };
    if let Some(outline) = face.outline_glyphs().get(glyph) {
        let settings = DrawSettings::unhinted(Size::new(size), LocationRef::default());
        // A glyph of our own file that cannot be drawn is left out.
        let _ = outline.draw(settings, pen);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    use gsk_core::model::ModelId;

    use super::*;
    use crate::face::face_of;
    use crate::keys::STRIP;

    /// Characters without an outline font: other scripts in tests, and marks that no window
    /// draws.
    const DOTS: &str = "𝄞٣글한ァ⬅⬆∬⌀";

    fn texts() -> String {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
        let mut texts = String::new();
        for folder in ["tables", "help", "lessons", "models", "machines", "ladder"] {
            let files = fs::read_dir(root.join(folder)).expect(folder);
            for file in files {
                let path = file.expect("an entry").path();
                if path.ends_with("command-line.tsv") {
                    // No window shows it.
                    continue;
                }
                texts += &fs::read_to_string(&path).unwrap_or_default();
            }
        }
        for row in ModelId::ALL.into_iter().flat_map(|it| face_of(it).keys()) {
            texts += &row.legend.concat();
            texts.push_str(row.name_zh);
        }
        for lamp in &STRIP {
            texts.push_str(lamp.label);
            texts.push_str(lamp.name_zh);
        }
        texts
    }

    #[test]
    fn every_character_of_the_texts_is_in_a_font() {
        let used: BTreeSet<char> = texts().chars().filter(|it| !it.is_control()).collect();
        assert!(used.len() > 900, "the texts stand elsewhere now");
        let missing = used.iter().filter(|it| !has(**it) && !DOTS.contains(**it));
        let missing: String = missing.collect();
        assert!(
            missing.is_empty(),
            "not in assets/fonts: {missing}: run `tools/font.py` as its head says"
        );
    }

    #[test]
    fn letters_have_a_width_and_an_outline() {
        for character in ['G', '0', '↑', '车'] {
            let width = advance(character, 16.0);
            assert!((4.0..17.0).contains(&width), "{character} is {width} wide");
            let mut drawn = String::new();
            outline(character, 16.0, &mut Letters(&mut drawn));
            assert!(drawn.starts_with('m') && drawn.ends_with('z'), "{drawn}");
        }
        assert!((advance('车', 16.0) - 16.0).abs() < 0.01);
        assert!(advance('i', 16.0) < advance('M', 16.0));
    }

    /// Writes the drawing commands of an outline as letters.
    struct Letters<'a>(&'a mut String);

    impl OutlinePen for Letters<'_> {
        fn move_to(&mut self, _: f32, _: f32) {
            self.0.push('m');
        }
        fn line_to(&mut self, _: f32, _: f32) {
            self.0.push('l');
        }
        fn quad_to(&mut self, _: f32, _: f32, _: f32, _: f32) {
            self.0.push('q');
        }
        fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, _: f32, _: f32) {
            self.0.push('c');
        }
        fn close(&mut self) {
            self.0.push('z');
        }
    }
}
