//! The state of the server between two messages: open documents and capabilities of the
//! editor.

use std::collections::BTreeMap;

use gsk_language::{ReadingContext, Style};

use super::convert::Encoding;
use super::documents::Document;
use super::folder::Folders;

/// Capabilities of the editor.
#[derive(Clone, Copy, Debug)]
pub struct Editor {
    /// The unit of its columns.
    pub encoding: Encoding,
    /// Whether it accepts completions with placeholders.
    pub snippets: bool,
    /// Whether it shows Markdown in hovers and in completions.
    pub markdown: (bool, bool),
    /// Control model and language of the programs.
    pub reader: ReadingContext,
}

/// The state from which requests are answered.
pub struct Desk {
    pub editor: Editor,
    /// The format style of programs.
    pub style: Style,
    /// Open documents by URI.
    pub open: BTreeMap<String, Document>,
    /// Programs in the folders of the documents.
    pub folders: Folders,
}
