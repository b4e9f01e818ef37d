//! Makes the lines and texts of a mill's picture.

use gsk_messages::{Language, say};

use super::super::clip::clipped;
use super::super::legend::{EDGE, GAP, SAMPLE, width};
use super::super::pens::Pen;
use super::super::pieces::Made;
use super::panes::{Pane, panes};
use super::{Cube, MillDrawing};
use crate::words::clock;

/// Units above the legend, height of one of its rows, and gap between its entries.
const TOP: f64 = 44.0;
const ROW: f64 = 22.0;
const BETWEEN: f64 = 30.0;

/// The lines of a frame.
const FRAME: Pen = Pen {
    color: [0xB0; 3],
    width: 1.0,
    dash: &[],
};

/// A line or text of a picture, units.
#[derive(Clone, Debug)]
pub enum Part {
    /// A line through points.
    Line(Pen, Vec<(f64, f64)>),
    /// A text.
    Text {
        /// Its reference point.
        at: (f64, f64),
        /// The text.
        words: String,
        /// Its position relative to the point.
        align: Place,
    },
}

/// Position of a text relative to its point.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// The point is at the left end of the text.
    Left,
    /// The point is in the middle of the text.
    Center,
    /// The point is at the right end of the text.
    Right,
}

/// All lines and texts of the picture.
pub fn parts(drawing: &MillDrawing, language: Language) -> Vec<Part> {
    let (wide, tall) = drawing.look.size.units();
    let cube = drawing.cube();
    let (mut parts, top) = head(drawing, wide, language);
    for pane in panes(&cube, (wide, tall), top) {
        let (left, upper, right, lower) = pane.frame;
        let frame = [
            (left, upper),
            (right, upper),
            (right, lower),
            (left, lower),
            (left, upper),
        ];
        parts.push(Part::Line(FRAME, frame.to_vec()));
        parts.push(Part::Text {
            at: (left + 8.0, upper + 18.0),
            words: pane.view.name(language),
            align: Place::Left,
        });
        figures(&pane, &drawing.reach(), &mut parts);
        for rapid in [true, false] {
            let strokes = drawing.strokes.iter();
            for stroke in strokes.filter(|it| (it.made == Made::Rapid) == rapid) {
                let points = stroke.points.iter().map(|point| pane.place(*point));
                clipped(points, pane.frame, |part| {
                    parts.push(Part::Line(Pen::of(stroke.made), part.to_vec()));
                });
            }
        }
    }
    parts
}

/// Title, time and a line for each tool, with their height.
fn head(drawing: &MillDrawing, wide: f64, language: Language) -> (Vec<Part>, f64) {
    let times = &drawing.times;
    let whole = times.all.rapid + times.all.feed + times.all.thread + times.all.dwell;
    let cutting = times.all.feed + times.all.thread;
    let summary = say::picture_time(clock(whole), clock(cutting)).text(language);
    let mut parts = vec![
        Part::Text {
            at: (EDGE, 24.0),
            words: drawing.title.clone(),
            align: Place::Left,
        },
        Part::Text {
            at: (wide - EDGE, 24.0),
            words: summary,
            align: Place::Right,
        },
    ];
    let (mut x, mut y) = (EDGE, TOP);
    for (tool, seconds) in times.cutting() {
        let Some(index) = drawing.tools.iter().position(|known| *known == tool) else {
            continue;
        };
        let words = say::picture_mill_tool(tool, clock(seconds)).text(language);
        let entry = SAMPLE + GAP + width(&words) + BETWEEN;
        if x + entry > wide - EDGE && x > EDGE {
            (x, y) = (EDGE, y + ROW);
        }
        let made = Made::Cut(u8::try_from(index).unwrap_or(u8::MAX));
        parts.push(Part::Line(Pen::of(made), vec![(x, y), (x + SAMPLE, y)]));
        parts.push(Part::Text {
            at: (x + SAMPLE + GAP, y + 5.0),
            words,
            align: Place::Left,
        });
        x += entry;
    }
    // The path shows X, Y and Z only. The range of rotary axes is written as text.
    for (further, least, greatest) in &drawing.further {
        let unit = if further.rotary { "°" } else { " mm" };
        let (least, greatest) = (figure(*least), figure(*greatest));
        let words = format!("{} {least} … {greatest}{unit}", further.letter);
        let entry = width(&words) + BETWEEN;
        if x + entry > wide - EDGE && x > EDGE {
            (x, y) = (EDGE, y + ROW);
        }
        parts.push(Part::Text {
            at: (x, y + 5.0),
            words,
            align: Place::Left,
        });
        x += entry;
    }
    (parts, y + ROW)
}

/// The ends of the path along the axes of a view, mm.
fn figures(pane: &Pane, cube: &Cube, parts: &mut Vec<Part>) {
    let Some([right, up]) = pane.view.axes() else {
        return;
    };
    let (left, upper, _, lower) = pane.frame;
    for (axis, level) in [(right, cube.low[right]), (right, cube.high[right])] {
        let mut point = cube.low;
        point[axis] = level;
        let (x, _) = pane.place(point);
        parts.push(Part::Text {
            at: (x, lower + 16.0),
            words: figure(level),
            align: Place::Center,
        });
    }
    for level in [cube.low[up], cube.high[up]] {
        let mut point = cube.low;
        point[up] = level;
        let (_, y) = pane.place(point);
        parts.push(Part::Text {
            at: (left - 6.0, y.clamp(upper + 10.0, lower) + 4.0),
            words: figure(level),
            align: Place::Right,
        });
    }
}

fn figure(value: f64) -> String {
    let rounded = (value * 10.0).round() / 10.0;
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}
