//! A virtual board in a process of its own.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test uses what it needs, and fails by panicking"
)]

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// A board behind a pseudo terminal.
pub struct Twin {
    child: Child,
    said: Receiver<String>,
    /// Its port.
    pub port: String,
}

impl Twin {
    /// `gsk980td link twin` with these options.
    pub fn play(options: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_gsk980td"))
            .args(["link", "twin", "--seconds", "1800"])
            .args(options)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let port = lines.next().unwrap().unwrap();
        let (sender, said) = channel();
        std::thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                // The test may be over.
                let _ = sender.send(line);
            }
        });
        Self { child, said, port }
    }

    /// The next line it prints that has this in it, with the time in front taken away.
    pub fn says(&self, what: &str, longest: Duration) -> Option<String> {
        let end = Instant::now() + longest;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let line = self.said.recv_timeout(left).ok()?;
            let (_, line) = line.trim().split_once(' ').unwrap();
            if line.contains(what) {
                return Some(line.trim().to_owned());
            }
        }
    }

    /// What it has printed and was not read yet.
    pub fn has_said(&self) -> Vec<String> {
        self.said.try_iter().collect()
    }

    /// It is gone.
    pub fn unplug(&mut self) {
        // One that has ended cannot be ended again.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Twin {
    fn drop(&mut self) {
        self.unplug();
    }
}

/// Sends a process a signal by its name.
pub fn signal(name: &str, process: u32) {
    let sent = Command::new("kill")
        .args([format!("-{name}"), process.to_string()])
        .status()
        .unwrap();
    assert!(sent.success(), "{name} {process}");
}
