//! The debug adapter as an editor uses it: starts the program and exchanges messages on its
//! streams.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use serde_json::{Value, json};

use crate::process::executable;

/// An editor and its adapter, with a temporary folder.
struct DapEditor {
    adapter: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    program: PathBuf,
    folder: PathBuf,
}

impl DapEditor {
    /// Launches a program with these options. It stops on entry.
    fn launch(name: &str, text: &str, options: &Value) -> Self {
        let folder = format!("gsk980td-{}-dap-{name}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        std::fs::create_dir_all(&folder).expect("folder");
        let program = folder.join("main.CNC");
        std::fs::write(&program, text).expect("program");
        let mut adapter = executable()
            .arg("dap")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("adapter");
        let output = BufReader::new(adapter.stdout.take().expect("output"));
        let mut editor = Self {
            input: adapter.stdin.take().expect("input"),
            adapter,
            output,
            program,
            folder,
        };
        editor.request("initialize", &json!({}));
        let mut launch = json!({"program": editor.program.display().to_string()});
        for (option, value) in options.as_object().expect("options") {
            launch[option] = value.clone();
        }
        editor.request("launch", &launch);
        editor
    }

    /// Reads the next message.
    fn read(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            self.output.read_line(&mut line).expect("a header");
            let line = line.trim();
            match line.strip_prefix("Content-Length: ") {
                Some(number) => length = number.parse().expect("a length"),
                None if line.is_empty() && length > 0 => break,
                None => panic!("{line}"),
            }
        }
        let mut body = vec![0; length];
        self.output.read_exact(&mut body).expect("a body");
        serde_json::from_slice(&body).expect("a message")
    }

    fn wait_for(&mut self, kind: &str, name: &str) -> Value {
        loop {
            let message = self.read();
            let key = if kind == "event" { "event" } else { "command" };
            if message["type"] == kind && message[key] == name {
                return message;
            }
        }
    }

    /// Sends a request and returns the body of its response.
    fn request(&mut self, command: &str, arguments: &Value) -> Value {
        let message = json!({
            "seq": 1,
            "type": "request",
            "command": command,
            "arguments": arguments,
        });
        let text = message.to_string();
        let header = format!("Content-Length: {}\r\n\r\n", text.len());
        self.input
            .write_all((header + &text).as_bytes())
            .expect("send");
        let response = self.wait_for("response", command);
        assert_eq!(response["success"], true, "{response}");
        response["body"].clone()
    }

    /// Sends a request that runs the program, and returns the reason of the next stop.
    fn run(&mut self, command: &str, arguments: &Value) -> String {
        self.request(command, arguments);
        let stopped = self.wait_for("event", "stopped");
        let reason = stopped["body"]["reason"].as_str();
        reason.expect("a reason").to_owned()
    }

    /// The lines of the call stack, the innermost first.
    fn lines(&mut self) -> Vec<i64> {
        let body = self.request("stackTrace", &json!({"threadId": 1}));
        let frames = body["stackFrames"].as_array().expect("frames");
        let path = self.program.display().to_string();
        assert!(frames.iter().all(|frame| frame["source"]["path"] == path));
        let lines = frames.iter().map(|frame| frame["line"].as_i64());
        lines.map(|line| line.expect("a line")).collect()
    }

    fn value(&mut self, expression: &str) -> String {
        let body = self.request("evaluate", &json!({"expression": expression}));
        body["result"].as_str().expect("a result").to_owned()
    }
}

impl Drop for DapEditor {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.adapter.kill();
        let _ = self.adapter.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

#[test]
fn an_entry_is_before_the_first_block_with_one_frame_there() {
    let text = "G00 X50 Z5\nG01 X40 F500\nX45\nM30\n";
    let mut editor = DapEditor::launch("entry", text, &json!({"stopOnEntry": true}));
    assert_eq!(editor.run("configurationDone", &json!({})), "entry");
    assert_eq!(editor.lines(), [1]);
    assert_eq!(editor.value("tick"), "0");
    assert_eq!(editor.run("next", &json!({})), "step");
    assert_eq!(editor.lines(), [2]);
    assert_eq!(editor.run("stepBack", &json!({})), "entry");
    assert_eq!(editor.lines(), [1]);
}

#[test]
fn a_slot_of_the_ladder_back_is_the_state_of_before() {
    let text = "G00 X50 Z5\nG01 X40 F500\nX45\nM30\n";
    let options = json!({"stopOnEntry": true, "instruction": "slot"});
    let mut editor = DapEditor::launch("slot", text, &options);
    editor.run("configurationDone", &json!({}));
    for _ in 0..2 {
        editor.run("next", &json!({}));
    }
    let slot = json!({"granularity": "instruction"});
    let mut states = Vec::new();
    for _ in 0..4 {
        assert_eq!(editor.run("next", &slot), "step");
        states.push((editor.value("tick"), editor.value("XM")));
    }
    for state in states.iter().rev().skip(1) {
        assert_eq!(editor.run("stepBack", &slot), "step");
        assert_eq!((editor.value("tick"), editor.value("XM")), *state);
    }
}
