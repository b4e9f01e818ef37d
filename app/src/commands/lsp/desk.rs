//! What lies on the desk between two messages: the open documents, and what the editor
//! wants.

use std::collections::BTreeMap;

use gsk_language::{ReadingContext, Style};

use super::convert::Encoding;
use super::documents::Document;
use super::folder::Folders;

/// What the editor can do and wants.
#[derive(Clone, Copy, Debug)]
pub struct Editor {
    /// How it counts columns.
    pub encoding: Encoding,
    /// Whether it takes proposals with places to be filled in.
    pub snippets: bool,
    /// Whether it shows Markdown under the pointer, and beside proposals.
    pub markdown: (bool, bool),
    /// Whose programs are read, in which language.
    pub reader: ReadingContext,
}

/// What answers are made from.
pub struct Desk {
    /// What the editor can do.
    pub editor: Editor,
    /// How programs are written.
    pub style: Style,
    /// Open documents by their URI.
    pub open: BTreeMap<String, Document>,
    /// The programs beside them.
    pub folders: Folders,
}
