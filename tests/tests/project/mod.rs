//! Checks the project folder: written data is read again bit for bit, the differences are
//! exactly the changes, and no damaged folder is accepted.
//!
//! `PROPTEST_CASES=1000 cargo test -p gsk980td-tests --test subjects project` runs more.

use std::sync::Arc;

use gsk_core::memory::{OperationLevel, ToolOffset};
use gsk_core::setup::{STANDARD_LADDER, Setup};
use gsk_messages::Language;
use gsk_project::{
    DataSet, OffsetColumn, ProjectFiles, ProjectKey, ProjectSection, ProjectState,
    describe_text_changes, diff, export, find_denied_changes, import,
};

use random::ProjectControl;

mod random;

fn is_table(name: &str) -> bool {
    name.ends_with(".txt") || name.ends_with(".gpr")
}

fn exported_files() -> ProjectFiles {
    export(&ProjectState::from_setup(&Setup::delivered()), Language::En)
}

/// The problems of a folder in which one file is replaced.
fn problems_with(name: &str, text: &str) -> Vec<String> {
    let mut files = exported_files();
    files.insert(name.to_owned(), text.to_owned());
    let problems = import(&files).expect_err(name);
    problems.iter().map(ToString::to_string).collect()
}

fn problems_after_edit(name: &str, old: &str, new: &str) -> Vec<String> {
    let text = exported_files()[name].clone();
    assert!(text.contains(old), "{name}: {old}");
    problems_with(name, &text.replacen(old, new, 1))
}

#[test]
fn every_rule_is_reported_with_file_and_line() {
    let line_of = |name: &str, text: &str| {
        let files = exported_files();
        let at = files[name].lines().position(|line| line.starts_with(text));
        at.unwrap() + 1
    };
    let at = line_of("parameters.txt", "022 ");
    for (name, old, new, message) in [
        (
            "parameters.txt",
            "022 = 3800",
            "022 = 99999",
            format!("parameters.txt:{at}: parameter 022: 99999 is outside 6..15000"),
        ),
        (
            "parameters.txt",
            "022 = 3800",
            "022 = x",
            format!("parameters.txt:{at}: `x` is not a whole number"),
        ),
        (
            "parameters.txt",
            "022 = 3800",
            "022 : 3800",
            format!("parameters.txt:{at}: write NAME = VALUE"),
        ),
        (
            "parameters.txt",
            "022 = 3800",
            "021 = 1",
            format!("parameters.txt:{at}: 021 is already in line {}", at - 1),
        ),
        (
            "parameters.txt",
            "022 = 3800",
            "0220 = 3800",
            format!("parameters.txt:{at}: there is no parameter 220"),
        ),
        (
            "parameters.txt",
            "001.4 = ",
            "001.4 = 7",
            "is outside 0 to 1".to_owned(),
        ),
        (
            "offsets.txt",
            "001.X = 0",
            "001.X = 1.2345",
            "offsets.txt:6: 1.2345 is finer than 0.001 mm".to_owned(),
        ),
        (
            "offsets.txt",
            "001.X = 0",
            "001.X = 99999",
            "offsets.txt:6: offset X 99999 is outside".to_owned(),
        ),
        (
            "offsets.txt",
            "001.T = 0",
            "001.T = 12",
            "offsets.txt:9: 12 is outside 0 to 9".to_owned(),
        ),
        (
            "pitch.txt",
            "000.X = 0",
            "000.X = 256",
            "pitch.txt:2: pitch error point 000: 256 is outside".to_owned(),
        ),
        (
            "variables.txt",
            "#200 = 0",
            "#200 = 1e12",
            "variables.txt:2: ".to_owned(),
        ),
        (
            "variables.txt",
            "#200 = 0",
            "#200 = 0\n#100 = 5",
            "variables.txt:3: #100 is not a variable kept at power-off".to_owned(),
        ),
        (
            "project.gpr",
            "model = gsk980td",
            "model = gsk980",
            "project.gpr:3: `gsk980` is not one of".to_owned(),
        ),
        (
            "project.gpr",
            "model = gsk980td",
            "model = gsk980mdi",
            "project.gpr:3: programs of the GSK980MDi cannot be executed".to_owned(),
        ),
        (
            "project.gpr",
            "format = 1",
            "format = 2",
            "project.gpr:2: 2 is outside 1 to 1".to_owned(),
        ),
        (
            "project.gpr",
            "selected = none",
            "selected = O0007",
            "program 0007 is not in the memory".to_owned(),
        ),
        (
            "project.gpr",
            "iso = on",
            "iso = maybe",
            "`maybe` is not on or off".to_owned(),
        ),
        (
            "ladder/data.txt",
            "K0000 = 0",
            "K0000 = 256",
            "ladder/data.txt:2: 256 is outside 0 to 255".to_owned(),
        ),
        (
            "ladder/main.il",
            "END2",
            "END3",
            "ladder/main.il:".to_owned(),
        ),
    ] {
        let problems = problems_after_edit(name, old, new);
        assert!(
            problems.iter().any(|it| it.contains(&message)),
            "{message}\n{problems:#?}"
        );
    }
    for (name, text, message) in [
        (
            "programs/O0001.CNC",
            "O0002;\nM30;\n",
            "programs/O0001.CNC: its O number is O0002",
        ),
        (
            "programs/O0001.CNC",
            "M30;\n",
            "programs/O0001.CNC: the text has no program number",
        ),
        (
            "programs/notes.txt",
            "x",
            "programs/notes.txt: not a file of a project",
        ),
        (
            "disks/N1/offsets.txt",
            "",
            "disks/N1/parameters.txt: the file is missing",
        ),
        (
            "disks/N5/offsets.txt",
            "",
            "disks/N5/offsets.txt: not a file of a project",
        ),
    ] {
        let problems = problems_with(name, text);
        assert!(
            problems.iter().any(|it| it.contains(message)),
            "{message}\n{problems:#?}"
        );
    }
    for name in exported_files().into_keys() {
        let mut files = exported_files();
        files.remove(&name);
        let problems = import(&files).expect_err(&name);
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert_eq!(
            problems[0].to_string(),
            format!("{name}: the file is missing")
        );
    }
}

#[test]
fn all_problems_are_reported_at_once_up_to_a_limit() {
    let mut files = exported_files();
    for name in ["parameters.txt", "pitch.txt"] {
        let text = files[name].replace(" = ", " is ");
        files.insert(name.to_owned(), text);
    }
    let problems = import(&files).unwrap_err();
    assert_eq!(problems.len(), gsk_project::MAX_PROBLEMS + 1);
    let last = problems.last().unwrap().to_string();
    assert!(last.ends_with("more problems"), "{last}");
}

#[test]
fn names_are_remarks_in_both_languages_and_are_not_read() {
    let state = ProjectState::from_setup(&Setup::delivered());
    let [en, zh] = [Language::En, Language::Zh].map(|language| export(&state, language));
    for (files, wanted) in [(&en, "rapid"), (&zh, "快速")] {
        let line = files["parameters.txt"]
            .lines()
            .find(|line| line.starts_with("022 "));
        assert!(line.unwrap().contains(wanted), "{line:?}");
        assert!(files["ladder/data.txt"].contains("DT0004 = 15000"));
    }
    assert_ne!(en, zh);
    assert_eq!(import(&en).unwrap(), import(&zh).unwrap());
    // Line ends as Windows and git write them.
    let crlf = en.into_iter().map(|(name, text)| match is_table(&name) {
        true => (name, text.replace('\n', "\r\n")),
        false => (name, text),
    });
    assert_eq!(import(&crlf.collect()).unwrap(), state);
}

#[test]
fn a_ladder_is_compared_by_meaning() {
    let with = |from: &str, to: &str| {
        assert!(STANDARD_LADDER.contains(from), "{from}");
        let mut files = exported_files();
        files.insert(
            "ladder/main.il".to_owned(),
            STANDARD_LADDER.replacen(from, to, 1),
        );
        let found = diff(
            &ProjectState::from_setup(&Setup::delivered()),
            &import(&files).unwrap(),
        );
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].section(), ProjectSection::Ladder);
        let description = describe_text_changes(&found[0]);
        description
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        with("压力低报警", "油压低"),
        ["A0001.5: 1014 压力低报警 → 1014 油压低"]
    );
    assert_eq!(
        with(".INIT DT4 15000", ".INIT DT4 9000"),
        [".INIT DT0004: 15000 → 9000"]
    );
    assert_eq!(with("\nEND1", "\n; one\nEND1"), ["only comments differ"]);
    let rungs = with("\nEND2", "\nLD R500.0\nOUT R501.0\nEND2");
    assert!(rungs[0].contains("0 rungs become 1"), "{rungs:?}");
}

#[test]
fn machine_and_jobs_are_compared_between_folders_alone() {
    let texts = |text: &str| {
        let machine = (ProjectKey::Machine, Arc::from(text));
        ProjectState::from_setup(&Setup::delivered())
            .with_texts([machine, (ProjectKey::Job(7), Arc::from("()"))])
    };
    let (one, other) = (texts("(name: \"a\")"), texts("(name: \"b\")"));
    let found = diff(&one, &other);
    assert_eq!(
        found.iter().map(|it| it.key).collect::<Vec<_>>(),
        [ProjectKey::Machine]
    );
    assert_eq!(
        diff(&one, &ProjectState::from_setup(&Setup::delivered())),
        []
    );
    let files = export(&one, Language::En);
    assert_eq!(files["machine.ron"], "(name: \"a\")");
    assert_eq!(import(&files).unwrap(), one);
}

/// Manual III-2.5.1: levels 3 and up for parameters and ladder, 4 for offsets and programs.
#[test]
fn rights_are_those_of_the_control() {
    let mut after = ProjectControl::new();
    after.memory.parameters.set(22, 4000).unwrap();
    let offset = ToolOffset {
        x: 1.0,
        ..ToolOffset::default()
    };
    after.memory.offsets.set(1, offset).unwrap();
    after.memory.variables.set(200, 1).unwrap();
    after.memory.programs.store("O0001;\nM30;\n").unwrap();
    after.memory.programs.store("O9001;\nM30;\n").unwrap();
    let before = ProjectControl::new();
    let found = diff(&before.state(), &after.state());
    let refused = |parameters: &_, level: OperationLevel| -> Vec<ProjectKey> {
        let denied = find_denied_changes(&found, parameters, level);
        denied.into_iter().map(|it| it.key).collect()
    };
    let level = |password: &str| before.memory.authority.level_for(password).unwrap();
    let parameter = ProjectKey::Parameter(DataSet::Control, 22, None);
    let offset = ProjectKey::Offset(DataSet::Control, 1, OffsetColumn::X);
    let (low, high) = (ProjectKey::Program(1), ProjectKey::Program(9001));
    let parameters = &before.memory.parameters;
    assert_eq!(refused(parameters, level("123456")), []);
    assert_eq!(refused(parameters, level("12345")), [high]);
    // Without 参数开关 parameters are refused; the level does not enable them.
    assert_eq!(refused(parameters, level("1234")), [parameter, high]);
    let refused_for_all = [parameter, offset, ProjectKey::Variable(200), low, high];
    assert_eq!(refused(parameters, OperationLevel::NONE), refused_for_all);
}
