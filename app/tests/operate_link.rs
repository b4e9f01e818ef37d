//! `operate --link`: a script moves a board without a window.

use std::process::{Command, Stdio};
use std::time::Duration;

use crate::at_board::{ATTEMPTS, Folder};
use crate::twin::{Twin, signal};

const LONGEST: Duration = Duration::from_secs(120);
const RETURN: &str = "press RESET\npress ZRN\npress XP\nwait 20s\npress ZP\nwait 20s\n\
    expect alarm none\n";
const PROGRAM: &str = "O0007\nG50 X60 Z20\nG98 G00 X50 Z10\nG01 Z5 F600\nM30\n";

fn folder(name: &str, script: &str) -> Folder {
    let files = [("part.CNC", PROGRAM), ("script.txt", script)];
    Folder::new(name, "grbl", &files)
}

fn operate(folder: &Folder, twin: &Twin) -> Command {
    folder.at(twin, &["operate", &folder.path("script.txt")])
}

pub fn a_script_makes_a_part_at_a_board_and_its_count_is_in_the_log() {
    let script = format!(
        "{RETURN}load part.CNC\npress AUTO\npress CS\nwait idle 60s\n\
        expect alarm none\nshow\n"
    );
    let folder = folder("operate-part", &script);
    let mut said = String::new();
    let made = (0..ATTEMPTS).any(|_| {
        let twin = folder.board();
        let output = operate(&folder, &twin).output().unwrap();
        said = String::from_utf8_lossy(&output.stderr).into_owned();
        let moved = twin.has_said().iter().any(|line| line.contains("Run"));
        output.status.code() == Some(0) && moved
    });
    assert!(made, "{said}");
    let line = folder.last_count();
    assert!(line.ends_with("agrees"), "{line}");
}

pub fn settings_that_differ_are_no_board_to_work_with() {
    let folder = folder("operate-differs", RETURN);
    let twin = Twin::play(&[]);
    let output = operate(&folder, &twin).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("603") && said.contains("--write-settings"),
        "{said}"
    );
    let lines = twin.has_said();
    assert!(!lines.iter().any(|line| line.contains("Run")), "{lines:?}");
}

pub fn ctrl_c_stops_the_board_in_motion_and_saves() {
    let folder = folder("operate-ends", "press RESET\npress JOG\nhold ZM 60s\n");
    let ended = (0..ATTEMPTS).any(|_| {
        let twin = folder.board();
        let mut operate = operate(&folder, &twin);
        let mut operate = operate.stderr(Stdio::null()).spawn().unwrap();
        let moved = twin.says("Run", Duration::from_secs(20)).is_some();
        if !moved {
            operate.kill().unwrap();
            operate.wait().unwrap();
            return false;
        }
        signal("INT", operate.id());
        // The link resets the board by Ctrl-X, moving or not. The computer may have been too
        // busy to continue.
        let stopped = twin.says("reset", LONGEST);
        assert!(stopped.is_some(), "not stopped");
        assert_eq!(operate.wait().unwrap().code(), Some(130));
        true
    });
    assert!(ended);
}
