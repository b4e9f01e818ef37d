//! Axis words, feeds, arcs and threads of one pass.

use gsk_messages::say;

use crate::block::{ForeignBlock, ForeignWord};
use crate::number::{Number, divide_rounded, round_to, write_feed, write_number};
use crate::porter::{Porter, Refusal};
use crate::state::{ActiveCode, TrackedAxis};

/// Letters for the position and for the distance of the axes X and Z.
pub(crate) const AXIS_LETTERS: [(u8, u8); 2] = [(b'X', b'U'), (b'Z', b'W')];
/// Number of decimals in the written lengths.
pub(crate) const LENGTH_DECIMALS: u32 = 3;
const FEED_DECIMALS: u32 = 5;

/// A position with X as a diameter as a point with X as a radius; `None` if an axis is unknown.
pub(crate) fn known(position: [Option<i64>; 2]) -> Option<[f64; 2]> {
    let [Some(x), Some(z)] = position else {
        return None;
    };
    Some([x as f64 / 2.0, z as f64])
}

/// Formats a length in millionths of a millimetre as a word with this letter.
pub(crate) fn length_word(letter: u8, micro: i64) -> String {
    format!(
        "{}{}",
        char::from(letter),
        write_number(micro, LENGTH_DECIMALS)
    )
}

impl Porter<'_> {
    /// Converts X or U (axis 0) or Z or W (axis 1). If `moves`, the tracked position changes to the
    /// end point.
    pub fn convert_axis(&mut self, block: &mut ForeignBlock, axis: usize, moves: bool) {
        let (position, distance) = AXIS_LETTERS[axis];
        let letter = match (block.has(position), block.has(distance)) {
            (true, _) => position,
            (false, true) => distance,
            (false, false) => return,
        };
        let Some(number) = block.number(letter) else {
            self.state.axes[axis].forget();
            return;
        };
        if axis == 0 && self.state.is_radius {
            let word = format!("{}", char::from(letter));
            self.note(block.line, word, say::ported_note_radius());
        }
        let value = self.axis_value(number, axis);
        let is_distance = letter == distance || self.state.is_incremental;
        let tracked = &mut self.state.axes[axis];
        let written = match (is_distance, moves) {
            (true, true) => tracked.move_by(value),
            (true, false) => tracked.written_distance(value),
            (false, true) => tracked.move_to(value),
            (false, false) => round_to(value, LENGTH_DECIMALS),
        };
        let here = if is_distance { distance } else { position };
        if here != letter || written != number.micro || self.state.changes_length(number) {
            block.replace(letter, &length_word(here, written));
        }
    }

    /// Returns the value of an axis word in millionths of a millimetre, X as a diameter.
    pub fn axis_value(&self, number: Number, axis: usize) -> i64 {
        match axis {
            0 => self.state.diameter(number),
            _ => self.state.length(number),
        }
    }

    /// Returns the end point of the axis words of a block, X and Z; `None` for an axis whose
    /// position the text does not show.
    pub fn end_point(&self, block: &ForeignBlock, from: [Option<i64>; 2]) -> [Option<i64>; 2] {
        let end = |axis: usize| {
            let (position, distance) = AXIS_LETTERS[axis];
            let value = |letter| Some(self.axis_value(block.number(letter)?, axis));
            if block.has(position) && !self.state.is_incremental {
                return value(position);
            }
            let letter = if block.has(position) {
                position
            } else {
                distance
            };
            match block.has(letter) {
                true => Some(from[axis]? + value(letter)?),
                false => from[axis],
            }
        };
        [end(0), end(1)]
    }

    /// Returns the current positions of X and Z, millionths of a millimetre; `None` for an unknown
    /// one.
    pub fn position(&self) -> [Option<i64>; 2] {
        self.state.axes.map(|axis| axis.position)
    }

    /// Converts the word with this letter, which is a length, to millimetres with a point.
    pub fn convert_length(&self, block: &mut ForeignBlock, letter: u8) {
        if let Some(number) = block.number(letter)
            && self.state.changes_length(number)
        {
            block.replace(letter, &length_word(letter, self.state.length(number)));
        }
    }

    /// Converts the F word of the block to the feed unit of this control.
    pub fn convert_feed(&mut self, block: &mut ForeignBlock) {
        let Some(number) = block.number(b'F') else {
            return;
        };
        self.start_feed(block);
        let feed = self.state.feed(number);
        if feed != number.micro {
            if !number.has_point && !self.state.set.is_rs274() {
                let word = block.word(b'F').map(ForeignWord::shown);
                self.note(
                    block.line,
                    word.unwrap_or_default(),
                    say::ported_note_feed_increments(),
                );
            }
            let decimals = match self.state.is_per_revolution() {
                true => FEED_DECIMALS,
                false => LENGTH_DECIMALS,
            };
            block.replace(b'F', &format!("F{}", write_feed(feed, decimals)));
        }
    }

    /// Writes, before the first feed, the G98 or G99 that equals the feed mode of the foreign
    /// control at power-on.
    pub fn start_feed(&mut self, block: &mut ForeignBlock) {
        if self.state.per_revolution.is_none() && !self.state.set.is_rs274() {
            self.state.per_revolution = Some(true);
            block.prepend("G99");
            self.note(block.line, "F", say::ported_note_first_feed());
        }
    }

    /// Writes the feed mode at power-on in a line before a call: the called program may feed before
    /// the first F of this text.
    pub fn start_feed_before_call(&mut self, block: &mut ForeignBlock) {
        if self.state.per_revolution.is_none() && !self.state.set.is_rs274() {
            self.state.per_revolution = Some(true);
            block.before.push("G99".to_owned());
            self.note(block.line, "F", say::ported_note_first_feed());
        }
    }

    /// Converts F or E of a threading block to a thread lead of this control.
    pub fn convert_lead(&mut self, block: &mut ForeignBlock) {
        let letter = match (block.has(b'E'), block.has(b'F')) {
            (true, _) => b'E',
            (false, true) => b'F',
            (false, false) => return,
        };
        let Some(number) = block.number(letter) else {
            return;
        };
        let lead = self.state.lead(number);
        if lead == number.micro && letter == b'F' {
            return;
        }
        if letter == b'E' {
            block.remove(b"F");
        }
        if !number.has_point && lead != number.micro {
            let word = block.word(letter).map(ForeignWord::shown);
            self.note(
                block.line,
                word.unwrap_or_default(),
                say::ported_note_feed_increments(),
            );
        }
        block.replace(letter, &format!("F{}", write_feed(lead, FEED_DECIMALS)));
    }

    /// Converts a block of G00 to G03: rapid, line or arc.
    pub fn convert_motion(
        &mut self,
        block: &mut ForeignBlock,
        index: usize,
    ) -> Result<(), Refusal> {
        self.start_profile(block);
        self.convert_feed(block);
        let code = self.state.next_code.take();
        if let Some(code) = code.filter(|_| !block.g_codes().any(|code| code <= 30)) {
            block.prepend(code);
        }
        match self.state.active {
            ActiveCode::Arc { .. } => {
                let corner = self.take_arc_corner(block, index)?;
                self.convert_arc(block)?;
                match corner {
                    Some(corner) => self.write_arc_corner(block, &corner)?,
                    None => self.complete_end(block),
                }
            }
            ActiveCode::Line => {
                self.convert_angle(block, index)?;
                self.convert_corner(block, index)?;
            }
            _ => {}
        }
        self.convert_axis(block, 0, true);
        self.convert_axis(block, 1, true);
        Ok(())
    }

    /// Converts R, or I and K, of an arc to those of this control.
    fn convert_arc(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let start = self.position();
        let end = self.end_point(block, start);
        self.complete_center(block)?;
        if let Some(number) = block.number(b'R') {
            if number.micro < 0 {
                let word = block.word(b'R').map(ForeignWord::shown);
                return Err(Refusal::new(
                    word.unwrap_or_default(),
                    say::ported_note_long_arc(),
                ));
            }
            let radius = round_to(self.state.length(number), LENGTH_DECIMALS);
            let written = self.state.axes.map(|axis| axis.written_position());
            let radius = radius.max(smallest_radius(written, end));
            if radius != number.micro {
                block.replace(b'R', &length_word(b'R', radius));
            }
        }
        for (axis, letter) in [(0, b'I'), (1, b'K')] {
            let Some(number) = block.number(letter) else {
                continue;
            };
            if !self.state.has_absolute_centers {
                self.convert_length(block, letter);
                continue;
            }
            let center = self.axis_value(number, axis);
            let Some(from) = start[axis] else {
                let word = block.word(letter).map(ForeignWord::shown);
                return Err(Refusal::new(
                    word.unwrap_or_default(),
                    say::ported_note_centers(),
                ));
            };
            let offset = (center - from) / if axis == 0 { 2 } else { 1 };
            block.replace(letter, &length_word(letter, offset));
        }
        Ok(())
    }

    /// Writes both coordinates of an arc after a corner, because it begins beside the programmed
    /// point.
    fn complete_end(&mut self, block: &mut ForeignBlock) {
        for (axis, (position, distance)) in AXIS_LETTERS.into_iter().enumerate() {
            let tracked = self.state.axes[axis];
            let is_missing = tracked.follows_corner() && !block.has_any(&[position, distance]);
            if let Some(end) = tracked.position.filter(|_| is_missing) {
                let written = self.state.axes[axis].move_to(end);
                block.append(&length_word(position, written));
            }
        }
    }

    /// Writes the centre of an arc after a corner as distances from the end of the corner.
    fn complete_center(&self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        if block.has(b'R') || !self.state.axes.iter().any(TrackedAxis::follows_corner) {
            return Ok(());
        }
        let center = known(self.position()).and_then(|from| self.arc_center(block, from));
        let written = self.state.axes.map(|axis| axis.written_position());
        let (Some(center), Some(written)) = (center, known(written)) else {
            return Err(Refusal::new("I K", say::ported_note_centers()));
        };
        for (axis, letter) in [(0, b'I'), (1, b'K')] {
            let offset = (center[axis] - written[axis]).round() as i64;
            let word = length_word(letter, offset);
            if !block.replace(letter, &word) {
                block.append(&word);
            }
        }
        Ok(())
    }

    /// Converts a thread of one pass: G32, or G34 with the change of its lead.
    pub fn convert_thread(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        self.convert_axis(block, 0, true);
        self.convert_axis(block, 1, true);
        if let Some(number) = block.number(b'Q') {
            if number.micro != 0 {
                return Err(Refusal::new("Q", say::ported_note_start_angle()));
            }
            block.remove(b"Q");
        }
        if self.state.set.is_rs274() {
            let along_z = block.has(b'K');
            let letter = if along_z { b'K' } else { b'I' };
            if let Some(number) = block.number(letter) {
                let lead = self.state.to_metric(number.micro);
                block.replace(letter, &format!("F{}", write_feed(lead, FEED_DECIMALS)));
                block.remove(b"IK");
            }
            return Ok(());
        }
        if block.has_g(340)
            && let Some(number) = block.number(b'K')
        {
            let change = self.state.lead(number);
            block.replace(b'K', &format!("R{}", write_number(change, FEED_DECIMALS)));
        }
        if let Some(word) = block.word(b'K').or(block.word(b'I')) {
            return Err(Refusal::new(word.shown(), say::ported_note_thread_words()));
        }
        self.convert_lead(block);
        Ok(())
    }
}

/// The smallest radius of an arc between two points, so that rounding does not make the chord
/// longer than the diameter; 0 if a point is unknown or the radius is much too small.
fn smallest_radius(start: [Option<i64>; 2], end: [Option<i64>; 2]) -> i64 {
    let ([Some(x), Some(z)], [Some(to_x), Some(to_z)]) = (start, end) else {
        return 0;
    };
    let rounded = |from: i64, to: i64| (round_to(to, 3) - round_to(from, 3)) as f64;
    let (x, z) = (rounded(x, to_x) / 2.0, rounded(z, to_z));
    let half = ((x * x + z * z).sqrt() / 2.0).ceil() as i64;
    divide_rounded(half + 499, 1_000) * 1_000
}
