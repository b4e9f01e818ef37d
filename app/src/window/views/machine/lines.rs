//! The path on the screen: pieces that fall on the same points are drawn once, so that
//! a million moves cost no more than the picture has points.

use std::sync::Arc;

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};

use super::camera::Camera;
use super::path::{Block, Path, Way};

/// Colours of the path.
pub const RAPID: Color32 = Color32::from_rgb(255, 150, 60);
/// Cuts.
pub const FEED: Color32 = Color32::from_rgb(90, 180, 255);
/// Threads.
pub const THREAD: Color32 = Color32::from_rgb(80, 225, 120);
const LIT: Color32 = Color32::from_rgb(255, 255, 140);
/// A pass of a cycle that was clicked.
pub const PASS: Color32 = Color32::from_rgb(255, 245, 170);
const WRONG: Color32 = Color32::from_rgb(255, 60, 50);
const CHOSEN: Color32 = Color32::from_rgb(255, 110, 220);

/// Rapids are dashed as long as there are no more of them than that.
const MOST_DASHED: usize = 4000;
const DASH: (f32, f32) = (6.0, 4.0);
/// Slots of the table of pieces that were drawn.
const SLOTS: usize = 1 << 16;

/// What a drawing was made for.
#[derive(Default)]
pub struct MadeFor(Option<(Camera, Arc<Path>)>);

impl MadeFor {
    /// Whether it is another view or another path; from now on it is this one.
    pub fn changes(&mut self, camera: &Camera, path: &Arc<Path>) -> bool {
        let known = self.0.as_ref();
        if known.is_some_and(|(made, of)| made == camera && Arc::ptr_eq(of, path)) {
            return false;
        }
        self.0 = Some((*camera, Arc::clone(path)));
        true
    }
}

/// The lines that were made for a view.
#[derive(Default)]
pub struct Lines {
    made_for: MadeFor,
    shapes: Vec<Shape>,
}

impl Lines {
    /// Draws the path.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, path: &Arc<Path>) {
        if self.made_for.changes(camera, path) {
            self.shapes = shapes(camera, path);
        }
        painter.extend(self.shapes.iter().cloned());
    }
}

/// Draws the pieces of a block over the path.
pub fn highlight(painter: &Painter, camera: &Camera, path: &Path, block: Block, lit: bool) {
    let (color, width) = if lit { (LIT, 3.0) } else { (CHOSEN, 2.5) };
    draw_block(painter, camera, path, block, Stroke::new(width, color));
}

/// Draws the pieces of a block that breaks a rule.
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

/// Draws the pieces of a pass over the path.
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

/// What is on the screen already.
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

    /// Whether a piece shows anything that is not there yet.
    fn is_new(&mut self, [from, to]: [Pos2; 2], way: Way) -> bool {
        let room = self.room;
        let outside = from.x.max(to.x) < room.left()
            || from.x.min(to.x) > room.right()
            || from.y.max(to.y) < room.top()
            || from.y.min(to.y) > room.bottom();
        if outside || !(from - to).length_sq().is_finite() {
            return false;
        }
        // Half points: nobody sees less.
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

/// Lines that hang together, by their colour.
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
                // What is shorter than a point waits for the next piece.
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
        // Cuts lie over rapids.
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
