//! Makes the lines and texts of a mill's picture.

use gsk_messages::{Language, say};

use super::views::{MillPane, lay_out_panes};
use super::{MillDrawing, PathBox};
use crate::clip::clip_to_frame;
use crate::legend::{EDGE, GAP, SAMPLE};
use crate::path_pieces::PathLine;
use crate::pens::LinePen;
use crate::text_width::text_width;
use gsk_runner::text_format::format_time;

/// Space above the legend, height of its rows, and gap between its entries, picture units.
const LEGEND_TOP: f64 = 44.0;
const ROW_HEIGHT: f64 = 22.0;
const ENTRY_GAP: f64 = 30.0;

/// The line style of the frame around a view.
const FRAME: LinePen = LinePen {
    color: [0xB0; 3],
    width: 1.0,
    dash: &[],
};

/// A line or text of a picture, with positions in picture units.
#[derive(Clone, Debug)]
pub enum PictureItem {
    /// A line through these points, drawn with this pen.
    Line(LinePen, Vec<(f64, f64)>),
    /// A text at a position, picture units.
    Text {
        /// Reference point of the text, picture units.
        position: (f64, f64),
        /// The text to draw.
        text: String,
        /// Which part of the text is at its reference point: left end, middle or right end.
        anchor: TextAnchor,
    },
}

/// Which part of a text is at its reference point.
#[derive(Clone, Copy, Debug)]
pub enum TextAnchor {
    /// The point is at the left end of the text.
    Left,
    /// The point is in the middle of the text.
    Center,
    /// The point is at the right end of the text.
    Right,
}

/// Returns all lines and texts of the picture of a mill path.
pub fn picture_items(drawing: &MillDrawing, language: Language) -> Vec<PictureItem> {
    let (wide, tall) = drawing.options.size.units();
    let cube = drawing.box_with_margin();
    let (mut parts, top) = head_items(drawing, wide, language);
    for pane in lay_out_panes(&cube, (wide, tall), top) {
        let (left, upper, right, lower) = pane.frame;
        let frame = [
            (left, upper),
            (right, upper),
            (right, lower),
            (left, lower),
            (left, upper),
        ];
        parts.push(PictureItem::Line(FRAME, frame.to_vec()));
        parts.push(PictureItem::Text {
            position: (left + 8.0, upper + 18.0),
            text: pane.view.name(language),
            anchor: TextAnchor::Left,
        });
        add_hole_marks(&pane, drawing, &mut parts);
        add_range_figures(&pane, &drawing.shown_box(), &mut parts);
        for rapid in [true, false] {
            let strokes = drawing.strokes.iter();
            for stroke in strokes.filter(|it| (it.line_kind == PathLine::Rapid) == rapid) {
                let points = stroke.points.iter().map(|point| pane.to_units(*point));
                clip_to_frame(points, pane.frame, |part| {
                    parts.push(PictureItem::Line(
                        LinePen::for_line(stroke.line_kind),
                        part.to_vec(),
                    ));
                });
            }
        }
    }
    parts
}

/// The title, the times and the legend of the tools. Returns them, and the vertical position
/// below them in picture units.
fn head_items(drawing: &MillDrawing, wide: f64, language: Language) -> (Vec<PictureItem>, f64) {
    let times = &drawing.times;
    let whole = times.total.rapid + times.total.feed + times.total.thread + times.total.dwell;
    let cutting = times.total.feed + times.total.thread;
    let summary = say::picture_time(format_time(whole), format_time(cutting)).text(language);
    let mut parts = vec![
        PictureItem::Text {
            position: (EDGE, 24.0),
            text: drawing.title.clone(),
            anchor: TextAnchor::Left,
        },
        PictureItem::Text {
            position: (wide - EDGE, 24.0),
            text: summary,
            anchor: TextAnchor::Right,
        },
    ];
    let (mut x, mut y) = (EDGE, LEGEND_TOP);
    for (tool, seconds) in times.cutting() {
        let Some(index) = drawing.tools.iter().position(|known| *known == tool) else {
            continue;
        };
        let words = say::picture_mill_tool(tool, format_time(seconds)).text(language);
        let entry = SAMPLE + GAP + text_width(&words) + ENTRY_GAP;
        if x + entry > wide - EDGE && x > EDGE {
            (x, y) = (EDGE, y + ROW_HEIGHT);
        }
        let made = PathLine::Cut(u8::try_from(index).unwrap_or(u8::MAX));
        parts.push(PictureItem::Line(
            LinePen::for_line(made),
            vec![(x, y), (x + SAMPLE, y)],
        ));
        parts.push(PictureItem::Text {
            position: (x + SAMPLE + GAP, y + 5.0),
            text: words,
            anchor: TextAnchor::Left,
        });
        x += entry;
    }
    // The path shows X, Y and Z only. The range of rotary axes is written as text.
    for (further, least, greatest) in &drawing.further {
        let unit = if further.rotary { "°" } else { " mm" };
        let (least, greatest) = (format_figure(*least), format_figure(*greatest));
        let words = format!("{} {least} … {greatest}{unit}", further.letter);
        let entry = text_width(&words) + ENTRY_GAP;
        if x + entry > wide - EDGE && x > EDGE {
            (x, y) = (EDGE, y + ROW_HEIGHT);
        }
        parts.push(PictureItem::Text {
            position: (x, y + 5.0),
            text: words,
            anchor: TextAnchor::Left,
        });
        x += entry;
    }
    (parts, y + ROW_HEIGHT)
}

/// Radius of the mark of a hole, and the length of an arm of its cross, picture units.
const HOLE_RADIUS: f64 = 4.0;
const HOLE_ARM: f64 = 6.5;
/// Number of chords of the circle of the mark.
const HOLE_CHORDS: u32 = 16;

/// Adds a circle with a cross for each hole that a view shows from above.
fn add_hole_marks(pane: &MillPane, drawing: &MillDrawing, parts: &mut Vec<PictureItem>) {
    let Some(axes) = pane.view.axes() else {
        return;
    };
    for hole in drawing.holes.marks() {
        if axes.contains(&hole.along) {
            continue;
        }
        let (x, y) = pane.to_units(hole.point);
        let circle = (0..=HOLE_CHORDS).map(|chord| {
            let angle = core::f64::consts::TAU * f64::from(chord) / f64::from(HOLE_CHORDS);
            (
                x + HOLE_RADIUS * libm::cos(angle),
                y + HOLE_RADIUS * libm::sin(angle),
            )
        });
        let pen = LinePen::for_line(PathLine::Cut(hole.tool));
        let lines = [
            circle.collect(),
            vec![(x - HOLE_ARM, y), (x + HOLE_ARM, y)],
            vec![(x, y - HOLE_ARM), (x, y + HOLE_ARM)],
        ];
        for line in lines {
            clip_to_frame(line.into_iter(), pane.frame, |part| {
                parts.push(PictureItem::Line(pen, part.to_vec()));
            });
        }
    }
}

/// Adds the least and greatest coordinates of the path, mm, along the two axes of a view.
fn add_range_figures(pane: &MillPane, cube: &PathBox, parts: &mut Vec<PictureItem>) {
    let Some([right, up]) = pane.view.axes() else {
        return;
    };
    let (left, upper, _, lower) = pane.frame;
    for (axis, level) in [(right, cube.low[right]), (right, cube.high[right])] {
        let mut point = cube.low;
        point[axis] = level;
        let (x, _) = pane.to_units(point);
        parts.push(PictureItem::Text {
            position: (x, lower + 16.0),
            text: format_figure(level),
            anchor: TextAnchor::Center,
        });
    }
    for level in [cube.low[up], cube.high[up]] {
        let mut point = cube.low;
        point[up] = level;
        let (_, y) = pane.to_units(point);
        parts.push(PictureItem::Text {
            position: (left - 6.0, y.clamp(upper + 10.0, lower) + 4.0),
            text: format_figure(level),
            anchor: TextAnchor::Right,
        });
    }
}

fn format_figure(value: f64) -> String {
    let rounded = (value * 10.0).round() / 10.0;
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}
