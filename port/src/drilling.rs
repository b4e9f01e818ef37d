//! Drilling cycles become the moves that they consist of.

use gsk_messages::say;

use crate::block::ForeignBlock;
use crate::motion::length_word;
use crate::number::{UNIT, round_to, write_feed, write_number};
use crate::porter::{Porter, Refusal};
use crate::state::ActiveCode;

/// Greatest number of pecks into which a hole is divided.
const MAX_PECKS: i64 = 200;
/// Least depth of a peck, 10⁻⁶ mm: the least increment of this control.
const LEAST_PECK: i64 = 1_000;
/// Distance before the bottom of the last peck at which the drill changes from rapid to feed, 10⁻⁶
/// mm.
const CLEARANCE: i64 = UNIT / 2;
/// Distance by which G73 of LinuxCNC backs off to break the chip, 10⁻⁶ mm.
const CHIP_RETRACT: i64 = 254_000;

impl Porter<'_> {
    /// Converts a block of G81 to G85, or one that repeats it at another position.
    pub fn convert_drill(&mut self, block: &mut ForeignBlock, code: i64) -> Result<(), Refusal> {
        let is_start = block.has_g(code);
        if !is_start && !block.has_any(b"XZUW") {
            return Ok(());
        }
        let refuse = |word: &str| Refusal::new(word, say::ported_note_drill_words());
        if self.state.is_incremental || block.has_any(b"UW") {
            return Err(refuse("U"));
        }
        self.convert_drill_words(block);
        let drill = self.state.drill;
        let (Some(bottom), Some(level)) = (drill.bottom, drill.level.or(drill.initial)) else {
            return Err(refuse("Z"));
        };
        let back = drill.initial.unwrap_or(level).max(level);
        let mut lines = Vec::new();
        let feed = self.take_drill_feed(block, code);
        let to = |code: &str, z: i64| format!("{code} {}", length_word(b'Z', z));
        lines.push(to("G00", level));
        match code {
            730 | 830 => {
                let clears = code == 830;
                peck_lines(&mut lines, (level, bottom), drill.peck, &feed, clears)
                    .ok_or_else(|| refuse("Q"))?;
            }
            840 => {
                lines.push(format!("{}{feed}", to("G33", bottom)));
                let direction = self.state.machine.spindle.unwrap_or(30) / 10;
                lines.push(format!("M{direction:02}"));
            }
            _ => lines.push(format!("{}{feed}", to("G01", bottom))),
        }
        if let Some(dwell) = drill.dwell.filter(|it| *it > 0 && code != 840) {
            lines.push(format!("G04 X{}", write_number(dwell, 3)));
        }
        if code == 850 {
            lines.push(to("G01", level));
        }
        lines.push(to("G00", back));
        self.note(
            block.line,
            format!("G{}", code / 10),
            say::ported_note_drill(),
        );
        block.remove_g(&[code, 0, 10]);
        block.remove(b"ZRQPFK");
        if block.has(b'X') {
            self.convert_axis(block, 0, true);
            block.prepend("G00");
        } else {
            block.append(&lines.remove(0));
        }
        block.after.extend(lines);
        self.state.axes[1].move_to(back);
        Ok(())
    }

    /// Converts G33.1, which taps and returns as G33 of this control does.
    pub fn convert_rigid_tap(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let refuse = || Refusal::new("G33.1", say::ported_note_drill_words());
        let words = block.number(b'Z').zip(block.number(b'K'));
        let (bottom, lead) = words.ok_or_else(refuse)?;
        if self.state.is_incremental || block.has_any(b"XUW") {
            return Err(refuse());
        }
        let bottom = round_to(self.state.length(bottom), 3);
        let lead = self.state.to_metric(lead.micro);
        block.remove_g(&[331]);
        block.remove(b"ZK");
        let (z, feed) = (length_word(b'Z', bottom), write_feed(lead, 5));
        block.append(&format!("G33 {z} F{feed}"));
        let direction = self.state.machine.spindle.unwrap_or(30) / 10;
        block.after.push(format!("M{direction:02}"));
        block.after.push("G00".to_owned());
        self.state.active = ActiveCode::Rapid;
        self.note(block.line, "G33.1", say::ported_note_rigid_tap());
        Ok(())
    }

    /// Stores the words of a drilling cycle that also apply to its next hole.
    fn convert_drill_words(&mut self, block: &ForeignBlock) {
        let state = &mut self.state;
        let length = |letter| block.number(letter).map(|it| state.length(it));
        let seconds = |number: crate::number::Number| match state.set.is_rs274() || number.has_point
        {
            true => number.micro,
            false => number.micro / 1_000,
        };
        let (bottom, level) = (length(b'Z'), length(b'R'));
        let peck = block.number(b'Q').map(|it| state.cycle_length(it));
        let dwell = block.number(b'P').map(seconds);
        let drill = &mut state.drill;
        drill.bottom = bottom.or(drill.bottom);
        drill.level = level.or(drill.level);
        drill.peck = peck.or(drill.peck);
        drill.dwell = dwell.or(drill.dwell);
    }

    /// Removes the F word of the block, and returns the feed as a word with a blank before it;
    /// empty without F.
    fn take_drill_feed(&mut self, block: &mut ForeignBlock, code: i64) -> String {
        let Some(number) = block.number(b'F') else {
            return String::new();
        };
        if code == 840 {
            return format!(" F{}", write_feed(self.state.lead(number), 5));
        }
        self.start_feed(block);
        format!(" F{}", write_feed(self.state.feed(number), 5))
    }
}

/// Adds the lines that drill a hole in pecks; if the drill `clears` the hole, it retracts to the
/// level after each peck, else it backs off a little. Returns `None` if there are too many pecks.
fn peck_lines(
    lines: &mut Vec<String>,
    (level, bottom): (i64, i64),
    peck: Option<i64>,
    feed: &str,
    clears: bool,
) -> Option<()> {
    let step = peck.map_or(level - bottom, i64::abs);
    if step < LEAST_PECK || (level - bottom) / step > MAX_PECKS {
        return None;
    }
    let mut feed = feed.to_owned();
    let mut depth = level;
    while depth > bottom {
        if depth != level {
            let (first, back) = match clears {
                true => (Some(level), depth + CLEARANCE),
                false => (None, depth + CHIP_RETRACT),
            };
            let back = Some(back.min(level)).filter(|back| Some(*back) != first);
            for z in first.into_iter().chain(back) {
                lines.push(format!("G00 {}", length_word(b'Z', z)));
            }
        }
        depth = round_to(depth - step, 3).max(bottom);
        lines.push(format!("G01 {}{feed}", length_word(b'Z', depth)));
        feed.clear();
    }
    Some(())
}
