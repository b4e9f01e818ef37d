//! Combines every code of the GSK980TD with every letter that a word can begin with. The code
//! reads the word, or the control refuses it, or `check` warns that it has no effect. No word
//! is lost without a message. `code-words.tsv` lists what each code reads besides its required
//! words. The table that editors show (`gsk_language::code_forms`) has each of them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use gsk_core::command::ProgramId;
use gsk_core::memory::ToolOffset;
use gsk_core::model::ModelId;
use gsk_core::preview::{CautionKind, preview};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_language::code_forms;
use gsk_tests::repository;

/// Letters, each with a value that most codes accept. F, S and T are modal: they have an
/// effect in every block, and the table omits them. N, O and G name a block or are codes.
const WORDS: [&str; 22] = [
    "A1", "B1", "C1", "D1", "E1", "V1", "Y1", "F50", "H1", "I1", "J1", "K1", "L1", "P10", "Q10",
    "R1", "S600", "T0101", "U-1", "W-1", "X39", "Z-9",
];
const MODAL: [char; 3] = ['F', 'S', 'T'];
/// Lines before the block of the table.
const HEAD: &str = "O0001\nM03 S500\nT0101\nG98 G00 X60 Z10 F100\n";

/// What happened to a word that was added to a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum WordFate {
    Used,
    Refused,
    Warned,
}

/// Codes that need the option 002.1 and a nose radius.
const COMPENSATION: [&str; 2] = ["G41", "G42"];

struct CodeRow {
    code: String,
    lines: Vec<String>,
    reads: BTreeSet<char>,
}

fn read_rows() -> Vec<CodeRow> {
    let text = fs::read_to_string(repository().join("tests/code-words.tsv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('\t').collect();
        let [code, program, reads, manual] = cells[..] else {
            panic!("code-words.tsv: four cells: {line}");
        };
        assert!(!manual.is_empty(), "{line}");
        CodeRow {
            code: code.to_owned(),
            lines: program.split('|').map(str::to_owned).collect(),
            reads: reads
                .split(' ')
                .filter_map(|it| it.chars().next())
                .collect(),
        }
    };
    text.lines().skip(1).map(row).collect()
}

/// Letters of the tested block.
fn own_letters(block: &str) -> BTreeSet<char> {
    block.chars().filter(char::is_ascii_uppercase).collect()
}

/// The fate of a word added to the tested block, or of no word.
fn word_fate(row: &CodeRow, word: &str) -> WordFate {
    let mut text = HEAD.to_owned();
    for line in &row.lines {
        match line.strip_prefix('@') {
            Some(block) => text += &format!("{block} {word}\n"),
            None => text += &format!("{line}\n"),
        }
    }
    text += "M30\n";
    let mut setup = Setup::default();
    if COMPENSATION.contains(&row.code.as_str()) {
        setup.memory.parameters.set_bit(2, 1, true).unwrap();
        let tool = ToolOffset {
            r: 0.4,
            t: 3,
            ..ToolOffset::default()
        };
        setup.memory.offsets.set(1, tool).unwrap();
    }
    let programs = &mut setup.memory.programs;
    programs.store("O0002\nM99\n").unwrap();
    programs.open_external(Program::new(text));
    programs.select(ProgramId::External);
    let seen = preview(&setup, &setup.memory.programs, &mut |_| {});
    if seen.alarm.is_some() {
        return WordFate::Refused;
    }
    // The word itself, or the one of the block that it replaces.
    let is_ignored = |slip: &CautionKind| matches!(slip, CautionKind::IgnoredWord(_));
    if seen
        .cautions
        .iter()
        .any(|caution| is_ignored(&caution.kind))
    {
        WordFate::Warned
    } else {
        WordFate::Used
    }
}

#[test]
fn no_word_is_silently_lost() {
    let mut wrong = Vec::new();
    for row in read_rows() {
        let block = row.lines.iter().find_map(|line| line.strip_prefix('@'));
        let block = block.expect("a block in question");
        if word_fate(&row, "") != WordFate::Used {
            wrong.push(format!("{block}: {:?} by itself", word_fate(&row, "")));
        }
        let own = own_letters(block);
        for word in WORDS {
            let letter = word.chars().next().unwrap();
            if own.contains(&letter) {
                continue;
            }
            let found = word_fate(&row, word);
            let right = match row.reads.contains(&letter) {
                true => found == WordFate::Used,
                false if MODAL.contains(&letter) => found != WordFate::Refused,
                false => found != WordFate::Used,
            };
            // An arithmetic block refuses all words except those of its operation.
            let refused = row.code == "G65" && found == WordFate::Refused;
            if !right && !refused {
                wrong.push(format!("{block} {word}: {found:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_code_has_a_row() {
    let record = ModelId::Gsk980td.record();
    let g = (0..100).filter(|code| record.g_code(*code).is_some());
    let known: BTreeSet<String> = read_rows().into_iter().map(|row| row.code).collect();
    let g = g.map(|code| format!("G{code:02}"));
    let m = record.m.keys().map(|code| format!("M{code:02}"));
    let mut missing = Vec::new();
    for code in g.chain(m).filter(|code| !known.contains(code)) {
        let alone = CodeRow {
            lines: vec![format!("@{code}")],
            code: code.clone(),
            reads: BTreeSet::new(),
        };
        // This lathe has no relays for some M codes: the control refuses them.
        if !code.starts_with('M') || word_fate(&alone, "") != WordFate::Refused {
            missing.push(code);
        }
    }
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn editors_show_the_words_that_the_codes_read() {
    let record = ModelId::Gsk980td.record();
    let mut read: BTreeMap<String, BTreeSet<char>> = BTreeMap::new();
    for row in read_rows()
        .into_iter()
        .filter(|row| row.code.starts_with('G'))
    {
        let block = row.lines.iter().find_map(|line| line.strip_prefix('@'));
        let own = own_letters(block.expect("a block in question"));
        let letters = own.iter().chain(&row.reads).copied();
        read.entry(row.code).or_default().extend(letters);
    }
    let mut wrong = Vec::new();
    for (code, mut read) in read {
        let number: i64 = code[1..].parse().unwrap();
        let forms = code_forms(record.g_code(number).unwrap());
        let shown: BTreeSet<char> = forms
            .iter()
            .copied()
            .flatten()
            .map(|it| it.letter)
            .collect();
        // Beside a code that only sets a mode the motion in force reads the words.
        if matches!(number, 40..=42 | 96..=99) {
            continue;
        }
        // Modal words act beside every code.
        read.retain(|letter| !MODAL.contains(letter) && !matches!(letter, 'G' | 'M'));
        if !read.is_subset(&shown) {
            wrong.push(format!("{code}: read {read:?}, shown {shown:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
