//! Messages of the Debug Adapter Protocol, as its published schema describes them.

use std::io::{self, Write};

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// A request that the client has sent.
#[derive(Debug, Deserialize)]
pub struct Request {
    pub seq: i64,
    #[serde(default)]
    pub command: String,
    #[serde(default)]
    pub arguments: Value,
}

impl Request {
    /// The arguments of the request; defaults for those that are missing.
    ///
    /// # Errors
    /// The text of what does not have the form of the schema.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, String> {
        let arguments = match &self.arguments {
            Value::Null => json!({}),
            arguments => arguments.clone(),
        };
        serde_json::from_value(arguments).map_err(|error| format!("{}: {error}", self.command))
    }
}

/// The file of a program, as the protocol describes it.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Source {
    pub path: String,
}

/// A breakpoint that the client asks for. A line breakpoint has a line, a function breakpoint a
/// name, a data breakpoint a data id.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct SourceBreakpoint {
    pub line: i64,
    pub name: String,
    pub data_id: String,
    pub condition: Option<String>,
}

/// Arguments of `setBreakpoints`, `setFunctionBreakpoints` and `setDataBreakpoints`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct BreakpointsArguments {
    pub source: Source,
    pub breakpoints: Vec<SourceBreakpoint>,
}

/// Arguments of `initialize`.
#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct InitializeArguments {
    #[serde(rename = "linesStartAt1")]
    pub lines_start_at_1: bool,
    pub locale: String,
}

impl Default for InitializeArguments {
    fn default() -> Self {
        Self {
            lines_start_at_1: true,
            locale: String::new(),
        }
    }
}

/// Arguments of `launch`.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct LaunchArguments {
    /// Path of the program to launch.
    pub program: String,
    /// Paths of further program files.
    pub subprograms: Vec<String>,
    pub stop_on_entry: bool,
    pub no_debug: bool,
    /// Whether the run cuts a part and reports collisions.
    pub part: bool,
    /// The step of the granularity `instruction`: `tick` or `slot`; empty is `tick`.
    pub instruction: String,
}

/// `variables`, `dataBreakpointInfo`, `evaluate`, and what requests for a step or a jump name.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct InquiryArguments {
    pub variables_reference: i64,
    pub name: String,
    pub expression: String,
    pub granularity: String,
    pub source: Source,
    pub line: i64,
    pub target_id: i64,
    pub filters: Vec<String>,
    pub start_frame: usize,
    pub levels: usize,
}

/// Writes messages of the adapter to the client.
pub struct ClientOutput<W> {
    output: W,
    seq: i64,
}

impl<W: Write> ClientOutput<W> {
    pub const fn new(output: W) -> Self {
        Self { output, seq: 0 }
    }

    pub fn send_event(&mut self, event: &str, body: Value) -> io::Result<()> {
        let mut message = json!({"type": "event", "event": event});
        message["body"] = body;
        self.send(message)
    }

    /// Answers a request: with its result, or with the text of its error.
    pub fn send_response(
        &mut self,
        request: &Request,
        result: Result<Value, String>,
    ) -> io::Result<()> {
        let mut message = json!({
            "type": "response",
            "request_seq": request.seq,
            "command": request.command,
            "success": result.is_ok(),
        });
        match result {
            Ok(Value::Null) => {}
            Ok(body) => message["body"] = body,
            Err(text) => {
                // A watch that cannot be evaluated shows its error itself.
                let is_shown = request.command != "evaluate";
                message["body"] = json!({"error": {"id": 1, "format": text, "showUser": is_shown}});
                message["message"] = text.into();
            }
        }
        self.send(message)
    }

    fn send(&mut self, mut message: Value) -> io::Result<()> {
        self.seq += 1;
        message["seq"] = self.seq.into();
        let text = message.to_string();
        write!(self.output, "Content-Length: {}\r\n\r\n{text}", text.len())?;
        self.output.flush()
    }
}
