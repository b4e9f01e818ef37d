//! Chamfers and corner arcs (`,C` `,R`) between a line and an arc, or between two arcs.

use gsk_messages::say;

use super::CornerBlock;
use super::contour::{ContourMove, MoveArc, Vector, corner_points};
use crate::block::{ForeignBlock, ForeignWord};
use crate::dialect::CodeSet;
use crate::motion::known;
use crate::porter::{Porter, Refusal};
use crate::state::ActiveCode;

/// A corner beside at least one arc.
pub(crate) struct ArcCorner {
    /// The move before the corner.
    first: ContourMove,
    /// The move after it.
    second: ContourMove,
    /// The code of the second move if its block does not name it.
    modal_code: Option<&'static str>,
    /// The word of the corner.
    word: ForeignWord,
    /// Length or radius, millionths of a millimetre.
    size: i64,
}

impl Porter<'_> {
    /// Finds the corner at the end of an arc and removes its word; `None` without one.
    pub fn take_arc_corner(
        &self,
        block: &mut ForeignBlock,
        index: usize,
    ) -> Result<Option<ArcCorner>, Refusal> {
        let is_corner = |word: &ForeignWord| matches!(word.letter, b'C' | b'R') && word.has_comma;
        let Some(word) = block.words().find(|word| is_corner(word)).cloned() else {
            return Ok(None);
        };
        let refuse = || Refusal::new(word.shown(), say::ported_note_corner());
        let size = self.state.length(word.number.ok_or_else(refuse)?).abs();
        let from = known(self.position()).ok_or_else(refuse)?;
        let first = self.arc_move(block, from).ok_or_else(refuse)?;
        let (second, modal_code) = self.next_move(index, first.to).ok_or_else(refuse)?;
        block.remove_where(is_corner);
        let corner = ArcCorner {
            first,
            second,
            modal_code,
            word,
            size,
        };
        Ok((size > 0).then_some(corner))
    }

    /// Converts the corner at the end of a line before an arc. Returns `false` if no arc follows.
    pub fn convert_corner_before_arc(
        &mut self,
        block: &mut ForeignBlock,
        index: usize,
        word: &ForeignWord,
        size: i64,
    ) -> Result<bool, Refusal> {
        let Some(next) = self.next_block(index).filter(|it| is_arc(it)) else {
            return Ok(false);
        };
        if !word.has_comma {
            return Err(Refusal::new(word.shown(), say::ported_note_corner_plain()));
        }
        let refuse = || Refusal::new(word.shown(), say::ported_note_corner());
        let start = self.position();
        let to = known(self.end_point(block, start)).ok_or_else(refuse)?;
        let first = ContourMove {
            from: known(start).ok_or_else(refuse)?,
            to,
            turn: None,
        };
        let corner = ArcCorner {
            first,
            second: self.arc_move(next, to).ok_or_else(refuse)?,
            modal_code: None,
            word: word.clone(),
            size,
        };
        self.write_arc_corner(block, &corner)?;
        Ok(true)
    }

    /// Refuses I or K of a line if an arc follows it.
    pub fn refuse_plain_chamfer(&self, block: &ForeignBlock, index: usize) -> Result<(), Refusal> {
        let word = block.word(b'I').or(block.word(b'K'));
        let is_before_arc = || self.next_block(index).is_some_and(is_arc);
        match word.filter(|_| !self.state.set.is_rs274() && is_before_arc()) {
            Some(word) => Err(Refusal::new(word.shown(), say::ported_note_corner_plain())),
            None => Ok(()),
        }
    }

    /// Writes a corner beside an arc: the first move ends before it, and a block follows for it.
    pub fn write_arc_corner(
        &mut self,
        block: &mut ForeignBlock,
        corner: &ArcCorner,
    ) -> Result<(), Refusal> {
        let ArcCorner {
            first,
            second,
            word,
            size,
            ..
        } = corner;
        if self.state.set == CodeSet::Haas {
            return Err(Refusal::new(word.shown(), say::ported_note_corner_haas()));
        }
        let position = self.state.axes.map(|axis| axis.written_position());
        let is_round = word.letter == b'R';
        let points = known(position)
            .and_then(|position| corner_points(first, position, second, *size as f64, is_round));
        let points =
            points.ok_or_else(|| Refusal::new(word.shown(), say::ported_note_corner_fit()))?;
        let written = CornerBlock {
            before: to_words(points.before),
            after: to_words(points.after),
            moved: [0, 1].map(|axis| first.turn.is_some() || first.from[axis] != first.to[axis]),
            arc: is_round.then_some((points.is_left, *size)),
        };
        self.write_corner_block(block, to_words(first.to), &written);
        self.state.next_code = corner.modal_code.filter(|code| *code != written.code());
        Ok(())
    }

    /// The arc of a block from a point; `None` if the block is no arc, or the text does not show
    /// its end and centre.
    fn arc_move(&self, block: &ForeignBlock, from: Vector) -> Option<ContourMove> {
        let is_left = match (block.g_codes().last(), self.state.active) {
            (Some(code @ (20 | 30)), _) => code == 30,
            (None, ActiveCode::Arc { is_left }) => is_left,
            _ => return None,
        };
        if !block.g_codes().all(|code| matches!(code, 20 | 30)) || !block.has_any(b"XUZW") {
            return None;
        }
        let to = known(self.end_point(block, to_words(from).map(Some)))?;
        let turn = match block.number(b'R') {
            Some(radius) if radius.micro > 0 => {
                let radius = self.state.length(radius) as f64;
                MoveArc::from_radius(from, to, radius, is_left)?
            }
            _ if block.has(b'R') => return None,
            _ => MoveArc {
                center: self.arc_center(block, from)?,
                is_left,
            },
        };
        Some(ContourMove {
            from,
            to,
            turn: Some(turn),
        })
    }

    /// The centre that I and K give; `None` without both, or with a variable.
    pub fn arc_center(&self, block: &ForeignBlock, from: Vector) -> Option<Vector> {
        if !block.has_any(b"IK") {
            return None;
        }
        let mut center = from;
        for (axis, letter) in [(0, b'I'), (1, b'K')] {
            if !block.has(letter) {
                continue;
            }
            let number = block.number(letter)?;
            center[axis] = match self.state.has_absolute_centers {
                true => self.axis_value(number, axis) as f64 / [2.0, 1.0][axis],
                false => from[axis] + self.state.length(number) as f64,
            };
        }
        Some(center)
    }

    /// The line or arc after an arc, and the code of an arc whose block names none; `None` if the
    /// next block is neither.
    fn next_move(&self, index: usize, from: Vector) -> Option<(ContourMove, Option<&'static str>)> {
        let next = self.next_block(index)?;
        if next.g_codes().eq([10]) {
            let to = known(self.line_end(next, to_words(from).map(Some))?)?;
            let line = ContourMove {
                from,
                to,
                turn: None,
            };
            return next.has_any(b"XUZW").then_some((line, None));
        }
        let arc = self.arc_move(next, from)?;
        let is_left = arc.turn.is_some_and(|it| it.is_left);
        let code = if is_left { "G03" } else { "G02" };
        Some((arc, next.g_codes().next().is_none().then_some(code)))
    }
}

/// Whether a block names an arc.
fn is_arc(block: &ForeignBlock) -> bool {
    block.g_codes().any(|code| matches!(code, 20 | 30))
}

/// A point with X as a radius as a position with X as a diameter.
fn to_words(point: Vector) -> [i64; 2] {
    [(2.0 * point[0]).round() as i64, point[1].round() as i64]
}
