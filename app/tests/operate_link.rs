//! `operate --link`: a script moves a board without a window.

use std::process::{Command, Stdio};
use std::time::Duration;

use crate::at_board::{ATTEMPTS, BoardFolder};
use crate::twin::{TwinProcess, send_signal};

const TIME_LIMIT: Duration = Duration::from_secs(120);
const RETURN: &str = "press RESET\npress ZRN\npress XP\nwait 20s\npress ZP\nwait 20s\n\
    expect alarm none\n";
const PROGRAM: &str = "O0007\nG50 X60 Z20\nG98 G00 X50 Z10\nG01 Z5 F600\nM30\n";

fn script_folder(name: &str, script: &str) -> BoardFolder {
    let files = [("part.CNC", PROGRAM), ("script.txt", script)];
    BoardFolder::new(name, "grbl", &files)
}

fn operate_command(folder: &BoardFolder, twin: &TwinProcess) -> Command {
    folder.command_at(twin, &["operate", &folder.path("script.txt")])
}

pub fn a_script_makes_a_part_and_the_pulses_are_logged() {
    let script = format!(
        "{RETURN}load part.CNC\npress AUTO\npress CS\nwait idle 60s\n\
        expect alarm none\nshow\n"
    );
    let folder = script_folder("operate-part", &script);
    let mut errors = String::new();
    let is_made = (0..ATTEMPTS).any(|_| {
        let twin = folder.start_board();
        let output = operate_command(&folder, &twin).output().unwrap();
        errors = String::from_utf8_lossy(&output.stderr).into_owned();
        let has_moved = twin.printed_lines().iter().any(|line| line.contains("Run"));
        output.status.code() == Some(0) && has_moved
    });
    assert!(is_made, "{errors}");
    let line = folder.last_count();
    assert!(line.ends_with("agrees"), "{line}");
}

pub fn a_board_with_different_settings_is_refused() {
    let folder = script_folder("operate-differs", RETURN);
    let twin = TwinProcess::start(&[]);
    let output = operate_command(&folder, &twin).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(
        errors.contains("603") && errors.contains("--write-settings"),
        "{errors}"
    );
    let lines = twin.printed_lines();
    assert!(!lines.iter().any(|line| line.contains("Run")), "{lines:?}");
}

pub fn ctrl_c_stops_the_board_in_motion_and_saves() {
    let folder = script_folder("operate-ends", "press RESET\npress JOG\nhold ZM 60s\n");
    let is_stopped = (0..ATTEMPTS).any(|_| {
        let twin = folder.start_board();
        let mut operate = operate_command(&folder, &twin);
        let mut operate = operate.stderr(Stdio::null()).spawn().unwrap();
        let has_moved = twin.wait_for_line("Run", Duration::from_secs(20)).is_some();
        if !has_moved {
            operate.kill().unwrap();
            operate.wait().unwrap();
            return false;
        }
        send_signal("INT", operate.id());
        // The link resets the board by Ctrl-X, moving or not. The computer may have been too
        // busy to continue.
        let reset_line = twin.wait_for_line("reset", TIME_LIMIT);
        assert!(reset_line.is_some(), "not stopped");
        assert_eq!(operate.wait().unwrap().code(), Some(130));
        true
    });
    assert!(is_stopped);
}
