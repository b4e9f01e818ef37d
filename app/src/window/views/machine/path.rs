//! The path of a program as the view draws it: pieces of line, kept small, in portions
//! that a worker hands over as they come.

use std::sync::Arc;

use egui::{Pos2, Rect, Vec2, pos2};
use gsk_core::command::{ExecutedMove, MoveKind, ProgramId};
use gsk_core::program::ProgramMemory;
use gsk_core::units::Point;
use gsk_runner::curves::{RapidRates, arc_points, rapid_bend};

/// Pieces of a portion.
const PORTION: usize = 16_384;
/// How far the chord of an arc may lie beside it, mm.
const SAGITTA: f64 = 0.01;

/// How a piece is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Nothing is drawn: the path begins here, or goes on elsewhere.
    Jump,
    /// At rapid rate.
    Rapid,
    /// Cutting.
    Feed,
    /// Tied to the spindle.
    Thread,
}

/// A piece of line: from the end of the one before it to its own end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its end, part coordinates: x is Z, y is X as a radius; mm.
    pub end: Pos2,
    /// Machine time when its move began, s.
    pub start_s: f32,
    /// Machine time when it ended, s.
    pub end_s: f32,
    /// Its block.
    pub line: u32,
    /// The program of its block.
    pub program: ProgramId,
    /// How it is made.
    pub way: Way,
}

/// A block of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// The program.
    pub program: ProgramId,
    /// Line of the text, from 1.
    pub line: u32,
}

/// A path, as far as it is known.
#[derive(Clone, Debug, Default)]
pub struct Path {
    portions: Vec<Arc<Vec<Piece>>>,
    /// The texts its blocks stand in.
    pub programs: ProgramMemory,
    /// Box around its cuts, or around everything where it cuts nothing.
    pub bounds: Option<Rect>,
    /// It goes on beyond what is known.
    pub partial: bool,
}

impl Path {
    /// The pieces in the order of execution, each with the point it begins at.
    pub fn pieces(&self) -> impl Iterator<Item = (Pos2, &Piece)> {
        let all = self.portions.iter().flat_map(|portion| portion.iter());
        let mut from = Pos2::ZERO;
        all.filter_map(move |piece| {
            let begin = std::mem::replace(&mut from, piece.end);
            (piece.way != Way::Jump).then_some((begin, piece))
        })
    }

    /// How many pieces there are.
    pub fn count(&self) -> usize {
        self.portions.iter().map(|portion| portion.len()).sum()
    }

    /// The block whose piece is nearest to a point, at most so far from it, mm. Of two
    /// that are equally near, the later one: it lies on top.
    pub fn nearest(&self, at: Pos2, reach: f32) -> Option<Block> {
        let mut nearest = (reach * reach, None);
        for (from, piece) in self.pieces() {
            let distance = distance_sq(at, from, piece.end);
            if distance <= nearest.0 {
                nearest = (distance, Some(piece));
            }
        }
        nearest.1.map(|piece| Block {
            program: piece.program,
            line: piece.line,
        })
    }

    /// The text of a block.
    pub fn text(&self, block: Block) -> &str {
        let program = self.programs.get(block.program);
        program.map_or("", |program| program.line(block.line))
    }
}

/// The square of the distance of a point from a piece.
fn distance_sq(at: Pos2, from: Pos2, to: Pos2) -> f32 {
    let (along, beside) = (to - from, at - from);
    let length = along.length_sq();
    let part = if length > 0.0 {
        (beside.dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (beside - along * part).length_sq()
}

/// Builds a path move by move.
#[derive(Debug, Default)]
pub struct Builder {
    done: Vec<Arc<Vec<Piece>>>,
    open: Vec<Piece>,
    last: Option<Pos2>,
    cuts: Option<Rect>,
    all: Option<Rect>,
}

impl Builder {
    /// Adds a move; `shift` leads from program to part coordinates.
    pub fn push(&mut self, executed: &ExecutedMove, shift: Point, rates: RapidRates) {
        let way = match executed.kind {
            MoveKind::Dwell => return,
            MoveKind::Rapid => Way::Rapid,
            MoveKind::Thread | MoveKind::RunOut => Way::Thread,
            MoveKind::Feed | MoveKind::Clockwise | MoveKind::CounterClockwise => Way::Feed,
        };
        let at = |point: Point| {
            let point = point + shift;
            pos2(point.z as f32, point.x as f32)
        };
        let piece = |end, way| Piece {
            end,
            start_s: executed.start_s as f32,
            end_s: (executed.start_s + executed.duration_s) as f32,
            line: executed.source.line,
            program: executed.source.program,
            way,
        };
        let from = at(executed.from);
        if self.last != Some(from) {
            self.add(piece(from, Way::Jump));
        }
        if way != Way::Rapid {
            extend(&mut self.cuts, from);
        }
        let (begin, end) = (executed.from, executed.to);
        match (executed.kind, executed.center) {
            (MoveKind::Rapid, _) => {
                if let Some(bend) = rapid_bend(begin, end, rates) {
                    self.add(piece(at(bend), way));
                }
                self.add(piece(at(end), way));
            }
            (MoveKind::Clockwise | MoveKind::CounterClockwise, Some(center)) => {
                let clockwise = executed.kind == MoveKind::Clockwise;
                for point in arc_points(begin, end, center, clockwise, SAGITTA * 2.0) {
                    self.add(piece(at(point), way));
                }
            }
            _ => self.add(piece(at(end), way)),
        }
    }

    fn add(&mut self, piece: Piece) {
        if !matches!(piece.way, Way::Rapid | Way::Jump) {
            extend(&mut self.cuts, piece.end);
        }
        extend(&mut self.all, piece.end);
        self.last = Some(piece.end);
        self.open.push(piece);
        if self.open.len() >= PORTION {
            self.done.push(Arc::new(std::mem::take(&mut self.open)));
        }
    }

    /// The path so far.
    pub fn path(&self, programs: &ProgramMemory, partial: bool) -> Path {
        let mut portions = self.done.clone();
        portions.push(Arc::new(self.open.clone()));
        Path {
            portions,
            programs: programs.clone(),
            bounds: self.cuts.or(self.all),
            partial,
        }
    }
}

fn extend(bounds: &mut Option<Rect>, point: Pos2) {
    let around = Rect::from_min_size(point, Vec2::ZERO);
    *bounds = Some(bounds.map_or(around, |bounds| bounds.union(around)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::preview::preview;
    use gsk_core::program::Program;
    use gsk_core::setup::Setup;

    fn path(text: &str) -> Path {
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        setup.memory.programs.select(ProgramId::External);
        let rates = RapidRates::of(&setup.memory.parameters);
        let mut builder = Builder::default();
        let programs = setup.memory.programs.clone();
        preview(&setup, &programs, &mut |executed| {
            builder.push(executed, Point::default(), rates);
        });
        builder.path(&programs, false)
    }

    #[test]
    fn the_nearest_piece_names_its_block() {
        let path = path("G00 X40 Z2\nG01 Z-30 F100\nX50\nG02 X60 Z-35 R5\nM30\n");
        let block = |z, x| path.nearest(pos2(z, x), 0.5).map(|block| block.line);
        assert_eq!(block(-10.0, 20.1), Some(2));
        assert_eq!(block(-30.0, 22.0), Some(3));
        assert_eq!(block(-33.536, 26.464), Some(4), "the middle of the arc");
        assert_eq!(block(-10.0, 25.0), None);
        let line = path.nearest(pos2(-10.0, 20.0), 0.5).unwrap();
        assert_eq!(path.text(line), "G01 Z-30 F100");
        let bounds = path.bounds.unwrap();
        assert_eq!((bounds.left(), bounds.right()), (-35.0, 2.0));
    }
}
