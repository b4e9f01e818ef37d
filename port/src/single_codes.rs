//! Codes of group 00 that are no cycles, coordinate systems and nose radius compensation.

use gsk_messages::say;

use crate::block::ForeignBlock;
use crate::motion::length_word;
use crate::number::{round_to, write_number};
use crate::porter::{Porter, Refusal};
use crate::program_numbers::whole;
use crate::thread_cycles::shown_word;

impl Porter<'_> {
    /// Converts a dwell G04: on this control P is in milliseconds, X and U are in seconds.
    pub fn convert_dwell(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let is_rs274 = self.state.set.is_rs274();
        for letter in [b'P', b'X', b'U'] {
            let Some(number) = block.number(letter) else {
                continue;
            };
            let is_whole_ms = letter == b'P' && !number.has_point && !is_rs274;
            if is_whole_ms {
                continue;
            }
            let in_increments = !is_rs274 && !number.has_point && self.state.changes_length(number);
            let seconds = if in_increments && self.state.plain == crate::PlainNumbers::Increments {
                number.micro / 1_000
            } else {
                number.micro
            };
            let here = if letter == b'P' {
                'X'
            } else {
                char::from(letter)
            };
            if here != char::from(letter) || seconds != number.micro {
                if letter == b'P' {
                    self.note(
                        block.line,
                        shown_word(block, b'P'),
                        say::ported_note_dwell(),
                    );
                }
                block.replace(letter, &format!("{here}{}", write_number(seconds, 3)));
            }
        }
        Ok(())
    }

    /// Converts G28 (return to the reference point). Without axis words it moves both axes on some
    /// controls.
    pub fn convert_home(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let set = self.state.set;
        let is_bare = !block.has_any(b"XUZW");
        if is_bare && (set.is_rs274() || set == crate::CodeSet::Haas) {
            block.append("U0 W0");
            self.note(block.line, "G28", say::ported_note_home());
        }
        for (axis, letters) in [(0, b"XU"), (1, b"ZW")] {
            if block.has_any(letters) || is_bare {
                self.convert_axis(block, axis, false);
                self.state.axes[axis].forget();
            }
        }
        Ok(())
    }

    /// Converts G30 (return to a further reference point): this control has only the first one.
    pub fn convert_second_home(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        self.note(block.line, "G30", say::ported_note_second_home());
        block.replace_g(300, "G28");
        block.remove(b"P");
        if !block.has_any(b"XUZW") {
            block.append("U0 W0");
        }
        self.convert_home(block)
    }

    /// Converts G53 to the reference point; this control has no other machine coordinates.
    pub fn convert_machine_coordinates(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        for (axis, position, distance) in [(0, b'X', b'U'), (1, b'Z', b'W')] {
            let Some(number) = block.number(position) else {
                continue;
            };
            if number.micro != 0 {
                let word = format!("G53 {}", shown_word(block, position));
                return Err(Refusal::new(word, say::ported_note_machine_coordinates()));
            }
            block.replace(position, &format!("{}0", char::from(distance)));
            self.state.axes[axis].forget();
        }
        self.note(block.line, "G53", say::ported_note_machine_coordinates());
        block.replace_g(530, "G28");
        Ok(())
    }

    /// Removes the selection of a coordinate system, if the program uses one only.
    pub fn select_work_offset(
        &mut self,
        block: &mut ForeignBlock,
        code: i64,
    ) -> Result<(), Refusal> {
        let number = match code {
            541 | 1540 => whole(block, b'P').unwrap_or(0),
            _ => 0,
        };
        let selected = code * 1_000 + number;
        let first = *self.state.machine.work_offset.get_or_insert(selected);
        if first != selected {
            let word = format!("G{}", write_number(code * 100_000, 1).trim_end_matches('.'));
            return Err(Refusal::new(word, say::ported_note_work_offset()));
        }
        block.remove_g(&[code]);
        if matches!(code, 541 | 1540) {
            block.remove(b"P");
        }
        Ok(())
    }

    /// Converts G50 and G92 of other sets: coordinates, or the maximum speed.
    pub fn convert_coordinates(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        if !block.has_any(b"XUZWS") {
            block.remove_g(&[500, 920]);
            return Ok(());
        }
        block.replace_g(920, "G50");
        for (axis, position, distance) in [(0, b'X', b'U'), (1, b'Z', b'W')] {
            if let Some(number) = block.number(position) {
                let value = self.axis_value(number, axis);
                let written = self.state.axes[axis].move_to(value);
                if written != number.micro || self.state.changes_length(number) {
                    block.replace(position, &length_word(position, written));
                }
            } else if let Some(number) = block.number(distance) {
                let value = round_to(self.axis_value(number, axis), 3);
                if value != number.micro || self.state.changes_length(number) {
                    block.replace(distance, &length_word(distance, value));
                }
                self.state.axes[axis].forget();
            }
        }
        Ok(())
    }

    /// Removes D of G41 and G42: on this control the nose radius belongs to the offset of T. Inside
    /// a roughing profile also the code is removed, because it is not permitted there.
    pub fn convert_compensation(&mut self, block: &mut ForeignBlock, code: i64) {
        block.remove(b"D");
        if self.is_inside_profile() {
            block.remove_g(&[code]);
            let word = format!("G{}", code / 10);
            self.note(block.line, word, say::ported_note_profile_words());
        }
    }
}
