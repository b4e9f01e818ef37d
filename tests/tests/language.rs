//! Checks that an editor's changes to a program do not change its moves, and that any text can
//! be processed.

use std::collections::BTreeSet;
use std::path::Path;

use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::model::ModelId;
use gsk_core::preview::{Preview, PreviewEnd, preview_with_progress};
use gsk_core::program::{Program, split_programs};
use gsk_core::setup::Setup;
use gsk_language::{
    Numbering, Position, ReadingContext, Spacing, Structure, Style, TextChange, TextDocument,
    analyse, complete, definition, folds, format, hover, lenses, references, rename, symbols,
};
use gsk_messages::Language;
use gsk_tests::repository;
use proptest::prelude::*;

/// Number of moves after which a preview is cancelled.
const MAX_MOVES: u64 = 20_000;

/// All part programs of the repository: samples and cases.
fn all_programs() -> Vec<(String, String)> {
    let mut found = Vec::new();
    for folder in ["assets/programs", "tests/cases"] {
        collect(&repository().join(folder), &mut found);
    }
    found.sort();
    assert!(found.len() > 400, "{} programs", found.len());
    found
}

fn collect(folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in std::fs::read_dir(folder).expect("folder") {
        let path = entry.expect("entry").path();
        if path.is_dir() {
            collect(&path, found);
            continue;
        }
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        if (ending == "nc" || ending == "cnc")
            && let Ok(text) = std::fs::read_to_string(&path)
        {
            found.push((path.display().to_string(), text));
        }
    }
}

/// A move without the line and the number of its block.
fn motion_text(executed: &ExecutedMove) -> String {
    let ExecutedMove { source, .. } = executed;
    let mut same = *executed;
    same.source.line = 0;
    same.source.sequence = None;
    format!("{:?} {same:?}", source.program)
}

/// The moves and the end of a text under two sets of options. With `alarms` the number of the
/// alarm counts, otherwise only its presence.
fn run_text(text: &str, alarms: bool) -> Vec<(Vec<String>, String)> {
    let all = [false, true].map(|macro_b| {
        let mut setup = Setup::default();
        setup.memory.settings.macro_b = macro_b;
        let bits = setup.memory.parameters.set_bit(2, 1, true);
        assert!(bits.is_ok());
        let mut parts = split_programs(text).into_iter();
        setup
            .memory
            .programs
            .open_external(parts.next().unwrap_or_else(|| Program::new("")));
        for part in parts {
            let _ = setup.memory.programs.store(part.text());
        }
        setup.memory.programs.select(ProgramId::External);
        let mut moves = Vec::new();
        let programs = &setup.memory.programs;
        let mut take = |executed: &ExecutedMove| moves.push(motion_text(executed));
        let seen = preview_with_progress(&setup, programs, &mut take, &mut |it| {
            it.moves < MAX_MOVES && it.motionless < MAX_MOVES
        });
        (moves, end_text(&seen, alarms))
    });
    all.into()
}

/// The end, the number of its alarm, and the final state.
fn end_text(preview: &Preview, alarms: bool) -> String {
    let alarm = preview
        .alarm
        .as_ref()
        .filter(|_| alarms)
        .map(|alarm| alarm.number);
    // The step at which a watcher cancels depends only on the moves.
    let place = (preview.end != PreviewEnd::Limit).then_some((
        preview.machine,
        preview.time_s,
        preview.parts,
    ));
    format!("{:?} {alarm:?} {place:?} {:?}", preview.end, preview.modal)
}

fn format_program(text: &str, style: Style) -> (String, bool) {
    let mut text = TextDocument::new(text);
    let structure = Structure::read(&text);
    let lines = 0..text.line_count();
    let made = format(&text, &structure, style, lines, (&[], ModelId::Gsk980td));
    text.apply_all(&made.edits);
    (text.as_str().to_owned(), made.refused.is_none())
}

fn styles() -> [Style; 3] {
    let (start, step) = (7, 3);
    [
        Style::default(),
        Style {
            numbering: Numbering::Present { start, step },
            spacing: Spacing::None,
            ..Style::default()
        },
        Style {
            numbering: Numbering::All { start, step },
            ..Style::default()
        },
    ]
}

/// Whether a refused block is refused with the same alarm: an invalid word at the beginning is
/// an invalid word within the block once it has a number.
fn keeps_alarms(style: Style) -> bool {
    !matches!(style.numbering, Numbering::All { .. })
}

#[test]
fn a_program_does_the_same_however_it_is_written() {
    let mut renumbered = 0;
    for (name, text) in all_programs() {
        let before = [false, true].map(|alarms| run_text(&text, alarms));
        for style in styles() {
            let (written, taken) = format_program(&text, style);
            renumbered += usize::from(taken && style.numbering != Numbering::Unchanged);
            if written != text {
                let alarms = keeps_alarms(style);
                let before = &before[usize::from(alarms)];
                assert_eq!(
                    &run_text(&written, alarms),
                    before,
                    "{name} under {style:?}:\n{written}"
                );
            }
            let (again, _) = format_program(&written, style);
            assert_eq!(
                again, written,
                "{name} under {style:?}: not the same a second time"
            );
        }
    }
    assert!(renumbered > 400, "only {renumbered} were numbered anew");
}

#[test]
fn a_program_does_the_same_under_other_numbers() {
    let mut renamed = 0;
    for (name, text) in all_programs() {
        let read = TextDocument::new(text.as_str());
        let structure = Structure::read(&read);
        let mut changed = TextDocument::new(text.as_str());
        // Each number moves to a free one; the structure is read again each time.
        for (index, block) in structure.blocks.iter().take(12).enumerate() {
            let line = block.digits.line;
            let anew = Structure::read(&changed);
            let Some(block) = anew.blocks.iter().find(|it| it.digits.line == line) else {
                continue;
            };
            let at = Position {
                line,
                byte: block.digits.from,
            };
            let to = format!("N{}", 9000 + index);
            let site: (&[u16], ModelId) = (&[], ModelId::Gsk980td);
            if let Ok(edits) = rename(&changed, &anew, at, &to, site) {
                changed.apply_all(&edits);
                renamed += 1;
            }
        }
        if changed.as_str() != text {
            // P of M99 names a block of the calling program. A caller in another file is
            // missing here.
            assert_eq!(
                run_text(changed.as_str(), true),
                run_text(&text, true),
                "{name}:\n{}",
                changed.as_str()
            );
        }
    }
    assert!(renamed > 300, "only {renamed} numbers");
}

/// Words that look like a program, and words that break one.
fn any_word() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => "[GMTSNXZUWRIKFPQLOH][0-9]{1,4}",
        3 => "[xzuwXZ] ?-? ?[0-9]{1,3}\\.[0-9]{0,3}",
        2 => "G(65 H8[0-6]|7[0-3]|98|99) P[0-9]{1,2} Q[0-9]{1,2}",
        2 => "(M98 P[0-9]{1,8}|M99 P[0-9]{1,2}|GOTO ?[0-9]{1,2}|IF \\[#1 GT 2\\] GOTO 1)",
        1 => "(WHILE \\[#1 LT 3\\] DO 1|END 1|#1=#1\\+1|X\\[#1\\*2\\])",
        1 => "[;%/()*#.+\\-\\[\\]]",
        1 => "\\PC{1,3}",
        1 => "[\u{FF01}-\u{FF5E}]{1,2}",
    ]
}

fn any_text() -> impl Strategy<Value = String> {
    let line = proptest::collection::vec(any_word(), 0..6).prop_map(|words| words.join(" "));
    let end = prop_oneof![Just("\n"), Just("\r\n"), Just("\r"), Just(";\n")];
    let lines = proptest::collection::vec((line, end), 0..12);
    lines.prop_map(|lines| lines.into_iter().map(|(line, end)| line + end).collect())
}

/// Whether an edit is within a text, from its beginning to its end.
fn is_within(text: &TextDocument, edit: &TextChange) -> bool {
    let in_line = |at: Position| {
        let line = text.line(at.line);
        at.line < text.line_count() && line.is_char_boundary(at.byte as usize)
    };
    in_line(edit.from) && in_line(edit.to) && edit.from <= edit.to
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_can_be_queried(
        text in any_text(), line in 0..14_u32, byte in 0..30_u32, macro_b: bool, model in 0..4_usize,
    ) {
        let read = TextDocument::new(text);
        let structure = Structure::read(&read);
        let at = Position { line, byte };
        for language in [Language::Zh, Language::En] {
            let reader = ReadingContext { model: ModelId::ALL[model], macro_b, language };
            hover(&read, &structure, at, reader, &|_| Some("(`````)".to_owned()));
            for item in complete(&read, &structure, at, reader, &BTreeSet::from([1])) {
                prop_assert!(item.range.from <= item.range.to);
            }
        }
        for place in definition(&structure, at).blocks {
            prop_assert!(is_within(&read, &TextChange::replace(&place, "")));
        }
        references(&structure, at, true);
        symbols(&read, &structure, ModelId::ALL[model]);
        for (from, to) in folds(&read, &structure) {
            prop_assert!(from < to && to < read.line_count());
        }
        let site: (&[u16], ModelId) = (&[], ModelId::ALL[model]);
        for edit in rename(&read, &structure, at, "N7", site).unwrap_or_default() {
            prop_assert!(is_within(&read, &edit));
        }
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(read.as_str()));
        setup.memory.programs.select(ProgramId::External);
        let seen = analyse(&setup, Language::En, &mut |it| {
            it.moves < 1000 && it.motionless < 1000
        });
        for finding in &seen.findings {
            let Some(at) = &finding.at else { continue };
            let line = read.line(at.line.saturating_sub(1));
            prop_assert!(line.get(at.bytes.clone()).is_some(), "{finding:?} in {line:?}");
        }
        lenses(&structure, &seen, Language::Zh);
    }

    #[test]
    fn any_text_does_the_same_however_it_is_written(text in any_text()) {
        for style in styles() {
            let (written, _) = format_program(&text, style);
            let alarms = keeps_alarms(style);
            prop_assert_eq!(run_text(&written, alarms), run_text(&text, alarms), "under {:?}: {:?}", style, written);
        }
    }
}
