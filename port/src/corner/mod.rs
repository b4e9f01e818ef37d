//! Chamfers and corner arcs between two lines.

mod arcs;
mod contour;

use gsk_messages::say;

use crate::angle::angle_word;
use crate::block::{ForeignBlock, ForeignWord};
use crate::motion::{AXIS_LETTERS, LENGTH_DECIMALS, length_word};
use crate::number::round_to;
use crate::porter::{Porter, Refusal};
use crate::program_numbers::whole;
use crate::source::SourcePart;

use contour::Vector;

/// A corner in the blocks of this control: points as X (diameter) and Z, millionths of a millimetre.
pub(crate) struct CornerBlock {
    /// End of the move before the corner.
    pub before: [i64; 2],
    /// Start of the move after it.
    pub after: [i64; 2],
    /// The axes that the move before the corner moves.
    pub moved: [bool; 2],
    /// Whether a corner arc is counter-clockwise, and its radius; `None` for a chamfer.
    pub arc: Option<(bool, i64)>,
}

impl CornerBlock {
    /// The code of the corner.
    pub const fn code(&self) -> &'static str {
        match self.arc {
            None => "G01",
            Some((true, _)) => "G03",
            Some((false, _)) => "G02",
        }
    }
}

impl<'a> Porter<'a> {
    /// Converts a chamfer or rounding (`,C` `,R`, C, R) at the end of a line. Between lines
    /// parallel to the axes it becomes I, K or R of this control; otherwise the tangent points are
    /// computed and the corner becomes a separate block.
    pub fn convert_corner(
        &mut self,
        block: &mut ForeignBlock,
        index: usize,
    ) -> Result<(), Refusal> {
        let is_rs274 = self.state.set.is_rs274();
        let is_corner = |word: &ForeignWord| {
            matches!(word.letter, b'C' | b'R') && (word.has_comma || !is_rs274)
        };
        let Some(word) = block.words().find(|word| is_corner(word)).cloned() else {
            self.refuse_plain_chamfer(block, index)?;
            self.convert_length(block, b'I');
            self.convert_length(block, b'K');
            return Ok(());
        };
        let refuse = || Refusal::new(word.shown(), say::ported_note_corner());
        let size = self.state.length(word.number.ok_or_else(refuse)?).abs();
        if !block.has_any(b"XUZW") {
            return Err(refuse());
        }
        block.remove_where(is_corner);
        if size == 0 || self.convert_corner_before_arc(block, index, &word, size)? {
            return Ok(());
        }
        let start = self.position();
        let corner = self.end_point(block, start);
        let (next, end) = self.next_line(index, corner).ok_or_else(refuse)?;
        let moves = [0, 1].map(|axis| leg(start[axis], corner[axis], block, axis));
        let leaves = match angle_word(next) {
            Some(_) => [0, 1].map(|axis| Some((end[axis]? - corner[axis]?) as f64)),
            None => [0, 1].map(|axis| leg(corner[axis], end[axis], next, axis)),
        };
        let ([Some(x1), Some(z1)], [Some(x2), Some(z2)]) = (moves, leaves) else {
            return Err(refuse());
        };
        let is_round = word.letter == b'R';
        let first = [x1 / 2.0, z1];
        let second = [x2 / 2.0, z2];
        let letter = match (is_round, x1 == 0.0 && z2 == 0.0, z1 == 0.0 && x2 == 0.0) {
            (true, true, _) | (true, _, true) => b'R',
            (false, true, _) => b'I',
            (false, _, true) => b'K',
            (_, false, false) => {
                return self
                    .write_corner(block, next, (first, second), size, is_round)
                    .ok_or_else(refuse);
            }
        };
        let sign = if second[0] + second[1] < 0.0 { -1 } else { 1 };
        block.append(&length_word(letter, size * sign));
        Ok(())
    }

    /// Writes a corner between lines of any direction as a block after the first line; `None`
    /// if it does not fit or a position is unknown.
    fn write_corner(
        &mut self,
        block: &mut ForeignBlock,
        next: &ForeignBlock,
        (first, second): (Vector, Vector),
        size: i64,
        is_round: bool,
    ) -> Option<()> {
        let [Some(x), Some(z)] = self.end_point(block, self.position()) else {
            return None;
        };
        let length = |vector: Vector| vector[0].hypot(vector[1]);
        let (one, two) = (length(first), length(second));
        if one < 1.0 || two < 1.0 {
            return None;
        }
        // The tool may be beside the programmed start: at the end of the corner before this one.
        let taken = self.state.axes.map(|axis| axis.rounding as f64);
        let free = length([first[0] - taken[0] / 2.0, first[1] - taken[1]]);
        let (one_unit, two_unit) = (first.map(|it| it / one), second.map(|it| it / two));
        let cross = one_unit[1] * two_unit[0] - one_unit[0] * two_unit[1];
        let dot = one_unit[0] * two_unit[0] + one_unit[1] * two_unit[1];
        let turn = cross.abs().atan2(dot);
        let reach = match is_round {
            true => size as f64 * (turn / 2.0).tan(),
            false => size as f64,
        };
        if reach > free || reach > two {
            return None;
        }
        let point = |unit: Vector, by: f64| {
            let diameter = x as f64 + 2.0 * unit[0] * by;
            [
                diameter.round() as i64,
                (z as f64 + unit[1] * by).round() as i64,
            ]
        };
        let corner = CornerBlock {
            before: point(one_unit, -reach),
            after: point(two_unit, reach),
            moved: first.map(|it| it != 0.0),
            arc: is_round.then_some((cross > 0.0, size)),
        };
        self.write_corner_block(block, [x, z], &corner);
        if is_round && !next.g_codes().any(|code| code <= 30) {
            block.after.push("G01".to_owned());
        }
        Some(())
    }

    /// Ends the block before a corner and writes the corner as a block after it. Distances in the
    /// next block count from `point`, where both moves meet.
    pub fn write_corner_block(
        &mut self,
        block: &mut ForeignBlock,
        point: [i64; 2],
        corner: &CornerBlock,
    ) {
        let [x, z] = corner.before;
        block.remove(b"XUZW");
        let written =
            |[x, z]: [i64; 2]| format!("{} {}", length_word(b'X', x), length_word(b'Z', z));
        // A corner of this control before the block needs a block that moves one axis only.
        block.append(&match corner.moved {
            [false, _] => length_word(b'Z', z),
            [true, false] => length_word(b'X', x),
            [true, true] => written(corner.before),
        });
        let mut line = format!("{} {}", corner.code(), written(corner.after));
        if let Some((_, radius)) = corner.arc {
            line.push_str(&format!(" {}", length_word(b'R', radius)));
        }
        block.after.push(line);
        for (axis, (point, end)) in
            (self.state.axes.iter_mut()).zip(point.into_iter().zip(corner.after))
        {
            axis.move_to(point);
            axis.rounding = round_to(end, LENGTH_DECIMALS) - point;
        }
    }

    /// Returns the next block with content; `None` at the end of the text.
    pub fn next_block(&self, index: usize) -> Option<&'a ForeignBlock> {
        let rest: &'a [SourcePart] = self.parts.get(index + 1..)?;
        let next = rest.iter().find(|part| part.block.has_content())?;
        Some(&next.block)
    }

    /// Returns the end of a line, which may have an angle in the place of a coordinate.
    pub fn line_end(
        &self,
        block: &ForeignBlock,
        from: [Option<i64>; 2],
    ) -> Option<[Option<i64>; 2]> {
        let has_both = block.has_any(b"XU") && block.has_any(b"ZW");
        match angle_word(block).filter(|_| !has_both) {
            Some(_) => Some(self.angle_end(block, from)?.map(Some)),
            None => Some(self.end_point(block, from)),
        }
    }

    /// Returns the next block with axis words and its end point, if that block is a straight line;
    /// `None` if it is not.
    fn next_line(
        &self,
        index: usize,
        from: [Option<i64>; 2],
    ) -> Option<(&'a ForeignBlock, [Option<i64>; 2])> {
        let block = self.next_block(index)?;
        let is_line = !block.g_codes().any(|code| code != 10);
        let is_program = whole(block, b'O').is_some();
        if !is_line || is_program || !block.has_any(b"XUZW") {
            return None;
        }
        let end = self.line_end(block, from)?;
        Some((block, end))
    }
}

/// Returns the distance of a move along an axis, with its sign: 0 if the block does not command the
/// axis, `None` if a position is unknown.
fn leg(from: Option<i64>, to: Option<i64>, block: &ForeignBlock, axis: usize) -> Option<f64> {
    let (position, distance) = AXIS_LETTERS[axis];
    if !block.has(position) && !block.has(distance) {
        return Some(0.0);
    }
    Some((to? - from?) as f64)
}
