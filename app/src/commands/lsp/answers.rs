//! Answers the requests of an editor.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use gsk_language::{
    CompletionKind, Position, ReadingContext, ReferenceTarget, Structure, Symbol, SymbolKind,
    TextDocument, complete, definition, folds, format, hover, lenses, references, renamable,
    rename, symbols, without_markup,
};
use gsk_messages::{Message, say};
use lsp_server::{ErrorCode, Request, Response};
use lsp_types::request::{
    CodeActionRequest, CodeLensRequest, Completion, DocumentHighlightRequest,
    DocumentSymbolRequest, FoldingRangeRequest, Formatting, GotoDefinition, HoverRequest,
    InlayHintRequest, PrepareRenameRequest, RangeFormatting, References, Rename, Request as _,
    SemanticTokensFullRequest, SemanticTokensRangeRequest, SignatureHelpRequest,
    WorkspaceSymbolRequest,
};
use lsp_types::{
    CodeLens, Command, CompletionItem, CompletionItemKind, CompletionTextEdit, DocumentHighlight,
    DocumentSymbol, Documentation, FoldingRange, InsertTextFormat, Location, MarkupContent,
    MarkupKind, PrepareRenameResponse, Range, TextDocumentPositionParams, TextEdit, Uri,
    WorkspaceEdit,
};

use super::actions;
use super::convert::{ColumnEncoding, path_to_uri};
use super::documents::OpenDocument;
use super::folder;
use super::hints;
use super::request::{
    RequestAnswer, RequestRefusal, document_position, find_document, parse_params, to_answer,
};
use super::server_state::ServerState;
use super::workspace;

/// The open document that a request names; `None` if it names none or the document is not
/// open.
pub fn document_of<'a>(
    desk: &'a mut ServerState,
    request: &Request,
) -> Option<&'a mut OpenDocument> {
    let uri = request.params.get("textDocument")?.get("uri")?.as_str()?;
    desk.documents.get_mut(uri)
}

/// Answers a request. The message, if any, is to be shown to the user.
pub fn answer(desk: &mut ServerState, request: Request) -> (Response, Option<Message>) {
    let id = request.id.clone();
    match dispatch_request(desk, request) {
        Ok((value, notice)) => (Response::new_ok(id, value), notice),
        Err(refusal) => {
            let language = desk.editor.reading.language;
            let (code, text) = match refusal {
                RequestRefusal::Params(text) => (ErrorCode::InvalidParams, text),
                RequestRefusal::NotOpen => {
                    (ErrorCode::InvalidParams, say::lsp_not_open().text(language))
                }
                RequestRefusal::Failed(message) => {
                    (ErrorCode::RequestFailed, message.text(language))
                }
                RequestRefusal::Method(method) => {
                    let text = say::lsp_no_method(method).text(language);
                    (ErrorCode::MethodNotFound, text)
                }
            };
            (Response::new_err(id, code as i32, text), None)
        }
    }
}

fn dispatch_request(desk: &mut ServerState, request: Request) -> RequestAnswer {
    match request.method.as_str() {
        HoverRequest::METHOD => on_hover(
            desk,
            &parse_params::<HoverRequest>(request)?.text_document_position_params,
        ),
        Completion::METHOD => on_completion(
            desk,
            &parse_params::<Completion>(request)?.text_document_position,
        ),
        GotoDefinition::METHOD => {
            let params = parse_params::<GotoDefinition>(request)?;
            on_definition(desk, &params.text_document_position_params)
        }
        References::METHOD => {
            let params = parse_params::<References>(request)?;
            let include_declaration = params.context.include_declaration;
            on_references(desk, &params.text_document_position, include_declaration)
        }
        DocumentHighlightRequest::METHOD => {
            let params = parse_params::<DocumentHighlightRequest>(request)?;
            on_highlight(desk, &params.text_document_position_params)
        }
        DocumentSymbolRequest::METHOD => {
            let params = parse_params::<DocumentSymbolRequest>(request)?;
            on_symbols(desk, &params.text_document.uri)
        }
        FoldingRangeRequest::METHOD => {
            let params = parse_params::<FoldingRangeRequest>(request)?;
            on_folds(desk, &params.text_document.uri)
        }
        Formatting::METHOD => {
            let params = parse_params::<Formatting>(request)?;
            on_format(desk, &params.text_document.uri, None)
        }
        RangeFormatting::METHOD => {
            let params = parse_params::<RangeFormatting>(request)?;
            on_format(desk, &params.text_document.uri, Some(params.range))
        }
        PrepareRenameRequest::METHOD => {
            on_prepare_rename(desk, &parse_params::<PrepareRenameRequest>(request)?)
        }
        Rename::METHOD => {
            let params = parse_params::<Rename>(request)?;
            on_rename(desk, &params.text_document_position, &params.new_name)
        }
        CodeActionRequest::METHOD => {
            actions::on_code_action(desk, &parse_params::<CodeActionRequest>(request)?)
        }
        SignatureHelpRequest::METHOD => {
            let params = parse_params::<SignatureHelpRequest>(request)?;
            hints::on_signature(desk, &params.text_document_position_params)
        }
        InlayHintRequest::METHOD => {
            hints::on_inlay_hints(desk, &parse_params::<InlayHintRequest>(request)?)
        }
        SemanticTokensFullRequest::METHOD => {
            let params = parse_params::<SemanticTokensFullRequest>(request)?;
            hints::on_tokens(desk, &params.text_document.uri, None)
        }
        SemanticTokensRangeRequest::METHOD => {
            let params = parse_params::<SemanticTokensRangeRequest>(request)?;
            let lines = params.range.start.line..params.range.end.line.saturating_add(1);
            hints::on_tokens(desk, &params.text_document.uri, Some(lines))
        }
        WorkspaceSymbolRequest::METHOD => {
            let params = parse_params::<WorkspaceSymbolRequest>(request)?;
            workspace::on_workspace_symbols(desk, &params.query)
        }
        CodeLensRequest::METHOD => {
            let params = parse_params::<CodeLensRequest>(request)?;
            let document = find_document(desk, &params.text_document.uri)?;
            to_answer(&code_lenses(
                document,
                desk.editor.encoding,
                desk.editor.reading,
            ))
        }
        _ => Err(RequestRefusal::Method(request.method)),
    }
}

/// Lists the programs in the folder of the document `uri`, by program number.
fn index_folder(
    desk: &mut ServerState,
    uri: &Uri,
) -> Result<BTreeMap<u16, PathBuf>, RequestRefusal> {
    let document = desk
        .documents
        .get(uri.as_str())
        .ok_or(RequestRefusal::NotOpen)?;
    Ok(match &document.path {
        Some(path) => desk.folders.index_for(path, desk.documents.values()),
        None => BTreeMap::new(),
    })
}

/// Wraps a text as Markdown, or as plain text if the editor cannot show Markdown.
fn to_markup(value: String, markdown: bool) -> MarkupContent {
    match markdown {
        true => MarkupContent {
            kind: MarkupKind::Markdown,
            value,
        },
        false => MarkupContent {
            kind: MarkupKind::PlainText,
            value: without_markup(&value),
        },
    }
}

fn on_hover(desk: &mut ServerState, params: &TextDocumentPositionParams) -> RequestAnswer {
    let index = index_folder(desk, &params.text_document.uri)?;
    let (document, position) = document_position(desk, params)?;
    let program = |number| {
        let path = index.get(&number)?;
        folder::read_text(path, desk.documents.values())
    };
    let (text, reader) = (&document.text, desk.editor.reading);
    let markdown = desk.editor.markdown.0;
    let found = hover(text, document.structure(), position, reader, &program);
    let found = found.map(|it| lsp_types::Hover {
        contents: lsp_types::HoverContents::Markup(to_markup(it.markdown, markdown)),
        range: Some(desk.editor.encoding.to_range(text, &it.range)),
    });
    to_answer(&found)
}

fn on_completion(desk: &mut ServerState, params: &TextDocumentPositionParams) -> RequestAnswer {
    let index = index_folder(desk, &params.text_document.uri)?;
    let (document, position) = document_position(desk, params)?;
    let editor = desk.editor;
    let programs: BTreeSet<u16> = index.into_keys().collect();
    let (text, structure) = (&document.text, document.structure());
    let found = complete(text, structure, position, editor.reading, &programs);
    let items = found.into_iter().enumerate().filter_map(|(order, it)| {
        let is_snippet = it.insert.contains("${");
        if is_snippet && !editor.snippets {
            return None;
        }
        let about = Some(it.about).filter(|about| !about.is_empty());
        Some(CompletionItem {
            label: it.label.clone(),
            kind: Some(match it.kind {
                CompletionKind::Code => CompletionItemKind::FUNCTION,
                CompletionKind::Letter => CompletionItemKind::FIELD,
                CompletionKind::Target => CompletionItemKind::REFERENCE,
                CompletionKind::Tool => CompletionItemKind::CONSTANT,
                CompletionKind::Statement => CompletionItemKind::KEYWORD,
                CompletionKind::Snippet => CompletionItemKind::SNIPPET,
            }),
            detail: Some(it.detail).filter(|detail| !detail.is_empty()),
            documentation: about.map(|about| match editor.markdown.1 {
                true => Documentation::MarkupContent(to_markup(about, true)),
                false => Documentation::String(without_markup(&about)),
            }),
            sort_text: Some(format!("{order:04}")),
            filter_text: Some(it.label),
            insert_text_format: is_snippet.then_some(InsertTextFormat::SNIPPET),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(
                editor.encoding.to_range(text, &it.range),
                it.insert,
            ))),
            ..CompletionItem::default()
        })
    });
    to_answer(&items.collect::<Vec<_>>())
}

fn on_definition(desk: &mut ServerState, params: &TextDocumentPositionParams) -> RequestAnswer {
    let index = index_folder(desk, &params.text_document.uri)?;
    let (document, position) = document_position(desk, params)?;
    let encoding = desk.editor.encoding;
    let targets = definition(document.structure(), position);
    let here = |range| {
        Location::new(
            document.uri.clone(),
            encoding.to_range(&document.text, range),
        )
    };
    let mut found: Vec<Location> = targets.blocks.iter().map(here).collect();
    let other = targets.program.and_then(|number| {
        let path = index.get(&number)?;
        let text = TextDocument::new(folder::read_text(path, desk.documents.values())?);
        let structure = Structure::read(&text);
        let mut parts = structure.parts.iter();
        let name = parts.find(|it| it.number == Some(number))?.name.clone();
        let range = name.map_or_else(Range::default, |it| encoding.to_range(&text, &it));
        Some(Location::new(find_uri(desk, path)?, range))
    });
    found.extend(other);
    to_answer(&found)
}

/// The URI of a file: the one that the editor uses if the file is open. `None` if the path has
/// none.
fn find_uri(desk: &ServerState, path: &std::path::Path) -> Option<Uri> {
    let mut open = desk.documents.values();
    let open = open.find(|document| document.path.as_deref() == Some(path));
    open.map(|document| document.uri.clone())
        .or_else(|| path_to_uri(path))
}

fn on_references(
    desk: &mut ServerState,
    params: &TextDocumentPositionParams,
    include_declaration: bool,
) -> RequestAnswer {
    let index = index_folder(desk, &params.text_document.uri)?;
    let (document, position) = document_position(desk, params)?;
    let encoding = desk.editor.encoding;
    let (here, program) = references(document.structure(), position, include_declaration);
    let own = document.uri.clone();
    let location = |range| Location::new(own.clone(), encoding.to_range(&document.text, range));
    let mut found: Vec<Location> = here.iter().map(location).collect();
    let others = program.into_iter().flat_map(|_| index.values());
    for path in others.collect::<BTreeSet<_>>() {
        let Some(number) = program else { break };
        let read = folder::read_text(path, desk.documents.values());
        let Some(text) = read.filter(|text| folder::is_small(text)) else {
            continue;
        };
        let text = TextDocument::new(text);
        let structure = Structure::read(&text);
        let calls = structure
            .references
            .iter()
            .filter(|it| it.target == ReferenceTarget::Program(number));
        let mut places: Vec<_> = calls.map(|it| it.digits.clone()).collect();
        let named = structure
            .parts
            .iter()
            .filter(|it| it.number == Some(number));
        places.extend(
            named
                .filter_map(|it| it.name.clone())
                .filter(|_| include_declaration),
        );
        if let Some(uri) = find_uri(desk, path) {
            let there = |range| Location::new(uri.clone(), encoding.to_range(&text, range));
            found.extend(places.iter().map(there));
        }
    }
    to_answer(&found)
}

fn on_highlight(desk: &ServerState, params: &TextDocumentPositionParams) -> RequestAnswer {
    let (document, position) = document_position(desk, params)?;
    let (places, _) = references(document.structure(), position, true);
    let highlights = places.iter().map(|range| DocumentHighlight {
        range: desk.editor.encoding.to_range(&document.text, range),
        kind: None,
    });
    to_answer(&highlights.collect::<Vec<_>>())
}

fn on_symbols(desk: &ServerState, uri: &Uri) -> RequestAnswer {
    let document = find_document(desk, uri)?;
    let found = symbols(
        &document.text,
        document.structure(),
        desk.editor.reading.model,
    );
    let encoding = desk.editor.encoding;
    let all = found
        .into_iter()
        .map(|it| to_document_symbol(&document.text, it, encoding));
    to_answer(&all.collect::<Vec<_>>())
}

#[expect(
    deprecated,
    reason = "the struct of the protocol has no other constructor"
)]
fn to_document_symbol(text: &TextDocument, it: Symbol, encoding: ColumnEncoding) -> DocumentSymbol {
    let selection_range = encoding.to_range(text, &it.range);
    let last = Position {
        line: it.last_line,
        byte: u32::MAX,
    };
    let first = Position {
        line: it.range.line,
        byte: 0,
    };
    let within = it.children.into_iter();
    let children: Vec<_> = within
        .map(|it| to_document_symbol(text, it, encoding))
        .collect();
    DocumentSymbol {
        name: it.name,
        detail: None,
        kind: match it.kind {
            SymbolKind::Program => lsp_types::SymbolKind::MODULE,
            SymbolKind::Tool => lsp_types::SymbolKind::OBJECT,
            SymbolKind::Block => lsp_types::SymbolKind::KEY,
            SymbolKind::Title => lsp_types::SymbolKind::STRING,
        },
        tags: None,
        deprecated: None,
        range: Range::new(
            encoding.to_editor(text, first),
            encoding.to_editor(text, last),
        ),
        selection_range,
        children: (!children.is_empty()).then_some(children),
    }
}

fn on_folds(desk: &ServerState, uri: &Uri) -> RequestAnswer {
    let document = find_document(desk, uri)?;
    let found = folds(&document.text, document.structure());
    let all = found
        .into_iter()
        .map(|(start_line, end_line)| FoldingRange {
            start_line,
            end_line,
            ..FoldingRange::default()
        });
    to_answer(&all.collect::<Vec<_>>())
}

fn on_format(desk: &ServerState, uri: &Uri, range: Option<Range>) -> RequestAnswer {
    let document = find_document(desk, uri)?;
    let text = &document.text;
    let lines = match range {
        None => 0..text.line_count(),
        Some(range) => range.start.line..range.end.line.saturating_add(1),
    };
    let outside = document.external_return_targets();
    let site = (&outside[..], desk.editor.reading.model);
    let done = format(text, document.structure(), desk.settings.style, lines, site);
    let encoding = desk.editor.encoding;
    let edits: Vec<TextEdit> = done
        .edits
        .iter()
        .map(|it| encoding.to_text_edit(text, it))
        .collect();
    let (value, _) = to_answer(&edits)?;
    Ok((value, done.refused))
}

fn on_prepare_rename(desk: &ServerState, params: &TextDocumentPositionParams) -> RequestAnswer {
    let (document, position) = document_position(desk, params)?;
    let range = renamable(document.structure(), position);
    let range = range.ok_or_else(|| RequestRefusal::Failed(say::rename_nothing()))?;
    let range = desk.editor.encoding.to_range(&document.text, &range);
    to_answer(&PrepareRenameResponse::Range(range))
}

#[expect(
    clippy::mutable_key_type,
    reason = "the map of the protocol; its keys are not changed"
)]
fn on_rename(desk: &ServerState, params: &TextDocumentPositionParams, name: &str) -> RequestAnswer {
    let (document, position) = document_position(desk, params)?;
    let outside = document.external_return_targets();
    let site = (&outside[..], desk.editor.reading.model);
    let edits = rename(&document.text, document.structure(), position, name, site);
    let edits = edits.map_err(RequestRefusal::Failed)?;
    let encoding = desk.editor.encoding;
    let edits = edits
        .iter()
        .map(|it| encoding.to_text_edit(&document.text, it))
        .collect();
    let changes = [(document.uri.clone(), edits)].into_iter().collect();
    to_answer(&WorkspaceEdit::new(changes))
}

/// Returns the code lenses of a document; empty before its first analysis.
pub fn code_lenses(
    document: &OpenDocument,
    encoding: ColumnEncoding,
    reader: ReadingContext,
) -> Vec<CodeLens> {
    let Some(analysis) = &document.analysis else {
        return Vec::new();
    };
    let found = lenses(document.structure(), analysis, reader.language);
    let all = found.into_iter().map(|it| CodeLens {
        range: encoding.to_range(&document.text, &it.range),
        command: Some(Command::new(it.text, String::new(), None)),
        data: None,
    });
    all.collect()
}
