//! Checks that the documents agree with the tables and folders they describe.

use gsk_panel::keys::KEYS;
use gsk_tests::repository;

fn read_document(name: &str) -> String {
    std::fs::read_to_string(repository().join(name)).expect(name)
}

#[test]
fn both_key_maps_are_those_of_the_key_table() {
    for (name, arrow) in [
        ("README.md", "Ctrl+arrow"),
        ("README.zh-CN.md", "Ctrl+方向键"),
    ] {
        let readme = read_document(name);
        let fitted = KEYS
            .iter()
            .filter(|row| !row.name_en.contains("not fitted"));
        for row in fitted.filter(|row| row.pc.len() > 1) {
            let wanted = match row.pc {
                pc if pc.starts_with("Ctrl+Arrow") => arrow.to_owned(),
                pc if pc.starts_with("Arrow") => continue,
                pc => format!("`{pc}`"),
            };
            let wanted = wanted.trim_matches('`');
            let listed = readme.contains(&format!("`{wanted}`"));
            assert!(listed, "{name}: {wanted} ({}) is missing", row.name_en);
        }
    }
}

#[test]
fn both_readmes_name_the_same_commands_files_and_keys() {
    let quoted = |name: &str| {
        let text = read_document(name);
        let mut quoted: Vec<String> = text
            .split('`')
            .skip(1)
            .step_by(2)
            .map(str::to_owned)
            .collect();
        quoted.retain(|word| word.is_ascii() && !word.contains('\n') && !word.contains("arrow"));
        quoted.sort();
        quoted.dedup();
        quoted
    };
    assert_eq!(quoted("README.md"), quoted("README.zh-CN.md"));
}

#[test]
fn samples_named_in_the_readme_exist() {
    let readme = read_document("README.md");
    for entry in std::fs::read_dir(repository().join("assets/programs")).expect("samples") {
        let path = entry.expect("entry").path();
        let name = path
            .file_name()
            .expect("name")
            .to_string_lossy()
            .into_owned();
        assert!(readme.contains(&name), "{name} is not in README.md");
    }
}

/// The command in the first code block after a heading line.
fn command_after<'a>(text: &'a str, heading: &str) -> &'a str {
    let (_, rest) = text.split_once(heading).expect(heading);
    let (_, block) = rest.split_once("```sh\n").expect("a code block");
    block.lines().next().expect("a command")
}

#[test]
fn ci_runs_the_test_command_of_both_readmes() {
    let ci = read_document(".ci/run");
    for (name, heading) in [
        ("README.md", "Run all tests:"),
        ("README.zh-CN.md", "运行全部测试："),
    ] {
        let readme = read_document(name);
        let command = command_after(&readme, heading);
        let runs = ci.lines().any(|line| line == command);
        assert!(runs, ".ci/run has no line `{command}`, which {name} prints");
    }
}

/// Every `cargo test`, `cargo bench` and `cargo run` in a document, with the document's name.
fn printed_commands() -> Vec<(&'static str, String)> {
    let names = [
        "README.md",
        "README.zh-CN.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "docs/real-lathe.md",
        "docs/real-lathe.zh-CN.md",
    ];
    let mut commands = Vec::new();
    for name in names {
        for piece in read_document(name).split(['`', '\n']) {
            let at = piece.find("cargo ");
            let command = at.map_or("", |at| &piece[at..]);
            let verb = command.split_whitespace().nth(1);
            if matches!(verb, Some("test" | "bench" | "run")) {
                commands.push((name, command.to_owned()));
            }
        }
    }
    commands
}

/// The folder and the manifest of a package of this workspace.
fn find_package(name: &str) -> Option<(std::path::PathBuf, String)> {
    let folders = std::fs::read_dir(repository()).expect("the repository");
    folders.flatten().find_map(|entry| {
        let manifest = std::fs::read_to_string(entry.path().join("Cargo.toml")).ok()?;
        let wanted = format!("name = \"{name}\"");
        let found = manifest.lines().any(|line| line == wanted);
        found.then(|| (entry.path(), manifest))
    })
}

#[test]
fn packages_and_targets_of_printed_commands_exist() {
    let commands = printed_commands();
    assert!(commands.len() > 10, "the documents print commands");
    for (document, command) in commands {
        let words: Vec<&str> = command.split_whitespace().collect();
        let value = |option: &str| {
            let at = words.iter().position(|word| *word == option)?;
            words.get(at + 1).copied()
        };
        let name = value("-p").unwrap_or("gsk980td");
        let (folder, manifest) = find_package(name)
            .unwrap_or_else(|| panic!("{document}: `{command}`: no package {name}"));
        for (option, targets) in [("--test", "tests"), ("--bench", "benches")] {
            let Some(target) = value(option) else {
                continue;
            };
            let listed = manifest.contains(&format!("name = \"{target}\""));
            let found = listed || folder.join(targets).join(format!("{target}.rs")).exists();
            assert!(found, "{document}: `{command}`: no target {target}");
        }
    }
}
