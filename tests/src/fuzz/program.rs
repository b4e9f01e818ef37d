//! Fuzzes the program parser with any text: index, words, search.

use gsk_core::model::ModelId;
use gsk_core::program::{Program, Syntax, append_points, split_programs};

use super::watch;

pub(super) fn fuzz_program(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let program = watch::run_unit(|| Program::new(text.as_ref()));
    assert_eq!(program.text(), text);
    assert_eq!(program.characters(), text.chars().count());
    let mut line_before = 0;
    for index in 0..program.block_count() {
        let line = program.block_line(index);
        assert!(line >= line_before, "blocks come in the order of lines");
        assert!(line <= program.line_count().max(1));
        line_before = line;
        assert!(program.block_from_line(line) <= index);
        for syntax in syntaxes() {
            watch::run_unit(|| parse(&program, index, syntax));
        }
        if let Some(number) = program.sequence(index) {
            assert!(program.find_sequence(number, 1).is_some());
        }
        let _ = program.has_skip_mark(index);
    }
    for line in 0..=program.line_count() + 1 {
        let _ = program.line(line);
    }
    let renumbered = watch::run_unit(|| program.renumbered(1234));
    if program.number().is_some() {
        assert_eq!(renumbered.number(), Some(1234));
    }
    let pointed = watch::run_unit(|| append_points(&text));
    assert_eq!(pointed.lines().count(), text.lines().count());
    let parts = watch::run_unit(|| split_programs(&*text));
    watch::record_event("parts", parts.len());
}

fn syntaxes() -> impl Iterator<Item = Syntax> {
    (0..32).map(|bits| Syntax {
        point_required: bits & 1 != 0,
        inch: bits & 2 != 0,
        macro_b: bits & 4 != 0,
        fine: bits & 16 != 0,
        model: match bits & 8 {
            0 => ModelId::Gsk980td,
            _ => ModelId::Ncb08,
        },
    })
}

fn parse(program: &Program, index: u32, syntax: Syntax) {
    match program.parse(index, syntax) {
        Ok(block) => {
            let addresses: Vec<u8> = block.words().iter().map(|word| word.address).collect();
            watch::record_event("block", addresses.len());
            for code in block.g_codes() {
                watch::record_event("code", code);
            }
            for address in addresses {
                watch::record_event("address", address);
                let finite = block.number(address).is_none_or(|n| n.value().is_finite());
                assert!(finite, "a value of {}", char::from(address));
            }
        }
        Err(error) => {
            watch::record_event(
                "error",
                (error.alarm, watch::message_rule(&error.detail.to_string())),
            );
            // Columns count from the beginning of the line, which may hold several blocks.
            let length = program.line(program.block_line(index)).chars().count();
            assert!(
                error.column >= 1 && error.column as usize <= length + 1,
                "column {} of {length}",
                error.column
            );
        }
    }
    let _ = program.parse_with_variables(index, syntax);
}
