//! Output files never overwrite files that the command reads.

use std::fs;
use std::path::PathBuf;
use std::process::Stdio;

use crate::process::executable;

struct OverwriteFolder(PathBuf);

impl OverwriteFolder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let name = format!("gsk980td-{}-overwriting-{name}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        for (name, text) in files {
            fs::write(folder.join(name), text).unwrap();
        }
        Self(folder)
    }

    fn read(&self, name: &str) -> Option<Vec<u8>> {
        fs::read(self.0.join(name)).ok()
    }

    /// Runs a command in this folder. Returns exit code and standard error.
    fn run(&self, command: &str) -> (Option<i32>, String) {
        let output = executable()
            .args(command.split_whitespace())
            .current_dir(&self.0)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), error)
    }

    /// Asserts that the command fails with this code and message, and changes no file.
    #[track_caller]
    fn assert_refused(&self, command: &str, code: i32, message: &str) {
        let names = || {
            let mut names: Vec<_> = fs::read_dir(&self.0)
                .unwrap()
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect();
            names.sort();
            names
        };
        let files = || -> Vec<_> {
            let files = names().into_iter().map(|name| (self.read(&name), name));
            files.collect()
        };
        let files_before = files();
        let (actual_code, errors) = self.run(command);
        assert_eq!(actual_code, Some(code), "{command}: {errors}");
        assert!(errors.contains(message), "{command}: {errors}");
        assert!(files() == files_before, "{command}: a file is changed");
    }
}

impl Drop for OverwriteFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const READ: &str = "this command reads";

#[test]
fn named_input_files_are_not_overwritten() {
    let script = "press AUTO\n";
    let files = [("part.nc", "G00 X50 Z0\nM30\n"), ("script.txt", script)];
    let folder = OverwriteFolder::new("named", &files);
    folder.assert_refused("check part.nc --moves part.nc", 2, READ);
    folder.assert_refused("run part.nc --positions part.nc", 2, READ);
    folder.assert_refused("run --dnc part.nc --moves part.nc", 2, READ);
    folder.assert_refused("operate script.txt --record script.txt", 2, READ);
}

#[test]
fn subprograms_are_not_overwritten() {
    let files = [
        ("main.CNC", "O0001\nM98 P9001\nM98 P0005\nM30\n"),
        ("9001.CNC", "O9001\nG00 X10\nM99\n"),
        ("groove.txt", "O0005\nG00 X20\nM99\n"),
    ];
    let folder = OverwriteFolder::new("subprograms", &files);
    let number = "would be read as subprogram O9001 of main.CNC";
    for command in ["run", "check"] {
        folder.assert_refused(&format!("{command} main.CNC --moves 9001.CNC"), 2, number);
        let command_line = format!("{command} main.CNC --moves groove.txt");
        folder.assert_refused(&command_line, 2, "as subprogram O0005");
    }
    // The file does not exist yet, but the next run would read it.
    let new = "run main.CNC --positions O0007.nc";
    folder.assert_refused(new, 2, "as subprogram O0007");
    let (code, errors) = folder.run("run main.CNC --moves moves.txt");
    assert_eq!(code, Some(0), "{errors}");
    assert!(
        folder
            .read("moves.txt")
            .is_some_and(|moves| moves.len() > 100)
    );
}

#[test]
fn files_that_a_script_loads_are_not_overwritten() {
    let files = [
        ("part.png", "O0001\nG00 X10\nM30\n"),
        ("data.par", "%\n"),
        ("line.CNC", "O0002\nM30\n"),
        ("load.txt", "load part.png\nshot part.png\n"),
        ("receive.txt", "press EDIT\nreceive data.par\n"),
        ("dnc.txt", "dnc line.CNC\n"),
        ("shot.txt", "shot new.png\n"),
    ];
    let folder = OverwriteFolder::new("script", &files);
    folder.assert_refused("operate load.txt", 2, READ);
    folder.assert_refused("operate receive.txt --record data.par", 2, READ);
    folder.assert_refused("operate dnc.txt --record line.CNC", 2, READ);
    let twice = "two outputs go to the same file";
    folder.assert_refused("operate shot.txt --record new.png", 2, twice);
}

#[test]
fn a_picture_replaces_only_a_picture() {
    let files = [
        ("part.CNC", "O0001\nG00 X10\nM30\n"),
        ("text.png", "not to be lost\n"),
        ("name.txt", "shot part.CNC\n"),
        ("link.txt", "shot link.png\n"),
        ("text.txt", "shot text.png\n"),
        ("twice.txt", "shot new.png\nshot new.png\n"),
    ];
    let folder = OverwriteFolder::new("picture", &files);
    std::os::unix::fs::symlink("part.CNC", folder.0.join("link.png")).unwrap();
    let name = "the name of a picture must end in .png";
    folder.assert_refused("operate name.txt", 1, name);
    folder.assert_refused("operate link.txt", 1, name);
    folder.assert_refused("operate text.txt", 1, "exists and is not a picture");
    folder.assert_refused("screen pos-abs -o part.CNC", 2, name);
    folder.assert_refused(
        "plot part.CNC -o text.png",
        2,
        "exists and is not a picture",
    );
    let (code, errors) = folder.run("operate twice.txt");
    assert_eq!(code, Some(0), "{errors}");
    let picture = folder.read("new.png").unwrap();
    assert!(picture.starts_with(b"\x89PNG"));
}

#[test]
fn the_memory_is_not_overwritten() {
    let files = [("part.nc", "G00 X50 Z0\nM30\n")];
    let folder = OverwriteFolder::new("memory", &files);
    let (code, errors) = folder.run("run part.nc --data data");
    assert_eq!(code, Some(0), "{errors}");
    for file in ["offsets.ron", "copies/offsets.ron", "programs/O0001.CNC"] {
        let command = format!("run part.nc --data data --moves data/{file}");
        folder.assert_refused(&command, 2, "belongs to the memory in data");
    }
}
