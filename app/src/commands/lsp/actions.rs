//! Answers code actions: the quick fixes of the findings at the cursor.

use gsk_language::QuickFix;
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, CodeActionParams, Range, Uri, WorkspaceEdit,
};

use super::convert::ColumnEncoding;
use super::diagnostics::{is_finding_in_text, to_diagnostic};
use super::documents::OpenDocument;
use super::request::{RequestAnswer, find_document, to_answer};
use super::server_state::ServerState;

pub fn on_code_action(desk: &ServerState, params: &CodeActionParams) -> RequestAnswer {
    let document = find_document(desk, &params.text_document.uri)?;
    let wants_fixes = params.context.only.as_ref().is_none_or(|kinds| {
        let is_wanted = |kind: &CodeActionKind| {
            *kind == CodeActionKind::QUICKFIX || *kind == CodeActionKind::EMPTY
        };
        kinds.iter().any(is_wanted)
    });
    let analysis = document.analysis.as_ref().filter(|_| wants_fixes);
    let mut actions = Vec::new();
    for finding in analysis.iter().flat_map(|it| &it.findings) {
        if finding.fixes.is_empty() || !is_finding_in_text(document, finding) {
            continue;
        }
        let diagnostic = to_diagnostic(document, finding, &desk.editor);
        if !overlap(diagnostic.range, params.range) {
            continue;
        }
        let is_only = finding.fixes.len() == 1;
        actions.extend(finding.fixes.iter().map(|fix| {
            CodeActionOrCommand::CodeAction(CodeAction {
                title: fix.title.clone(),
                kind: Some(CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![diagnostic.clone()]),
                edit: Some(workspace_edit(document, fix, desk.editor.encoding)),
                is_preferred: Some(is_only),
                ..CodeAction::default()
            })
        }));
    }
    to_answer(&actions)
}

fn overlap(one: Range, other: Range) -> bool {
    one.start <= other.end && other.start <= one.end
}

fn workspace_edit(
    document: &OpenDocument,
    fix: &QuickFix,
    encoding: ColumnEncoding,
) -> WorkspaceEdit {
    let edits = fix.changes.iter();
    let edits = edits
        .map(|it| encoding.to_text_edit(&document.text, it))
        .collect();
    let uri: Uri = document.uri.clone();
    WorkspaceEdit::new([(uri, edits)].into_iter().collect())
}
