//! The language server as an editor uses it: starts the program and exchanges messages on its
//! streams.

mod hints;

use std::io::{BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

use lsp_server::{Message, Notification, Request, RequestId};
use serde_json::{Value, json};

use crate::process::executable;

/// A stepped shaft with a profile, a cycle that names the profile's blocks, and a subprogram.
const MAIN: &str = "O0001 (轴)\nN10 T0101 M03 S800\nN20 G00 X62 Z2\nN30 G71 U2 R1\n\
                    N40 G71 P50 Q70 U0.5 W0.1 F150\nN50 G00 X20\nN60 G01 Z-30\nN70 X60\n\
                    N80 M98 P31\nN90 G00 X100 Z100\nN100 M30\n";
const SUB: &str = "O0031\nG01 U-1 F100\nM99\n";

/// An editor and its server.
struct LspEditor {
    server: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    folder: PathBuf,
    last_id: i32,
    /// Notifications that arrived while an answer was awaited.
    notifications: Vec<Notification>,
}

impl LspEditor {
    /// Starts a server with a temporary folder and the capabilities of the editor.
    fn start(name: &str, options: &[&str], capabilities: &Value) -> Self {
        let mut editor = Self::connect(name, options);
        let params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
        let result = editor.request("initialize", params).expect("initialize");
        assert_eq!(result["serverInfo"]["name"], "gsk980td");
        editor.notify("initialized", json!({}));
        editor
    }

    fn connect(name: &str, options: &[&str]) -> Self {
        let folder = format!("gsk980td-{}-lsp-{name}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        std::fs::create_dir_all(&folder).expect("folder");
        let mut server = executable()
            .arg("lsp")
            .args(options)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("server");
        let output = BufReader::new(server.stdout.take().expect("output"));
        Self {
            input: server.stdin.take(),
            server,
            output,
            folder,
            last_id: 0,
            notifications: Vec::new(),
        }
    }

    fn uri(&self, name: &str) -> String {
        let path = self.folder.join(name).display().to_string();
        let path = path.replace('\\', "/");
        format!(
            "file://{}{path}",
            if path.starts_with('/') { "" } else { "/" }
        )
    }

    fn send(&mut self, message: impl Into<Message>) {
        let input = self.input.as_mut().expect("input");
        message.into().write(input).expect("send");
    }

    fn notify(&mut self, method: &str, params: Value) {
        self.send(Notification::new(method.to_owned(), params));
    }

    fn send_request(&mut self, method: &str, params: Value) -> RequestId {
        self.last_id += 1;
        let id = RequestId::from(self.last_id);
        self.send(Request::new(id.clone(), method.to_owned(), params));
        id
    }

    /// Waits for the answer to a request: its result, or code and text of its error.
    fn wait_for_answer(&mut self, id: &RequestId) -> Result<Value, (i32, String)> {
        loop {
            match Message::read(&mut self.output)
                .expect("read")
                .expect("an answer")
            {
                Message::Response(it) if it.id == *id => {
                    return match it.response_result {
                        Ok(result) => Ok(result),
                        Err(error) => Err((error.code, error.message)),
                    };
                }
                Message::Notification(it) => self.notifications.push(it),
                other => panic!("{other:?}"),
            }
        }
    }

    fn request(&mut self, method: &str, params: Value) -> Result<Value, (i32, String)> {
        let id = self.send_request(method, params);
        self.wait_for_answer(&id)
    }

    fn open(&mut self, name: &str, text: &str) {
        let document = json!({
            "uri": self.uri(name), "languageId": "gsk980td", "version": 1, "text": text
        });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Waits for the diagnostics of a version of a document.
    fn wait_for_diagnostics(&mut self, name: &str, version: i32) -> Vec<Value> {
        let uri = self.uri(name);
        let is_wanted = |it: &Notification| {
            it.method == "textDocument/publishDiagnostics"
                && it.params["uri"] == uri
                && it.params["version"] == version
        };
        loop {
            if let Some(at) = self.notifications.iter().position(is_wanted) {
                let notification = self.notifications.remove(at);
                return notification.params["diagnostics"]
                    .as_array()
                    .cloned()
                    .expect("a list");
            }
            match Message::read(&mut self.output)
                .expect("read")
                .expect("a message")
            {
                Message::Notification(it) => self.notifications.push(it),
                other => panic!("{other:?}"),
            }
        }
    }

    fn position(&self, name: &str, line: u32, character: u32) -> Value {
        json!({
            "textDocument": { "uri": self.uri(name) },
            "position": { "line": line, "character": character },
        })
    }

    /// Ends the server as an editor does. Returns the exit code.
    fn shut_down(mut self) -> Option<i32> {
        self.request("shutdown", Value::Null).expect("shutdown");
        self.notify("exit", Value::Null);
        self.server.wait().expect("ended").code()
    }
}

impl Drop for LspEditor {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn utf8() -> Value {
    json!({ "general": { "positionEncodings": ["utf-16", "utf-8"] } })
}

#[test]
fn diagnostics_follow_the_typed_text() {
    let mut editor = LspEditor::start("typed", &["--lang", "en"], &json!({}));
    std::fs::write(editor.folder.join("O0031.CNC"), SUB).expect("subprogram");
    editor.open("main.CNC", MAIN);
    assert_eq!(
        editor.wait_for_diagnostics("main.CNC", 1),
        Vec::<Value>::new()
    );
    // An arc that is too small, after characters of three bytes in a comment.
    let range = |line: u32, from: u32, to: u32| {
        let at = |character| json!({ "line": line, "character": character });
        json!({ "start": at(from), "end": at(to) })
    };
    let change = |version: i32, range: Value, text: &str, uri: String| {
        json!({
            "textDocument": { "uri": uri, "version": version },
            "contentChanges": [{ "range": range, "text": text }],
        })
    };
    let uri = editor.uri("main.CNC");
    let insertion = change(2, range(9, 0, 0), "(圆弧) G01 X30. Y5\n", uri.clone());
    editor.notify("textDocument/didChange", insertion);
    let found = editor.wait_for_diagnostics("main.CNC", 2);
    assert_eq!(found[0]["code"], "009", "{found:?}");
    assert_eq!(found[0]["range"], range(9, 14, 16), "{found:?}");
    assert_eq!(
        (&found[0]["severity"], &found[0]["source"]),
        (&json!(1), &json!("gsk980td"))
    );
    let deletion = change(
        3,
        json!({
            "start": { "line": 9, "character": 0 }, "end": { "line": 10, "character": 0 }
        }),
        "",
        uri.clone(),
    );
    editor.notify("textDocument/didChange", deletion);
    assert!(editor.wait_for_diagnostics("main.CNC", 3).is_empty());
    // The text of an open subprogram has priority over the file.
    editor.open("O0031.CNC", "O0031\nG02 X90 Z-1 R1\nM99\n");
    let found = editor.wait_for_diagnostics("main.CNC", 3);
    assert_eq!(found[0]["range"]["start"]["line"], 8, "{found:?}");
    let related = &found[0]["relatedInformation"][0]["location"];
    assert_eq!(related["range"]["start"]["line"], 1, "{found:?}");
    assert!(
        related["uri"]
            .as_str()
            .is_some_and(|it| it.ends_with("/O0031.CNC"))
    );
    assert_eq!(editor.shut_down(), Some(0));
}

#[test]
fn a_mill_program_is_served_with_the_codes_of_the_mill() {
    let options = ["--model", "gsk980mdi", "--lang", "en"];
    let mut editor = LspEditor::start("mill", &options, &utf8());
    editor.open("cover.nc", "O0001\nT1 M06\nG90 G00 X0 Y0\nG83 \nG71\nM30\n");
    let found = editor.wait_for_diagnostics("cover.nc", 1);
    let codes: Vec<_> = found
        .iter()
        .map(|it| (&it["code"], &it["range"]["start"]["line"]))
        .collect();
    assert_eq!(codes, [(&json!("010"), &json!(4))], "{found:?}");
    let at = |line, character| {
        json!({
            "textDocument": { "uri": editor.uri("cover.nc") },
            "position": { "line": line, "character": character },
        })
    };
    let (on_code, after_it) = (at(3, 1), at(3, 4));
    let hover = editor
        .request("textDocument/hover", on_code)
        .expect("hover");
    assert!(hover.to_string().contains("peck"), "{hover}");
    let answer = editor.request("textDocument/completion", after_it);
    let proposed = answer.expect("completion").to_string();
    assert!(proposed.contains("Y: end point"), "{proposed}");
    assert_eq!(editor.shut_down(), Some(0));
}

#[test]
fn requests_about_a_word_are_answered() {
    let mut editor = LspEditor::start("asked", &["--lang", "en"], &utf8());
    std::fs::write(editor.folder.join("O0031.CNC"), SUB).expect("subprogram");
    editor.open("main.CNC", MAIN);
    let at = |editor: &LspEditor, line, column| editor.position("main.CNC", line, column);
    let lines = |found: &Value| -> Vec<u64> {
        let found = found.as_array().expect("a list").iter();
        found
            .filter_map(|it| it["range"]["start"]["line"].as_u64())
            .collect()
    };

    let hover = editor
        .request("textDocument/hover", at(&editor, 3, 5))
        .expect("hover");
    let text = hover["contents"]["value"].as_str().expect("text");
    assert!(text.contains("G71: roughing"), "{text}");

    let items = editor
        .request("textDocument/completion", at(&editor, 3, 5))
        .expect("items");
    let labels: Vec<_> = items
        .as_array()
        .expect("a list")
        .iter()
        .map(|it| &it["label"])
        .collect();
    assert!(labels.contains(&&json!("G71")), "{labels:?}");
    assert!(
        !labels.contains(&&json!("G71 …")),
        "an editor without snippets"
    );

    let position = at(&editor, 4, 9);
    let block = editor
        .request("textDocument/definition", position.clone())
        .expect("definition");
    assert_eq!(lines(&block), [5]);
    let call = editor
        .request("textDocument/definition", at(&editor, 8, 8))
        .expect("definition");
    assert!(
        call[0]["uri"]
            .as_str()
            .is_some_and(|it| it.ends_with("/O0031.CNC")),
        "{call}"
    );
    let mut with_declaration = position.clone();
    with_declaration["context"] = json!({ "includeDeclaration": true });
    let found = editor
        .request("textDocument/references", with_declaration)
        .expect("references");
    assert_eq!(lines(&found), [4, 5]);
    let found = editor
        .request("textDocument/documentHighlight", position.clone())
        .expect("highlight");
    assert_eq!(lines(&found), [4, 5]);

    let document = json!({ "textDocument": { "uri": editor.uri("main.CNC") } });
    let found = editor
        .request("textDocument/documentSymbol", document.clone())
        .expect("symbols");
    assert_eq!(found[0]["name"], "O0001 轴");
    let folds = editor
        .request("textDocument/foldingRange", document.clone())
        .expect("folds");
    assert!(
        folds
            .as_array()
            .is_some_and(|it| it.contains(&json!({ "startLine": 5, "endLine": 7 })))
    );
    let lenses = editor
        .request("textDocument/codeLens", document.clone())
        .expect("lenses");
    let titles: Vec<&str> = (lenses.as_array().expect("a list").iter())
        .filter_map(|it| it["command"]["title"].as_str())
        .collect();
    assert!(titles[0].contains("Z -29.9 to 300"), "{titles:?}");
    assert!(
        titles.iter().any(|it| it.contains("N50 to N70")),
        "{titles:?}"
    );

    let range = editor
        .request("textDocument/prepareRename", position.clone())
        .expect("rename");
    assert_eq!(range["start"], json!({ "line": 4, "character": 9 }));
    let mut rename = position.clone();
    rename["newName"] = json!("N55");
    let edit = editor
        .request("textDocument/rename", rename.clone())
        .expect("rename");
    let edits = edit["changes"][editor.uri("main.CNC")]
        .as_array()
        .cloned()
        .expect("edits");
    assert_eq!(edits.len(), 2, "{edits:?}");
    assert!(edits.iter().all(|it| it["newText"] == "55"));
    rename["newName"] = json!("N60");
    let refused = editor
        .request("textDocument/rename", rename)
        .expect_err("N60 is there");
    assert_eq!(
        refused,
        (-32803, "N60 exists already, in line 7".to_owned())
    );

    let settings =
        json!({ "settings": { "gsk980td": { "format": { "numbers": "present", "step": 5 } } } });
    editor.notify("workspace/didChangeConfiguration", settings);
    let mut formatting = document.clone();
    formatting["options"] = json!({ "tabSize": 4, "insertSpaces": true });
    let edits = editor
        .request("textDocument/formatting", formatting)
        .expect("edits");
    let texts: Vec<_> = edits
        .as_array()
        .expect("a list")
        .iter()
        .map(|it| &it["newText"])
        .collect();
    assert!(
        texts.contains(&&json!("N25 G71 P30 Q40 U0.5 W0.1 F150")),
        "{texts:?}"
    );
    assert_eq!(editor.shut_down(), Some(0));
}

#[test]
fn invalid_requests_are_refused_and_do_not_end_the_server() {
    let mut editor = LspEditor::connect("wrong", &["--lang", "en"]);
    let refused = editor
        .request("textDocument/hover", json!({}))
        .expect_err("before initialize");
    assert_eq!(refused.0, -32002);
    let refused = editor
        .request("initialize", json!({ "capabilities": 7 }))
        .expect_err("no capabilities");
    assert_eq!(refused.0, -32602);
    let params = json!({ "processId": null, "rootUri": null, "capabilities": {} });
    editor.request("initialize", params).expect("initialize");
    let refused = editor
        .request("textDocument/nothing", json!({}))
        .expect_err("no method");
    assert_eq!(refused.0, -32601);
    let refused = editor
        .request("textDocument/hover", json!({ "position": 3 }))
        .expect_err("params");
    assert_eq!(refused.0, -32602);
    let refused = editor
        .request("textDocument/hover", editor.position("none.CNC", 0, 0))
        .expect_err("closed");
    assert_eq!(refused, (-32602, "this document is not open".to_owned()));
    editor.notify("textDocument/didChange", json!({ "textDocument": 7 }));
    editor.notify("$/nothing", json!({}));
    editor.open("a.CNC", "");
    assert!(
        editor.wait_for_diagnostics("a.CNC", 1).is_empty(),
        "an empty text"
    );
    let beyond = editor.request(
        "textDocument/hover",
        editor.position("a.CNC", 4_000_000_000, 4_000_000_000),
    );
    assert_eq!(beyond, Ok(Value::Null));
    editor.request("shutdown", Value::Null).expect("shutdown");
    let refused = editor
        .request("textDocument/hover", editor.position("a.CNC", 0, 0))
        .expect_err("after shutdown");
    assert_eq!(refused.0, -32600);
    editor.notify("exit", Value::Null);
    assert_eq!(editor.server.wait().expect("ended").code(), Some(0));
}

#[test]
fn a_closed_stream_ends_the_server() {
    let mut editor = LspEditor::start("gone", &[], &json!({}));
    drop(editor.input.take());
    assert_eq!(editor.server.wait().expect("ended").code(), Some(1));
    let mut editor = LspEditor::start("broken", &[], &json!({}));
    let input = editor.input.as_mut().expect("input");
    input
        .write_all(b"Content-Length: 5\r\n\r\n{]{]{")
        .expect("write");
    input.flush().expect("flush");
    assert_eq!(editor.server.wait().expect("ended").code(), Some(2));
}

#[test]
fn pending_answers_end_when_the_text_changes() {
    let mut editor = LspEditor::start("waiting", &["--lang", "en"], &json!({}));
    // An endless loop keeps the preview busy.
    let endless = "M03 S500 T0101\nN1 G01 U1 F6000\nU-1\nG65 H80 P1\n";
    editor.open("endless.CNC", endless);
    let document = json!({ "textDocument": { "uri": editor.uri("endless.CNC") } });
    let first = editor.send_request("textDocument/codeLens", document.clone());
    editor.notify("$/cancelRequest", json!({ "id": 1 }));
    editor.notify("$/cancelRequest", json!({ "id": editor.last_id }));
    assert_eq!(
        editor.wait_for_answer(&first).map_err(|it| it.0),
        Err(-32800)
    );
    let second = editor.send_request("textDocument/codeLens", document.clone());
    let change = json!({
        "textDocument": { "uri": editor.uri("endless.CNC"), "version": 2 },
        "contentChanges": [{ "text": "G00 X20 Z2\nM30\n" }],
    });
    editor.notify("textDocument/didChange", change);
    assert_eq!(
        editor.wait_for_answer(&second).map_err(|it| it.0),
        Err(-32801)
    );
    editor.wait_for_diagnostics("endless.CNC", 2);
    let lenses = editor
        .request("textDocument/codeLens", document)
        .expect("lenses");
    assert_eq!(lenses.as_array().map(Vec::len), Some(1));
    assert_eq!(editor.shut_down(), Some(0));
}
