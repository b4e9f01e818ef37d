//! The state of the server between two messages: open documents and capabilities of the
//! editor.

use std::collections::BTreeMap;

use gsk_language::{ReadingContext, Style};

use super::convert::ColumnEncoding;
use super::documents::OpenDocument;
use super::folder::FolderIndexes;

/// Capabilities of the editor.
#[derive(Clone, Copy, Debug)]
pub struct EditorCapabilities {
    /// The unit of its columns.
    pub encoding: ColumnEncoding,
    /// Whether it accepts completions with placeholders.
    pub snippets: bool,
    /// Whether it shows Markdown in hovers and in completions.
    pub markdown: (bool, bool),
    /// Control model and language of the programs.
    pub reading: ReadingContext,
}

/// The state from which requests are answered.
pub struct ServerState {
    pub editor: EditorCapabilities,
    /// The format style of programs.
    pub style: Style,
    /// Open documents by URI.
    pub documents: BTreeMap<String, OpenDocument>,
    /// Programs in the folders of the documents.
    pub folders: FolderIndexes,
}
