//! Finds blocks that no other block leads to: those after the end of a program that no jump,
//! call or cycle names.

use super::PreviewRun;
use super::caution::CautionKind;
use super::line_words::{WrittenWord, numbers_of, split_line};
use crate::command::{ProgramId, SourcePosition};
use crate::program::Program;

impl PreviewRun<'_> {
    /// Adds a caution about the first block of a program that no other block leads to.
    pub(super) fn check_reach(&mut self, program: ProgramId) {
        let Some(text) = self.programs.get(program) else {
            return;
        };
        if let Some(line) = find_unreachable_line(text) {
            let source = SourcePosition {
                program,
                line,
                sequence: None,
            };
            self.add_caution(CautionKind::UnreachableBlock, source);
        }
    }
}

/// Whether a block always ends its program: M02, M30, or M99 without the number of a block.
fn ends_program(words: &[WrittenWord]) -> bool {
    let m_codes = numbers_of(words, b'M');
    let is_plain = !words
        .iter()
        .any(|(letter, _)| matches!(letter, b'I' | b'P' | b'G'));
    is_plain && m_codes.flatten().any(|code| matches!(code, 2 | 30 | 99))
}

/// The text of a block without comments in the lines after it.
fn block_text(program: &Program, index: u32) -> &str {
    program.block(index).lines().next().unwrap_or_default()
}

/// The numbers that a program may continue at; `None` if it computes one of them.
fn named_numbers(program: &Program) -> Option<Vec<u32>> {
    let mut numbers = Vec::new();
    for index in 0..program.block_count() {
        let block = block_text(program, index);
        if let Some((_, target)) = block.to_ascii_uppercase().split_once("GOTO") {
            numbers.push(
                target
                    .trim()
                    .trim_end_matches(';')
                    .trim_end()
                    .parse()
                    .ok()?,
            );
        } else if !block.trim_start().starts_with('#') {
            let words = split_line(block);
            // An N elsewhere than at the beginning names a block on some models.
            let named = words.iter().enumerate().filter(|(at, (letter, _))| {
                matches!(letter, b'P' | b'Q') || *letter == b'N' && *at > 0
            });
            for (_, (_, number)) in named {
                numbers.push((*number)?);
            }
        }
    }
    Some(numbers)
}

/// The line of the first block that no other block leads to, from 1; `None` if there is none,
/// or if the program computes where it continues.
fn find_unreachable_line(program: &Program) -> Option<u32> {
    let count = program.block_count();
    let is_end = |index: &u32| {
        let block = block_text(program, *index);
        block.contains(['M', 'm'])
            && !program.has_skip_mark(*index)
            && ends_program(&split_line(block))
    };
    let end = (0..count).find(is_end)?;
    let is_written = |index: &u32| !split_line(block_text(program, *index)).is_empty();
    (end + 1..count).find(is_written)?;
    let targets = named_numbers(program)?;
    let mut is_reached = false;
    for index in end + 1..count {
        let words = split_line(block_text(program, index));
        let is_named = (program.sequence(index)).is_some_and(|it| targets.contains(&it));
        // Another program of the same text begins with its name.
        is_reached |= is_named || matches!(words.first(), Some((b'O', Some(_))));
        if !is_reached && !words.is_empty() {
            return Some(program.block_line(index));
        }
        if is_reached && is_end(&index) {
            is_reached = false;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_after_the_end_need_a_jump_to_them() {
        let cases = [
            ("O1\nG00 X1\nM30\n", None),
            ("O1\nG00 X1\nM30\n%\n", None),
            ("O1\nG00 X1\nM30\nG01 Z5\n", Some(4)),
            ("O1\nM30\n(notes)\n\nG00 X2\nM30\n", Some(5)),
            ("O1\n/M30\nG00 X2\nM30\n", None),
            ("O1\nM98 P2\nM30\nO2\nG00 X1\nM99\n", None),
            ("O1\nM98 P2\nM30\nO2\nG00 X1\nM99\nG00 X3\n", Some(7)),
            ("O1\nG70 P10 Q20\nM30\nN10 G00 X1\nN20 G01 Z-5\n", None),
            ("O1\nG65 H81 P30 Q#200 R5\nM30\nN30 G00 X1\nM30\n", None),
            ("O1\nIF [#1 EQ 2] GOTO 30\nM30\nN30 G00 X1\nM30\n", None),
            ("O1\nIF [#1 EQ 2] GOTO #3\nM30\nN30 G00 X1\nM30\n", None),
            ("O1\nGOTO 30\nM30\nN30 G00 X1\nM30\n", None),
            ("O1\nM99 P5\nG00 X1\nN5 M30\n", None),
            ("O1\nN5 G00 X1\nM99\nM30\n", Some(4)),
        ];
        for (text, line) in cases {
            assert_eq!(find_unreachable_line(&Program::new(text)), line, "{text}");
        }
    }
}
