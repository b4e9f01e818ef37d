//! Places the part and its dimensions on the paper.
//!
//! ```text
//!   leaders and widths
//!   +-----------------+  diameters, the
//!   |   the part      |  smallest next
//!   +-----------------+  to the part
//!   lengths, the shortest next to the part
//! ```

use gsk_core::units::Point;

use super::hatch::hatch;
use super::{DrawingArrow, DrawingLabel, DrawingLine, DrawingPen, PaperPoint, TaskDrawing};
use crate::criterion::{CriterionRule, PartDimension, PartSurface, TolerancedSize};
use crate::outline::{DimensionPlace, PieceForm, TaskOutline, locate};
use crate::task::ExerciseTask;

/// Distance between two rows of dimensions, in text heights.
const ROW: f64 = 1.9;
/// Distance between the part and the first row of dimensions, in text heights.
const GAP: f64 = 1.6;
/// Width of the empty margin of the paper, in text heights.
const EDGE: f64 = 0.8;
/// Length of an arrowhead, in text heights.
const ARROW: f64 = 0.75;
/// Distance between a dimension line and the middle of its text, in text heights.
const TEXT_DISTANCE: f64 = 0.72;
/// Width of a character, in text heights.
const CHARACTER: f64 = 0.56;
/// Length of the uncut end that is drawn, as a fraction of the length of the outline.
const REST: f64 = 0.12;
/// Greatest height of the part on the paper, as a fraction of the paper width.
const MAX_PART_HEIGHT: f64 = 0.6;
/// Distance between hatch lines, in text heights.
const HATCH: f64 = 0.6;

/// A dimension with its position on the outline and its text.
struct PlacedDimension {
    criterion: usize,
    place: DimensionPlace,
    text: String,
}

/// Draws the part of a task with its marked dimensions. `width` is the width of the drawing and
/// `text_height` that of its texts, in drawing units. `None` if the task has no outline.
pub fn draw_task(task: &ExerciseTask, width: f64, text_height: f64) -> Option<TaskDrawing> {
    let outline = task.outline.as_ref()?;
    let criteria = task.criteria.iter().enumerate();
    let dimensions: Vec<PlacedDimension> = criteria
        .filter_map(|(criterion, it)| match &it.rule {
            CriterionRule::Size(dimension, size) => Some(PlacedDimension {
                criterion,
                place: locate(outline, dimension)?.0,
                text: dimension_text(dimension, size),
            }),
            _ => None,
        })
        .collect();
    let mut sheet = Sheet::new(outline, &dimensions, width, text_height);
    sheet.draw_part(outline);
    sheet.draw_dimensions(outline, &dimensions);
    Some(sheet.drawing)
}

/// The text of a dimension, as `⌀40 ±0.05`.
fn dimension_text(dimension: &PartDimension, size: &TolerancedSize) -> String {
    let figure = |value: f64| format!("{}", (value * 1000.0).round() / 1000.0);
    let (upper, lower) = (size.max - size.nominal, size.min - size.nominal);
    let tolerance = match (upper + lower).abs() < 1e-9 {
        true => format!("±{}", figure(upper)),
        false => format!("{:+}/{:+}", round(upper), round(lower)),
    };
    let nominal = figure(size.nominal.abs());
    let nominal = match dimension {
        PartDimension::Diameter { .. } => format!("⌀{nominal}"),
        PartDimension::Length { .. } | PartDimension::Width { .. } => nominal,
        PartDimension::Angle { .. } => format!("{nominal}°"),
        PartDimension::Radius { .. } => format!("R{nominal}"),
        PartDimension::Pitch { .. } => format!("P{nominal}"),
        PartDimension::ThreadDepth { .. } => format!("h{nominal}"),
    };
    format!("{nominal} {tolerance}")
}

fn round(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

/// Returns whether a diameter is visible from the front, so that it is dimensioned there: no larger
/// surface is before it, or in a bore no smaller one.
fn is_seen_from_front(outline: &TaskOutline, place: &DimensionPlace) -> bool {
    let DimensionPlace::Across { radius, z, surface } = *place else {
        return false;
    };
    let points = outline.points(surface);
    let mut before = points.iter().filter(|point| point.z >= z.0);
    match surface {
        PartSurface::Outside => before.all(|point| point.x <= radius + 1e-6),
        PartSurface::Bore => before.all(|point| point.x >= radius - 1e-6),
    }
}

/// The paper of the drawing, with scale and position of the part on it.
struct Sheet {
    drawing: TaskDrawing,
    /// Drawing units per mm of the part.
    scale: f64,
    /// Point on the paper at which the spindle axis crosses the front of the part.
    origin: PaperPoint,
    /// Length of the drawn part with its uncut end, mm.
    length: f64,
    /// Greatest radius of the part, mm.
    radius: f64,
}

impl Sheet {
    fn new(outline: &TaskOutline, dimensions: &[PlacedDimension], width: f64, text: f64) -> Self {
        let count = |is_kind: &dyn Fn(&DimensionPlace) -> bool| {
            dimensions.iter().filter(|it| is_kind(&it.place)).count() as f64
        };
        let stacked = count(&|place| is_seen_from_front(outline, place));
        let lengths = count(&|place| matches!(place, DimensionPlace::FromFront(_)));
        let above =
            count(&|place| matches!(place, DimensionPlace::At(_) | DimensionPlace::Along(..)));
        let rows = |count: f64| {
            if count > 0.0 {
                (GAP + count * ROW) * text
            } else {
                text
            }
        };
        let (length, radius) = outline.extent();
        let length = (length * (1.0 + REST)).max(1e-3);
        let radius = radius.max(1e-3);
        let edge = EDGE * text;
        let (left, right) = (edge, edge + rows(stacked));
        let by_width = (width - left - right).max(1.0) / length;
        let by_height = width * MAX_PART_HEIGHT / (2.0 * radius);
        let scale = by_width.min(by_height);
        let top = edge + rows(above);
        let height = top + 2.0 * radius * scale + rows(lengths) + edge;
        let spare = (width - left - right - length * scale).max(0.0);
        Self {
            drawing: TaskDrawing {
                width,
                height,
                text_height: text,
                ..TaskDrawing::default()
            },
            scale,
            origin: PaperPoint {
                right: width - right - spare / 2.0,
                down: top + radius * scale,
            },
            length,
            radius,
        }
    }

    fn text(&self, heights: f64) -> f64 {
        heights * self.drawing.text_height
    }

    /// Converts a point of the part, above the axis, to the paper.
    fn above(&self, point: Point) -> PaperPoint {
        PaperPoint {
            right: self.origin.right + point.z * self.scale,
            down: self.origin.down - point.x * self.scale,
        }
    }

    /// Converts a point of the part to the paper, mirrored below the axis.
    fn below(&self, point: Point) -> PaperPoint {
        self.above(Point::new(-point.x, point.z))
    }

    fn line(&mut self, pen: DrawingPen, points: Vec<PaperPoint>) {
        self.drawing.lines.push(DrawingLine { pen, points });
    }

    fn draw_part(&mut self, outline: &TaskOutline) {
        let mut outside = outline.points(PartSurface::Outside);
        let mut bore = outline.points(PartSurface::Bore);
        let is_bored = !bore.is_empty();
        for surface in [&mut outside, &mut bore] {
            if let Some(last) = surface.last().copied() {
                surface.push(Point::new(last.x, -self.length));
            }
        }
        let half: Vec<Point> = outside.iter().chain(bore.iter().rev()).copied().collect();
        for side in [Self::above, Self::below] {
            if is_bored {
                let polygon: Vec<PaperPoint> = half.iter().map(|it| side(self, *it)).collect();
                let distance = self.text(HATCH);
                for line in hatch(&polygon, distance) {
                    self.line(DrawingPen::Hatch, line.to_vec());
                }
            }
            for surface in [&outside, &bore] {
                let points = surface.iter().map(|it| side(self, *it)).collect();
                self.line(DrawingPen::Edge, points);
            }
        }
        self.draw_edges(outline, is_bored);
        self.draw_threads(outline);
        self.draw_break(&outside);
        let over = self.text(0.4);
        let left = self.above(Point::new(0.0, -self.length)).right - over;
        let axis = |right| PaperPoint {
            right,
            down: self.origin.down,
        };
        let ends = vec![axis(left), axis(self.origin.right + over)];
        self.line(DrawingPen::Axis, ends);
        self.drawing.lines.retain(|line| line.points.len() > 1);
    }

    /// Draws the circular edges, which appear as lines across the part: all of a solid part, only
    /// those of the bore in a section.
    fn draw_edges(&mut self, outline: &TaskOutline, is_bored: bool) {
        let surface = match is_bored {
            true => PartSurface::Bore,
            false => PartSurface::Outside,
        };
        let pieces = outline.pieces(surface).to_vec();
        for pair in pieces.windows(2) {
            let corner = pair[0].to;
            let is_tangent = matches!(pair[0].form, PieceForm::Arc(_)) && pair[1].is_cylinder()
                || pair[0].is_cylinder() && matches!(pair[1].form, PieceForm::Arc(_));
            if !is_tangent {
                let ends = vec![self.above(corner), self.below(corner)];
                self.line(DrawingPen::Edge, ends);
            }
        }
        if is_bored && let Some(first) = pieces.first() {
            let ends = vec![self.above(first.from), self.below(first.from)];
            self.line(DrawingPen::Edge, ends);
        }
    }

    /// Draws the root line of each thread.
    fn draw_threads(&mut self, outline: &TaskOutline) {
        for surface in [PartSurface::Outside, PartSurface::Bore] {
            for piece in outline.pieces(surface) {
                let PieceForm::Thread(pitch) = piece.form else {
                    continue;
                };
                let inwards = match surface {
                    PartSurface::Outside => -0.61 * pitch,
                    PartSurface::Bore => 0.61 * pitch,
                };
                for side in [Self::above, Self::below] {
                    let root = |point: Point| Point::new(point.x + inwards, point.z);
                    let ends = [piece.from, piece.to].map(|end| side(self, root(end)));
                    self.line(DrawingPen::Thin, ends.to_vec());
                }
            }
        }
    }

    /// Draws the break line at the uncut end of the part.
    fn draw_break(&mut self, outside: &[Point]) {
        let Some(last) = outside.last() else { return };
        let (top, bottom) = (self.above(*last), self.below(*last));
        let wave = self.text(0.4);
        let at = |part: f64, aside: f64| PaperPoint {
            right: top.right + aside,
            down: top.down + (bottom.down - top.down) * part,
        };
        let points = vec![
            top,
            at(0.42, 0.0),
            at(0.46, -wave),
            at(0.54, wave),
            at(0.58, 0.0),
            bottom,
        ];
        self.line(DrawingPen::Thin, points);
    }

    fn draw_dimensions(&mut self, outline: &TaskOutline, dimensions: &[PlacedDimension]) {
        let mut sorted: Vec<&PlacedDimension> = dimensions.iter().collect();
        let size = |it: &PlacedDimension| match it.place {
            DimensionPlace::Across { radius, .. } => radius,
            DimensionPlace::FromFront(corner) => -corner.z,
            DimensionPlace::Along(..) | DimensionPlace::At(_) => 0.0,
        };
        sorted.sort_by(|one, other| size(one).total_cmp(&size(other)));
        let (mut beside, mut below, mut above) = (0.0, 0.0, 0.0);
        for dimension in sorted {
            match dimension.place {
                DimensionPlace::Across { radius, z, .. } => {
                    let is_beside = is_seen_from_front(outline, &dimension.place);
                    let row = is_beside.then_some(beside);
                    self.draw_diameter(dimension, radius, z, row);
                    beside += f64::from(u8::from(is_beside));
                }
                DimensionPlace::FromFront(corner) => {
                    self.draw_length(dimension, corner, below);
                    below += 1.0;
                }
                DimensionPlace::Along(front, back) => {
                    self.draw_width(dimension, front, back, above);
                    above += 1.0;
                }
                DimensionPlace::At(point) => {
                    self.draw_leader(dimension, point, above);
                    above += 1.0;
                }
            }
        }
    }

    /// Draws a diameter dimension, in a row beside the part or across its cylinder.
    fn draw_diameter(
        &mut self,
        dimension: &PlacedDimension,
        radius: f64,
        z: (f64, f64),
        row: Option<f64>,
    ) {
        let pen = DrawingPen::Dimension(dimension.criterion);
        let (right, start) = match row {
            Some(row) => {
                let right = self.origin.right + self.text(GAP + row * ROW);
                (right, Some(self.above(Point::new(radius, z.0)).right))
            }
            None => {
                let middle = Point::new(radius, (z.0 + z.1) / 2.0);
                (self.above(middle).right, None)
            }
        };
        let (top, bottom) = (
            self.origin.down - radius * self.scale,
            self.origin.down + radius * self.scale,
        );
        let at = |right: f64, down: f64| PaperPoint { right, down };
        if let Some(start) = start {
            let over = right + self.text(0.4);
            for down in [top, bottom] {
                self.line(pen, vec![at(start, down), at(over, down)]);
            }
        }
        self.dimension_line(dimension.criterion, at(right, top), at(right, bottom));
        // Beside the axis, which would cross the text.
        let aside = match row {
            Some(_) => 0.0,
            None => radius * self.scale / 2.0,
        };
        self.drawing.labels.push(DrawingLabel {
            criterion: dimension.criterion,
            middle: at(right - self.text(TEXT_DISTANCE), self.origin.down - aside),
            is_upright: true,
            text: dimension.text.clone(),
        });
    }

    /// Draws a length dimension from the front of the part, in a row below the part.
    fn draw_length(&mut self, dimension: &PlacedDimension, corner: Point, row: f64) {
        let down = self.origin.down + self.radius * self.scale + self.text(GAP + row * ROW);
        let front = PaperPoint {
            right: self.origin.right,
            down: self.origin.down,
        };
        let corner = self.below(corner);
        self.draw_span(dimension, corner, front, down);
    }

    /// Draws the length dimension of a cylinder, in a row above the part.
    fn draw_width(&mut self, dimension: &PlacedDimension, front: Point, back: Point, row: f64) {
        let down = self.origin.down - self.radius * self.scale - self.text(GAP + row * ROW);
        let (front, back) = (self.above(front), self.above(back));
        self.draw_span(dimension, back, front, down);
    }

    /// Draws a horizontal dimension line between two points of the part, at a height on the paper.
    fn draw_span(
        &mut self,
        dimension: &PlacedDimension,
        left: PaperPoint,
        right: PaperPoint,
        down: f64,
    ) {
        let pen = DrawingPen::Dimension(dimension.criterion);
        let over = match down > self.origin.down {
            true => self.text(0.4),
            false => -self.text(0.4),
        };
        let at = |right: f64, down: f64| PaperPoint { right, down };
        for point in [left, right] {
            self.line(pen, vec![point, at(point.right, down + over)]);
        }
        let text_width = self.text_width(&dimension.text);
        let width = right.right - left.right;
        let middle = match text_width < width - self.text(0.5) {
            true => {
                self.dimension_line(
                    dimension.criterion,
                    at(left.right, down),
                    at(right.right, down),
                );
                (left.right + right.right) / 2.0
            }
            false => {
                // Arrows from outside, the text to the left of them.
                let tail = self.text(1.8);
                for (tip, from) in [
                    (left.right, left.right - tail - text_width),
                    (right.right, right.right + tail),
                ] {
                    self.line(pen, vec![at(from, down), at(tip, down)]);
                    self.arrow(dimension.criterion, at(tip, down), at(from, down));
                }
                left.right - self.text(1.4) - text_width / 2.0
            }
        };
        self.drawing.labels.push(DrawingLabel {
            criterion: dimension.criterion,
            middle: at(middle, down - self.text(TEXT_DISTANCE)),
            is_upright: false,
            text: dimension.text.clone(),
        });
    }

    /// Draws a leader from a text above the part to a point of its surface.
    fn draw_leader(&mut self, dimension: &PlacedDimension, point: Point, row: f64) {
        let pen = DrawingPen::Dimension(dimension.criterion);
        let tip = self.above(point);
        let down = self.origin.down - self.radius * self.scale - self.text(GAP + row * ROW);
        let half = self.text_width(&dimension.text) / 2.0;
        let edge = self.text(EDGE);
        let lean = self.text(1.0);
        let least = edge + half;
        let most = (self.drawing.width - edge - half).max(least);
        let middle = (tip.right - lean - half).clamp(least, most);
        let shoulder = PaperPoint {
            right: middle + half,
            down,
        };
        let start = PaperPoint {
            right: middle - half,
            down,
        };
        self.line(pen, vec![start, shoulder, tip]);
        self.arrow(dimension.criterion, tip, shoulder);
        self.drawing.labels.push(DrawingLabel {
            criterion: dimension.criterion,
            middle: PaperPoint {
                right: middle,
                down: down - self.text(TEXT_DISTANCE),
            },
            is_upright: false,
            text: dimension.text.clone(),
        });
    }

    fn text_width(&self, text: &str) -> f64 {
        self.text(CHARACTER) * text.chars().count() as f64
    }

    /// Draws a dimension line with an arrowhead at both ends.
    fn dimension_line(&mut self, criterion: usize, from: PaperPoint, to: PaperPoint) {
        self.line(DrawingPen::Dimension(criterion), vec![from, to]);
        self.arrow(criterion, from, to);
        self.arrow(criterion, to, from);
    }

    /// Draws an arrowhead with its tip at `tip`, pointing away from `from`.
    fn arrow(&mut self, criterion: usize, tip: PaperPoint, from: PaperPoint) {
        let (right, down) = (from.right - tip.right, from.down - tip.down);
        let length = right.hypot(down);
        if length < 1e-9 {
            return;
        }
        let size = self.text(ARROW).min(length / 2.0) / length;
        let (back_right, back_down) = (right * size, down * size);
        let corner = |side: f64| PaperPoint {
            right: tip.right + back_right - side * back_down / 5.0,
            down: tip.down + back_down + side * back_right / 5.0,
        };
        self.drawing.arrows.push(DrawingArrow {
            criterion,
            corners: [tip, corner(1.0), corner(-1.0)],
        });
    }
}
