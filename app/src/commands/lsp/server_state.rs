//! The state of the server between two messages: open documents and capabilities of the
//! editor.

use std::collections::BTreeMap;

use gsk_language::ReadingContext;

use super::convert::ColumnEncoding;
use super::documents::OpenDocument;
use super::folder::FolderIndexes;
use super::settings::ServerSettings;

/// The functions that the editor supports, from its initialization message.
#[derive(Clone, Copy, Debug)]
pub struct EditorCapabilities {
    /// The unit in which positions count columns.
    pub encoding: ColumnEncoding,
    /// Whether the editor accepts completions with placeholders.
    pub snippets: bool,
    /// Whether the editor shows Markdown: first in hovers, then in completions.
    pub markdown: (bool, bool),
    /// Whether the editor accepts code actions with their edits.
    pub actions: bool,
    /// Whether the editor shows tags of diagnostics, such as text without effect.
    pub tags: bool,
    /// Control model of the programs, and language of the texts about them.
    pub reading: ReadingContext,
}

/// The state of the server, from which requests are answered.
pub struct ServerState {
    pub editor: EditorCapabilities,
    /// The settings of the editor for this server.
    pub settings: ServerSettings,
    /// Documents that are open in the editor, by URI.
    pub documents: BTreeMap<String, OpenDocument>,
    /// Indexes of the programs in the folders of the documents.
    pub folders: FolderIndexes,
}
