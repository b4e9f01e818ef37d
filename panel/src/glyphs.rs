//! Contains the LCD's character set: GNU Unifont with 8x16 dots for a half-width and 16x16 for
//! a full-width character, the classic Song face of such LCDs.

use unifont::Glyph;

// `RUNS` contains the first and last character of each run without a gap. `GLYPHS` contains the
// glyphs of all runs.
include!(concat!(env!("OUT_DIR"), "/glyphs.rs"));

/// Height of a character on the LCD, dots.
pub(crate) const GLYPH_HEIGHT: usize = 16;

/// The character that is drawn instead of one without a glyph.
const REPLACEMENT: char = '?';

/// The dot pattern of a character on the LCD.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GlyphDots {
    /// Rows of 16 dots, the leftmost dot in bit 15. A half-width character uses the upper byte
    /// only.
    pub rows: [u16; GLYPH_HEIGHT],
    /// Width of the character in LCD columns of 8 dots: 1 or 2.
    pub columns: usize,
}

/// Returns the Unifont glyph of a character; `None` if the program contains none.
pub fn glyph(character: char) -> Option<&'static Glyph> {
    let character = u32::from(character);
    let mut before = 0;
    for (first, last) in &RUNS {
        if (*first..=*last).contains(&character) {
            return GLYPHS.get((before + character - first) as usize);
        }
        before += last - first + 1;
    }
    None
}

/// Returns the dots of a character, or those of `?` if it has no glyph.
pub fn dots(character: char) -> GlyphDots {
    match glyph(character).or_else(|| glyph(REPLACEMENT)) {
        Some(Glyph::Halfwidth(rows)) => GlyphDots {
            rows: rows.map(|row| u16::from(row) << 8),
            columns: 1,
        },
        Some(Glyph::Fullwidth(rows)) => GlyphDots {
            rows: *rows,
            columns: 2,
        },
        None => GlyphDots {
            rows: [0; GLYPH_HEIGHT],
            columns: 1,
        },
    }
}

/// Returns the number of LCD columns (8 dots wide) that a character takes: 1 or 2.
pub fn columns(character: char) -> usize {
    if character.is_ascii() {
        return 1;
    }
    let wide = glyph(character).is_some_and(Glyph::is_fullwidth);
    1 + usize::from(wide)
}

/// Returns the number of LCD columns (8 dots wide) that all characters of a text take.
pub fn text_columns(text: &str) -> usize {
    text.chars().map(columns).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chinese_takes_two_columns_and_ascii_one() {
        assert_eq!(columns('现'), 2);
        assert_eq!(columns('X'), 1);
        assert_eq!(columns(';'), 1);
        assert_eq!(text_columns("现在位置(相对坐标)"), 18);
    }

    #[test]
    fn half_width_dots_stay_in_the_upper_byte() {
        let dots = dots('A');
        assert_eq!(dots.columns, 1);
        assert!(dots.rows.iter().all(|row| row & 0x00ff == 0));
        assert!(dots.rows.iter().any(|row| *row != 0));
    }

    #[test]
    fn every_glyph_is_that_of_its_character() {
        for (character, of_unifont) in unifont::enumerate_glyphs() {
            if let Some(kept) = glyph(character) {
                assert_eq!(kept, of_unifont, "{character}");
            }
        }
        let kept = |text: &str| text.chars().all(|it| glyph(it).is_some());
        assert!(kept("~°±µαΩЖ…→⌀□●、。《》【】ァ一龥齿車轴(A)"));
        assert_eq!(glyph('\u{3400}'), None);
    }

    #[test]
    fn a_character_without_a_glyph_becomes_a_question_mark() {
        assert_eq!(dots('\u{10ffff}'), dots('?'));
        assert_eq!(columns('\u{10ffff}'), 1);
    }
}
