//! Cycles along a profile and peck cycles: G70 to G75.

use gsk_messages::say;

use crate::block::{ForeignBlock, ForeignWord};
use crate::motion::length_word;
use crate::number::{Number, divide_rounded, write_whole};
use crate::porter::{Porter, Refusal};
use crate::program_numbers::whole;
use crate::state::{ActiveCode, RoughProfile};

/// The R word with the retract distance, mm, for cycles whose one-block form takes it from a
/// parameter.
const RETRACT: &str = "R0.5";

impl Porter<'_> {
    /// Notes that the profile of a roughing cycle begins, if `sequence` is the number of its first
    /// block.
    pub fn enter_profile(&mut self, sequence: Option<i64>) {
        if let Some(profile) = &mut self.state.profile
            && sequence == Some(profile.first)
        {
            profile.is_inside = true;
        }
    }

    /// Sets the position back to the one before the roughing cycle, after the last block of its
    /// profile.
    pub fn leave_profile(&mut self, sequence: Option<i64>) {
        if let Some(profile) = self.state.profile
            && profile.is_inside
            && sequence == Some(profile.last)
        {
            self.state.axes = profile.resume;
            self.state.active = profile.active;
            self.state.profile = None;
        }
    }

    /// Converts the first block of a roughing profile, which moves one axis only here: removes a
    /// word that does not move the other axis.
    pub fn start_profile(&mut self, block: &mut ForeignBlock) {
        let Some(profile) = self.state.profile else {
            return;
        };
        if !profile.is_inside || whole(block, b'N') != Some(profile.first) {
            return;
        }
        if !block.g_codes().any(|code| code <= 30) {
            block.prepend(match self.state.active {
                ActiveCode::Line => "G01",
                _ => "G00",
            });
        }
        let (axis, letters, other) = match profile.cycle {
            710 => (1, b"ZW", b"XU"),
            720 => (0, b"XU", b"ZW"),
            _ => return,
        };
        if !block.has_any(letters) || !block.has_any(other) {
            return;
        }
        let from = self.position();
        let end = self.end_point(block, from);
        let distance = block.number(letters[1]);
        let stands = end[axis].is_some() && end[axis] == from[axis];
        if stands || distance.is_some_and(|it| it.micro == 0) {
            for word in block.remove(letters) {
                self.note(block.line, word.shown(), say::ported_note_profile_start());
            }
        }
    }

    /// Whether the current block belongs to the profile of a roughing cycle.
    pub fn is_inside_profile(&self) -> bool {
        self.state.profile.is_some_and(|profile| profile.is_inside)
    }

    /// Converts a roughing cycle G71, G72 or G73, in its one-block or two-block form.
    pub fn convert_rough(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let cycle = block.g_codes().find(|code| (710..=730).contains(code));
        let cycle = cycle.unwrap_or(710);
        let (Some(first), Some(last)) = (whole(block, b'P'), whole(block, b'Q')) else {
            return self.convert_rough_depth(block, cycle);
        };
        match cycle {
            730 => self.split_pattern(block)?,
            _ => self.split_rough(block, cycle)?,
        }
        self.convert_feed(block);
        self.convert_length(block, b'U');
        self.convert_length(block, b'W');
        self.convert_sequence_words(block, b"PQ")?;
        self.state.profile = Some(RoughProfile {
            cycle,
            first,
            last,
            resume: self.state.axes,
            active: self.state.active,
            is_inside: false,
        });
        Ok(())
    }

    /// Converts the first block of a two-block roughing cycle, which has no P and Q; `cycle` is its
    /// G code in tenths.
    fn convert_rough_depth(&mut self, block: &mut ForeignBlock, cycle: i64) -> Result<(), Refusal> {
        self.convert_feed(block);
        self.convert_length(block, b'U');
        self.convert_length(block, b'W');
        match (cycle, block.number(b'R')) {
            (730, Some(number)) => {
                let Some(count) = number.whole() else {
                    return Err(Refusal::new("R", say::ported_note_pattern()));
                };
                block.replace(b'R', &format!("R{count}"));
            }
            _ => self.convert_length(block, b'R'),
        }
        Ok(())
    }

    /// Writes the depth of cut of a one-block G71 or G72 as a block before it.
    fn split_rough(&mut self, block: &mut ForeignBlock, cycle: i64) -> Result<(), Refusal> {
        for word in block.remove(b"IK") {
            if word.number.is_none_or(|it| it.micro != 0) {
                self.note(block.line, word.shown(), say::ported_note_semi_finish());
            }
        }
        block.remove(b"R");
        let Some(depth) = block.number(b'D') else {
            return Ok(());
        };
        let letter = if cycle == 710 { b'U' } else { b'W' };
        let depth = length_word(letter, self.state.cycle_length(depth));
        block
            .before
            .push(format!("G{} {depth} {RETRACT}", cycle / 10));
        block.remove(b"D");
        self.note(
            block.line,
            format!("G{}", cycle / 10),
            say::ported_note_rough(),
        );
        Ok(())
    }

    /// Writes the relief and the number of passes of a one-block G73 as a block before it.
    fn split_pattern(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let Some(count) = block.number(b'D') else {
            return Ok(());
        };
        let Some(count) = count.whole() else {
            return Err(Refusal::new("D", say::ported_note_pattern()));
        };
        let mut text = "G73".to_owned();
        for (from, to) in [(b'I', b'U'), (b'K', b'W')] {
            let relief = block.number(from).map_or(0, |it| self.state.length(it));
            text.push_str(&format!(" {}", length_word(to, relief)));
        }
        block.before.push(format!("{text} R{count}"));
        block.remove(b"DIK");
        Ok(())
    }

    /// Converts a finishing cycle G70.
    pub fn convert_finish(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        self.convert_feed(block);
        self.convert_sequence_words(block, b"PQ")
    }

    /// Converts the words that refer to sequence numbers, to the new sequence numbers.
    pub fn convert_sequence_words(
        &self,
        block: &mut ForeignBlock,
        letters: &[u8],
    ) -> Result<(), Refusal> {
        for letter in letters {
            let Some(word) = block.word(*letter).cloned() else {
                continue;
            };
            let number = word.number.and_then(Number::whole);
            let here = number.and_then(|number| self.numbers.sequence(number));
            let Some(here) = here else {
                return Err(Refusal::new(word.shown(), say::ported_note_long_sequence()));
            };
            if number != Some(here) || word.number.is_some_and(|it| it.has_point) {
                block.replace(*letter, &format!("{}{here}", char::from(*letter)));
            }
        }
        Ok(())
    }

    /// Returns the number of a word in thousandths of a millimetre; a number without a point counts
    /// least increments.
    pub fn thousandths(&self, number: Number, factor: i64) -> i64 {
        divide_rounded(self.state.cycle_length(number) * factor, 1_000)
    }

    /// Converts G74 or G75 in the one-block or two-block form. Steps along X are radius values on
    /// foreign controls and diameters on this one.
    pub fn convert_peck(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let along_z = block.has_g(740);
        self.convert_feed(block);
        if !block.has_any(b"XUZW") {
            self.convert_length(block, b'R');
            return Ok(());
        }
        let relief = if along_z { 2 } else { 1 };
        if block.has_any(b"IKD") {
            let code = if along_z { "G74" } else { "G75" };
            block.before.push(format!("{code} {RETRACT}"));
            self.note(block.line, code, say::ported_note_peck());
            for (from, to, factor) in [(b'I', 'P', 2), (b'K', 'Q', 1)] {
                if let Some(number) = block.number(from) {
                    let step = self.state.length(number) * factor;
                    block.replace(from, &format!("{to}{}", write_whole(step.abs() * 1_000)));
                }
            }
            if let Some(number) = block.number(b'D') {
                let value = self.state.cycle_length(number) * relief;
                block.replace(b'D', &length_word(b'R', value));
            }
        } else {
            for (letter, factor) in [(b'P', 2), (b'Q', 1)] {
                if let Some(number) = block.number(letter) {
                    let step = self.thousandths(number, factor);
                    let text = format!("{}{}", char::from(letter), write_whole(step * 1_000_000));
                    block.replace(letter, &text);
                }
            }
            if let Some(number) = block.number(b'R') {
                block.replace(b'R', &length_word(b'R', self.state.length(number) * relief));
            }
        }
        if self.word_is_step(block) {
            self.note(block.line, "P", say::ported_note_peck_step());
        }
        self.convert_axis(block, 0, false);
        self.convert_axis(block, 1, false);
        Ok(())
    }

    /// Whether the foreign block has a step along X (P or I) that is not 0.
    fn word_is_step(&self, block: &ForeignBlock) -> bool {
        let source = self.parts.iter().find(|part| part.block.line == block.line);
        let word = |letter| source.and_then(|part| part.block.word(letter));
        word(b'P')
            .or(word(b'I'))
            .is_some_and(|it: &ForeignWord| it.number.is_some_and(|number| number.micro != 0))
    }
}
