//! Programs of other controls: every file of `tests/port/` has the outcome that stands beside
//! it, the ported text passes the check, and the manual pages show the table of codes.

use std::path::{Path, PathBuf};

use gsk_core::command::ProgramId;
use gsk_core::preview::{PreviewProgress, preview_beyond_alarms};
use gsk_core::program;
use gsk_core::setup::Setup;
use gsk_messages::Language;
use gsk_port::{ForeignDialect, PortOptions, PortedProgram, code_table, port_program};
use gsk_tests::repository;

/// Programs that shall be ported without an edit.
const LEAST_PORTED: usize = 35;

/// The foreign programs with their dialects, in a fixed order.
fn foreign_programs() -> Vec<(ForeignDialect, PathBuf)> {
    let mut all = Vec::new();
    for dialect in ForeignDialect::ALL {
        let folder = repository().join("tests/port").join(dialect.command_word());
        let files = std::fs::read_dir(folder).expect("folder of the dialect");
        let mut paths: Vec<PathBuf> = files.map(|file| file.expect("file").path()).collect();
        paths.retain(|path| path.extension().is_some_and(|it| it == "nc"));
        paths.sort();
        all.extend(paths.into_iter().map(|path| (dialect, path)));
    }
    all
}

fn port_file(dialect: ForeignDialect, path: &Path) -> PortedProgram {
    let text = std::fs::read_to_string(path).expect("program");
    port_program(&text, dialect, PortOptions::default())
}

/// `ported`, or the first block without an equivalent.
fn outcome(ported: &PortedProgram) -> String {
    let refused = ported.findings.iter().find(|finding| finding.is_refused);
    refused.map_or_else(
        || "ported".to_owned(),
        |finding| {
            let word = finding.word.split(' ').next().unwrap_or_default();
            format!("line {}: {}", finding.line, word.to_lowercase())
        },
    )
}

/// The alarm of the check of a text on the lathe as delivered, but with eight tool stations;
/// `None` if it ends without one.
fn check_text(text: &str) -> Option<String> {
    let mut setup = Setup::default().with_chuck();
    setup.memory.parameters.set(84, 8).unwrap();
    let mut programs = program::split_programs(text.to_owned());
    let main = programs.remove(0);
    for part in programs {
        setup
            .memory
            .programs
            .store(part.text())
            .expect("subprogram");
    }
    setup.memory.programs.open_external(main);
    setup.memory.programs.select(ProgramId::External);
    let mut can_continue = |_: &PreviewProgress| true;
    let preview = preview_beyond_alarms(
        &setup,
        &setup.memory.programs,
        &mut |_| {},
        &mut can_continue,
    );
    preview.alarm.map(|alarm| alarm.reason().text(Language::En))
}

#[test]
fn foreign_programs_have_the_expected_outcome() {
    let programs = foreign_programs();
    let mut ported_count = 0;
    for (dialect, path) in &programs {
        let expected = std::fs::read_to_string(path.with_extension("expected")).expect("outcome");
        let ported = port_file(*dialect, path);
        let found = outcome(&ported);
        assert_eq!(found, expected.trim().to_lowercase(), "{}", path.display());
        ported_count += usize::from(found == "ported");
    }
    assert!(ported_count >= LEAST_PORTED, "{ported_count}");
}

#[test]
fn ported_programs_pass_the_check() {
    for (dialect, path) in foreign_programs() {
        let ported = port_file(dialect, &path);
        if ported.is_complete() {
            let alarm = check_text(&ported.text);
            assert_eq!(alarm, None, "{}:\n{}", path.display(), ported.text);
        }
    }
}

#[test]
fn a_block_without_an_equivalent_stops_the_program() {
    let ported = port_program(
        "O1\nG31 Z1.\nM30\n",
        ForeignDialect::Haas,
        PortOptions::default(),
    );
    assert_eq!(ported.text, "O1\nG65 H99 P0 (G31 Z1.)\nM30\n");
    assert!(check_text(&ported.text).is_some());
}

/// `gsk980td dialect --codes` prints the table: copy it into the page.
#[test]
fn the_manual_pages_show_the_table_of_codes() {
    for (name, language) in [
        ("docs/foreign-programs.md", Language::En),
        ("docs/foreign-programs.zh-CN.md", Language::Zh),
    ] {
        let page = std::fs::read_to_string(repository().join(name)).expect(name);
        assert!(page.contains(&code_table(language)), "{name}");
    }
}

#[test]
fn strange_text_is_ported_to_its_end() {
    for text in [
        "",
        "(",
        ")",
        "G",
        ",",
        ",C",
        "G1 X",
        "中文 G92 (车",
        "#",
        "%%",
        ";;;",
        "G71 P1 Q1 D0",
        "G76 K0 D0 F0",
        "N99999999999 G0",
        "G83 Z-5 Q0.0001 R1",
        "M98",
        "M97 P1",
        "X1 A0",
        "G1 Z-1 ,R1\nX2",
        "O",
        ":",
        "T999",
        "G2 X1 Z1 R0",
        "S99999999",
    ] {
        for dialect in ForeignDialect::ALL {
            port_program(text, dialect, PortOptions::default());
        }
    }
}
