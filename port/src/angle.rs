//! Lines that are given by their angle to the Z axis, as in direct drawing input.

use gsk_messages::say;

use crate::block::{ForeignBlock, ForeignWord, LinePiece};
use crate::number::{Number, UNIT, divide_rounded, write_number};
use crate::porter::{Porter, Refusal};

/// Greatest coordinate that an angle may yield, millionths of a millimetre.
const MAX_COORDINATE: f64 = 1e10;

impl Porter<'_> {
    /// Replaces the angle A of a line by the coordinates that it yields: with one coordinate of the
    /// end, or as the first of two lines whose end is given with the second.
    pub fn convert_angle(&mut self, block: &mut ForeignBlock, index: usize) -> Result<(), Refusal> {
        let Some(word) = angle_word(block).cloned() else {
            return Ok(());
        };
        let refuse = || Refusal::new(word.shown(), say::ported_note_angle());
        let start = self.position();
        let commands = [block.has_any(b"XU"), block.has_any(b"ZW")];
        let end = match commands {
            // The second of two lines: its end needs no angle.
            [true, true] if self.follows_angle(index) => None,
            [true, true] => return Err(refuse()),
            [false, false] => Some(self.crossing(block, index, start).ok_or_else(refuse)?),
            _ => Some(self.angle_end(block, start).ok_or_else(refuse)?),
        };
        let mut words = Vec::new();
        for (axis, letter) in [(0, b'X'), (1, b'Z')] {
            if let (Some(end), false) = (end, commands[axis]) {
                words.push(LinePiece::Word(self.axis_word(axis, letter, end[axis])));
                words.push(LinePiece::Text(" ".to_owned()));
            }
        }
        words.pop();
        let is_angle =
            |piece: &LinePiece| matches!(piece, LinePiece::Word(word) if word.letter == b'A');
        let at = block.pieces.iter().position(is_angle);
        if let Some(at) = at.filter(|_| !words.is_empty()) {
            block.pieces.splice(at..=at, words);
        } else {
            block.remove_where(|word| word.letter == b'A');
        }
        Ok(())
    }

    /// Returns the end of a line with an angle and one coordinate, X as a diameter and Z; `None` if
    /// they do not yield one or the start is unknown.
    pub fn angle_end(&self, block: &ForeignBlock, start: [Option<i64>; 2]) -> Option<[i64; 2]> {
        let tangent = angle(block)?.tan();
        let ([Some(x), Some(z)], [Some(from_x), Some(from_z)]) =
            (self.end_point(block, start), start)
        else {
            return None;
        };
        let end = match (block.has_any(b"XU"), block.has_any(b"ZW")) {
            (true, false) => [
                x as f64,
                from_z as f64 + (x - from_x) as f64 / 2.0 / tangent,
            ],
            (false, true) => [
                from_x as f64 + (z - from_z) as f64 * 2.0 * tangent,
                z as f64,
            ],
            _ => return None,
        };
        rounded(end)
    }

    /// Returns the point where a line with an angle only meets the next one, which has an angle and
    /// its end.
    fn crossing(
        &self,
        block: &ForeignBlock,
        index: usize,
        start: [Option<i64>; 2],
    ) -> Option<[i64; 2]> {
        let rest = self.parts.get(index + 1..)?;
        let next = &rest.iter().find(|part| part.block.has_content())?.block;
        let is_absolute = next.has(b'X') && next.has(b'Z') && !self.state.is_incremental;
        if !is_absolute || next.g_codes().any(|code| code != 10) {
            return None;
        }
        let ([Some(x), Some(z)], [Some(from_x), Some(from_z)]) =
            (self.end_point(next, start), start)
        else {
            return None;
        };
        let (one, two) = (angle(block)?.sin_cos(), angle(next)?.sin_cos());
        let (dx, dz) = ((x - from_x) as f64 / 2.0, (z - from_z) as f64);
        let along = (dx * two.1 - dz * two.0) / (one.0 * two.1 - one.1 * two.0);
        let end = [
            from_x as f64 + 2.0 * along * one.0,
            from_z as f64 + along * one.1,
        ];
        rounded(end).filter(|_| along > 0.0)
    }

    /// Whether the block before this one is a line with an angle and no end.
    fn follows_angle(&self, index: usize) -> bool {
        let before = self.parts[..index].iter().rev();
        let mut before = before.map(|part| &part.block).filter(|it| it.has_content());
        before
            .next()
            .is_some_and(|it| angle_word(it).is_some() && !it.has_any(b"XUZW"))
    }

    /// Returns a word of the foreign program for a position, millionths of a millimetre.
    fn axis_word(&self, axis: usize, letter: u8, position: i64) -> ForeignWord {
        let state = &self.state;
        let from = state.axes[axis].position.filter(|_| state.is_incremental);
        let value = position - from.unwrap_or(0);
        let micro = match state.is_inch {
            true => divide_rounded(value * 10, 254),
            false => value,
        };
        ForeignWord {
            letter,
            has_comma: false,
            number: Some(Number {
                micro,
                has_point: true,
            }),
            written: format!("{}{}", char::from(letter), write_number(micro, 6)),
        }
    }
}

/// Returns the angle word of a block, with or without a comma.
pub(crate) fn angle_word(block: &ForeignBlock) -> Option<&ForeignWord> {
    block.words().find(|word| word.letter == b'A')
}

/// Returns the angle A of a block, radians; `None` if it has none or a variable.
fn angle(block: &ForeignBlock) -> Option<f64> {
    let number = angle_word(block)?.number?;
    Some((number.micro as f64 / UNIT as f64).to_radians())
}

/// Rounds a point to whole millionths; `None` if it is far away, as for a line along its own axis.
fn rounded(point: [f64; 2]) -> Option<[i64; 2]> {
    let is_near = |it: f64| it.is_finite() && it.abs() <= MAX_COORDINATE;
    point
        .into_iter()
        .all(is_near)
        .then(|| point.map(|it| it.round() as i64))
}
