//! Finds blocks that no other block leads to: those after the end of a program that no jump,
//! call or cycle names.

use super::caution::CautionKind;
use super::line_words::{WrittenWord, numbers_of, split_line};
use super::{PreviewEnd, PreviewRun};
use crate::command::{ProgramId, SourcePosition};
use crate::program::Program;

impl PreviewRun<'_> {
    /// Adds a caution about the first block after the executed end of the main program that no
    /// other block leads to. `main` is the program that the run began with.
    pub(super) fn check_reach(&mut self, main: ProgramId) {
        let is_end = matches!(
            self.preview.end,
            PreviewEnd::M30 | PreviewEnd::M02 | PreviewEnd::M99
        );
        let end = self.source.filter(|end| is_end && end.program == main);
        let (Some(end), Some(text)) = (end, self.programs.get(main)) else {
            return;
        };
        if let Some(line) = find_unreachable_line(text, end.line) {
            let source = SourcePosition {
                program: main,
                line,
                sequence: None,
            };
            self.add_caution(CautionKind::UnreachableBlock, source);
        }
    }
}

/// Whether a block begins a subprogram in the text of its main program: G22 N of the Huaxing
/// lathes, which no other model has.
fn begins_subprogram(words: &[WrittenWord]) -> bool {
    numbers_of(words, b'G').any(|code| code == Some(22))
}

/// Whether a block always ends its program: M02, M30, M99 without the number of a block, or G24
/// after G22.
fn ends_program(words: &[WrittenWord]) -> bool {
    if numbers_of(words, b'G').any(|code| code == Some(24)) {
        return true;
    }
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
            if begins_subprogram(&words) {
                continue;
            }
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

/// The first line after the end of a program in line `end`, both from 1, with a block that no
/// other block leads to; `None` if there is none, or if the program computes where it continues.
fn find_unreachable_line(program: &Program, end: u32) -> Option<u32> {
    let rest = program.block_from_line(end + 1)..program.block_count();
    // Nearly every program returns here, before its whole text is read. Block skip passes an
    // end with `/`.
    let mut last_line = program.block_from_line(end)..rest.start;
    if rest.is_empty() || last_line.any(|index| program.has_skip_mark(index)) {
        return None;
    }
    let targets = named_numbers(program)?;
    let mut is_reached = false;
    for index in rest {
        let words = split_line(block_text(program, index));
        let is_named = (program.sequence(index)).is_some_and(|it| targets.contains(&it));
        let is_called = begins_subprogram(&words)
            && numbers_of(&words, b'N').any(|it| it.is_some_and(|it| targets.contains(&it)));
        // Another program of the same text begins with its name.
        let is_program = matches!(words.first(), Some((b'O', Some(_))));
        is_reached |= is_named || is_called || is_program;
        if !is_reached && !words.is_empty() {
            return Some(program.block_line(index));
        }
        is_reached &= program.has_skip_mark(index) || !ends_program(&words);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::preview;
    use crate::setup::Setup;

    #[test]
    fn blocks_after_the_end_need_a_jump_to_them() {
        // Program, line of its end, line of the caution.
        let cases = [
            ("O1\nG00 X1\nM30\n", 3, None),
            ("O1\nG00 X1\nM30\n%\n", 3, None),
            ("O1\nG00 X1\nM30\nG01 Z5\n", 3, Some(4)),
            ("O1\nM30\n(notes)\n\nG00 X2\nM30\n", 2, Some(5)),
            ("O1\nM98 P2\nM30\nO2\nG00 X1\nM99\n", 3, None),
            ("O1\nM98 P2\nM30\nO2\nG00 X1\nM99\nG00 X3\n", 3, Some(7)),
            ("O1\nM98 P2\nM30\nO2\n/M99\nG00 X1\nM99\n", 3, None),
            ("O1\nG70 P10 Q20\nM30\nN10 G00 X1\nN20 G01 Z-5\n", 3, None),
            ("O1\nG65 H81 P30 Q#200 R5\nM30\nN30 G00 X1\nM30\n", 3, None),
            ("O1\nIF [#1 EQ 2] GOTO 30\nM30\nN30 G00 X1\nM30\n", 3, None),
            ("O1\nIF [#1 EQ 2] GOTO #3\nM30\nN30 G00 X1\nM30\n", 3, None),
            (
                "O1\nIF [#1 EQ 2] GOTO 30\nM30\nN40 G00 X1\nM30\n",
                3,
                Some(4),
            ),
            ("O1\nN5 G00 X1\nM99\nM30\n", 3, Some(4)),
            ("G20 N05 L3\nM02\nN160 G22 N05\nN170 G00 X1\nG24\n", 2, None),
            ("G20 N05\nM02\nG22 N05\nG24\nG22 N06\nN9 G24\n", 2, Some(5)),
            ("G20 N05\nM02\nG22 N05\nG24\nN6 G00 X1\nG24\n", 2, Some(5)),
        ];
        for (text, end, line) in cases {
            let program = Program::new(text);
            assert_eq!(find_unreachable_line(&program, end), line, "{text}");
        }
    }

    #[test]
    fn the_executed_end_counts() {
        let caution_lines = |text: &str| -> Vec<u32> {
            let mut setup = Setup::default();
            setup.memory.programs.open_external(Program::new(text));
            setup.memory.programs.select(ProgramId::External);
            let preview = preview(&setup, &setup.memory.programs, &mut |_| {});
            let lines = preview.cautions.iter().map(|it| it.source.line);
            lines.collect()
        };
        assert_eq!(caution_lines("O1\nG00 X1\nM30\nG00 X2\n"), [4]);
        assert!(caution_lines("O1\n/M30\nG00 X2\nM30\n").is_empty());
        assert!(caution_lines("O1\nG00 X1\nN5 M30\n").is_empty());
    }
}
