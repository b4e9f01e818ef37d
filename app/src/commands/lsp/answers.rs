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
    CodeLensRequest, Completion, DocumentHighlightRequest, DocumentSymbolRequest,
    FoldingRangeRequest, Formatting, GotoDefinition, HoverRequest, PrepareRenameRequest,
    RangeFormatting, References, Rename, Request as _,
};
use lsp_types::{
    CodeLens, Command, CompletionItem, CompletionItemKind, CompletionTextEdit, DocumentHighlight,
    DocumentSymbol, Documentation, FoldingRange, InsertTextFormat, Location, MarkupContent,
    MarkupKind, PrepareRenameResponse, Range, TextDocumentPositionParams, TextEdit, Uri,
    WorkspaceEdit,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::convert::{Encoding, uri_of};
use super::desk::Desk;
use super::documents::Document;
use super::folder;

/// The result of a request, with a notice for the user.
type Answer = Result<(Value, Option<Message>), Refusal>;

/// Why a request is refused.
enum Refusal {
    /// The parameters do not fit the method.
    Params(String),
    NotOpen,
    /// The operation would change the meaning of the program, or does not apply at the
    /// position.
    Failed(Message),
    /// The server does not know the method.
    Method(String),
}

/// The open document that a request names, if any.
pub fn document_of<'a>(desk: &'a mut Desk, request: &Request) -> Option<&'a mut Document> {
    let uri = request.params.get("textDocument")?.get("uri")?.as_str()?;
    desk.open.get_mut(uri)
}

/// Answers a request. The message, if any, is shown to the user.
pub fn answer(desk: &mut Desk, request: Request) -> (Response, Option<Message>) {
    let id = request.id.clone();
    match answered(desk, request) {
        Ok((value, notice)) => (Response::new_ok(id, value), notice),
        Err(refusal) => {
            let language = desk.editor.reader.language;
            let (code, text) = match refusal {
                Refusal::Params(text) => (ErrorCode::InvalidParams, text),
                Refusal::NotOpen => (ErrorCode::InvalidParams, say::lsp_not_open().text(language)),
                Refusal::Failed(message) => (ErrorCode::RequestFailed, message.text(language)),
                Refusal::Method(method) => {
                    let said = say::lsp_no_method(method).text(language);
                    (ErrorCode::MethodNotFound, said)
                }
            };
            (Response::new_err(id, code as i32, text), None)
        }
    }
}

fn answered(desk: &mut Desk, request: Request) -> Answer {
    match request.method.as_str() {
        HoverRequest::METHOD => on_hover(
            desk,
            &read::<HoverRequest>(request)?.text_document_position_params,
        ),
        Completion::METHOD => {
            on_completion(desk, &read::<Completion>(request)?.text_document_position)
        }
        GotoDefinition::METHOD => {
            let params = read::<GotoDefinition>(request)?;
            on_definition(desk, &params.text_document_position_params)
        }
        References::METHOD => {
            let params = read::<References>(request)?;
            let itself = params.context.include_declaration;
            on_references(desk, &params.text_document_position, itself)
        }
        DocumentHighlightRequest::METHOD => {
            let params = read::<DocumentHighlightRequest>(request)?;
            on_highlight(desk, &params.text_document_position_params)
        }
        DocumentSymbolRequest::METHOD => {
            let params = read::<DocumentSymbolRequest>(request)?;
            on_symbols(desk, &params.text_document.uri)
        }
        FoldingRangeRequest::METHOD => {
            let params = read::<FoldingRangeRequest>(request)?;
            on_folds(desk, &params.text_document.uri)
        }
        Formatting::METHOD => {
            let params = read::<Formatting>(request)?;
            on_format(desk, &params.text_document.uri, None)
        }
        RangeFormatting::METHOD => {
            let params = read::<RangeFormatting>(request)?;
            on_format(desk, &params.text_document.uri, Some(params.range))
        }
        PrepareRenameRequest::METHOD => {
            on_prepare_rename(desk, &read::<PrepareRenameRequest>(request)?)
        }
        Rename::METHOD => {
            let params = read::<Rename>(request)?;
            on_rename(desk, &params.text_document_position, &params.new_name)
        }
        CodeLensRequest::METHOD => {
            let params = read::<CodeLensRequest>(request)?;
            let document = document(desk, &params.text_document.uri)?;
            value(&lenses_of(
                document,
                desk.editor.encoding,
                desk.editor.reader,
            ))
        }
        _ => Err(Refusal::Method(request.method)),
    }
}

fn read<R>(request: Request) -> Result<R::Params, Refusal>
where
    R: lsp_types::request::Request,
    R::Params: DeserializeOwned,
{
    let params = serde_json::from_value(request.params);
    params.map_err(|error| Refusal::Params(error.to_string()))
}

fn value(answer: &impl Serialize) -> Answer {
    let value = serde_json::to_value(answer);
    let value = value.map_err(|error| Refusal::Failed(say::as_written(error)))?;
    Ok((value, None))
}

fn document<'a>(desk: &'a Desk, uri: &Uri) -> Result<&'a Document, Refusal> {
    desk.open.get(uri.as_str()).ok_or(Refusal::NotOpen)
}

/// The document of a request and the position in its text.
fn at<'a>(
    desk: &'a Desk,
    params: &TextDocumentPositionParams,
) -> Result<(&'a Document, Position), Refusal> {
    let document = document(desk, &params.text_document.uri)?;
    let position = desk
        .editor
        .encoding
        .to_text(&document.text, params.position);
    Ok((document, position))
}

/// The programs in the folder of a document, by number.
fn beside(desk: &mut Desk, uri: &Uri) -> Result<BTreeMap<u16, PathBuf>, Refusal> {
    let document = desk.open.get(uri.as_str()).ok_or(Refusal::NotOpen)?;
    Ok(match &document.path {
        Some(path) => desk.folders.beside(path, desk.open.values()),
        None => BTreeMap::new(),
    })
}

/// Markdown, or plain text for an editor that cannot show it.
fn markup(value: String, markdown: bool) -> MarkupContent {
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

fn on_hover(desk: &mut Desk, params: &TextDocumentPositionParams) -> Answer {
    let index = beside(desk, &params.text_document.uri)?;
    let (document, position) = at(desk, params)?;
    let program = |number| {
        let path = index.get(&number)?;
        folder::text_of(path, desk.open.values())
    };
    let (text, reader) = (&document.text, desk.editor.reader);
    let markdown = desk.editor.markdown.0;
    let found = hover(text, document.structure(), position, reader, &program);
    let found = found.map(|it| lsp_types::Hover {
        contents: lsp_types::HoverContents::Markup(markup(it.markdown, markdown)),
        range: Some(desk.editor.encoding.range(text, &it.range)),
    });
    value(&found)
}

fn on_completion(desk: &mut Desk, params: &TextDocumentPositionParams) -> Answer {
    let index = beside(desk, &params.text_document.uri)?;
    let (document, position) = at(desk, params)?;
    let editor = desk.editor;
    let programs: BTreeSet<u16> = index.into_keys().collect();
    let (text, structure) = (&document.text, document.structure());
    let found = complete(text, structure, position, editor.reader, &programs);
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
                true => Documentation::MarkupContent(markup(about, true)),
                false => Documentation::String(without_markup(&about)),
            }),
            sort_text: Some(format!("{order:04}")),
            filter_text: Some(it.label),
            insert_text_format: is_snippet.then_some(InsertTextFormat::SNIPPET),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(
                editor.encoding.range(text, &it.range),
                it.insert,
            ))),
            ..CompletionItem::default()
        })
    });
    value(&items.collect::<Vec<_>>())
}

fn on_definition(desk: &mut Desk, params: &TextDocumentPositionParams) -> Answer {
    let index = beside(desk, &params.text_document.uri)?;
    let (document, position) = at(desk, params)?;
    let encoding = desk.editor.encoding;
    let led = definition(document.structure(), position);
    let here = |place| Location::new(document.uri.clone(), encoding.range(&document.text, place));
    let mut found: Vec<Location> = led.blocks.iter().map(here).collect();
    let other = led.program.and_then(|number| {
        let path = index.get(&number)?;
        let text = TextDocument::new(folder::text_of(path, desk.open.values())?);
        let structure = Structure::read(&text);
        let mut parts = structure.parts.iter();
        let name = parts.find(|it| it.number == Some(number))?.name.clone();
        let range = name.map_or_else(Range::default, |it| encoding.range(&text, &it));
        Some(Location::new(uri_in(desk, path)?, range))
    });
    found.extend(other);
    value(&found)
}

/// The URI of a file; that of the editor if the file is open.
fn uri_in(desk: &Desk, path: &std::path::Path) -> Option<Uri> {
    let mut open = desk.open.values();
    let open = open.find(|document| document.path.as_deref() == Some(path));
    open.map(|document| document.uri.clone())
        .or_else(|| uri_of(path))
}

fn on_references(desk: &mut Desk, params: &TextDocumentPositionParams, itself: bool) -> Answer {
    let index = beside(desk, &params.text_document.uri)?;
    let (document, position) = at(desk, params)?;
    let encoding = desk.editor.encoding;
    let (here, program) = references(document.structure(), position, itself);
    let own = document.uri.clone();
    let location = |place| Location::new(own.clone(), encoding.range(&document.text, place));
    let mut found: Vec<Location> = here.iter().map(location).collect();
    let others = program.into_iter().flat_map(|_| index.values());
    for path in others.collect::<BTreeSet<_>>() {
        let Some(number) = program else { break };
        let read = folder::text_of(path, desk.open.values());
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
        places.extend(named.filter_map(|it| it.name.clone()).filter(|_| itself));
        if let Some(uri) = uri_in(desk, path) {
            let there = |place| Location::new(uri.clone(), encoding.range(&text, place));
            found.extend(places.iter().map(there));
        }
    }
    value(&found)
}

fn on_highlight(desk: &Desk, params: &TextDocumentPositionParams) -> Answer {
    let (document, position) = at(desk, params)?;
    let (places, _) = references(document.structure(), position, true);
    let highlights = places.iter().map(|place| DocumentHighlight {
        range: desk.editor.encoding.range(&document.text, place),
        kind: None,
    });
    value(&highlights.collect::<Vec<_>>())
}

fn on_symbols(desk: &Desk, uri: &Uri) -> Answer {
    let document = document(desk, uri)?;
    let found = symbols(&document.text, document.structure());
    let encoding = desk.editor.encoding;
    let all = found
        .into_iter()
        .map(|it| symbol(&document.text, it, encoding));
    value(&all.collect::<Vec<_>>())
}

#[expect(
    deprecated,
    reason = "the struct of the protocol has no other constructor"
)]
fn symbol(text: &TextDocument, it: Symbol, encoding: Encoding) -> DocumentSymbol {
    let selection_range = encoding.range(text, &it.range);
    let last = Position {
        line: it.last_line,
        byte: u32::MAX,
    };
    let first = Position {
        line: it.range.line,
        byte: 0,
    };
    let within = it.children.into_iter();
    let children: Vec<_> = within.map(|it| symbol(text, it, encoding)).collect();
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

fn on_folds(desk: &Desk, uri: &Uri) -> Answer {
    let document = document(desk, uri)?;
    let found = folds(&document.text, document.structure());
    let all = found
        .into_iter()
        .map(|(start_line, end_line)| FoldingRange {
            start_line,
            end_line,
            ..FoldingRange::default()
        });
    value(&all.collect::<Vec<_>>())
}

fn on_format(desk: &Desk, uri: &Uri, range: Option<Range>) -> Answer {
    let document = document(desk, uri)?;
    let text = &document.text;
    let lines = match range {
        None => 0..text.line_count(),
        Some(range) => range.start.line..range.end.line.saturating_add(1),
    };
    let outside = document.led_from_outside();
    let site = (&outside[..], desk.editor.reader.model);
    let done = format(text, document.structure(), desk.style, lines, site);
    let encoding = desk.editor.encoding;
    let edits: Vec<TextEdit> = done
        .edits
        .iter()
        .map(|it| encoding.edit(text, it))
        .collect();
    let (value, _) = value(&edits)?;
    Ok((value, done.refused))
}

fn on_prepare_rename(desk: &Desk, params: &TextDocumentPositionParams) -> Answer {
    let (document, position) = at(desk, params)?;
    let place = renamable(document.structure(), position);
    let place = place.ok_or_else(|| Refusal::Failed(say::rename_nothing()))?;
    let range = desk.editor.encoding.range(&document.text, &place);
    value(&PrepareRenameResponse::Range(range))
}

#[expect(
    clippy::mutable_key_type,
    reason = "the map of the protocol; its keys are not changed"
)]
fn on_rename(desk: &Desk, params: &TextDocumentPositionParams, name: &str) -> Answer {
    let (document, position) = at(desk, params)?;
    let outside = document.led_from_outside();
    let site = (&outside[..], desk.editor.reader.model);
    let edits = rename(&document.text, document.structure(), position, name, site);
    let edits = edits.map_err(Refusal::Failed)?;
    let encoding = desk.editor.encoding;
    let edits = edits
        .iter()
        .map(|it| encoding.edit(&document.text, it))
        .collect();
    let changes = [(document.uri.clone(), edits)].into_iter().collect();
    value(&WorkspaceEdit::new(changes))
}

/// The code lenses of a document; none before its first analysis.
pub fn lenses_of(document: &Document, encoding: Encoding, reader: ReadingContext) -> Vec<CodeLens> {
    let Some(analysis) = &document.analysis else {
        return Vec::new();
    };
    let found = lenses(document.structure(), analysis, reader.language);
    let all = found.into_iter().map(|it| CodeLens {
        range: encoding.range(&document.text, &it.range),
        command: Some(Command::new(it.text, String::new(), None)),
        data: None,
    });
    all.collect()
}
