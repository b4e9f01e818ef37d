//! Answers searches for symbols in all programs of the open folders.

use std::collections::BTreeSet;
use std::path::PathBuf;

use gsk_language::{Structure, Symbol, SymbolKind, TextDocument, named_symbols};
use lsp_types::{Location, SymbolInformation, Uri};

use super::convert::{ColumnEncoding, path_to_uri};
use super::folder;
use super::request::{RequestAnswer, to_answer};
use super::server_state::ServerState;

/// Greatest number of symbols in an answer.
const MAX_SYMBOLS: usize = 500;

/// Answers the programs and the blocks named by comments whose names contain `query`, in the
/// open documents and in the files of their folders.
pub fn on_workspace_symbols(desk: &mut ServerState, query: &str) -> RequestAnswer {
    let encoding = desk.editor.encoding;
    let model = desk.editor.reading.model;
    let query = query.to_lowercase();
    let mut found = Vec::new();
    let mut paths: BTreeSet<PathBuf> = BTreeSet::new();
    for document in desk.documents.values() {
        let symbols = named_symbols(&document.text, document.structure(), model);
        add_symbols(&mut found, symbols, &query, |it| {
            to_information(&document.text, document.uri.clone(), it, encoding)
        });
        if let Some(path) = &document.path {
            let index = desk.folders.index_for(path, desk.documents.values());
            paths.extend(index.into_values());
        }
    }
    let is_open = |path: &PathBuf| {
        let mut open = desk.documents.values();
        open.any(|document| document.path.as_ref() == Some(path))
    };
    for path in paths.iter().filter(|path| !is_open(path)) {
        if found.len() >= MAX_SYMBOLS {
            break;
        }
        let read = folder::read_text(path, desk.documents.values());
        let Some(text) = read.filter(|text| folder::is_small(text)) else {
            continue;
        };
        let text = TextDocument::new(text);
        let symbols = named_symbols(&text, &Structure::read(&text), model);
        if let Some(uri) = path_to_uri(path) {
            add_symbols(&mut found, symbols, &query, |it| {
                to_information(&text, uri.clone(), it, encoding)
            });
        }
    }
    to_answer(&found)
}

fn add_symbols(
    found: &mut Vec<SymbolInformation>,
    symbols: Vec<Symbol>,
    query: &str,
    convert: impl Fn(Symbol) -> SymbolInformation,
) {
    let left = MAX_SYMBOLS.saturating_sub(found.len());
    let wanted = symbols
        .into_iter()
        .filter(|it| it.name.to_lowercase().contains(query));
    found.extend(wanted.take(left).map(convert));
}

#[expect(
    deprecated,
    reason = "the struct of the protocol has no other constructor"
)]
fn to_information(
    text: &TextDocument,
    uri: Uri,
    symbol: Symbol,
    encoding: ColumnEncoding,
) -> SymbolInformation {
    SymbolInformation {
        kind: match symbol.kind {
            SymbolKind::Program => lsp_types::SymbolKind::MODULE,
            _ => lsp_types::SymbolKind::KEY,
        },
        tags: None,
        deprecated: None,
        location: Location::new(uri, encoding.to_range(text, &symbol.range)),
        name: symbol.name,
        container_name: None,
    }
}
