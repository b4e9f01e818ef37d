//! The command `project` and the project view: the whole memory of a control is exported to a
//! folder and imported again.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use egui_kittest::kittest::{NodeT as _, Queryable as _};
use gsk_core::setup::Setup;
use gsk_host::files::data_dir::DataDir;
use gsk_host::project::{self, ImportRequest, ImportRights};
use gsk_host::retained;
use gsk_panel::emulator::Emulator;

use crate::common::WindowBench;
use crate::common::folder::TempFolder;

impl TempFolder {
    /// Runs `project …` in this folder. Returns exit code, standard output and standard error.
    fn run_project(&self, command: &str) -> (i32, String, String) {
        self.run(&format!("project {command}"))
    }

    #[track_caller]
    fn run_successfully(&self, command: &str) -> String {
        let (code, out, error) = self.run_project(command);
        assert_eq!((code, error.as_str()), (0, ""), "{command}: {out}");
        out
    }

    /// Asserts that the command fails with this exit code and message, and changes no file.
    #[track_caller]
    fn assert_refused(&self, command: &str, code: i32, message: &str) {
        let files_before = self.files();
        let (actual_code, out, error) = self.run_project(command);
        assert_eq!(actual_code, code, "{command}: {out}{error}");
        assert!(error.contains(message), "{command}: {error}");
        assert!(self.files() == files_before, "{command}: a file is changed");
    }

    fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut files = BTreeMap::new();
        let mut folders = vec![self.0.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                match path.is_dir() {
                    true => folders.push(path),
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
    fn create_control(&self, name: &str, change: impl FnOnce(&mut Setup)) -> PathBuf {
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
fn gbk_text() -> Vec<u8> {
    let mut text = b"O0007 (".to_vec();
    text.extend([0xB3, 0xB5]);
    text.extend(b")\r\nG00 X50 Z2\r\nM30\r\n%");
    text
}

#[test]
fn a_control_is_exported_deleted_and_imported() {
    let folder = TempFolder::new("project-back");
    folder.run_successfully("new start");
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
    folder.write("start/programs/O0007.CNC", gbk_text());
    let output = folder.run_successfully("import start --data one");
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
        "values written to one: 9",
    ] {
        assert!(output.contains(line), "{line}\n{output}");
    }
    folder.run_successfully("export out --data one");
    let bytes = fs::read(folder.0.join("out/programs/O0007.CNC")).unwrap();
    assert_eq!(bytes, gbk_text(), "byte for byte");
    let stored = fs::read(folder.0.join("one/programs/O0007.CNC")).unwrap();
    assert_eq!(stored, gbk_text(), "in the memory, too");
    fs::remove_dir_all(folder.0.join("one")).unwrap();
    folder.run_successfully("import out --data one");
    let same = folder.run_successfully("diff out --data one");
    assert_eq!(same, "no differences\n");
    folder.run_successfully("export again --data one");
    for (path, bytes) in folder.files() {
        if let Ok(name) = path.strip_prefix(folder.0.join("out")) {
            assert_eq!(fs::read(folder.0.join("again").join(name)).unwrap(), bytes);
        }
    }
    // The backup of the previous state is a project, too.
    let (code, output, _) = folder.run_project("diff one/backups/before-import-0001 out");
    assert_eq!(code, 1, "{output}");
    assert!(output.contains("values that differ: 9"), "{output}");
}

#[test]
fn one_invalid_line_prevents_the_import() {
    let folder = TempFolder::new("project-wrong");
    folder.run_successfully("new part");
    folder.create_control("data", |_| {});
    folder.edit("part/parameters.txt", "022 = 3800", "022 = 4000");
    folder.edit("part/pitch.txt", "007.X = 0", "007.X = 300");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z zero");
    let line = "pitch.txt:16: pitch error point 007: 300 is outside";
    folder.assert_refused("import part --data data", 2, line);
    folder.assert_refused(
        "import part --data data",
        2,
        "offsets.txt:7: write NAME = VALUE",
    );
    folder.assert_refused("import part --data data", 2, "problems: 2");
    folder.assert_refused("diff part --data data", 2, line);
    let (_, _, error) = folder.run_project("import part --data data --lang zh");
    assert!(
        error.contains("offsets.txt:7: 应写成 名称 = 数值"),
        "{error}"
    );
    folder.write("part/machine.ron", b"(\n  naem: \"x\",\n)");
    folder.assert_refused("import part --data data", 2, "machine.ron:2: ");
    folder.write("part/programs/O0001.job.ron", b"(stok: 1)");
    folder.assert_refused("import part --data data", 2, "programs/O0001.job.ron:1: ");
    folder.write("part/counters.txt", [0, 1, 2]);
    folder.assert_refused(
        "import part --data data",
        2,
        "counters.txt: this is a binary file",
    );
}

#[test]
fn single_sections_can_be_imported() {
    let folder = TempFolder::new("project-only");
    folder.run_successfully("new part");
    folder.create_control("data", |_| {});
    folder.edit("part/parameters.txt", "022 = 3800", "022 = 4000");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z = 5");
    folder.write("part/programs/O0002.CNC", b"O0002;\nM30;\n");
    let output =
        folder.run_successfully("import part --data data --only offsets,programs --dry-run");
    assert!(output.contains("values to write to data: 3"), "{output}");
    let output = folder.run_successfully("import part --data data --only offsets,programs");
    assert!(
        !output.contains("No.022") && output.contains("offset 001 Z"),
        "{output}"
    );
    let (code, output, _) =
        folder.run_project("diff part --data data --only parameters --format json");
    assert_eq!(code, 1);
    let rows: serde_json::Value = serde_json::from_str(&output).unwrap();
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
fn an_import_needs_the_rights_of_the_control_or_a_password() {
    let folder = TempFolder::new("project-rights");
    folder.run_successfully("new part");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z = 5");
    folder.write("part/programs/O9003.CNC", b"O9003;\nM99;\n");
    let data = folder.create_control("data", |setup| setup.memory.authority.log_off());
    let authority_file = || fs::read(data.join("authority.ron")).unwrap();
    let previous = authority_file();
    let message = "offset 001 Z: the operation level is too low";
    folder.assert_refused("import part --data data --only offsets", 1, message);
    folder.assert_refused(
        "import part --data data --only offsets --password 1",
        2,
        "no operation level",
    );
    folder.run_successfully("import part --data data --only offsets --password 1234");
    let message = "O9003: the operation level is too low";
    folder.assert_refused(
        "import part --data data --only programs --password 12345",
        1,
        message,
    );
    folder.run_successfully("import part --data data --only programs --password 123456");
    assert_eq!(authority_file(), previous, "nobody is logged on by it");
    folder.run_successfully("export out --data data");
    for (path, bytes) in folder.files() {
        if path.starts_with(folder.0.join("out")) {
            let text = String::from_utf8_lossy(&bytes);
            assert!(!text.contains("12345678"), "{path:?} holds a password");
        }
    }
}

#[test]
fn a_running_control_is_left_alone() {
    let folder = TempFolder::new("project-in-use");
    folder.run_successfully("new part");
    let path = folder.create_control("data", |_| {});
    let window = DataDir::open(&path).unwrap();
    for command in [
        "import part --data data",
        "export out --data data",
        "diff part --data data",
    ] {
        folder.assert_refused(command, 2, "is using the data directory");
    }
    drop(window);
    folder.run_successfully("export out --data data");
}

#[test]
fn other_folders_are_left_alone_and_an_unfinished_project_is_refused() {
    let folder = TempFolder::new("project-folders");
    folder.create_control("data", |setup| {
        setup.memory.programs.store("O0001;\nM30;\n").unwrap();
    });
    folder.write("notes/letter.txt", b"dear");
    folder.assert_refused("export notes --data data", 2, "contains other files");
    folder.assert_refused("export data --data data", 2, "contains other files");
    folder.assert_refused(
        "import notes --data data",
        2,
        "neither a project nor a data directory",
    );
    folder.assert_refused(
        "diff notes data",
        2,
        "neither a project nor a data directory",
    );
    folder.assert_refused("export out --data nowhere", 2, "not a data directory yet");
    folder.run_successfully("export out --data data");
    folder.assert_refused("new out", 2, "contains other files");
    // Other files of the owner in the folder stay.
    folder.write("out/README.md", b"mine");
    folder.write("out/.git/HEAD", b"ref");
    folder.write(
        "out/programs/O0001.job.ron",
        b"(stock: (form: Bar(diameter: 40), length: 90, overhang: 50))",
    );
    folder.write("out/programs/O0002.CNC", b"O0002;\nM30;\n");
    let output = folder.run_successfully("export out --data data");
    assert_eq!(output, "out: files written 0, removed 1\n");
    let names = folder.files();
    for (name, exists) in [
        ("out/README.md", true),
        ("out/.git/HEAD", true),
        ("out/programs/O0001.job.ron", true),
        ("out/programs/O0002.CNC", false),
    ] {
        assert_eq!(names.contains_key(&folder.0.join(name)), exists, "{name}");
    }
    folder.write("out/.gsk980td-unfinished", b"");
    folder.assert_refused("import out --data data", 2, "was interrupted");
    folder.run_successfully("export out --data data");
    folder.run_successfully("diff out data");
}

#[test]
fn a_machine_file_is_exported_and_compared() {
    let folder = TempFolder::new("project-machine");
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/machines");
    let machine = machines.join("small-flat-bed.ron");
    folder.run_successfully(&format!("new one --machine {}", machine.display()));
    assert_eq!(
        fs::read(folder.0.join("one/machine.ron")).unwrap(),
        fs::read(&machine).unwrap()
    );
    folder.run_successfully("new two");
    let (code, output, _) = folder.run_project("diff two one --only machine");
    assert_eq!(code, 1);
    assert!(output.contains("machine file: added"), "{output}");
    folder.run_successfully("import one --data data");
    assert_eq!(
        folder.run_successfully("diff one --data data"),
        "no differences\n"
    );
    folder.run_successfully("new ncb --model ncb08");
    folder.edit("ncb/model-parameters.txt", "017 = 15000", "017 = 9000");
    folder.run_successfully("import ncb --data data");
    assert!(folder.0.join("data/models/ncb08/parameters.ron").exists());
    assert_eq!(
        folder.run_successfully("diff ncb --data data --model ncb08"),
        "no differences\n"
    );
}

#[test]
fn damaged_files_of_the_memory_are_reported() {
    let folder = TempFolder::new("project-damaged");
    let data = folder.create_control("data", |_| {});
    for file in ["offsets.ron", "copies/offsets.ron"] {
        fs::write(data.join(file), "(1, 2").unwrap();
    }
    let (code, out, error) = folder.run_project("export out --data data");
    assert_eq!(code, 1, "{out}{error}");
    assert!(error.contains("offsets.ron"), "{error}");
}

/// A window whose operator is logged on but must not write parameters.
fn open_window() -> WindowBench {
    let mut setup = Setup::delivered().with_chuck();
    setup.memory.authority.log_off();
    assert!(setup.memory.authority.enter("1234"));
    setup.memory.programs.store("O0005;\nM30;\n").unwrap();
    WindowBench::with_setup(setup)
}

/// Draws frames until a text is shown.
#[track_caller]
fn wait_for_text(bench: &mut WindowBench, text: &str) {
    let is_shown = (0..1000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(1);
        let mut found = bench.harness.query_all_by_label_contains(text);
        found.next().is_some()
    });
    assert!(is_shown, "{text} is never seen");
}

#[track_caller]
fn click(bench: &mut WindowBench, name: &str) {
    bench.harness.get_by_label(name).click();
    bench.run(20);
    bench.run(20);
}

/// The project view lists differences from the running control, with check boxes.
#[test]
fn the_view_lists_differences_and_takes_over_the_checked_ones() {
    let folder = TempFolder::new("project-window");
    folder.run_successfully("new part");
    folder.edit("part/parameters.txt", "022 = 3800", "022 = 4000");
    folder.edit("part/offsets.txt", "001.Z = 0", "001.Z = 5");
    let mut bench = open_window();
    let context = bench.harness.ctx.clone();
    let part = folder.0.join("part");
    bench
        .harness
        .state_mut()
        .compare_project(&context, part.clone());
    wait_for_text(&mut bench, "No.022 X rapid speed");
    let nodes_with_counts = bench.harness.query_all_by_label_contains(" · ");
    let nodes_with_counts: Vec<String> = nodes_with_counts
        .filter_map(|it| it.accesskit_node().label())
        .collect();
    assert_eq!(
        nodes_with_counts,
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
    click(&mut bench, "none");
    assert!(bench.harness.state_mut().take_project_selection().is_none());
    // A node of the tree shows only its own differences and content.
    click(&mut bench, "Tool offsets · 1");
    assert!(bench.harness.query_by_label_contains("No.022").is_none());
    click(&mut bench, "Contents");
    assert!(bench.harness.query_by_label("001.Z").is_some());
    assert!(bench.harness.query_by_label("5 mm").is_some());
    click(&mut bench, "Differences: 1");
    click(&mut bench, "offset 001 Z: 0 → 5 mm");
    click(&mut bench, "Power off, write 1, power on");
    let selection = bench
        .harness
        .state_mut()
        .take_project_selection()
        .expect("chosen");
    assert_eq!(selection.folder, part);
    let labels: Vec<String> = selection
        .differences
        .iter()
        .map(|it| it.key.name())
        .collect();
    assert_eq!(labels, ["001.Z"]);
    // The application does the same while the control is off.
    let data = folder.create_control("data", |setup| {
        *setup = core::mem::take(setup).with_chuck();
        setup.memory.authority.log_off();
        assert!(setup.memory.authority.enter("1234"));
    });
    let takeover = ImportRequest {
        project_folder: &part,
        data_dir: &data,
        model: Some(gsk_core::model::ModelId::Gsk980td),
        rights: ImportRights::LoggedOn,
        dry_run: false,
    };
    let taken =
        project::import_project(&takeover, &|it| selection.contains(it)).expect("taken over");
    assert_eq!(taken.differences.len(), 1, "{taken:?}");
    assert!(taken.backup_folder.is_some());
    let (_, output, _) = folder.run_project("diff data part --only offsets");
    assert_eq!(output, "no differences\n");
    let (_, output, _) = folder.run_project("diff data part --only parameters");
    assert!(output.contains("No.022"), "{output}");
    let other_model = ImportRequest {
        model: Some(gsk_core::model::ModelId::Ncb08),
        ..takeover
    };
    let refused = project::import_project(&other_model, &|_| true).expect_err("another model");
    assert!(
        refused.to_string().contains("select this model first"),
        "{refused}"
    );
}

/// The other direction: values of the control or of another project are taken over into the
/// open project. The view asks before the project is lost, and saves it.
#[test]
fn the_view_takes_values_over_into_the_project_and_saves_it() {
    let folder = TempFolder::new("project-into");
    folder.run_successfully("new part");
    folder.run_successfully("new other");
    folder.edit("other/pitch.txt", "007.X = 0", "007.X = 12");
    folder.edit("other/ladder/main.il", "压力低报警", "油压低");
    let mut bench = open_window();
    let context = bench.harness.ctx.clone();
    let part = folder.0.join("part");
    let file = part.join("project.gpr");
    bench.harness.state_mut().open(&context, file.clone());
    wait_for_text(&mut bench, "O0005: removed");
    let click_nth = |bench: &mut WindowBench, index: usize, label: &str| {
        let found: Vec<_> = bench.harness.get_all_by_label(label).collect();
        found.get(index).expect("it is there").click();
        bench.run(20);
    };
    click_nth(&mut bench, 0, "the project");
    wait_for_text(&mut bench, "O0005: added");
    wait_for_text(&mut bench, "the control → the project");
    click(&mut bench, "none");
    click(&mut bench, "O0005: added, 2 lines");
    click(&mut bench, "Write 1 to the project");
    wait_for_text(&mut bench, "not saved");
    // A thread repeats the comparison.
    let is_gone = (0..1000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        bench.run(1);
        let mut found = bench.harness.query_all_by_label_contains("O0005: added");
        found.next().is_none()
    });
    assert!(is_gone, "what was taken in still differs");
    // The control takes over the files of the folder, not unsaved changes.
    let last = bench.harness.get_all_by_label("the control").count() - 1;
    click_nth(&mut bench, last, "the control");
    wait_for_text(&mut bench, "Power off, write");
    let button = bench.harness.get_by_label_contains("Power off, write");
    assert!(button.accesskit_node().is_disabled());
    // The view asks before it opens another project.
    let click_entry = |bench: &mut WindowBench, entry: &str| {
        click(bench, entry);
        bench.run(20);
    };
    click_entry(&mut bench, "Close");
    wait_for_text(&mut bench, "The project is not saved");
    // A key of the panel has the same name.
    let last = bench.harness.get_all_by_label("Cancel").count() - 1;
    click_nth(&mut bench, last, "Cancel");
    click(&mut bench, "Save");
    wait_for_text(&mut bench, "files written");
    assert!(part.join("programs/O0005.CNC").exists());
    let (_, output, _) = folder.run_project("diff other part");
    assert!(output.contains("O0005: added"), "{output}");
    // Closed and opened again, the view shows the files of the folder.
    click_entry(&mut bench, "Close");
    wait_for_text(&mut bench, "No project is open");
    bench.harness.state_mut().open(&context, file);
    wait_for_text(&mut bench, "Project: part");
}
