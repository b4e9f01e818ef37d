//! Numbers, calls and variables.

use gsk_messages::say;

use crate::block::{ForeignBlock, ForeignWord, LinePiece};
use crate::dialect::CodeSet;
use crate::number::Number;
use crate::o_words::is_o_keyword;
use crate::porter::{Porter, Refusal};
use crate::program_numbers::{has_m, whole};
use crate::thread_cycles::shown_word;

impl Porter<'_> {
    /// Converts the program number O and the sequence number N of a block. A local subprogram gets
    /// its O word in a line before the block.
    pub fn convert_numbers(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        if let Some(word) = block.word(b'O').cloned() {
            let number = word.number.and_then(Number::whole);
            let Some(here) = number.and_then(|it| self.numbers.program(it)) else {
                return Err(Refusal::new(
                    word.shown(),
                    say::ported_note_program_number(),
                ));
            };
            if number != Some(here) || !word.written.to_ascii_uppercase().starts_with('O') {
                self.note(block.line, word.shown(), say::ported_note_program_number());
                block.replace(b'O', &format!("O{here:04}"));
            }
            self.start_program();
        }
        if let Some(number) = whole(block, b'N') {
            if let Some(program) = self.numbers.locals.get(&number).copied() {
                block.before.push(format!("O{program:04}"));
                self.start_program();
            }
            match self.numbers.sequence(number) {
                Some(here) if here == number => {}
                Some(here) => {
                    block.replace(b'N', &format!("N{here}"));
                }
                None => {
                    block.remove(b"N");
                }
            }
        }
        Ok(())
    }

    fn start_program(&mut self) {
        self.state.machine.has_ended = false;
        for axis in &mut self.state.axes {
            axis.forget();
        }
    }

    /// Converts M98 (subprogram call) with the number of its repetitions.
    pub fn convert_call(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let refuse =
            |block: &ForeignBlock| Refusal::new(shown_word(block, b'P'), say::ported_note_call());
        let number = whole(block, b'P').ok_or_else(|| refuse(block))?;
        let repeats = block.number(b'L').map(Number::whole);
        let splits = repeats.is_none() && number > 9999 && self.state.set != CodeSet::Haas;
        let (count, program) = match splits {
            true => (number / 10_000, number % 10_000),
            false => (repeats.flatten().unwrap_or(1), number),
        };
        let program = self.numbers.program(program).unwrap_or(program);
        if program > 9999 || !(1..=9999).contains(&count) {
            return Err(refuse(block));
        }
        if repeats.is_some() {
            self.note(block.line, shown_word(block, b'L'), say::ported_note_call());
        }
        self.start_feed_before_call(block);
        self.write_call(block, count, program);
        Ok(())
    }

    /// Converts M97: the part of the program that it calls becomes a separate program.
    pub fn convert_local_call(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let number = whole(block, b'P');
        let program = number.and_then(|it| self.numbers.locals.get(&it).copied());
        let count = block.number(b'L').map_or(Some(1), Number::whole);
        let (Some(program), Some(count)) = (program, count) else {
            return Err(Refusal::new(
                shown_word(block, b'P'),
                say::ported_note_local_call(),
            ));
        };
        self.note(block.line, "M97", say::ported_note_local_call());
        block.replace_where(
            |word| word.letter == b'M' && word.number.and_then(Number::whole) == Some(97),
            "M98",
        );
        self.start_feed_before_call(block);
        self.write_call(block, count, program);
        Ok(())
    }

    fn write_call(&mut self, block: &mut ForeignBlock, count: i64, program: i64) {
        let text = match count {
            1 => format!("P{program:04}"),
            _ => format!("P{count}{program:04}"),
        };
        if whole(block, b'P') != text[1..].parse().ok() {
            block.replace(b'P', &text);
        }
        block.remove(b"L");
        for axis in &mut self.state.axes {
            axis.forget();
        }
    }

    /// Notes the end of a program, and converts the target of M99.
    pub fn end_program(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        if has_m(block, 99) {
            self.convert_sequence_words(block, b"P")?;
        }
        self.state.machine.has_ended = true;
        self.state.machine.spindle = None;
        Ok(())
    }

    /// Renumbers the variables of macro A, and refuses formulas.
    pub fn convert_variables(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let is_formula =
            |piece: &LinePiece| matches!(piece, LinePiece::Formula(text) if text.trim() != "*");
        if let Some(formula) = block.pieces.iter().position(is_formula) {
            // The number of an O word belongs to its keyword.
            let is_o =
                |piece: &LinePiece| matches!(piece, LinePiece::Word(word) if word.letter == b'O');
            let at = block.pieces.iter().position(is_o).unwrap_or(formula);
            let at = at.min(formula);
            let text: String = (block.pieces[at..].iter())
                .filter(|piece| !matches!(piece, LinePiece::Text(text) if text.starts_with('(')))
                .map(LinePiece::written)
                .collect();
            let shown: String = text.trim().chars().take(24).collect();
            let is_o_word = block.has(b'O') && is_o_keyword(block.pieces[formula].written());
            let note = match is_o_word {
                true => say::ported_note_o_word_refused(),
                false => say::ported_note_macro(),
            };
            return Err(Refusal::new(shown.to_ascii_uppercase(), note));
        }
        let words: Vec<ForeignWord> = block.words().cloned().collect();
        for word in words.iter().filter(|word| word.number.is_none()) {
            let shown = word.shown();
            let number = shown
                .split_once('#')
                .and_then(|(_, it)| it.parse::<i64>().ok());
            let here = match number {
                Some(number @ 100..=131) => number + 100,
                Some(number @ 500..=515) => number,
                _ => return Err(Refusal::new(shown, say::ported_note_macro())),
            };
            if self.state.set.is_rs274() || self.state.is_inch {
                return Err(Refusal::new(shown, say::ported_note_macro()));
            }
            let text = shown.replace(&format!("#{}", here_source(number)), &format!("#{here}"));
            self.note(block.line, shown, say::ported_note_variables());
            block.replace_where(|it| it == word, &text);
        }
        Ok(())
    }

    /// Checks that this control has the operation of a macro A block (G65 H), and refuses the block
    /// if not.
    pub fn convert_macro(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let operation = whole(block, b'H');
        let is_known =
            |number| matches!(number, 1..=5 | 11..=13 | 21..=27 | 31..=34 | 80..=86 | 99);
        match operation {
            Some(number) if is_known(number) => {
                block.replace(b'H', &format!("H{number:02}"));
                Ok(())
            }
            _ => Err(Refusal::new("G65", say::ported_note_macro())),
        }
    }
}

fn here_source(number: Option<i64>) -> i64 {
    number.unwrap_or_default()
}
