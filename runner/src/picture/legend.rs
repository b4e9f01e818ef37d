//! Lays out the texts above the path: name, time, and a legend line for each tool.

use gsk_messages::{Language, say};

use super::drawing::Drawing;
use super::extent::MARGIN;
use super::pens::Pen;
use super::pieces::Made;
use crate::report::tool_word;
use crate::words::{clock, in_short};

/// Units from the left and the right edge.
pub(super) const EDGE: f64 = 20.0;
/// Units from the top to the first row of the legend.
const TITLE: f64 = 50.0;
/// Height of a row of the legend, units.
const ROW: f64 = 22.0;
/// Length of the line of an entry, and the gap to its text, units.
pub(super) const SAMPLE: f64 = 28.0;
pub(super) const GAP: f64 = 8.0;
/// Units between two entries.
const BETWEEN: f64 = 24.0;
/// Units below the legend, with the name of the X axis.
const BELOW: f64 = 32.0;

/// An entry of the legend: a line and its meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The line.
    pub pen: Pen,
    /// Left end of the line, and its height, units.
    pub at: (f64, f64),
    /// Its meaning: T word and cutting time.
    pub words: String,
}

/// The texts above the path.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// The name, shortened to the available width.
    pub title: String,
    /// The times of the whole program.
    pub summary: String,
    /// The legend: tools, then rapids.
    pub entries: Vec<Entry>,
    /// Vertical position where the path begins, units.
    pub height: f64,
}

impl Head {
    /// Lays out the texts of a drawing that is `wide` units wide.
    pub(super) fn new(drawing: &Drawing, wide: f64, language: Language) -> Self {
        let spent = drawing.spent();
        let (time, cutting) = (clock(spent.whole()), clock(spent.cutting()));
        let summary = match spent.whole() > 0.0 {
            true => say::picture_time(time, cutting).text(language),
            false => String::new(),
        };
        let room = wide - 2.0 * EDGE - BETWEEN - width(&summary);
        let title = shortened(&drawing.title, room);
        let mut entries: Vec<(Pen, String)> = (drawing.tools().zip(0..))
            .map(|((number, offset, spent), index)| {
                let (tool, time) = (tool_word((number, offset)), clock(spent.cutting()));
                let shape = drawing.scenery().tools.get(&number);
                let shape = shape.map(|it| format!("{}, ", in_short(it).text(language)));
                let words = format!("T{tool} {}{time}", shape.unwrap_or_default());
                (Pen::of(Made::Cut(index)), words)
            })
            .collect();
        let rapid = |(made, _)| made == Made::Rapid;
        if drawing.pieces().strokes().any(rapid) {
            let words = say::report_kind_rapid().text(language);
            entries.push((Pen::of(Made::Rapid), words));
        }
        let (entries, rows) = flowed(entries, wide);
        Self {
            title,
            summary,
            entries,
            height: TITLE + ROW * f64::from(rows.max(1)) - ROW / 2.0 + BELOW,
        }
    }
}

/// Arranges entries side by side, in as many rows as needed.
fn flowed(entries: Vec<(Pen, String)>, wide: f64) -> (Vec<Entry>, u32) {
    let (mut left, mut row) = (MARGIN, 0);
    let mut placed = Vec::with_capacity(entries.len());
    for (pen, words) in entries {
        let needs = SAMPLE + GAP + width(&words);
        if left > MARGIN && left + needs > wide - EDGE {
            left = MARGIN;
            row += 1;
        }
        placed.push(Entry {
            pen,
            at: (left, TITLE + ROW * f64::from(row)),
            words,
        });
        left += needs + BETWEEN;
    }
    (placed, row + 1)
}

/// Width of a text, units: that of its glyphs.
pub(super) fn width(text: &str) -> f64 {
    let glyphs = text.chars().filter_map(gsk_panel::glyphs::glyph);
    glyphs.map(|glyph| glyph.get_width() as f64).sum()
}

/// A text, shortened to an available width.
fn shortened(text: &str, room: f64) -> String {
    if width(text) <= room {
        return text.to_owned();
    }
    let mut left = room - width("…");
    let mut out = String::new();
    for letter in text.chars() {
        left -= width(letter.encode_utf8(&mut [0; 4]));
        if left < 0.0 {
            break;
        }
        out.push(letter);
    }
    out.push('…');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_legend_takes_the_rows_it_needs() {
        let entry = |index| (Pen::of(Made::Cut(index)), format!("T{index:02}01 1:23.4"));
        let (placed, rows) = flowed((0..12).map(entry).collect(), 640.0);
        assert!(rows > 2);
        for entry in &placed {
            assert!(entry.at.0 + SAMPLE + GAP + width(&entry.words) <= 640.0);
        }
    }

    #[test]
    fn a_long_name_is_cut_off() {
        assert_eq!(shortened("轴.CNC", 100.0), "轴.CNC");
        let short = shortened(&"车削".repeat(100), 100.0);
        assert!(short.ends_with('…') && width(&short) <= 100.0);
    }
}
