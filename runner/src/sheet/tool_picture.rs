//! Draws a tool as SVG: insert and holder as the job describes them, Z to the right, X up.

use core::fmt::Write;

use gsk_workpiece::grid::{GridContour, from_grid};
use gsk_workpiece::tool::{BodyPart, Tool, ToolShape};

/// Greatest distance from the tool tip that the picture shows, mm.
const MAX_REACH_MM: f64 = 45.0;

/// Draws a tool with its holder as an SVG picture.
pub(super) fn render_tool(tool: &Tool) -> String {
    let shape = ToolShape::from_tool(tool);
    let holder = shape
        .body
        .iter()
        .filter(|(part, _)| *part != BodyPart::Turret);
    let holder: Vec<&GridContour> = holder.map(|(_, contour)| contour).collect();
    let corners = |contours: &[&GridContour]| {
        let points = contours.iter().flat_map(|contour| contour.iter());
        points.map(|point| from_grid(*point)).collect::<Vec<_>>()
    };
    let mut all = corners(&holder);
    all.extend(corners(&[&shape.cutting]));
    let bounds = |values: Vec<f64>| {
        let low = values
            .iter()
            .copied()
            .fold(0.0, f64::min)
            .max(-MAX_REACH_MM);
        let high = values.iter().copied().fold(0.0, f64::max).min(MAX_REACH_MM);
        (low - 2.0, high + 2.0)
    };
    let (left, right) = bounds(all.iter().map(|point| point.z).collect());
    let (low, high) = bounds(all.iter().map(|point| point.x).collect());
    let mut out = format!(
        "<svg class=\"tool\" viewBox=\"{left:.2} {:.2} {:.2} {:.2}\">",
        -high,
        right - left,
        high - low
    );
    for contour in holder {
        write_polygon(&mut out, contour, "#d0d0d0");
    }
    write_polygon(&mut out, &shape.cutting, "#f0b000");
    out.push_str("<circle r=\"0.6\" fill=\"#c00000\"/></svg>");
    out
}

fn write_polygon(out: &mut String, contour: &GridContour, fill: &str) {
    out.push_str("<polygon points=\"");
    for point in contour {
        let point = from_grid(*point);
        let _ = write!(out, "{:.3},{:.3} ", point.z, -point.x);
    }
    let _ = write!(
        out,
        "\" fill=\"{fill}\" stroke=\"#000\" stroke-width=\"0.3\"/>"
    );
}
