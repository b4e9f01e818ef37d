//! Writes the drawing as SVG.

use std::fmt::Write;

use gsk_messages::Language;

use crate::clip::clip_to_frame;
use crate::coverage::Coverage;
use crate::drawing::PathDrawing;
use crate::extent::PictureSize;
use crate::layout::PathLayout;
use crate::legend::{EDGE, GAP, SAMPLE};
use crate::number_placement::HEIGHT;
use crate::path_pieces::PathLine;
use crate::pens::{COLLISION_MARK, DIMENSION, LinePen, MARK_ARM};
use crate::text_width::text_width;

/// Draws a toolpath and returns the text of the SVG file. `language` is the language of its
/// texts.
pub fn render(drawing: &PathDrawing, language: Language) -> String {
    let layout = PathLayout::new(drawing, language);
    let mut out = begin_file(drawing.options().size);
    write_grid(&mut out, &layout);
    write_scenery(&mut out, drawing, &layout);
    let mut covered: Vec<(PathLine, Coverage)> = Vec::new();
    for (made, points) in drawing.pieces().strokes() {
        let points = points.map(|point| layout.to_units(point));
        let known = covered.iter().position(|(known, _)| *known == made);
        let index = known.unwrap_or_else(|| {
            covered.push((made, Coverage::new(layout.frame)));
            covered.len() - 1
        });
        let Some((_, coverage)) = covered.get_mut(index) else {
            continue;
        };
        clip_to_frame(points, layout.frame, |part| {
            coverage.draw_uncovered(part, |part| {
                write_polyline(&mut out, LinePen::for_line(made), part);
            });
        });
    }
    for mark in drawing
        .scenery()
        .marks
        .iter()
        .filter(|it| layout.contains(**it))
    {
        let (x, y) = layout.to_units(*mark);
        let _ = writeln!(
            out,
            "<path d=\"M{:.2},{:.2} l{w},{w} m0,-{w} l-{w},{w}\" fill=\"none\" {}/>",
            x - MARK_ARM,
            y - MARK_ARM,
            stroke_style(COLLISION_MARK),
            w = 2.0 * MARK_ARM
        );
    }
    write_dimensions(&mut out, &layout);
    write_numbers(&mut out, &layout);
    write_head(&mut out, &layout);
    out.push_str("</svg>\n");
    out
}

/// Returns the beginning of an SVG file for a picture of this size, with a white background.
pub(super) fn begin_file(size: PictureSize) -> String {
    let (wide, tall) = size.units();
    let (width, height) = (size.width(), size.height());
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {wide} {tall}\" font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"{wide}\" height=\"{tall}\" fill=\"#ffffff\"/>\n"
    )
}

/// Writes a line through points, in picture units.
pub(super) fn write_polyline(out: &mut String, pen: LinePen, points: &[(f64, f64)]) {
    let style = stroke_style(pen);
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

/// Writes a text at a point, in picture units; `anchor` is its SVG `text-anchor`.
pub(super) fn write_text(out: &mut String, (x, y): (f64, f64), words: &str, anchor: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\">{}</text>",
        escape_xml(words)
    );
}

/// Writes the part and its clamping, under the path.
fn write_scenery(out: &mut String, drawing: &PathDrawing, layout: &PathLayout) {
    let (low, high) = layout.visible_range();
    for (look, polygons) in drawing.scenery().clip_to(low, high) {
        if polygons.is_empty() {
            continue;
        }
        let fill = look.fill.map_or_else(
            || "none".to_owned(),
            |[red, green, blue]| format!("#{red:02x}{green:02x}{blue:02x}"),
        );
        let _ = write!(
            out,
            "<path fill=\"{fill}\" {} d=\"",
            stroke_style(look.edge)
        );
        for polygon in polygons {
            for (index, point) in polygon.iter().enumerate() {
                let (x, y) = layout.to_units(*point);
                let _ = write!(out, "{}{x:.2},{y:.2}", if index == 0 { "M" } else { " " });
            }
            out.push('Z');
        }
        out.push_str("\"/>\n");
    }
}

fn stroke_style(pen: LinePen) -> String {
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

fn write_head(out: &mut String, layout: &PathLayout) {
    let head = &layout.head;
    let _ = writeln!(
        out,
        "<text x=\"{EDGE}\" y=\"30\" font-size=\"16\">{}</text>\
         <text x=\"{}\" y=\"30\" text-anchor=\"end\">{}</text>",
        escape_xml(&head.title),
        layout.size.0 - EDGE,
        escape_xml(&head.summary)
    );
    for entry in &head.entries {
        let (x, y) = entry.line_start;
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\">{}</text>\
             <line x1=\"{x}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" {}/>",
            x + SAMPLE + GAP,
            y + 5.0,
            escape_xml(&entry.text),
            x + SAMPLE,
            stroke_style(entry.pen)
        );
    }
}

fn write_dimensions(out: &mut String, layout: &PathLayout) {
    for dimension in &layout.dimensions {
        if let Some([(x, from), (_, to)]) = dimension.line {
            let _ = writeln!(
                out,
                "<line x1=\"{x:.2}\" y1=\"{from:.2}\" x2=\"{x:.2}\" y2=\"{to:.2}\" {}/>",
                stroke_style(DIMENSION)
            );
        }
        let (x, y) = dimension.corner;
        let _ = writeln!(
            out,
            "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"13\" text-anchor=\"middle\" \
             stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            x + text_width(&dimension.text) / 2.0,
            y + HEIGHT - 4.0,
            dimension.text
        );
    }
}

fn write_numbers(out: &mut String, layout: &PathLayout) {
    for number in &layout.numbers {
        let ((end_x, end_y), (x, y)) = (number.end, number.corner);
        let _ = writeln!(
            out,
            "<circle cx=\"{end_x:.2}\" cy=\"{end_y:.2}\" r=\"2\"/>\
             <text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"13\" stroke=\"#ffffff\" \
             stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            y + HEIGHT - 4.0,
            number.text
        );
    }
}

fn write_grid(out: &mut String, layout: &PathLayout) {
    let (left, top, right, bottom) = layout.frame;
    for tick in &layout.z_ticks {
        let (at, label) = (tick.position, &tick.label);
        let _ = writeln!(
            out,
            "<line x1=\"{at:.2}\" y1=\"{top}\" x2=\"{at:.2}\" y2=\"{bottom}\" stroke=\"#e0e0e0\"/>\
             <text x=\"{at:.2}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            bottom + 22.0
        );
    }
    for tick in &layout.x_ticks {
        let (at, label) = (tick.position, &tick.label);
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
fn escape_xml(text: &str) -> String {
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
