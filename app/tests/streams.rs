//! A full or closed output stream does not end the program: edited data is saved, and the exit
//! code is that of the work.

use std::fs::File;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::process::executable;

/// Types a program, shows its page, and expects an alarm that is not raised.
const SCRIPT: &str = "press EDIT\npress PRG\ntype O1234\npress EOB\nshow\nexpect alarm 999\n";

struct StreamFolder(PathBuf);

impl StreamFolder {
    fn new(name: &str) -> Self {
        let name = format!("gsk980td-{}-streams-{name}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("script.txt"), SCRIPT).unwrap();
        Self(folder)
    }

    fn operate(&self) -> Command {
        let mut command = executable();
        command
            .arg("operate")
            .arg(self.0.join("script.txt"))
            .arg("--data")
            .arg(self.0.join("data"));
        command
    }

    fn has_program(&self) -> bool {
        let programs = std::fs::read_dir(self.0.join("data").join("programs")).unwrap();
        programs
            .flatten()
            .any(|entry| entry.file_name().to_string_lossy().contains("1234"))
    }
}

impl Drop for StreamFolder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn full_stream() -> Stdio {
    File::options()
        .write(true)
        .open("/dev/full")
        .unwrap()
        .into()
}

/// A pipe without a reader.
fn closed_stream() -> Stdio {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    writer.into()
}

#[test]
fn typed_data_is_saved_with_broken_streams() {
    type StreamPair = fn() -> (Stdio, Stdio);
    let cases: [(&str, StreamPair, i32); 4] = [
        ("full-error", || (Stdio::null(), full_stream()), 1),
        ("closed-error", || (Stdio::null(), closed_stream()), 1),
        ("closed-both", || (closed_stream(), closed_stream()), 1),
        // The requested output was not written: the exit code reports it.
        ("full-both", || (full_stream(), full_stream()), 2),
    ];
    for (name, streams, code) in cases {
        let folder = StreamFolder::new(name);
        let (out, error) = streams();
        let status = folder.operate().stdout(out).stderr(error).status().unwrap();
        assert_eq!(status.code(), Some(code), "{name}");
        assert!(folder.has_program(), "{name}: lost");
    }
}

#[test]
fn a_full_standard_output_is_reported() {
    let output = executable()
        .arg("keys")
        .stdout(full_stream())
        .stderr(Stdio::piped())
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("standard output cannot be written"),
        "{errors}"
    );
}

/// The run continues to its end, and its memory is saved.
#[test]
fn a_run_continues_after_its_explanation_pipe_is_closed() {
    let folder = StreamFolder::new("explained");
    let program = folder.0.join("part.CNC");
    std::fs::write(
        &program,
        "O0007\nG50 X60 Z20\nG00 X50 Z10\nG98 G01 Z5 F600\nM30\n",
    )
    .unwrap();
    for (out, code) in [(closed_stream(), 0), (full_stream(), 2)] {
        let status = executable()
            .arg("run")
            .arg(&program)
            .arg("--explain")
            .stdout(out)
            .stderr(Stdio::null())
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(code));
    }
}
