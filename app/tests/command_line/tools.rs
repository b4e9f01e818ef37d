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
fn inserts_of_the_lathe_addon_of_freecad_are_imported_and_exported() {
    let folder = TempFolder::new("tool-addon");
    let bit = |name: &str, shape: &str, angle: &str, rotation: &str| {
        let text = format!(
            "{{\"version\": 2, \"name\": \"{name}\", \"shape\": \"/Tools/Shape/{shape}.fcstd\", \
             \"parameter\": {{\"Diameter\": \"1.48 mm\", \"EdgeLength\": \"6.35 mm\", \
             \"Rotation\": \"{rotation}\", \"TipAngle\": \"{angle}\", \"TipRadius\": \"0.40 mm\"}}, \
             \"attribute\": {{}}}}"
        );
        std::fs::write(folder.join(format!("{name}.fctb")), text).unwrap();
    };
    bit("iso_c", "Iso_shape_C", "80.00 °", "45.00 °");
    bit("iso_s", "Iso_shape_S", "90.00 °", "45.00 °");
    let list = "{\"tools\": [{\"nr\": 1, \"path\": \"iso_c.fctb\"}, \
                {\"nr\": 3, \"path\": \"iso_s.fctb\"}], \"version\": 1}";
    std::fs::write(folder.join("own.fctl"), list).unwrap();
    let (code, out, error) = run(&folder, "tools import own.fctl");
    assert_eq!((code, out.as_str()), (0, "1 tools are in the library\n"));
    assert!(
        error.contains("iso_s.fctb: `Rotation` is 45.00 °: entering angle"),
        "{error}"
    );
    let (_, own, _) = run(&folder, "tools show iso_c");
    assert!(
        own.contains("entering=95 size=6.35 nose=0.4 tip=3"),
        "{own}"
    );
    let (code, _, error) = run(&folder, "tools export out.fctl --format freecad-lathe");
    assert_eq!(code, 0, "{error}");
    // FreeCAD drops the attributes.
    let written = std::fs::read_to_string(folder.join("iso_c.fctb")).unwrap();
    let mut written: serde_json::Value = serde_json::from_str(&written).unwrap();
    assert_eq!(written["shape"], "Iso_shape_C.fcstd");
    written["attribute"] = serde_json::json!({});
    std::fs::write(folder.join("iso_c.fctb"), written.to_string()).unwrap();
    let (code, _, error) = folder.run("tools import iso_c.fctb --data other");
    assert_eq!(code, 0, "{error}");
    let (_, again, _) = folder.run("tools show iso_c --data other");
    assert_eq!(again, own);
    let (code, _, _) = run(&folder, "tools export one.fctb");
    assert_eq!(code, 2, "a bit is not a list");
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
