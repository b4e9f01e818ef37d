//! Draws the path as lines. Segments that cover the same points of the screen are drawn once,
//! so the cost depends on the size of the picture and not on the number of moves.

use std::sync::Arc;

use egui::{Painter, Pos2, Rect, Shape, Stroke};

use super::camera::Camera;
use super::path::{BlockRef, DrawnPath, SegmentKind};
use crate::theme;

/// Maximum number of rapid segments that are drawn dashed.
const MAX_DASHED: usize = 4000;
const DASH: (f32, f32) = (6.0, 4.0);
/// Number of slots of the hash table of drawn segments.
const SLOTS: usize = 1 << 16;

/// Camera and path for which a drawing was made; `None` before the first one.
#[derive(Default)]
pub struct DrawingKey(Option<(Camera, Arc<DrawnPath>)>);

impl DrawingKey {
    /// Stores camera and path. Returns true if they differ from those of the last call.
    pub fn replace_if_changed(&mut self, camera: &Camera, path: &Arc<DrawnPath>) -> bool {
        let known = self.0.as_ref();
        if known.is_some_and(|(made, of)| made == camera && Arc::ptr_eq(of, path)) {
            return false;
        }
        self.0 = Some((*camera, Arc::clone(path)));
        true
    }
}

/// Draws a path as lines, which it keeps with the view they were made for.
#[derive(Default)]
pub struct PathLines {
    drawn_for: DrawingKey,
    shapes: Vec<Shape>,
}

impl PathLines {
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<DrawnPath>) {
        if self.drawn_for.replace_if_changed(camera, path) {
            self.shapes = build_shapes(camera, path);
        }
        painter.extend(self.shapes.iter().cloned());
    }
}

/// Highlights the segments of a block over the path. `is_running`: the block runs; else it is
/// selected.
pub fn highlight_block(
    painter: &Painter,
    camera: &Camera,
    path: &DrawnPath,
    block: BlockRef,
    is_running: bool,
) {
    let (color, width) = if is_running {
        // A faint wide line below a thin one looks like a glow.
        let glow = Stroke::new(6.0, theme::running_glow());
        draw_block(painter, camera, path, block, glow);
        (theme::RUNNING_PATH, 1.5)
    } else {
        (theme::SELECTED_PATH, 2.5)
    };
    draw_block(painter, camera, path, block, Stroke::new(width, color));
}

/// Marks the segments of a block that breaks a rule of its cycle.
pub fn mark_wrong(painter: &Painter, camera: &Camera, path: &DrawnPath, block: BlockRef) {
    draw_block(
        painter,
        camera,
        path,
        block,
        Stroke::new(4.0, theme::FAULT_PATH),
    );
}

fn draw_block(
    painter: &Painter,
    camera: &Camera,
    path: &DrawnPath,
    block: BlockRef,
    stroke: Stroke,
) {
    let rect = camera.rect.expand(4.0);
    for (from, piece) in path.segments() {
        if piece.line != block.line || piece.program != block.program {
            continue;
        }
        let ends = [
            camera.screen_position(from),
            camera.screen_position(piece.end),
        ];
        if Rect::from_two_pos(ends[0], ends[1]).intersects(rect) {
            painter.line_segment(ends, stroke);
        }
    }
}

/// Highlights the segments of a cycle pass over the path.
pub fn highlight_pass(painter: &Painter, camera: &Camera, pieces: &[[Pos2; 2]]) {
    for ends in pieces {
        let ends = ends.map(|end| camera.screen_position(end));
        painter.line_segment(ends, Stroke::new(3.5, theme::PASS_PATH));
    }
}

fn build_shapes(camera: &Camera, path: &DrawnPath) -> Vec<Shape> {
    let mut drawn = DrawnSegments::new(camera.rect);
    let mut strokes = StrokeBuilder::default();
    for (from, piece) in path.segments() {
        let ends = [
            camera.screen_position(from),
            camera.screen_position(piece.end),
        ];
        if drawn.is_new(ends, piece.kind) {
            strokes.add_segment(ends, piece.kind);
        } else {
            strokes.finish_line();
        }
    }
    strokes.finish_line();
    strokes.into_shapes()
}

/// A hash table of the segments that are already drawn on the screen.
struct DrawnSegments {
    rect: Rect,
    slots: Vec<u64>,
}

impl DrawnSegments {
    fn new(rect: Rect) -> Self {
        Self {
            rect: rect.expand(4.0),
            slots: vec![u64::MAX; SLOTS],
        }
    }

    /// Whether a segment is visible and was not drawn yet; records it as drawn.
    fn is_new(&mut self, [from, to]: [Pos2; 2], kind: SegmentKind) -> bool {
        let rect = self.rect;
        let is_outside = from.x.max(to.x) < rect.left()
            || from.x.min(to.x) > rect.right()
            || from.y.max(to.y) < rect.top()
            || from.y.min(to.y) > rect.bottom();
        if is_outside || !(from - to).length_sq().is_finite() {
            return false;
        }
        // Keys have a resolution of half a point: smaller differences are invisible.
        let key = |at: Pos2| {
            let [x, y] = [at.x * 2.0, at.y * 2.0].map(|it| (it as i32 as u64) & 0x7fff);
            x << 15 | y
        };
        let key = key(from) << 32 | key(to) << 2 | kind as u64;
        let slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48) as usize;
        let Some(slot) = self.slots.get_mut(slot) else {
            return true;
        };
        std::mem::replace(slot, key) != key
    }
}

/// Joins segments to connected lines, separately for each kind of move.
#[derive(Default)]
struct StrokeBuilder {
    open_line: Option<(SegmentKind, Vec<Pos2>)>,
    finished_lines: Vec<(SegmentKind, Vec<Pos2>)>,
    rapid_count: usize,
}

impl StrokeBuilder {
    fn add_segment(&mut self, [from, to]: [Pos2; 2], kind: SegmentKind) {
        self.rapid_count += usize::from(kind == SegmentKind::Rapid);
        match &mut self.open_line {
            Some((open, points)) if *open == kind && points.last() == Some(&from) => {
                // A segment shorter than a point waits for the next one.
                points.push(to);
            }
            _ => {
                self.finish_line();
                self.open_line = Some((kind, vec![from, to]));
            }
        }
    }

    fn finish_line(&mut self) {
        self.finished_lines.extend(self.open_line.take());
    }

    fn into_shapes(self) -> Vec<Shape> {
        let mut shapes = Vec::with_capacity(self.finished_lines.len());
        let is_dashed = self.rapid_count <= MAX_DASHED;
        // Cuts are drawn over rapids.
        let (rapids, cuts): (Vec<_>, Vec<_>) = self
            .finished_lines
            .into_iter()
            .partition(|(way, _)| *way == SegmentKind::Rapid);
        for (kind, points) in rapids.into_iter().chain(cuts) {
            let stroke = match kind {
                SegmentKind::Rapid | SegmentKind::Jump => Stroke::new(1.0, theme::RAPID_PATH),
                SegmentKind::Feed => Stroke::new(1.3, theme::FEED_PATH),
                SegmentKind::Thread => Stroke::new(1.3, theme::THREAD_PATH),
            };
            if kind == SegmentKind::Rapid && is_dashed {
                shapes.extend(Shape::dashed_line(&points, stroke, DASH.0, DASH.1));
            } else {
                shapes.push(Shape::line(points, stroke));
            }
        }
        shapes
    }
}
