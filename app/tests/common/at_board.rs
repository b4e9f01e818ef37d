//! Runs commands at a virtual board whose settings are written.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test uses what it needs, and fails by panicking"
)]

use std::path::PathBuf;
use std::process::Command;

use crate::process::executable;
use crate::twin::TwinProcess;

/// Attempts of a test that may fail because the computer is too busy.
pub const ATTEMPTS: u32 = 20;

pub fn gsk_command(arguments: &[&str]) -> Command {
    let mut command = executable();
    command.args(arguments);
    command
}

/// A temporary folder with files and the machine file of the virtual board.
pub struct BoardFolder {
    path: PathBuf,
    firmware: &'static str,
}

impl BoardFolder {
    pub fn new(name: &str, firmware: &'static str, files: &[(&str, &str)]) -> Self {
        let name = format!("gsk980td-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        let print = ["link", "twin", "--firmware", firmware, "--print-machine"];
        let machine = gsk_command(&print).output().unwrap();
        std::fs::write(path.join("twin.ron"), machine.stdout).unwrap();
        for (name, text) in files {
            std::fs::write(path.join(name), text).unwrap();
        }
        Self { path, firmware }
    }

    pub fn path(&self, name: &str) -> String {
        self.path.join(name).display().to_string()
    }

    /// Starts a board and writes its settings, as its owner does first.
    pub fn start_board(&self) -> TwinProcess {
        let twin = TwinProcess::start(&["--firmware", self.firmware]);
        if self.firmware != "klipper" {
            let machine = self.path("twin.ron");
            let test = ["link", "test", &twin.port, "--write-settings", "--machine"];
            let gear = [machine.as_str(), "--param", "17=5", "--param", "18=5"];
            gsk_command(&[&test[..], &gear].concat()).output().unwrap();
        }
        twin
    }

    /// A command that runs at a board.
    pub fn command_at(&self, twin: &TwinProcess, arguments: &[&str]) -> Command {
        let mut command = gsk_command(arguments);
        command
            .args(["--link", &twin.port, "--machine", &self.path("twin.ron")])
            .args(["--data", &self.path("data")])
            .args(["--param", "17=5", "--param", "18=5", "--param", "11.2=1"]);
        command
    }

    /// The last comparison of commanded and counted pulses in the log.
    pub fn last_count(&self) -> String {
        let log = std::fs::read_to_string(self.path.join("data").join("link.log"));
        let log = log.unwrap_or_default();
        let mut lines = log.lines();
        let last = lines.rfind(|line| line.contains("commanded"));
        last.unwrap_or_default().to_owned()
    }
}

impl Drop for BoardFolder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.path);
    }
}
