//! The documents agree with the tables and folders they speak of.

use gsk_panel::keys::KEYS;
use gsk_tests::repository;

fn text(name: &str) -> String {
    std::fs::read_to_string(repository().join(name)).expect(name)
}

#[test]
fn both_key_maps_are_those_of_the_key_table() {
    for (name, arrow) in [
        ("README.md", "Ctrl+arrow"),
        ("README.zh-CN.md", "Ctrl+方向键"),
    ] {
        let readme = text(name);
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
        let text = text(name);
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
    let readme = text("README.md");
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
    let ci = text(".ci/run");
    for (name, heading) in [
        ("README.md", "Run all tests:"),
        ("README.zh-CN.md", "运行全部测试:"),
    ] {
        let readme = text(name);
        let command = command_after(&readme, heading);
        let runs = ci.lines().any(|line| line == command);
        assert!(runs, ".ci/run has no line `{command}`, which {name} prints");
    }
}
