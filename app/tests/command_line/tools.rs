//! The output of `tools`, and jobs that name tools of the library.

use crate::common::folder::TempFolder;

/// Runs commands in a folder whose data folder is inside it.
fn run(folder: &TempFolder, command: &str) -> (i32, String, String) {
    folder.run(&format!("{command} --data data"))
}

#[test]
fn tools_are_added_listed_exported_and_imported() {
    let folder = TempFolder::new("tool-library");
    let add = "tools add CNMG 120408 PCLNR 2020K12 --id rough --station 1 --life 15 --edges 4";
    let (code, out, error) = run(&folder, add);
    assert_eq!(
        (code, out.as_str()),
        (0, "rough: CNMG 120408 PCLNR 2020K12\n"),
        "{error}"
    );
    assert_eq!(run(&folder, add).0, 2, "the id is taken");
    assert_eq!(run(&folder, "tools add drill 8.5").0, 0);
    let (code, _, error) = run(&folder, "tools add CNMG 130408");
    assert!(
        code == 2 && error.contains("position 5 (edge length)"),
        "{error}"
    );
    let (_, out, _) = run(&folder, "tools list cnmg");
    assert!(
        out.starts_with("rough\tT01\t") && out.lines().count() == 1,
        "{out}"
    );
    let (_, out, _) = run(&folder, "tools show DCMT 11T304 SDJCR 1616H11");
    assert!(
        out.contains("entering=93") && out.contains("edge=11.63"),
        "{out}"
    );
    for table in ["t.csv", "t.tbl", "t.fctl", "t.ron"] {
        let (code, _, error) = run(&folder, &format!("tools export {table}"));
        assert_eq!(code, 0, "{table}: {error}");
        let other = format!("{table}-data");
        let import = format!("tools import {table} --data {other}");
        let (code, out, error) = folder.run(&import);
        assert_eq!(
            (code, out.as_str()),
            (0, "2 tools are in the library\n"),
            "{table}: {error}"
        );
        let (_, out, _) = folder.run(&format!("tools list --data {other}"));
        let (_, own, _) = run(&folder, "tools list");
        let names = |out: &str| -> Vec<String> {
            let fields = out
                .lines()
                .map(|it| it.split('\t').take(4).collect::<Vec<_>>().join(" "));
            fields.map(|it| it.replace(" T02 ", "  ")).collect()
        };
        assert_eq!(names(&out), names(&own), "{table}");
    }
    let (code, out, _) = run(&folder, "tools life rough --add 20");
    assert!(code == 0 && out.contains("20.0 of 15 min"), "{out}");
    assert_eq!(run(&folder, "tools life").0, 1, "an edge is used up");
    let (_, out, _) = run(&folder, "tools life rough --next-edge");
    assert!(out.contains("edge 2 of 4: 0.0 of 15"), "{out}");
    assert_eq!(run(&folder, "tools remove rough").0, 0);
    assert_eq!(run(&folder, "tools remove rough").0, 2);
}

#[test]
fn a_form_takes_its_tool_from_the_library_and_names_it_in_the_job() {
    let folder = TempFolder::new("tool-of-form");
    let add = "tools add DNMG 110402 PDJNR 2020K11 --id fine --station 7";
    assert_eq!(run(&folder, add).0, 0);
    let (code, _, error) = run(&folder, "form turn --tool fine -o part.CNC");
    assert_eq!(code, 0, "{error}");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let program = read("part.CNC");
    assert!(
        program.contains("T0707") && program.contains("NOSE=0.2"),
        "{program}"
    );
    assert!(read("part.job.ron").contains("7: \"fine\""));
    let (code, _, error) = run(&folder, "form drill --tool fine");
    assert!(
        code == 2 && error.contains("fine is no tool for this form"),
        "{error}"
    );
    assert_eq!(run(&folder, "form turn --tool none").0, 2);
}
