//! The drawing as SVG.

use std::fmt::Write;

use super::drawing::Drawing;
use super::extent::{HEIGHT, WIDTH};
use super::layout::Layout;

/// The whole file.
pub fn render(drawing: &Drawing) -> String {
    let layout = Layout::new(drawing.extent());
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>"
    );
    grid(&mut out, &layout);
    for (rapid, points) in drawing.strokes() {
        let style = if rapid {
            "stroke=\"#c05020\" stroke-width=\"1\" stroke-dasharray=\"6 4\""
        } else {
            "stroke=\"#1040b0\" stroke-width=\"2\""
        };
        let _ = write!(
            out,
            "<polyline fill=\"none\" stroke-linejoin=\"round\" {style} points=\""
        );
        for (index, point) in points.enumerate() {
            let (x, y) = layout.place(point);
            let between = if index == 0 { "" } else { " " };
            let _ = write!(out, "{between}{x:.2},{y:.2}");
        }
        out.push_str("\"/>\n");
    }
    let _ = writeln!(
        out,
        "<text x=\"20\" y=\"34\" font-size=\"18\">{}</text>",
        safe(&drawing.title)
    );
    out.push_str("</svg>\n");
    out
}

fn grid(out: &mut String, layout: &Layout) {
    let (left, right) = Layout::across();
    let (top, bottom) = Layout::down();
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

/// A text as XML may have it: without the control characters it forbids.
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
