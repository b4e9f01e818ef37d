//! Every code of the GSK980TD with every letter that a word can begin with: the code reads
//! the word, or the control refuses it, or `check` warns that it has no effect. No word is
//! silently lost. `code-words.tsv` lists what each code reads beside the words it needs.

use std::collections::BTreeSet;
use std::fs;

use gsk_core::command::ProgramId;
use gsk_core::model::ModelId;
use gsk_core::preview::{Slip, preview};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_tests::repository;

/// Letters and a value that most codes take. F, S and T are modal: they have an effect in
/// every block, and the table leaves them out.
const WORDS: [&str; 15] = [
    "F50", "H1", "I1", "J1", "K1", "L1", "P10", "Q10", "R1", "S600", "T0101", "U-1", "W-1", "X39",
    "Z-9",
];
const MODAL: [char; 3] = ['F', 'S', 'T'];
/// Lines before the block of the table.
const HEAD: &str = "O0001\nM03 S500\nT0101\nG98 G00 X60 Z10 F100\n";

/// What happened to a word that was added to a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Used,
    Refused,
    Warned,
}

struct Row {
    code: String,
    lines: Vec<String>,
    reads: BTreeSet<char>,
}

fn rows() -> Vec<Row> {
    let text = fs::read_to_string(repository().join("tests/code-words.tsv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('\t').collect();
        let [code, program, reads, manual] = cells[..] else {
            panic!("code-words.tsv: four cells: {line}");
        };
        assert!(!manual.is_empty(), "{line}");
        Row {
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

/// Letters of the block in question.
fn own_letters(block: &str) -> BTreeSet<char> {
    block.chars().filter(char::is_ascii_uppercase).collect()
}

/// The fate of a word added to the block in question; without a word, of none.
fn fate(row: &Row, word: &str) -> Fate {
    let mut text = HEAD.to_owned();
    for line in &row.lines {
        match line.strip_prefix('@') {
            Some(block) => text += &format!("{block} {word}\n"),
            None => text += &format!("{line}\n"),
        }
    }
    text += "M30\n";
    let mut setup = Setup::default();
    let programs = &mut setup.memory.programs;
    programs.store("O0002\nM99\n").unwrap();
    programs.open_external(Program::new(text));
    programs.select(ProgramId::External);
    let seen = preview(&setup, &setup.memory.programs, &mut |_| {});
    if seen.alarm.is_some() {
        return Fate::Refused;
    }
    // The word itself, or one of the block whose place it takes.
    let is_ignored = |slip: &Slip| matches!(slip, Slip::IgnoredWord(_));
    if seen
        .cautions
        .iter()
        .any(|caution| is_ignored(&caution.slip))
    {
        Fate::Warned
    } else {
        Fate::Used
    }
}

#[test]
fn no_word_is_silently_lost() {
    let mut wrong = Vec::new();
    for row in rows() {
        let block = row.lines.iter().find_map(|line| line.strip_prefix('@'));
        let block = block.expect("a block in question");
        if fate(&row, "") != Fate::Used {
            wrong.push(format!("{block}: {:?} by itself", fate(&row, "")));
        }
        let own = own_letters(block);
        for word in WORDS {
            let letter = word.chars().next().unwrap();
            if own.contains(&letter) {
                continue;
            }
            let found = fate(&row, word);
            let right = match row.reads.contains(&letter) {
                true => found == Fate::Used,
                false if MODAL.contains(&letter) => found != Fate::Refused,
                false => found != Fate::Used,
            };
            // An arithmetic block refuses all words but those of its operation.
            let refused = row.code == "G65" && found == Fate::Refused;
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
    let known: BTreeSet<String> = rows().into_iter().map(|row| row.code).collect();
    // Nose radius compensation needs the option 002.1 and a contour behind it.
    let elsewhere = ["G41", "G42"];
    let missing: Vec<String> = g
        .map(|code| format!("G{code:02}"))
        .filter(|code| !known.contains(code) && !elsewhere.contains(&code.as_str()))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}
