//! Quick fixes, signatures, tokens, modal codes and symbols of the folder.

use serde_json::{Value, json};

use super::{LspEditor, SUB};

/// A program with a word without effect, a short dwell and a code of other controls.
const FAULTY: &str = "O0001\nN10 M03 S500 T0101\nN20 G21 G00 X40 Z2\nN30 M98 P0031 L3\n\
                      N40 G04 P5\nN50 M30\n";

fn capabilities() -> Value {
    json!({
        "general": { "positionEncodings": ["utf-8"] },
        "textDocument": {
            "codeAction": {
                "codeActionLiteralSupport": { "codeActionKind": { "valueSet": ["quickfix"] } },
            },
            "publishDiagnostics": { "tagSupport": { "valueSet": [1, 2] } },
        },
    })
}

fn range(from: (u32, u32), to: (u32, u32)) -> Value {
    let at = |(line, character)| json!({ "line": line, "character": character });
    json!({ "start": at(from), "end": at(to) })
}

/// Applies the first offered action at a line, and returns its title.
fn apply_action(editor: &mut LspEditor, version: i32, line: u32) -> String {
    let params = json!({
        "textDocument": { "uri": editor.uri("main.CNC") },
        "range": range((line, 0), (line, 30)),
        "context": { "diagnostics": [] },
    });
    let actions = editor.request("textDocument/codeAction", params);
    let actions = actions.expect("actions");
    let action = &actions[0];
    assert_eq!(action["kind"], "quickfix", "{actions}");
    let uri = editor.uri("main.CNC");
    let mut edits = action["edit"]["changes"][&uri]
        .as_array()
        .cloned()
        .expect("edits");
    // Changes of a notification follow each other: from the end of the text.
    edits.sort_by_key(|it| {
        let start = &it["range"]["start"];
        (start["line"].as_u64(), start["character"].as_u64())
    });
    let changes: Vec<Value> = (edits.iter().rev())
        .map(|it| json!({ "range": it["range"], "text": it["newText"] }))
        .collect();
    let change = json!({
        "textDocument": { "uri": uri, "version": version },
        "contentChanges": changes,
    });
    editor.notify("textDocument/didChange", change);
    action["title"].as_str().unwrap_or_default().to_owned()
}

#[test]
fn quick_fixes_correct_a_program() {
    let mut editor = LspEditor::start("fixes", &["--lang", "en"], &capabilities());
    std::fs::write(editor.folder.join("O0031.CNC"), SUB).expect("subprogram");
    editor.open("main.CNC", FAULTY);
    let found = editor.wait_for_diagnostics("main.CNC", 1);
    let codes: Vec<&Value> = found.iter().map(|it| &it["code"]).collect();
    let expected = ["010", "ignored-word", "short-dwell", "foreign-program"];
    assert_eq!(codes, expected, "{found:?}");
    assert_eq!(apply_action(&mut editor, 2, 2), "Delete G21");
    let found = editor.wait_for_diagnostics("main.CNC", 2);
    let codes: Vec<&Value> = found.iter().map(|it| &it["code"]).collect();
    let expected = ["ignored-word", "short-dwell", "foreign-program"];
    assert_eq!(codes, expected, "L of M98 is foreign: {found:?}");
    assert_eq!(found[0]["tags"], json!([1]), "text without effect is faded");
    assert_eq!(apply_action(&mut editor, 3, 3), "Write P30031");
    assert_eq!(editor.wait_for_diagnostics("main.CNC", 3).len(), 1);
    assert_eq!(apply_action(&mut editor, 4, 4), "Write P5000");
    assert!(editor.wait_for_diagnostics("main.CNC", 4).is_empty());
    assert_eq!(editor.shut_down(), Some(0));
}

#[test]
fn a_program_of_another_control_is_ported_by_an_action() {
    let mut editor = LspEditor::start("port", &["--lang", "en"], &capabilities());
    let text = "O0001\nG99 M03 S500 T0101\nG00 X52. Z2.\nG71 P10 Q20 U0.4 W0.1 D2000 F0.2\n\
                N10 G00 X30.\nG01 Z-20.\nN20 X50.\nG00 X90. Z50.\nM30\n";
    editor.open("main.CNC", text);
    let found = editor.wait_for_diagnostics("main.CNC", 1);
    let foreign = found.iter().find(|it| it["code"] == "foreign-program");
    let foreign = foreign.unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!(foreign["range"]["start"]["line"], 3, "{foreign}");
    let params = json!({
        "textDocument": { "uri": editor.uri("main.CNC") },
        "range": range((3, 0), (3, 5)),
        "context": { "diagnostics": [] },
    });
    let actions = editor
        .request("textDocument/codeAction", params)
        .expect("actions");
    let port = actions.as_array().and_then(|all| {
        let is_port = |it: &&Value| {
            it["title"]
                .as_str()
                .is_some_and(|it| it.starts_with("Port"))
        };
        all.iter().find(is_port)
    });
    let port = port.unwrap_or_else(|| panic!("{actions}"));
    let edit = &port["edit"]["changes"][editor.uri("main.CNC")][0];
    assert_eq!(edit["range"]["start"], json!({ "line": 0, "character": 0 }));
    let ported = edit["newText"].as_str().expect("a text");
    assert!(
        ported.contains("G71 U2. R0.5\nG71 P10 Q20 U0.4 W0.1 F0.2"),
        "{ported}"
    );
    let change = json!({
        "textDocument": { "uri": editor.uri("main.CNC"), "version": 2 },
        "contentChanges": [{ "text": ported }],
    });
    editor.notify("textDocument/didChange", change);
    let found = editor.wait_for_diagnostics("main.CNC", 2);
    let is_foreign = |it: &Value| it["code"] == "foreign-program";
    assert!(!found.iter().any(is_foreign), "{found:?}");
    assert_eq!(editor.shut_down(), Some(0));
}

#[test]
fn an_editor_without_actions_is_offered_none() {
    let mut editor = LspEditor::connect("plain", &["--lang", "en"]);
    let params = json!({ "processId": null, "rootUri": null, "capabilities": {} });
    let result = editor.request("initialize", params).expect("initialize");
    let provided = &result["capabilities"];
    assert!(provided.get("codeActionProvider").is_none(), "{provided}");
    assert_eq!(
        provided["semanticTokensProvider"]["range"], true,
        "{provided}"
    );
}

#[test]
fn words_are_explained_where_they_are() {
    let mut editor = LspEditor::start("words", &["--lang", "en"], &capabilities());
    std::fs::write(editor.folder.join("O0031.CNC"), SUB).expect("subprogram");
    let text = "O0001 (shaft)\n(ROUGHING)\nN10 G99 G00 X40 Z2 M03 S500 T0101\nX42\n\
                N20 G71 U2 R1\nN30 G71 P40 Q50 U0.5 W0 F0.2\nN40 G00 X20\nN50 G01 Z-9\nN60 M30\n";
    editor.open("main.CNC", text);
    assert!(editor.wait_for_diagnostics("main.CNC", 1).is_empty());
    let at = editor.position("main.CNC", 5, 20);
    let help = editor
        .request("textDocument/signatureHelp", at)
        .expect("help");
    assert_eq!(
        (&help["activeSignature"], &help["activeParameter"]),
        (&json!(1), &json!(2))
    );
    let signature = &help["signatures"][1];
    assert_eq!(signature["label"], "G71 P Q U W F S T");
    assert_eq!(signature["parameters"][2]["label"], json!([8, 9]));
    let document = json!({ "uri": editor.uri("main.CNC") });
    let lines = range((3, 0), (3, 3));
    let params = json!({ "textDocument": document, "range": lines });
    let tokens = editor.request("textDocument/semanticTokens/range", params.clone());
    // Line 3, the word X42: a property that is rapid.
    assert_eq!(tokens.expect("tokens")["data"], json!([3, 0, 3, 4, 1]));
    let all = json!({ "textDocument": document });
    let tokens = editor
        .request("textDocument/semanticTokens/full", all)
        .expect("tokens");
    assert_eq!(tokens["data"].as_array().map(|it| it.len() % 5), Some(0));
    let hints = editor.request("textDocument/inlayHint", params.clone());
    assert_eq!(hints, Ok(json!([])), "hints are off");
    let settings = json!({ "settings": { "gsk980td": { "hints": { "modal": true } } } });
    editor.notify("workspace/didChangeConfiguration", settings);
    let hints = editor
        .request("textDocument/inlayHint", params)
        .expect("hints");
    assert_eq!(hints[0]["label"], "G00");
    let symbols = editor
        .request("workspace/symbol", json!({ "query": "" }))
        .expect("symbols");
    let names: Vec<&str> = (symbols.as_array().expect("a list").iter())
        .filter_map(|it| it["name"].as_str())
        .collect();
    assert_eq!(names, ["O0001 shaft", "N10 ROUGHING", "O0031"]);
    let found = editor
        .request("workspace/symbol", json!({ "query": "rough" }))
        .expect("symbols");
    assert_eq!(found.as_array().map(Vec::len), Some(1));
    assert_eq!(editor.shut_down(), Some(0));
}
