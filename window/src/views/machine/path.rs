//! The path of a program as line segments, small in memory, in portions that a worker hands
//! over while the path grows.

use std::sync::Arc;

use egui::{Pos2, Rect, Vec2, pos2};
use gsk_core::command::{ExecutedMove, MoveKind, ProgramId};
use gsk_core::interpreter::Explanation;
use gsk_core::program::ProgramMemory;
use gsk_core::units::Point;
use gsk_runner::curves::{RapidRates, arc_points, rapid_bend};

/// Number of segments of a portion, the unit in which a path grows.
const PORTION_SIZE: usize = 16_384;
/// Maximum number of cycle passes that are explained.
const MAX_PASSES: usize = 20_000;
/// Maximum distance between an arc and the chords that replace it, mm.
const SAGITTA_MM: f64 = 0.01;

/// The kind of motion along a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentKind {
    /// Not drawn: the path begins at the end of this segment, or continues there.
    Jump,
    Rapid,
    Feed,
    /// Feed that is synchronous with the spindle, as of a thread.
    Thread,
}

/// A straight segment from the end of the previous segment to its own end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSegment {
    /// End of the segment in part coordinates: x is Z, y is X as a radius; mm.
    pub end: Pos2,
    /// Machine time at the start of the segment's move, s.
    pub start_s: f32,
    /// Machine time at the end of the segment's move, s.
    pub end_s: f32,
    /// Line of the segment's block in its program, from 1.
    pub line: u32,
    pub program: ProgramId,
    pub kind: SegmentKind,
}

/// Identifies a block of the path by its program and line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockRef {
    pub program: ProgramId,
    /// Line of the block in the program text, from 1.
    pub line: u32,
}

/// A pass of a cycle: the segments from its first one up to the first one of the next pass.
#[derive(Clone, Debug)]
pub struct CyclePass {
    first_segment: usize,
    block: BlockRef,
    /// The explanation of the position of the pass; `None` for moves outside cycles.
    pub explanation: Option<Arc<Explanation>>,
}

/// The path of a program in the picture, complete or partial.
#[derive(Clone, Debug, Default)]
pub struct DrawnPath {
    portions: Vec<Arc<Vec<LineSegment>>>,
    passes: Vec<CyclePass>,
    /// The programs that contain the blocks of the path.
    pub programs: ProgramMemory,
    /// Bounding box of the cuts, or of all moves if nothing is cut, part coordinates; `None`
    /// without moves.
    pub bounds: Option<Rect>,
    /// Whether the path is incomplete: the program continues after the last segment.
    pub is_partial: bool,
}

impl DrawnPath {
    /// The drawn segments in the order of execution, each with the position at which it
    /// starts.
    pub fn segments(&self) -> impl Iterator<Item = (Pos2, &LineSegment)> {
        let all = self.portions.iter().flat_map(|portion| portion.iter());
        let mut from = Pos2::ZERO;
        all.filter_map(move |piece| {
            let begin = std::mem::replace(&mut from, piece.end);
            (piece.kind != SegmentKind::Jump).then_some((begin, piece))
        })
    }

    /// Returns the number of segments, jumps included.
    pub fn segment_count(&self) -> usize {
        self.portions.iter().map(|portion| portion.len()).sum()
    }

    /// Index of the segment nearest to `at` within `reach`, mm; `None` if there is none. Of
    /// two that are equally near it is the later one, which is drawn on top.
    pub fn nearest_segment(&self, at: Pos2, reach: f32) -> Option<usize> {
        self.nearest_matching(at, reach, |_| true)
    }

    /// The cycle pass of the running block whose path is nearest to the tool tip; `None` if
    /// the block has no path.
    pub fn running_pass(&self, block: BlockRef, tip: Pos2) -> Option<&CyclePass> {
        let of_block =
            |piece: &LineSegment| piece.line == block.line && piece.program == block.program;
        self.pass_at(self.nearest_matching(tip, f32::INFINITY, of_block)?)
    }

    fn nearest_matching(
        &self,
        at: Pos2,
        reach: f32,
        is_match: impl Fn(&LineSegment) -> bool,
    ) -> Option<usize> {
        let mut nearest = (reach * reach, None);
        let mut from = Pos2::ZERO;
        let all = self.portions.iter().flat_map(|portion| portion.iter());
        for (index, piece) in all.enumerate() {
            let begin = std::mem::replace(&mut from, piece.end);
            if piece.kind == SegmentKind::Jump || !is_match(piece) {
                continue;
            }
            let distance = (at - nearest_point_on(begin, piece.end, at)).length_sq();
            if distance <= nearest.0 {
                nearest = (distance, Some(index));
            }
        }
        nearest.1
    }

    /// The block of the segment with this index; `None` if there is no such segment.
    pub fn block_at(&self, index: usize) -> Option<BlockRef> {
        let mut all = self.portions.iter().flat_map(|portion| portion.iter());
        let piece = all.nth(index)?;
        Some(BlockRef {
            program: piece.program,
            line: piece.line,
        })
    }

    /// The cycle pass to which the segment with this index belongs; `None` if it is outside of
    /// cycles or does not exist.
    pub fn pass_at(&self, index: usize) -> Option<&CyclePass> {
        let after = self
            .passes
            .partition_point(|pass| pass.first_segment <= index);
        let pass = self.passes.get(after.checked_sub(1)?)?;
        (pass.explanation.is_some() && self.block_at(index) == Some(pass.block)).then_some(pass)
    }

    /// The pass of this path with the same number and block as `pass`, or the last earlier
    /// pass of that block. `None` if there is none.
    pub fn find_same_pass(&self, pass: Option<CyclePass>) -> Option<CyclePass> {
        let pass = pass?;
        let number = pass.explanation.as_ref()?.pass;
        let number_of = |other: &CyclePass| other.explanation.as_ref().map(|why| why.pass);
        let of_block = self.passes.iter().filter(|other| other.block == pass.block);
        let up_to = of_block.filter(|other| number_of(other).is_some_and(|it| it <= number));
        up_to.max_by_key(|other| number_of(other)).cloned()
    }

    /// The segments of a pass, each as its start and end position.
    pub fn pass_segments(&self, pass: &CyclePass) -> Vec<[Pos2; 2]> {
        let next = self
            .passes
            .iter()
            .find(|other| other.first_segment > pass.first_segment)
            .map_or(usize::MAX, |next| next.first_segment);
        let all = self.portions.iter().flat_map(|portion| portion.iter());
        let before = pass.first_segment.saturating_sub(1);
        let count = next.saturating_sub(before);
        let pieces: Vec<&LineSegment> = all.skip(before).take(count).collect();
        let pairs = pieces
            .windows(2)
            .filter(|pair| pair[1].kind != SegmentKind::Jump);
        pairs.map(|pair| [pair[0].end, pair[1].end]).collect()
    }

    /// The text of a block; empty if the program of the block is missing.
    pub fn block_text(&self, block: BlockRef) -> &str {
        let program = self.programs.get(block.program);
        program.map_or("", |program| program.line(block.line))
    }
}

/// The position on the segment between `from` and `to` that is nearest to `at`.
pub fn nearest_point_on(from: Pos2, to: Pos2, at: Pos2) -> Pos2 {
    let (along, beside) = (to - from, at - from);
    let length = along.length_sq();
    let share = if length > 0.0 {
        (beside.dot(along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    from + along * share
}

#[derive(Debug, Default)]
pub struct PathBuilder {
    full_portions: Vec<Arc<Vec<LineSegment>>>,
    open_portion: Vec<LineSegment>,
    passes: Vec<CyclePass>,
    last_end: Option<Pos2>,
    cut_bounds: Option<Rect>,
    move_bounds: Option<Rect>,
}

impl PathBuilder {
    /// Begins a new pass if block or explanation differ from those of the current pass.
    pub fn begin_pass(&mut self, executed: &ExecutedMove, explanation: Option<&Explanation>) {
        let block = BlockRef {
            program: executed.source.program,
            line: executed.source.line,
        };
        let is_same_pass = self.passes.last().map(|last| {
            let explained = last.explanation.as_deref();
            explained == explanation && (explanation.is_none() || last.block == block)
        });
        if is_same_pass.unwrap_or(explanation.is_none()) || self.passes.len() > MAX_PASSES {
            return;
        }
        let first = self
            .full_portions
            .iter()
            .map(|portion| portion.len())
            .sum::<usize>()
            + self.open_portion.len();
        self.passes.push(CyclePass {
            first_segment: first,
            block,
            explanation: explanation.cloned().map(Arc::new),
        });
    }

    /// Adds the segments of a move. `shift` is added to program coordinates to get part
    /// coordinates, mm.
    pub fn add_move(&mut self, executed: &ExecutedMove, shift: Point, rates: RapidRates) {
        let kind = match executed.kind {
            MoveKind::Dwell => return,
            MoveKind::Rapid => SegmentKind::Rapid,
            MoveKind::Thread | MoveKind::RunOut => SegmentKind::Thread,
            MoveKind::Feed | MoveKind::Clockwise | MoveKind::CounterClockwise => SegmentKind::Feed,
        };
        let at = |point: Point| {
            let point = point + shift;
            pos2(point.z as f32, point.x as f32)
        };
        let piece = |end, kind| LineSegment {
            end,
            start_s: executed.start_s as f32,
            end_s: (executed.start_s + executed.duration_s) as f32,
            line: executed.source.line,
            program: executed.source.program,
            kind,
        };
        let from = at(executed.from);
        if self.last_end != Some(from) {
            self.add_segment(piece(from, SegmentKind::Jump));
        }
        if kind != SegmentKind::Rapid {
            extend_bounds(&mut self.cut_bounds, from);
        }
        let (begin, end) = (executed.from, executed.to);
        match (executed.kind, executed.center) {
            (MoveKind::Rapid, _) => {
                if let Some(bend) = rapid_bend(begin, end, rates) {
                    self.add_segment(piece(at(bend), kind));
                }
                self.add_segment(piece(at(end), kind));
            }
            (MoveKind::Clockwise | MoveKind::CounterClockwise, Some(center)) => {
                let clockwise = executed.kind == MoveKind::Clockwise;
                for point in arc_points(begin, end, center, clockwise, SAGITTA_MM * 2.0) {
                    self.add_segment(piece(at(point), kind));
                }
            }
            _ => self.add_segment(piece(at(end), kind)),
        }
    }

    fn add_segment(&mut self, piece: LineSegment) {
        if !matches!(piece.kind, SegmentKind::Rapid | SegmentKind::Jump) {
            extend_bounds(&mut self.cut_bounds, piece.end);
        }
        extend_bounds(&mut self.move_bounds, piece.end);
        self.last_end = Some(piece.end);
        self.open_portion.push(piece);
        if self.open_portion.len() >= PORTION_SIZE {
            self.full_portions
                .push(Arc::new(std::mem::take(&mut self.open_portion)));
        }
    }

    /// Builds the path of the moves added until now. `partial`: further moves will follow.
    pub fn build(&self, programs: &ProgramMemory, partial: bool) -> DrawnPath {
        let mut portions = self.full_portions.clone();
        portions.push(Arc::new(self.open_portion.clone()));
        DrawnPath {
            portions,
            passes: self.passes.clone(),
            programs: programs.clone(),
            bounds: self.cut_bounds.or(self.move_bounds),
            is_partial: partial,
        }
    }
}

fn extend_bounds(bounds: &mut Option<Rect>, point: Pos2) {
    let around = Rect::from_min_size(point, Vec2::ZERO);
    *bounds = Some(bounds.map_or(around, |bounds| bounds.union(around)));
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use gsk_core::preview::preview_explained;
    use gsk_core::program::Program;
    use gsk_core::setup::Setup;

    pub fn preview_path(text: &str) -> DrawnPath {
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        setup.memory.programs.select(ProgramId::External);
        let rates = RapidRates::from_memory(&setup.memory);
        let mut builder = PathBuilder::default();
        let programs = setup.memory.programs.clone();
        let on_move = &mut |executed: &ExecutedMove, why: Option<&Explanation>| {
            builder.begin_pass(executed, why);
            builder.add_move(executed, Point::default(), rates);
        };
        preview_explained(&setup, &programs, on_move, &mut |_| true);
        builder.build(&programs, false)
    }

    #[test]
    fn the_nearest_piece_names_its_block() {
        let path = preview_path("G00 X40 Z2\nG01 Z-30 F100\nX50\nG02 X60 Z-35 R5\nM30\n");
        let block_at = |z, x| path.block_at(path.nearest_segment(pos2(z, x), 0.5)?);
        let block = |z, x| block_at(z, x).map(|block| block.line);
        assert_eq!(block(-10.0, 20.1), Some(2));
        assert_eq!(block(-30.0, 22.0), Some(3));
        assert_eq!(block(-33.536, 26.464), Some(4), "the middle of the arc");
        assert_eq!(block(-10.0, 25.0), None);
        let line = block_at(-10.0, 20.0).unwrap();
        assert_eq!(path.block_text(line), "G01 Z-30 F100");
        let bounds = path.bounds.unwrap();
        assert_eq!((bounds.left(), bounds.right()), (-35.0, 2.0));
    }

    /// The path of the cycle of the next test with deeper passes.
    fn deeper_pass_path() -> DrawnPath {
        preview_path("G00 X44 Z2\nG71 U6 R1\nG71 P1 Q2 F100\nN1 G00 X20\nG01 Z-20\nN2 X40\nM30\n")
    }

    #[test]
    fn a_piece_of_a_cycle_names_its_pass() {
        let path = preview_path(
            "G00 X44 Z2\nG71 U3 R1\nG71 P1 Q2 F100\nN1 G00 X20\nG01 Z-20\nN2 X40\nM30\n",
        );
        let pass = |z, x| {
            let pass = path.pass_at(path.nearest_segment(pos2(z, x), 0.2)?)?;
            Some((
                pass.explanation.as_ref()?.pass,
                path.pass_segments(pass).len(),
            ))
        };
        let (number, pieces) = pass(-10.0, 19.0).unwrap();
        assert_eq!(number, 1, "the level of X38");
        assert!((3..=5).contains(&pieces), "{pieces}");
        assert_eq!(pass(-10.0, 13.0).unwrap().0, 3);
        assert_eq!(pass(2.0, 30.0), None, "the way to the cycle");
        let cycle = path.block_at(path.nearest_segment(pos2(-10.0, 13.0), 0.2).unwrap());
        let in_work = path.running_pass(cycle.unwrap(), pos2(-5.0, 13.1));
        assert_eq!(in_work.unwrap().explanation.as_ref().unwrap().pass, 3);
        let fewer = deeper_pass_path();
        let again = fewer.find_same_pass(in_work.cloned()).unwrap();
        assert_eq!(again.explanation.unwrap().pass, 2, "there is no third one");
    }
}
