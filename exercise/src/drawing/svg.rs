//! Writes a drawing as SVG.

use std::fmt::Write as _;

use super::{DrawingPen, PaperPoint, TaskDrawing};

/// Writes a drawing as an SVG file, black on white.
pub fn write_svg(drawing: &TaskDrawing, title: &str) -> String {
    let (width, height) = (drawing.width, drawing.height);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.2} {height:.2}\" font-family=\"sans-serif\" font-size=\"{:.2}\">\n\
         <title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        drawing.text_height,
        escape_markup(title)
    );
    let thin = drawing.text_height / 14.0;
    for line in &drawing.lines {
        let (factor, dashes) = match line.pen {
            DrawingPen::Edge => (2.2, None),
            DrawingPen::Axis => (1.0, Some((0.8, 0.2, 0.15))),
            DrawingPen::Thin | DrawingPen::Hatch | DrawingPen::Dimension(_) => (1.0, None),
        };
        let dashes = dashes.map_or_else(String::new, |(long, gap, short)| {
            let [long, gap, short] = [long, gap, short].map(|it| it * drawing.text_height);
            format!(" stroke-dasharray=\"{long:.2} {gap:.2} {short:.2} {gap:.2}\"")
        });
        let points = list(&line.points);
        // Writing to a string cannot fail.
        let _ = writeln!(
            svg,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"#000\" \
             stroke-linejoin=\"round\" stroke-width=\"{:.2}\"{dashes}/>",
            thin * factor
        );
    }
    for arrow in &drawing.arrows {
        let _ = writeln!(svg, "<polygon points=\"{}\"/>", list(&arrow.corners));
    }
    for label in &drawing.labels {
        let (x, y) = (label.middle.right, label.middle.down);
        let turn = match label.is_upright {
            true => format!(" transform=\"rotate(-90 {x:.2} {y:.2})\""),
            false => String::new(),
        };
        let _ = writeln!(
            svg,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" text-anchor=\"middle\"{turn}>{}</text>",
            escape_markup(&label.text)
        );
    }
    svg + "</svg>\n"
}

fn list(points: &[PaperPoint]) -> String {
    let pairs = points
        .iter()
        .map(|point| format!("{:.2},{:.2}", point.right, point.down));
    pairs.collect::<Vec<_>>().join(" ")
}

/// Escapes a text for XML and HTML.
pub fn escape_markup(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
