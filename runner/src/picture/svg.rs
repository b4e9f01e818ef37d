//! Writes the drawing as SVG.

use std::fmt::Write;

use gsk_messages::Language;

use super::clip::clipped;
use super::coverage::Coverage;
use super::drawing::Drawing;
use super::extent::Size;
use super::layout::Layout;
use super::legend::{EDGE, GAP, SAMPLE, width};
use super::numbers::HEIGHT;
use super::pens::{ARM, DIMENSION, MARK, Pen};
use super::pieces::Made;

/// Draws the whole picture.
pub fn render(drawing: &Drawing, language: Language) -> String {
    let layout = Layout::new(drawing, language);
    let mut out = open(drawing.look().size);
    grid(&mut out, &layout);
    scenery(&mut out, drawing, &layout);
    let mut covered: Vec<(Made, Coverage)> = Vec::new();
    for (made, points) in drawing.pieces().strokes() {
        let points = points.map(|point| layout.place(point));
        let known = covered.iter().position(|(known, _)| *known == made);
        let index = known.unwrap_or_else(|| {
            covered.push((made, Coverage::new(layout.frame)));
            covered.len() - 1
        });
        let Some((_, coverage)) = covered.get_mut(index) else {
            continue;
        };
        clipped(points, layout.frame, |part| {
            coverage.bare(part, |part| polyline(&mut out, Pen::of(made), part));
        });
    }
    for mark in drawing
        .scenery()
        .marks
        .iter()
        .filter(|it| layout.shows(**it))
    {
        let (x, y) = layout.place(*mark);
        let _ = writeln!(
            out,
            "<path d=\"M{:.2},{:.2} l{w},{w} m0,-{w} l-{w},{w}\" fill=\"none\" {}/>",
            x - ARM,
            y - ARM,
            style(MARK),
            w = 2.0 * ARM
        );
    }
    dimensions(&mut out, &layout);
    numbers(&mut out, &layout);
    head(&mut out, &layout);
    out.push_str("</svg>\n");
    out
}

/// The beginning of a file, with a white background.
pub(super) fn open(size: Size) -> String {
    let (wide, tall) = size.units();
    let (width, height) = (size.width(), size.height());
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {wide} {tall}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"{wide}\" height=\"{tall}\" fill=\"#ffffff\"/>\n"
    )
}

/// Writes a line through points.
pub(super) fn polyline(out: &mut String, pen: Pen, points: &[(f64, f64)]) {
    let style = style(pen);
    let _ = write!(
        out,
        "<polyline fill=\"none\" stroke-linejoin=\"round\" {style} points=\""
    );
    for (index, (x, y)) in points.iter().enumerate() {
        let between = if index == 0 { "" } else { " " };
        let _ = write!(out, "{between}{x:.2},{y:.2}");
    }
    out.push_str("\"/>\n");
}

/// Writes a text at a point; `anchor` is the SVG text-anchor.
pub(super) fn text(out: &mut String, (x, y): (f64, f64), words: &str, anchor: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\">{}</text>",
        safe(words)
    );
}

/// Writes part and clamping.
fn scenery(out: &mut String, drawing: &Drawing, layout: &Layout) {
    let (low, high) = layout.window();
    for (look, polygons) in drawing.scenery().within(low, high) {
        if polygons.is_empty() {
            continue;
        }
        let fill = look.fill.map_or_else(
            || "none".to_owned(),
            |[red, green, blue]| format!("#{red:02x}{green:02x}{blue:02x}"),
        );
        let _ = write!(out, "<path fill=\"{fill}\" {} d=\"", style(look.edge));
        for polygon in polygons {
            for (index, point) in polygon.iter().enumerate() {
                let (x, y) = layout.place(*point);
                let _ = write!(out, "{}{x:.2},{y:.2}", if index == 0 { "M" } else { " " });
            }
            out.push('Z');
        }
        out.push_str("\"/>\n");
    }
}

fn style(pen: Pen) -> String {
    let [red, green, blue] = pen.color;
    let mut style = format!(
        "stroke=\"#{red:02x}{green:02x}{blue:02x}\" stroke-width=\"{}\"",
        pen.width
    );
    if !pen.dash.is_empty() {
        let dash: Vec<String> = pen.dash.iter().map(ToString::to_string).collect();
        let _ = write!(style, " stroke-dasharray=\"{}\"", dash.join(" "));
    }
    style
}

fn head(out: &mut String, layout: &Layout) {
    let head = &layout.head;
    let _ = writeln!(
        out,
        "<text x=\"{EDGE}\" y=\"30\" font-size=\"16\">{}</text>\
         <text x=\"{}\" y=\"30\" text-anchor=\"end\">{}</text>",
        safe(&head.title),
        layout.size.0 - EDGE,
        safe(&head.summary)
    );
    for entry in &head.entries {
        let (x, y) = entry.at;
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\">{}</text>\
             <line x1=\"{x}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" {}/>",
            x + SAMPLE + GAP,
            y + 5.0,
            safe(&entry.words),
            x + SAMPLE,
            style(entry.pen)
        );
    }
}

fn dimensions(out: &mut String, layout: &Layout) {
    for dimension in &layout.dimensions {
        if let Some([(x, from), (_, to)]) = dimension.line {
            let _ = writeln!(
                out,
                "<line x1=\"{x:.2}\" y1=\"{from:.2}\" x2=\"{x:.2}\" y2=\"{to:.2}\" {}/>",
                style(DIMENSION)
            );
        }
        let (x, y) = dimension.at;
        let _ = writeln!(
            out,
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"13\" text-anchor=\"middle\" \
             stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            x + width(&dimension.words) / 2.0,
            y + HEIGHT - 4.0,
            dimension.words
        );
    }
}

fn numbers(out: &mut String, layout: &Layout) {
    for number in &layout.numbers {
        let ((end_x, end_y), (x, y)) = (number.end, number.at);
        let _ = writeln!(
            out,
            "<circle cx=\"{end_x:.2}\" cy=\"{end_y:.2}\" r=\"2\"/>\
             <text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"13\" stroke=\"#ffffff\" \
             stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            y + HEIGHT - 4.0,
            number.words
        );
    }
}

fn grid(out: &mut String, layout: &Layout) {
    let (left, top, right, bottom) = layout.frame;
    for tick in &layout.z_ticks {
        let (at, label) = (tick.at, &tick.label);
        let _ = writeln!(
            out,
            "<line x1=\"{at:.2}\" y1=\"{top}\" x2=\"{at:.2}\" y2=\"{bottom}\" stroke=\"#e0e0e0\"/>\
             <text x=\"{at:.2}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            bottom + 22.0
        );
    }
    for tick in &layout.x_ticks {
        let (at, label) = (tick.at, &tick.label);
        let _ = writeln!(
            out,
            "<line x1=\"{left}\" y1=\"{at:.2}\" x2=\"{right}\" y2=\"{at:.2}\" stroke=\"#e0e0e0\"/>\
             <text x=\"{}\" y=\"{:.2}\" text-anchor=\"end\">{label}</text>",
            left - 8.0,
            at + 5.0
        );
    }
    let _ = writeln!(
        out,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" \
         stroke=\"#b0b0b0\"/>",
        right - left,
        bottom - top
    );
    if let Some(at) = layout.spindle_axis {
        let _ = writeln!(
            out,
            "<line x1=\"{left}\" y1=\"{at:.2}\" x2=\"{right}\" y2=\"{at:.2}\" stroke=\"#808080\" \
             stroke-dasharray=\"16 4 3 4\"/>"
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\">Z mm</text>",
        right + 8.0,
        bottom + 22.0
    );
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\">X ⌀ mm</text>",
        left - 60.0,
        top - 10.0
    );
}

/// Escapes a text for XML and replaces the control characters that XML forbids.
fn safe(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '\u{fffe}' | '\u{ffff}' => out.push(char::REPLACEMENT_CHARACTER),
            letter if letter.is_control() => out.push(char::REPLACEMENT_CHARACTER),
            letter => out.push(letter),
        }
    }
    out
}
