//! The command `project` and the project view: the whole memory of a control is exported to a
//! folder and imported again.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gsk_app::files::data_dir::DataDir;
use gsk_app::project::{self, Taking, Who};
use gsk_app::retained;
use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;

use crate::common::Bench;
use crate::common::folder::Folder;

impl Folder {
    /// Runs `project …` in this folder. Returns exit code, standard output and standard error.
    fn project(&self, command: &str) -> (i32, String, String) {
        self.call(&format!("project {command}"))
    }

    #[track_caller]
    fn does(&self, command: &str) -> String {
        let (code, out, error) = self.project(command);
        assert_eq!((code, error.as_str()), (0, ""), "{command}: {out}");
        out
    }

    /// Asserts that the command fails with this exit code and message, and changes no file.
    #[track_caller]
    fn refuses(&self, command: &str, code: i32, sentence: &str) {
        let before = self.files();
        let (found, out, error) = self.project(command);
        assert_eq!(found, code, "{command}: {out}{error}");
        assert!(error.contains(sentence), "{command}: {error}");
        assert!(self.files() == before, "{command}: a file is changed");
    }

    fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut files = BTreeMap::new();
        let mut open = vec![self.0.clone()];
        while let Some(folder) = open.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                match path.is_dir() {
                    true => open.push(path),
                    false => drop(files.insert(path.clone(), fs::read(&path).unwrap())),
                }
            }
        }
        files
    }

    fn edit(&self, file: &str, from: &str, to: &str) {
        let path = self.0.join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{file}: {from}");
        fs::write(path, text.replacen(from, to, 1)).unwrap();
    }

    /// Creates a data directory as a control leaves it.
    fn control(&self, name: &str, change: impl FnOnce(&mut Setup)) -> PathBuf {
        let path = self.0.join(name);
        let data = DataDir::open(&path).unwrap();
        let mut setup = Setup::delivered();
        let restored = retained::load(&data, &mut setup);
        change(&mut setup);
        retained::save_emulator(data, &restored, &Emulator::new(setup)).unwrap();
        path
    }
}

/// O0007 with a Chinese comment from an old editor: GB18030, CR LF.
fn old_text() -> Vec<u8> {
    let mut text = b"O0007 (".to_vec();
    text.extend([0xB3, 0xB5]);
    text.extend(b")\r\nG00 X50 Z2\r\nM30\r\n%");
    text
}

#[test]
fn a_control_is_exported_wiped_and_brought_back() {
    let folder = Folder::new("project-back");
    folder.does("new start");
    folder.edit("start/parameters.txt", "022 = 3800", "022 = 4000");
    folder.edit("start/offsets.txt", "003.X = 0", "003.X = -12.345");
    folder.edit(
        "start/variables.txt",
        "#515 = 0",
        "#515 = 0.1\n#600 = 1e-300",
    );
    folder.edit("start/project.gpr", "macro-b = off", "macro-b = on");
    folder.edit("start/ladder/data.txt", "D0300 = 0", "D0300 = 200");
    folder.edit("start/ladder/main.il", "压力低报警", "油压低");
    folder.write("start/programs/O0007.CNC", old_text());
    let said = folder.does("import start --data one");
    for line in [
        "No.022 X rapid speed: 3800 → 4000 mm/min",
        "offset 003 X: 0 → -12.345 mm",
        "#515: 0 → 0.1",
        "#600: – → 1e-300",
        "macro B: off → on",
        "D0300: 0 → 200",
        "ladder: A0001.5: 1014 压力低报警 → 1014 油压低",
        "O0007: added, 4 lines",
        "selected program: none → O0007",
        "values taken over into one: 9",
    ] {
        assert!(said.contains(line), "{line}\n{said}");
    }
    folder.does("export out --data one");
    let bytes = fs::read(folder.0.join("out/programs/O0007.CNC")).unwrap();
    assert_eq!(bytes, old_text(), "byte for byte");
    let kept = fs::read(folder.0.join("one/programs/O0007.CNC")).unwrap();
    assert_eq!(kept, old_text(), "in the memory, too");
    fs::remove_dir_all(folder.0.join("one")).unwrap();
    folder.does("import out --data one");
    let same = folder.does("diff out --data one");
    assert_eq!(same, "nothing differs\n");
    folder.does("export again --data one");
    for (path, bytes) in folder.files() {
        if let Ok(name) = path.strip_prefix(folder.0.join("out")) {
            assert_eq!(fs::read(folder.0.join("again").join(name)).unwrap(), bytes);
        }
    }
    // The backup of the previous state is a project, too.
    let (code, said, _) = folder.project("diff one/backups/before-import-0001 out");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("values that differ: 9"), "{said}");
}

#[test]
fn one_wrong_line_and_nothing_is_taken_over() {
    let folder = Folder::new("project-wrong");
    folder.does("new part");
    folder.control("data", |_| {});
    folder.edit("part/parameters.txt", "022 = 3800", "022 = 4000");
    folder.edit("part/pitch.txt", "007.X = 0", "007.X = 300");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z zero");
    let line = "pitch.txt:16: pitch error point 007: 300 is outside";
    folder.refuses("import part --data data", 2, line);
    folder.refuses(
        "import part --data data",
        2,
        "offsets.txt:7: write NAME = VALUE",
    );
    folder.refuses("import part --data data", 2, "problems: 2");
    folder.refuses("diff part --data data", 2, line);
    let (_, _, error) = folder.project("import part --data data --lang zh");
    assert!(
        error.contains("offsets.txt:7: 应写成 名称 = 数值"),
        "{error}"
    );
    folder.write("part/machine.ron", b"(\n  naem: \"x\",\n)");
    folder.refuses("import part --data data", 2, "machine.ron:2: ");
    folder.write("part/programs/O0001.job.ron", b"(stok: 1)");
    folder.refuses("import part --data data", 2, "programs/O0001.job.ron:1: ");
    folder.write("part/counters.txt", [0, 1, 2]);
    folder.refuses(
        "import part --data data",
        2,
        "counters.txt: this is a binary file",
    );
}

#[test]
fn parts_alone_are_taken_over() {
    let folder = Folder::new("project-only");
    folder.does("new part");
    folder.control("data", |_| {});
    folder.edit("part/parameters.txt", "022 = 3800", "022 = 4000");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z = 5");
    folder.write("part/programs/O0002.CNC", b"O0002;\nM30;\n");
    let said = folder.does("import part --data data --only offsets,programs --dry-run");
    assert!(
        said.contains("values that would be taken over into data: 3"),
        "{said}"
    );
    let said = folder.does("import part --data data --only offsets,programs");
    assert!(
        !said.contains("No.022") && said.contains("offset 001 Z"),
        "{said}"
    );
    let (code, said, _) = folder.project("diff part --data data --only parameters --format json");
    assert_eq!(code, 1);
    let rows: serde_json::Value = serde_json::from_str(&said).unwrap();
    let row = rows
        .as_array()
        .unwrap()
        .iter()
        .find(|row| row["name"] == "022")
        .unwrap();
    assert_eq!((&row["old"], &row["new"]), (&4000.into(), &3800.into()));
    assert_eq!(row["label_zh"], "No.022 X轴快速移动速度");
}

/// Rights and passwords: manual III-2.5.1.
#[test]
fn the_rights_of_the_control_are_asked_and_a_password_opens_them() {
    let folder = Folder::new("project-rights");
    folder.does("new part");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z = 5");
    folder.write("part/programs/O9003.CNC", b"O9003;\nM99;\n");
    let data = folder.control("data", |setup| setup.memory.authority.leave());
    let level = || fs::read(data.join("authority.ron")).unwrap();
    let before = level();
    let refused = "offset 001 Z: the operation level is too low";
    folder.refuses("import part --data data --only offsets", 1, refused);
    folder.refuses(
        "import part --data data --only offsets --password 1",
        2,
        "no operation level",
    );
    folder.does("import part --data data --only offsets --password 1234");
    let refused = "O9003: the operation level is too low";
    folder.refuses(
        "import part --data data --only programs --password 12345",
        1,
        refused,
    );
    folder.does("import part --data data --only programs --password 123456");
    assert_eq!(level(), before, "nobody is logged on by it");
    folder.does("export out --data data");
    for (path, bytes) in folder.files() {
        if path.starts_with(folder.0.join("out")) {
            let text = String::from_utf8_lossy(&bytes);
            assert!(!text.contains("12345678"), "{path:?} holds a password");
        }
    }
}

#[test]
fn a_control_that_is_on_is_left_alone() {
    let folder = Folder::new("project-in-use");
    folder.does("new part");
    let path = folder.control("data", |_| {});
    let window = DataDir::open(&path).unwrap();
    for command in [
        "import part --data data",
        "export out --data data",
        "diff part --data data",
    ] {
        folder.refuses(command, 2, "is using the data directory");
    }
    drop(window);
    folder.does("export out --data data");
}

#[test]
fn folders_of_others_are_left_alone_and_half_a_project_is_none() {
    let folder = Folder::new("project-folders");
    folder.control("data", |setup| {
        setup.memory.programs.store("O0001;\nM30;\n").unwrap();
    });
    folder.write("notes/letter.txt", b"dear");
    folder.refuses("export notes --data data", 2, "holds other files");
    folder.refuses("export data --data data", 2, "holds other files");
    folder.refuses(
        "import notes --data data",
        2,
        "neither a project nor a data directory",
    );
    folder.refuses(
        "diff notes data",
        2,
        "neither a project nor a data directory",
    );
    folder.refuses("export out --data nowhere", 2, "no data directory");
    folder.does("export out --data data");
    folder.refuses("new out", 2, "holds other files");
    // Other files of the owner in the folder stay.
    folder.write("out/README.md", b"mine");
    folder.write("out/.git/HEAD", b"ref");
    folder.write(
        "out/programs/O0001.job.ron",
        b"(stock: (form: Bar(diameter: 40), length: 90, overhang: 50))",
    );
    folder.write("out/programs/O0002.CNC", b"O0002;\nM30;\n");
    let said = folder.does("export out --data data");
    assert_eq!(said, "out: files written 0, removed 1\n");
    let names = folder.files();
    for (name, there) in [
        ("out/README.md", true),
        ("out/.git/HEAD", true),
        ("out/programs/O0001.job.ron", true),
        ("out/programs/O0002.CNC", false),
    ] {
        assert_eq!(names.contains_key(&folder.0.join(name)), there, "{name}");
    }
    folder.write("out/.gsk980td-unfinished", b"");
    folder.refuses("import out --data data", 2, "was broken off");
    folder.does("export out --data data");
    folder.does("diff out data");
}

#[test]
fn a_machine_file_goes_along_and_is_compared_between_projects() {
    let folder = Folder::new("project-machine");
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/machines");
    let machine = machines.join("small-flat-bed.ron");
    folder.does(&format!("new one --machine {}", machine.display()));
    assert_eq!(
        fs::read(folder.0.join("one/machine.ron")).unwrap(),
        fs::read(&machine).unwrap()
    );
    folder.does("new two");
    let (code, said, _) = folder.project("diff two one --only machine");
    assert_eq!(code, 1);
    assert!(said.contains("machine file: added"), "{said}");
    folder.does("import one --data data");
    assert_eq!(folder.does("diff one --data data"), "nothing differs\n");
    folder.does("new ncb --model ncb08");
    folder.edit("ncb/model-parameters.txt", "017 = 15000", "017 = 9000");
    folder.does("import ncb --data data");
    assert!(folder.0.join("data/models/ncb08/parameters.ron").exists());
    assert_eq!(
        folder.does("diff ncb --data data --model ncb08"),
        "nothing differs\n"
    );
}

#[test]
fn what_was_damaged_in_the_memory_is_said() {
    let folder = Folder::new("project-damaged");
    let data = folder.control("data", |_| {});
    for place in ["offsets.ron", "copies/offsets.ron"] {
        fs::write(data.join(place), "(1, 2").unwrap();
    }
    let (code, out, error) = folder.project("export out --data data");
    assert_eq!(code, 1, "{out}{error}");
    assert!(error.contains("offsets.ron"), "{error}");
}

/// A window whose operator is logged on but must not write parameters.
fn window() -> Bench {
    let mut setup = Setup::delivered().with_chuck();
    setup.memory.authority.leave();
    assert!(setup.memory.authority.enter("1234"));
    setup.memory.programs.store("O0005;\nM30;\n").unwrap();
    Bench::with(setup)
}

/// Draws frames until a text is shown.
#[track_caller]
fn sees(bench: &mut Bench, words: &str) {
    let seen = (0..1000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(1);
        let mut found = bench.harness.query_all_by_label_contains(words);
        found.next().is_some()
    });
    assert!(seen, "{words} is never seen");
}

#[track_caller]
fn press(bench: &mut Bench, name: &str) {
    bench.harness.get_by_label(name).click();
    bench.run(20);
    bench.run(20);
}

/// The project view lists differences from the running control, with check boxes.
#[test]
fn the_view_lists_what_differs_and_takes_what_is_ticked() {
    let folder = Folder::new("project-window");
    folder.does("new part");
    folder.edit("part/parameters.txt", "022 = 3800", "022 = 4000");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z = 5");
    let mut bench = window();
    let context = bench.harness.ctx.clone();
    let part = folder.0.join("part");
    bench.harness.state_mut().compare(&context, part.clone());
    sees(&mut bench, "No.022 X rapid speed");
    let counted = bench.harness.query_all_by_label_contains(" · ");
    let counted: Vec<String> = counted
        .filter_map(|it| it.accesskit_node().label())
        .collect();
    assert_eq!(
        counted,
        [
            "Project: part · 5",
            "CNC configuration · 3",
            // One of them is the station of the turret.
            "Parameters · 2",
            "Tool offsets · 1",
            "Part programs · 2",
            "O0005 · 1",
        ]
    );
    let row = bench
        .harness
        .get_by_label("No.022 X rapid speed: 3800 → 4000 mm/min");
    assert!(
        row.accesskit_node().is_disabled(),
        "the level is too low for it"
    );
    press(&mut bench, "none");
    assert!(bench.harness.state_mut().take_chosen().is_none());
    // A node of the tree shows only its own differences and content.
    press(&mut bench, "Tool offsets · 1");
    assert!(bench.harness.query_by_label_contains("No.022").is_none());
    press(&mut bench, "Contents");
    assert!(bench.harness.query_by_label("001.Z").is_some());
    assert!(bench.harness.query_by_label("5 mm").is_some());
    press(&mut bench, "Differences: 1");
    press(&mut bench, "offset 001 Z: 0 → 5 mm");
    press(&mut bench, "Switch off, take over 1, switch on");
    let chosen = bench.harness.state_mut().take_chosen().expect("chosen");
    assert_eq!(chosen.folder, part);
    let labels: Vec<String> = chosen.differences.iter().map(|it| it.key.name()).collect();
    assert_eq!(labels, ["001.Z"]);
    // The application does the same while the control is off.
    let data = folder.control("data", |setup| {
        *setup = core::mem::take(setup).with_chuck();
        setup.memory.authority.leave();
        assert!(setup.memory.authority.enter("1234"));
    });
    let taking = Taking {
        project: &part,
        directory: &data,
        model: Some(gsk_core::model::ModelId::Gsk980td),
        who: Who::LoggedOn,
        dry_run: false,
    };
    let taken = project::take_over(&taking, &|it| chosen.has(it)).expect("taken over");
    assert_eq!(taken.differences.len(), 1, "{taken:?}");
    assert!(taken.backup.is_some());
    let (_, said, _) = folder.project("diff data part --only offsets");
    assert_eq!(said, "nothing differs\n");
    let (_, said, _) = folder.project("diff data part --only parameters");
    assert!(said.contains("No.022"), "{said}");
    let other = Taking {
        model: Some(gsk_core::model::ModelId::Ncb08),
        ..taking
    };
    let refused = project::take_over(&other, &|_| true).expect_err("another model");
    assert!(
        refused.to_string().contains("turn this model on first"),
        "{refused}"
    );
}

/// The other direction: values of the control or of another project are taken over into the
/// open project. The view asks before the project is lost, and saves it.
#[test]
fn the_view_takes_values_into_the_project_and_saves_it() {
    let folder = Folder::new("project-into");
    folder.does("new part");
    folder.does("new other");
    folder.edit("other/pitch.txt", "007.X = 0", "007.X = 12");
    folder.edit("other/ladder/main.il", "压力低报警", "油压低");
    let mut bench = window();
    let context = bench.harness.ctx.clone();
    let part = folder.0.join("part");
    let file = part.join("project.gpr");
    bench.harness.state_mut().open(&context, file.clone());
    sees(&mut bench, "O0005: removed");
    let into = |bench: &mut Bench, at: usize, words: &str| {
        let found: Vec<_> = bench.harness.get_all_by_label(words).collect();
        found.get(at).expect("it is there").click();
        bench.run(20);
    };
    into(&mut bench, 0, "the project");
    sees(&mut bench, "O0005: added");
    sees(&mut bench, "the control → the project");
    press(&mut bench, "none");
    press(&mut bench, "O0005: added, 2 lines");
    press(&mut bench, "Take 1 into the project");
    sees(&mut bench, "not saved");
    // A thread repeats the comparison.
    let gone = (0..1000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(1);
        let mut found = bench.harness.query_all_by_label_contains("O0005: added");
        found.next().is_none()
    });
    assert!(gone, "what was taken in still differs");
    // The control takes over the files of the folder, not unsaved changes.
    let at = bench.harness.get_all_by_label("the control").count() - 1;
    into(&mut bench, at, "the control");
    sees(&mut bench, "Switch off, take over");
    let button = bench.harness.get_by_label_contains("Switch off, take over");
    assert!(button.accesskit_node().is_disabled());
    // The view asks before it opens another project.
    let menu = |bench: &mut Bench, entry: &str| {
        press(bench, entry);
        bench.run(20);
    };
    menu(&mut bench, "Close");
    sees(&mut bench, "The project is not saved");
    // A key of the panel has the same name.
    let at = bench.harness.get_all_by_label("Cancel").count() - 1;
    into(&mut bench, at, "Cancel");
    press(&mut bench, "Save");
    sees(&mut bench, "files written");
    assert!(part.join("programs/O0005.CNC").exists());
    let (_, said, _) = folder.project("diff other part");
    assert!(said.contains("O0005: added"), "{said}");
    // Closed and opened again, the view shows the files of the folder.
    menu(&mut bench, "Close");
    sees(&mut bench, "No project is open");
    bench.harness.state_mut().open(&context, file);
    sees(&mut bench, "Project: part");
}
