//! The path of a program as line segments, small in memory, in portions that a worker hands
//! over while the path grows.

use std::sync::Arc;

use egui::{Pos2, Rect, Vec2, pos2};
use gsk_core::command::{ExecutedMove, MoveKind, ProgramId};
use gsk_core::interpreter::Explanation;
use gsk_core::program::ProgramMemory;
use gsk_core::units::Point;
use gsk_runner::curves::{RapidRates, arc_points, rapid_bend};

/// Segments of a portion.
const PORTION: usize = 16_384;
/// Greatest number of cycle passes that are explained.
const MOST_PASSES: usize = 20_000;
/// Greatest deviation of a chord from its arc, mm.
const SAGITTA: f64 = 0.01;

/// The kind of motion along a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Not drawn: the path begins here or continues elsewhere.
    Jump,
    Rapid,
    Feed,
    /// Synchronous with the spindle.
    Thread,
}

/// A line segment from the end of the previous segment to its own end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// End in part coordinates: x is Z, y is X as a radius; mm.
    pub end: Pos2,
    /// Machine time at the start of its move, s.
    pub start_s: f32,
    /// Machine time at the end of its move, s.
    pub end_s: f32,
    /// Line of its block, from 1.
    pub line: u32,
    pub program: ProgramId,
    pub way: Way,
}

/// A block of a program, by its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    pub program: ProgramId,
    /// Line of the program text, from 1.
    pub line: u32,
}

/// A pass of a cycle: the segments from its first up to the first of the next pass.
#[derive(Clone, Debug)]
pub struct Pass {
    first: usize,
    block: Block,
    /// Why the pass is where it is; `None` for moves outside of cycles.
    pub why: Option<Arc<Explanation>>,
}

/// The path of a program, complete or partial.
#[derive(Clone, Debug, Default)]
pub struct Path {
    portions: Vec<Arc<Vec<Piece>>>,
    passes: Vec<Pass>,
    /// The texts of the blocks.
    pub programs: ProgramMemory,
    /// Bounding box of the cuts, or of all moves where nothing is cut, mm.
    pub bounds: Option<Rect>,
    /// The path continues after the last known segment.
    pub partial: bool,
}

impl Path {
    /// The drawn segments in the order of execution, each with its start point.
    pub fn pieces(&self) -> impl Iterator<Item = (Pos2, &Piece)> {
        let all = self.portions.iter().flat_map(|portion| portion.iter());
        let mut from = Pos2::ZERO;
        all.filter_map(move |piece| {
            let begin = std::mem::replace(&mut from, piece.end);
            (piece.way != Way::Jump).then_some((begin, piece))
        })
    }

    /// The number of segments.
    pub fn count(&self) -> usize {
        self.portions.iter().map(|portion| portion.len()).sum()
    }

    /// Index of the segment nearest to a point within `reach`, mm. If two are equally near, it
    /// is the later one, which is drawn on top.
    pub fn nearest(&self, at: Pos2, reach: f32) -> Option<usize> {
        self.nearest_of(at, reach, |_| true)
    }

    /// The pass that a running block makes while the tip is at a point.
    pub fn pass_in_work(&self, block: Block, tip: Pos2) -> Option<&Pass> {
        let of_block = |piece: &Piece| piece.line == block.line && piece.program == block.program;
        self.pass_at(self.nearest_of(tip, f32::INFINITY, of_block)?)
    }

    fn nearest_of(&self, at: Pos2, reach: f32, meant: impl Fn(&Piece) -> bool) -> Option<usize> {
        let mut nearest = (reach * reach, None);
        let mut from = Pos2::ZERO;
        let all = self.portions.iter().flat_map(|portion| portion.iter());
        for (index, piece) in all.enumerate() {
            let begin = std::mem::replace(&mut from, piece.end);
            if piece.way == Way::Jump || !meant(piece) {
                continue;
            }
            let distance = (at - nearest_on(begin, piece.end, at)).length_sq();
            if distance <= nearest.0 {
                nearest = (distance, Some(index));
            }
        }
        nearest.1
    }

    /// The block of the segment with this index.
    pub fn block_at(&self, index: usize) -> Option<Block> {
        let mut all = self.portions.iter().flat_map(|portion| portion.iter());
        let piece = all.nth(index)?;
        Some(Block {
            program: piece.program,
            line: piece.line,
        })
    }

    /// The pass of a cycle that the segment with this index belongs to.
    pub fn pass_at(&self, index: usize) -> Option<&Pass> {
        let after = self.passes.partition_point(|pass| pass.first <= index);
        let pass = self.passes.get(after.checked_sub(1)?)?;
        (pass.why.is_some() && self.block_at(index) == Some(pass.block)).then_some(pass)
    }

    /// The pass with the same number and block in this path, or the block's last pass if there
    /// are fewer.
    pub fn pass_again(&self, pass: Option<Pass>) -> Option<Pass> {
        let pass = pass?;
        let number = pass.why.as_ref()?.pass;
        let number_of = |other: &Pass| other.why.as_ref().map(|why| why.pass);
        let of_block = self.passes.iter().filter(|other| other.block == pass.block);
        let up_to = of_block.filter(|other| number_of(other).is_some_and(|it| it <= number));
        up_to.max_by_key(|other| number_of(other)).cloned()
    }

    /// The segments of a pass, each as start and end point.
    pub fn pieces_of(&self, pass: &Pass) -> Vec<[Pos2; 2]> {
        let next = self
            .passes
            .iter()
            .find(|other| other.first > pass.first)
            .map_or(usize::MAX, |next| next.first);
        let all = self.portions.iter().flat_map(|portion| portion.iter());
        let before = pass.first.saturating_sub(1);
        let count = next.saturating_sub(before);
        let pieces: Vec<&Piece> = all.skip(before).take(count).collect();
        let pairs = pieces.windows(2).filter(|pair| pair[1].way != Way::Jump);
        pairs.map(|pair| [pair[0].end, pair[1].end]).collect()
    }

    /// The text of a block; empty if its program is missing.
    pub fn text(&self, block: Block) -> &str {
        let program = self.programs.get(block.program);
        program.map_or("", |program| program.line(block.line))
    }
}

/// The point of a line segment that is nearest to a point.
pub fn nearest_on(from: Pos2, to: Pos2, at: Pos2) -> Pos2 {
    let (along, beside) = (to - from, at - from);
    let length = along.length_sq();
    let part = if length > 0.0 {
        (beside.dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    from + along * part
}

#[derive(Debug, Default)]
pub struct Builder {
    done: Vec<Arc<Vec<Piece>>>,
    open: Vec<Piece>,
    passes: Vec<Pass>,
    last: Option<Pos2>,
    cuts: Option<Rect>,
    all: Option<Rect>,
}

impl Builder {
    /// Begins a pass when block or explanation differ from those of the current pass.
    pub fn explain(&mut self, executed: &ExecutedMove, why: Option<&Explanation>) {
        let block = Block {
            program: executed.source.program,
            line: executed.source.line,
        };
        let same = self.passes.last().map(|last| {
            let explained = last.why.as_deref();
            explained == why && (why.is_none() || last.block == block)
        });
        if same.unwrap_or(why.is_none()) || self.passes.len() > MOST_PASSES {
            return;
        }
        let first = self.done.iter().map(|portion| portion.len()).sum::<usize>() + self.open.len();
        self.passes.push(Pass {
            first,
            block,
            why: why.cloned().map(Arc::new),
        });
    }

    /// Adds a move. `shift` is added to program coordinates to get part coordinates, mm.
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

    /// The path of the moves added until now.
    pub fn path(&self, programs: &ProgramMemory, partial: bool) -> Path {
        let mut portions = self.done.clone();
        portions.push(Arc::new(self.open.clone()));
        Path {
            portions,
            passes: self.passes.clone(),
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
pub(super) mod tests {
    use super::*;
    use gsk_core::preview::preview_explained;
    use gsk_core::program::Program;
    use gsk_core::setup::Setup;

    pub fn path(text: &str) -> Path {
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        setup.memory.programs.select(ProgramId::External);
        let rates = RapidRates::of(&setup.memory);
        let mut builder = Builder::default();
        let programs = setup.memory.programs.clone();
        let on_move = &mut |executed: &ExecutedMove, why: Option<&Explanation>| {
            builder.explain(executed, why);
            builder.push(executed, Point::default(), rates);
        };
        preview_explained(&setup, &programs, on_move, &mut |_| true);
        builder.path(&programs, false)
    }

    #[test]
    fn the_nearest_piece_names_its_block() {
        let path = path("G00 X40 Z2\nG01 Z-30 F100\nX50\nG02 X60 Z-35 R5\nM30\n");
        let block_at = |z, x| path.block_at(path.nearest(pos2(z, x), 0.5)?);
        let block = |z, x| block_at(z, x).map(|block| block.line);
        assert_eq!(block(-10.0, 20.1), Some(2));
        assert_eq!(block(-30.0, 22.0), Some(3));
        assert_eq!(block(-33.536, 26.464), Some(4), "the middle of the arc");
        assert_eq!(block(-10.0, 25.0), None);
        let line = block_at(-10.0, 20.0).unwrap();
        assert_eq!(path.text(line), "G01 Z-30 F100");
        let bounds = path.bounds.unwrap();
        assert_eq!((bounds.left(), bounds.right()), (-35.0, 2.0));
    }

    /// The cycle of the next test with deeper passes.
    fn path_of_two() -> Path {
        path("G00 X44 Z2\nG71 U6 R1\nG71 P1 Q2 F100\nN1 G00 X20\nG01 Z-20\nN2 X40\nM30\n")
    }

    #[test]
    fn a_piece_of_a_cycle_names_its_pass() {
        let path =
            path("G00 X44 Z2\nG71 U3 R1\nG71 P1 Q2 F100\nN1 G00 X20\nG01 Z-20\nN2 X40\nM30\n");
        let pass = |z, x| {
            let pass = path.pass_at(path.nearest(pos2(z, x), 0.2)?)?;
            Some((pass.why.as_ref()?.pass, path.pieces_of(pass).len()))
        };
        let (number, pieces) = pass(-10.0, 19.0).unwrap();
        assert_eq!(number, 1, "the level of X38");
        assert!((3..=5).contains(&pieces), "{pieces}");
        assert_eq!(pass(-10.0, 13.0).unwrap().0, 3);
        assert_eq!(pass(2.0, 30.0), None, "the way to the cycle");
        let cycle = path.block_at(path.nearest(pos2(-10.0, 13.0), 0.2).unwrap());
        let in_work = path.pass_in_work(cycle.unwrap(), pos2(-5.0, 13.1));
        assert_eq!(in_work.unwrap().why.as_ref().unwrap().pass, 3);
        let fewer = path_of_two();
        let again = fewer.pass_again(in_work.cloned()).unwrap();
        assert_eq!(again.why.unwrap().pass, 2, "there is no third one");
    }
}
