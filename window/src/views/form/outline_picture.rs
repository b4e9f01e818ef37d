//! Draws an outline with its points and its dimensions, the axis below it.
//!
//! Diameters and radii are written beside their pieces, Z below the axis. A dimension that
//! would cover another one is left out: the table has all of them.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};
use gsk_core::units::Point;
use gsk_forms::{DrawnOutline, Thousandths};
use gsk_outline::ProfilePiece;

use crate::theme;

/// Space around the outline for dimensions, points.
const MARGIN: f32 = 26.0;
/// Number of lines by which an arc is drawn.
const ARC_STEPS: u32 = 24;
/// Number of points of a line or arc that no dimension covers.
const SAMPLES: u32 = 48;
/// Least length of a taper whose angle is written, points.
const LEAST_TAPER: f32 = 24.0;
/// Radius of the mark at a fault, points.
const MARK_RADIUS: f32 = 9.0;
/// Length of a tick below the axis, points.
const TICK: f32 = 4.0;

/// Draws lines and arcs with the points of the form at which they end.
pub fn draw_outline(painter: &Painter, rect: Rect, outline: &DrawnOutline) {
    let mut drawing = OutlineDrawing::new(painter, rect, &outline.pieces);
    drawing.draw_pieces(theme::FEED_PATH);
    for (number, at) in &outline.points {
        let center = drawing.position(*at);
        painter.circle_filled(center, 2.5, theme::BRIGHT_TEXT);
        let label = center + vec2(6.0, -3.0);
        drawing.label(
            label,
            Align2::LEFT_BOTTOM,
            &number.to_string(),
            theme::HINT_TEXT,
        );
    }
    drawing.draw_dimensions(&outline.pieces);
}

/// Draws the lines and arcs of a drawing with its faults, which have numbers.
pub fn draw_faults(painter: &Painter, rect: Rect, pieces: &[ProfilePiece], marks: &[Point]) {
    let mut drawing = OutlineDrawing::new(painter, rect, pieces);
    drawing.draw_pieces(theme::PART_EDGE);
    for (index, at) in marks.iter().enumerate() {
        let center = drawing.position(*at);
        painter.circle_stroke(center, MARK_RADIUS, Stroke::new(2.0, theme::FAULT_PATH));
        let label = center + vec2(MARK_RADIUS, -MARK_RADIUS);
        let number = (index + 1).to_string();
        drawing.label(label, Align2::LEFT_BOTTOM, &number, theme::ERROR_TEXT);
    }
}

struct OutlineDrawing<'a> {
    painter: Painter,
    pieces: &'a [ProfilePiece],
    rect: Rect,
    /// Points for each millimetre.
    scale: f32,
    /// The position of Z 0 on the axis.
    origin: Pos2,
    /// The dimensions that are written already.
    labels: Vec<Rect>,
    /// Points of the lines and arcs, which no dimension covers.
    drawn: Vec<Pos2>,
}

impl<'a> OutlineDrawing<'a> {
    fn new(painter: &Painter, rect: Rect, pieces: &'a [ProfilePiece]) -> Self {
        let painter = painter.with_clip_rect(rect);
        painter.rect_filled(rect, 0.0, theme::DRAWING_GROUND);
        let bounds = pieces.iter().map(ProfilePiece::bounds);
        let (low, high) = bounds.fold(
            (Point::new(0.0, 0.0), Point::new(1.0, 0.0)),
            |(low, high), (below, above)| {
                (
                    Point::new(low.x.min(below.x), low.z.min(below.z)),
                    Point::new(high.x.max(above.x), high.z.max(above.z)),
                )
            },
        );
        let size = vec2((high.z - low.z).max(1.0) as f32, (high.x - low.x) as f32);
        let room = (rect.size() - vec2(2.0 * MARGIN, 2.0 * MARGIN)).max(vec2(10.0, 10.0));
        let scale = (room.x / size.x).min(room.y / size.y);
        let used = size * scale;
        let left = rect.center().x - used.x / 2.0;
        let bottom = rect.center().y + used.y / 2.0;
        let origin = pos2(left - low.z as f32 * scale, bottom + low.x as f32 * scale);
        let mut drawing = Self {
            painter,
            pieces,
            rect,
            scale,
            origin,
            labels: Vec::new(),
            drawn: Vec::new(),
        };
        let fractions = (0..=SAMPLES).map(|index| f64::from(index) / f64::from(SAMPLES));
        let points = pieces.iter().flat_map(|piece| {
            let fractions = fractions.clone();
            fractions.map(move |at| piece.point_at(at))
        });
        drawing.drawn = points.map(|at| drawing.position(at)).collect();
        drawing
    }

    fn position(&self, at: Point) -> Pos2 {
        self.origin + vec2(at.z as f32, -at.x as f32) * self.scale
    }

    fn draw_pieces(&self, color: Color32) {
        let axis = [
            pos2(self.rect.left() + 4.0, self.origin.y),
            pos2(self.rect.right() - 4.0, self.origin.y),
        ];
        let stroke = Stroke::new(1.0, theme::SPINDLE_AXIS);
        let dashes = Shape::dashed_line(&axis, stroke, 8.0, 4.0);
        self.painter.extend(dashes);
        for piece in self.pieces {
            let steps = if piece.is_arc() { ARC_STEPS } else { 1 };
            let fractions = (0..=steps).map(|step| f64::from(step) / f64::from(steps));
            let points = fractions.map(|at| self.position(piece.point_at(at)));
            let stroke = Stroke::new(2.0, color);
            self.painter.add(Shape::line(points.collect(), stroke));
        }
    }

    fn draw_dimensions(&mut self, pieces: &[ProfilePiece]) {
        // Diameters and radii come before angles where there is not enough space.
        for shows_angles in [false, true] {
            for piece in pieces {
                let (middle, chord) = (piece.point_at(0.5), piece.chord());
                let is_taper = !piece.is_arc() && chord.x.abs() > 1e-6 && chord.z.abs() > 1e-6;
                let text = if is_taper {
                    let angle = chord.x.atan2(-chord.z).to_degrees();
                    format!("{}°", Thousandths(Thousandths::round(angle).0 / 10 * 10))
                } else if piece.is_arc() {
                    format!("R{}", Thousandths::round(piece.radius()))
                } else if chord.x.abs() <= 1e-6 {
                    format!("Ø{}", Thousandths::round(2.0 * middle.x))
                } else {
                    continue;
                };
                let is_long = !is_taper || chord.length() as f32 * self.scale >= LEAST_TAPER;
                if is_taper == shows_angles && is_long {
                    self.label_beside(self.position(middle), &text, theme::ROW_TEXT);
                }
            }
        }
        let ends = pieces.iter().map(|piece| piece.end);
        let start = pieces.first().map(|piece| piece.start);
        for end in start.into_iter().chain(ends) {
            let on_axis = self.position(Point::new(0.0, end.z));
            let text = Thousandths::round(end.z).to_string();
            let at = on_axis + vec2(0.0, TICK + 1.0);
            if self.label(at, Align2::CENTER_TOP, &text, theme::NOTE_TEXT) {
                let tick = [on_axis, on_axis + vec2(0.0, TICK)];
                let stroke = Stroke::new(1.0, theme::NOTE_TEXT);
                self.painter.line_segment(tick, stroke);
            }
        }
    }

    /// Writes a text above a position, below it, or to one of its sides.
    fn label_beside(&mut self, at: Pos2, text: &str, color: Color32) {
        let distance = 5.0;
        for (offset, anchor) in [
            (vec2(0.0, -distance), Align2::CENTER_BOTTOM),
            (vec2(distance, 0.0), Align2::LEFT_CENTER),
            (vec2(0.0, distance), Align2::CENTER_TOP),
            (vec2(-distance, 0.0), Align2::RIGHT_CENTER),
        ] {
            if self.label(at + offset, anchor, text, color) {
                return;
            }
        }
    }

    /// Writes a text unless it would cover another one; returns whether it was written.
    fn label(&mut self, at: Pos2, anchor: Align2, text: &str, color: Color32) -> bool {
        let font = FontId::proportional(theme::LABEL_SIZE);
        let text = self.painter.layout_no_wrap(text.to_owned(), font, color);
        let rect = anchor.anchor_size(at, text.size());
        let is_covered = self.labels.iter().any(|other| other.intersects(rect));
        let covers = self.drawn.iter().any(|point| rect.contains(*point));
        if is_covered || covers || !self.rect.contains_rect(rect) {
            return false;
        }
        self.painter.galley(rect.min, text, color);
        self.labels.push(rect.expand(1.0));
        true
    }
}
