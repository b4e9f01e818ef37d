//! A virtual board in a separate process.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test uses what it needs, and fails by panicking"
)]

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// A virtual board at a pseudo terminal.
pub struct TwinProcess {
    child: Child,
    output: Receiver<String>,
    /// The path of its port.
    pub port: String,
}

impl TwinProcess {
    /// Starts `gsk980td link twin` with these options.
    pub fn start(options: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_gsk980td"))
            .args(["link", "twin", "--seconds", "1800"])
            .args(options)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let port = lines.next().unwrap().unwrap();
        let (sender, output) = channel();
        std::thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                // The test may have ended.
                let _ = sender.send(line);
            }
        });
        Self {
            child,
            output,
            port,
        }
    }

    /// Waits for the next printed line that contains `what`, and returns it without its time.
    pub fn wait_for_line(&self, what: &str, time_limit: Duration) -> Option<String> {
        let end = Instant::now() + time_limit;
        loop {
            let remaining = end.saturating_duration_since(Instant::now());
            let line = self.output.recv_timeout(remaining).ok()?;
            let (_, line) = line.trim().split_once(' ').unwrap();
            if line.contains(what) {
                return Some(line.trim().to_owned());
            }
        }
    }

    /// The lines that it has printed and that were not read yet.
    pub fn printed_lines(&self) -> Vec<String> {
        self.output.try_iter().collect()
    }

    /// Ends the process, as if the board were unplugged.
    pub fn unplug(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for TwinProcess {
    fn drop(&mut self) {
        self.unplug();
    }
}

/// Sends a signal, by its name, to a process.
pub fn send_signal(name: &str, process: u32) {
    let sent = Command::new("kill")
        .args([format!("-{name}"), process.to_string()])
        .status()
        .unwrap();
    assert!(sent.success(), "{name} {process}");
}
