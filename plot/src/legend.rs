//! Lays out the texts above the path: name, time, and a legend line for each tool.

use gsk_messages::{Language, say};

use crate::drawing::PathDrawing;
use crate::extent::PATH_MARGIN;
use crate::path_pieces::PathLine;
use crate::pens::LinePen;
use crate::text_width::text_width;
use gsk_runner::report::tool_word;
use gsk_runner::text_format::{format_time, short_description};

/// Distance of texts from the left and the right edge of the picture, picture units.
pub(super) const EDGE: f64 = 20.0;
/// Distance from the top to the first row of the legend, picture units.
const LEGEND_TOP: f64 = 50.0;
/// Height of a row of the legend, picture units.
const ROW_HEIGHT: f64 = 22.0;
/// Length of the line of an entry (`SAMPLE`) and its gap to the text (`GAP`), picture units.
pub(super) const SAMPLE: f64 = 28.0;
pub(super) const GAP: f64 = 8.0;
/// Gap between two entries of the legend, picture units.
const ENTRY_GAP: f64 = 24.0;
/// Height of the space below the legend, which holds the name of the X axis, picture units.
const LEGEND_BOTTOM: f64 = 32.0;

/// An entry of the legend: a sample line and its meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// The style of the line.
    pub pen: LinePen,
    /// Left end of the line: right and down from the upper left corner, picture units.
    pub line_start: (f64, f64),
    /// Meaning of the line: T word and cutting time of a tool, or rapids.
    pub text: String,
}

/// The title, times and legend above the path.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureHead {
    /// The title of the drawing, shortened to the available width.
    pub title: String,
    /// Total time and cutting time of the program; empty without a time.
    pub summary: String,
    /// The entries of the legend: first tools, then rapids.
    pub entries: Vec<LegendEntry>,
    /// Vertical position at which the path begins, picture units from the top.
    pub height: f64,
}

impl PictureHead {
    /// Lays out the texts of a drawing that is `wide` picture units wide.
    pub(super) fn new(drawing: &PathDrawing, wide: f64, language: Language) -> Self {
        let spent = drawing.spent();
        let (time, cutting) = (format_time(spent.total_s()), format_time(spent.cutting_s()));
        let summary = match spent.total_s() > 0.0 {
            true => say::picture_time(time, cutting).text(language),
            false => String::new(),
        };
        let room = wide - 2.0 * EDGE - ENTRY_GAP - text_width(&summary);
        let title = shorten(&drawing.title, room);
        let mut entries: Vec<(LinePen, String)> = (drawing.tools().zip(0..))
            .map(|((number, offset, spent), index)| {
                let (tool, time) = (tool_word((number, offset)), format_time(spent.cutting_s()));
                let shape = drawing.scenery().tools.get(&number);
                let shape = shape.map(|it| format!("{}, ", short_description(it).text(language)));
                let words = format!("T{tool} {}{time}", shape.unwrap_or_default());
                (LinePen::for_line(PathLine::Cut(index)), words)
            })
            .collect();
        let rapid = |(made, _)| made == PathLine::Rapid;
        if drawing.pieces().strokes().any(rapid) {
            let words = say::report_kind_rapid().text(language);
            entries.push((LinePen::for_line(PathLine::Rapid), words));
        }
        let (entries, rows) = arrange_entries(entries, wide);
        Self {
            title,
            summary,
            entries,
            height: LEGEND_TOP + ROW_HEIGHT * f64::from(rows.max(1)) - ROW_HEIGHT / 2.0
                + LEGEND_BOTTOM,
        }
    }
}

/// Arranges entries side by side within `wide` picture units. Returns them with their
/// positions, and the number of rows.
fn arrange_entries(entries: Vec<(LinePen, String)>, wide: f64) -> (Vec<LegendEntry>, u32) {
    let (mut left, mut row) = (PATH_MARGIN, 0);
    let mut placed = Vec::with_capacity(entries.len());
    for (pen, words) in entries {
        let needs = SAMPLE + GAP + text_width(&words);
        if left > PATH_MARGIN && left + needs > wide - EDGE {
            left = PATH_MARGIN;
            row += 1;
        }
        placed.push(LegendEntry {
            pen,
            line_start: (left, LEGEND_TOP + ROW_HEIGHT * f64::from(row)),
            text: words,
        });
        left += needs + ENTRY_GAP;
    }
    (placed, row + 1)
}

/// Returns the text, shortened with an ellipsis if it is wider than `room` picture units.
fn shorten(text: &str, room: f64) -> String {
    if text_width(text) <= room {
        return text.to_owned();
    }
    let mut left = room - text_width("…");
    let mut out = String::new();
    for letter in text.chars() {
        left -= text_width(letter.encode_utf8(&mut [0; 4]));
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
        let entry = |index| {
            (
                LinePen::for_line(PathLine::Cut(index)),
                format!("T{index:02}01 1:23.4"),
            )
        };
        let (placed, rows) = arrange_entries((0..12).map(entry).collect(), 640.0);
        assert!(rows > 2);
        for entry in &placed {
            assert!(entry.line_start.0 + SAMPLE + GAP + text_width(&entry.text) <= 640.0);
        }
    }

    #[test]
    fn a_long_name_is_cut_off() {
        assert_eq!(shorten("轴.CNC", 100.0), "轴.CNC");
        let short = shorten(&"车削".repeat(100), 100.0);
        assert!(short.ends_with('…') && text_width(&short) <= 100.0);
    }
}
