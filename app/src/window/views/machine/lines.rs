//! Draws the path as lines. Segments that cover the same points of the screen are drawn once,
//! so the cost depends on the size of the picture and not on the number of moves.

use std::sync::Arc;

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};

use super::camera::Camera;
use super::path::{Block, Path, Way};

/// Colour of rapid moves.
pub const RAPID: Color32 = Color32::from_rgb(255, 150, 60);
/// Colour of cutting moves.
pub const FEED: Color32 = Color32::from_rgb(90, 180, 255);
/// Colour of threads.
pub const THREAD: Color32 = Color32::from_rgb(80, 225, 120);
const LIT: Color32 = Color32::from_rgb(255, 255, 140);
/// Colour of the selected pass of a cycle.
pub const PASS: Color32 = Color32::from_rgb(255, 245, 170);
const WRONG: Color32 = Color32::from_rgb(255, 60, 50);
const CHOSEN: Color32 = Color32::from_rgb(255, 110, 220);

/// Greatest number of rapid segments that are drawn dashed.
const MOST_DASHED: usize = 4000;
const DASH: (f32, f32) = (6.0, 4.0);
/// Slots of the hash table of drawn segments.
const SLOTS: usize = 1 << 16;

/// Camera and path for which a drawing was made.
#[derive(Default)]
pub struct MadeFor(Option<(Camera, Arc<Path>)>);

impl MadeFor {
    /// Whether camera or path differ from those of the last call.
    pub fn changes(&mut self, camera: &Camera, path: &Arc<Path>) -> bool {
        let known = self.0.as_ref();
        if known.is_some_and(|(made, of)| made == camera && Arc::ptr_eq(of, path)) {
            return false;
        }
        self.0 = Some((*camera, Arc::clone(path)));
        true
    }
}

/// The shapes of a path, and the view they were made for.
#[derive(Default)]
pub struct Lines {
    made_for: MadeFor,
    shapes: Vec<Shape>,
}

impl Lines {
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<Path>) {
        if self.made_for.changes(camera, path) {
            self.shapes = shapes(camera, path);
        }
        painter.extend(self.shapes.iter().cloned());
    }
}

/// Highlights the segments of a block over the path. `lit`: the block runs; else it is
/// selected.
pub fn highlight(painter: &Painter, camera: &Camera, path: &Path, block: Block, lit: bool) {
    let (color, width) = if lit { (LIT, 3.0) } else { (CHOSEN, 2.5) };
    draw_block(painter, camera, path, block, Stroke::new(width, color));
}

/// Marks the segments of a block that breaks a rule.
pub fn mark_wrong(painter: &Painter, camera: &Camera, path: &Path, block: Block) {
    draw_block(painter, camera, path, block, Stroke::new(4.0, WRONG));
}

fn draw_block(painter: &Painter, camera: &Camera, path: &Path, block: Block, stroke: Stroke) {
    let room = camera.room.expand(4.0);
    for (from, piece) in path.pieces() {
        if piece.line != block.line || piece.program != block.program {
            continue;
        }
        let ends = [camera.screen(from), camera.screen(piece.end)];
        if Rect::from_two_pos(ends[0], ends[1]).intersects(room) {
            painter.line_segment(ends, stroke);
        }
    }
}

/// Highlights the segments of a pass over the path.
pub fn highlight_pass(painter: &Painter, camera: &Camera, pieces: &[[Pos2; 2]]) {
    for ends in pieces {
        let ends = ends.map(|end| camera.screen(end));
        painter.line_segment(ends, Stroke::new(3.5, PASS));
    }
}

fn shapes(camera: &Camera, path: &Path) -> Vec<Shape> {
    let mut drawn = Drawn::new(camera.room);
    let mut strokes = Strokes::default();
    for (from, piece) in path.pieces() {
        let ends = [camera.screen(from), camera.screen(piece.end)];
        if drawn.is_new(ends, piece.way) {
            strokes.add(ends, piece.way);
        } else {
            strokes.end();
        }
    }
    strokes.end();
    strokes.shapes()
}

/// A hash table of the segments that are already on the screen.
struct Drawn {
    room: Rect,
    slots: Vec<u64>,
}

impl Drawn {
    fn new(room: Rect) -> Self {
        Self {
            room: room.expand(4.0),
            slots: vec![u64::MAX; SLOTS],
        }
    }

    /// Whether a segment is visible and not yet drawn.
    fn is_new(&mut self, [from, to]: [Pos2; 2], way: Way) -> bool {
        let room = self.room;
        let outside = from.x.max(to.x) < room.left()
            || from.x.min(to.x) > room.right()
            || from.y.max(to.y) < room.top()
            || from.y.min(to.y) > room.bottom();
        if outside || !(from - to).length_sq().is_finite() {
            return false;
        }
        // Keys have a resolution of half a point: smaller differences are invisible.
        let key = |at: Pos2| {
            let [x, y] = [at.x * 2.0, at.y * 2.0].map(|it| (it as i32 as u64) & 0x7fff);
            x << 15 | y
        };
        let key = key(from) << 32 | key(to) << 2 | way as u64;
        let slot = (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48) as usize;
        let Some(slot) = self.slots.get_mut(slot) else {
            return true;
        };
        std::mem::replace(slot, key) != key
    }
}

/// Connected lines, grouped by their kind of move.
#[derive(Default)]
struct Strokes {
    open: Option<(Way, Vec<Pos2>)>,
    done: Vec<(Way, Vec<Pos2>)>,
    rapids: usize,
}

impl Strokes {
    fn add(&mut self, [from, to]: [Pos2; 2], way: Way) {
        self.rapids += usize::from(way == Way::Rapid);
        match &mut self.open {
            Some((open, points)) if *open == way && points.last() == Some(&from) => {
                // A segment shorter than a point waits for the next one.
                points.push(to);
            }
            _ => {
                self.end();
                self.open = Some((way, vec![from, to]));
            }
        }
    }

    fn end(&mut self) {
        self.done.extend(self.open.take());
    }

    fn shapes(self) -> Vec<Shape> {
        let mut shapes = Vec::with_capacity(self.done.len());
        let dashed = self.rapids <= MOST_DASHED;
        // Cuts are drawn over rapids.
        let (rapids, cuts): (Vec<_>, Vec<_>) = self
            .done
            .into_iter()
            .partition(|(way, _)| *way == Way::Rapid);
        for (way, points) in rapids.into_iter().chain(cuts) {
            let stroke = match way {
                Way::Rapid | Way::Jump => Stroke::new(1.0, RAPID),
                Way::Feed => Stroke::new(1.3, FEED),
                Way::Thread => Stroke::new(1.3, THREAD),
            };
            if way == Way::Rapid && dashed {
                shapes.extend(Shape::dashed_line(&points, stroke, DASH.0, DASH.1));
            } else {
                shapes.push(Shape::line(points, stroke));
            }
        }
        shapes
    }
}
