//! M codes, tools and spindle speeds.

use gsk_messages::say;

use crate::block::{ForeignBlock, ForeignWord, LinePiece};
use crate::number::{divide_rounded, write_whole};
use crate::porter::{Porter, Refusal, row_note};
use crate::program_numbers::whole;
use crate::table::{CodeRule, ForeignCodeRow, find_row};
use crate::thread_cycles::shown_word;

/// Greatest tool number and greatest offset number of this control.
const MAX_TOOL: i64 = 32;

/// Whether a word is the M code `code`, in tenths: M03 is 30.
fn is_m(word: &ForeignWord, code: i64) -> bool {
    word.letter == b'M' && word.number.is_some_and(|it| it.micro / 100_000 == code)
}

impl Porter<'_> {
    /// Converts the M codes of a block; this control permits one M code in a block.
    pub fn convert_m_codes(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let codes: Vec<i64> = (block.words().filter(|word| word.letter == b'M'))
            .filter_map(|word| Some(word.number?.micro / 100_000))
            .collect();
        let inside = self.is_inside_profile();
        for code in &codes {
            let word = format!("M{:02}", code / 10);
            let Some(row) = find_row(b'M', *code, self.state.set) else {
                return Err(Refusal::new(word, say::ported_note_unknown_m()));
            };
            if inside && !matches!(row.rule, CodeRule::Refuse) {
                block.remove_where(|it| is_m(it, *code));
                self.note(block.line, word, say::ported_note_profile_words());
                continue;
            }
            self.convert_m_code(block, *code, row, &word)?;
        }
        self.split_m_codes(block);
        Ok(())
    }

    fn convert_m_code(
        &mut self,
        block: &mut ForeignBlock,
        code: i64,
        row: &ForeignCodeRow,
        word: &str,
    ) -> Result<(), Refusal> {
        match row.rule {
            CodeRule::Rename => {
                block.replace_where(|it| is_m(it, code), row.becomes);
                if row.note.is_some() {
                    self.note(block.line, word, row_note(row));
                }
                if matches!(code, 20 | 170) {
                    self.end_program(block)?;
                }
            }
            CodeRule::Remove | CodeRule::RemoveNoted => {
                block.remove_where(|it| is_m(it, code));
                if row.rule == CodeRule::RemoveNoted {
                    self.note(block.line, word, row_note(row));
                }
            }
            CodeRule::OptionalStop => self.convert_optional_stop(block, row),
            CodeRule::ToolChange => {
                block.remove_where(|it| is_m(it, code));
                if !block.has(b'T')
                    && let Some(tool) = self.state.machine.pending_tool.take()
                {
                    block.append(&format!("T{tool:02}{tool:02}"));
                }
            }
            CodeRule::Call => self.convert_call(block)?,
            CodeRule::LocalCall => self.convert_local_call(block)?,
            CodeRule::RunOut | CodeRule::NoRunOut => {
                let machine = &mut self.state.machine;
                machine.run_out = Some(row.rule == CodeRule::RunOut);
                machine.wrote_run_out = false;
                block.remove_where(|it| is_m(it, code));
                self.note(block.line, word, row_note(row));
            }
            CodeRule::Refuse => return Err(Refusal::new(word, row_note(row))),
            _ => match code {
                30 | 40 => self.convert_spindle(block, code),
                50 => self.state.machine.spindle = None,
                300 | 990 => self.end_program(block)?,
                _ => {}
            },
        }
        Ok(())
    }

    /// Writes M05 before the block if `code` reverses the turning spindle: this control needs the
    /// stop.
    fn convert_spindle(&mut self, block: &mut ForeignBlock, code: i64) {
        let direction = self.state.machine.spindle.replace(code);
        if direction.is_some_and(|it| it != code) {
            block.before.push("M05".to_owned());
            self.note(
                block.line,
                format!("M{:02}", code / 10),
                say::ported_note_reverse(),
            );
        }
    }

    /// Writes M01 as a skipped M00: the block skip switch becomes the optional stop switch.
    fn convert_optional_stop(&mut self, block: &mut ForeignBlock, row: &ForeignCodeRow) {
        self.note(block.line, "M01", row_note(row));
        let is_alone = block
            .words()
            .all(|word| is_m(word, 10) || word.letter == b'N');
        let is_skipped = block.text().trim_start().starts_with('/');
        if !is_alone {
            block.remove_where(|word| is_m(word, 10));
            block.after.push("/M00".to_owned());
            return;
        }
        block.replace_where(|word| is_m(word, 10), "M00");
        if !is_skipped {
            block.pieces.insert(0, LinePiece::Text("/".to_owned()));
        }
    }

    /// Moves all M codes but one into separate lines.
    fn split_m_codes(&mut self, block: &mut ForeignBlock) {
        let is_code = |text: &str| text.starts_with('M') && text.len() > 1;
        let mut codes: Vec<(usize, String)> = Vec::new();
        for (at, piece) in block.pieces.iter().enumerate() {
            let text = match piece {
                LinePiece::Word(word) if word.letter == b'M' => word.shown(),
                LinePiece::Text(text) if is_code(text) => text.clone(),
                _ => continue,
            };
            codes.push((at, text));
        }
        if codes.len() < 2 {
            return;
        }
        let main = codes.iter().position(|(_, text)| {
            matches!(text.trim_start_matches(['M', '0']), "" | "30" | "98" | "99")
        });
        let main = main.unwrap_or(0);
        let line = block.line;
        for (index, (at, text)) in codes.iter().enumerate().rev() {
            if index == main {
                continue;
            }
            let is_start = matches!(text.trim_start_matches(['M', '0']), "3" | "4" | "8");
            match is_start || main > 0 || index < main {
                true => block.before.push(text.clone()),
                false => block.after.push(text.clone()),
            }
            block.pieces[*at] = LinePiece::Text(String::new());
        }
        block.drop_double_blanks();
        self.note(line, codes[main].1.clone(), say::ported_note_one_m());
    }

    /// Converts a T word to the tool and offset of this control, two digits each.
    pub fn convert_tool(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        if self.is_thread_taper(block) {
            return Ok(());
        }
        let Some(word) = block.word(b'T').cloned() else {
            return Ok(());
        };
        if self.is_inside_profile() {
            block.remove(b"T");
            self.note(block.line, word.shown(), say::ported_note_profile_words());
            return Ok(());
        }
        let refuse = || Refusal::new(word.shown(), say::ported_note_tool());
        let Some(number) = word.number else {
            return Ok(());
        };
        let number = number.whole().ok_or_else(refuse)?;
        let digits = word.shown().len() - 1;
        let (tool, offset) = match number {
            0 => (0, 0),
            _ if digits <= 2 => (number, number),
            _ => (number / 100, number % 100),
        };
        if tool > MAX_TOOL || offset > MAX_TOOL {
            return Err(refuse());
        }
        if digits <= 2 && number > 0 {
            let in_block = self.parts.iter().any(|part| {
                part.block.line == block.line && crate::program_numbers::has_m(&part.block, 6)
            });
            if self.numbers.has_tool_change && !in_block {
                self.state.machine.pending_tool = Some(number);
                block.remove(b"T");
                return Ok(());
            }
            if !self.state.set.is_rs274() && !in_block {
                return Err(refuse());
            }
            self.note(block.line, word.shown(), say::ported_note_tool());
        }
        let text = format!("T{tool:02}{offset:02}");
        if word.shown() != text && number > 0 {
            block.replace(b'T', &text);
        }
        Ok(())
    }

    /// Converts S, and D of G96: to whole r/min, or m/min.
    pub fn convert_speed(
        &mut self,
        block: &mut ForeignBlock,
        main: Option<&ForeignCodeRow>,
    ) -> Result<(), Refusal> {
        let is_limit = main.is_some_and(|row| row.rule == CodeRule::SetCoordinates);
        if block.has_g(960) && self.state.set.is_rs274() {
            if let Some(limit) = whole(block, b'D') {
                block.before.push(format!("G50 S{limit}"));
                self.note(
                    block.line,
                    shown_word(block, b'D'),
                    say::ported_note_surface_speed(),
                );
            }
            block.remove(b"D");
        }
        let Some(number) = block.number(b'S') else {
            return Ok(());
        };
        if self.is_inside_profile() {
            let word = shown_word(block, b'S');
            block.remove(b"S");
            block.remove_g(&[960, 970]);
            self.note(block.line, word, say::ported_note_profile_words());
            return Ok(());
        }
        let is_surface = self.state.has_surface_speed && !is_limit;
        let speed = match is_surface && self.state.is_inch {
            true => divide_rounded(number.micro * 3_048, 10_000),
            false => number.micro,
        };
        if !(0..=9_999_500_000).contains(&speed) {
            return Err(Refusal::new(
                shown_word(block, b'S'),
                say::ported_note_speed(),
            ));
        }
        if speed != number.micro || number.has_point {
            if speed != number.micro {
                self.note(
                    block.line,
                    shown_word(block, b'S'),
                    say::ported_note_surface_speed(),
                );
            }
            block.replace(b'S', &format!("S{}", write_whole(speed)));
        }
        Ok(())
    }
}
