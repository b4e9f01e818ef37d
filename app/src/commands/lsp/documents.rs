//! The documents that are open in the editor.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use gsk_language::{Analysis, ReferenceTarget, Structure, TextChange, TextDocument};
use lsp_server::RequestId;
use lsp_types::{TextDocumentContentChangeEvent, Uri};

use super::convert::Encoding;
use crate::files::subprograms::Found;

/// An open document.
pub struct Document {
    pub uri: Uri,
    /// `None` if the document was never saved.
    pub path: Option<PathBuf>,
    /// The version number that the editor assigned.
    pub version: i32,
    pub text: Arc<TextDocument>,
    structure: OnceLock<Arc<Structure>>,
    /// Called programs of other files.
    pub found: Arc<Vec<Found>>,
    /// The analysis of the current text; `None` until the checker has finished.
    pub analysis: Option<Arc<Analysis>>,
    /// False cancels the running analysis.
    wanted: Arc<AtomicBool>,
    /// Code lens requests that wait for the analysis.
    pub waiting: Vec<RequestId>,
}

impl Document {
    pub fn new(uri: Uri, path: Option<PathBuf>, version: i32, text: String) -> Self {
        Self {
            uri,
            path,
            version,
            text: Arc::new(TextDocument::new(text)),
            structure: OnceLock::new(),
            found: Arc::default(),
            analysis: None,
            wanted: Arc::default(),
            waiting: Vec::new(),
        }
    }

    /// The structure of the text, parsed on first use.
    pub fn structure(&self) -> &Arc<Structure> {
        let read = || Arc::new(Structure::read(&self.text));
        self.structure.get_or_init(read)
    }

    /// Stores the analysis of the current text.
    pub fn looked(&mut self, structure: Arc<Structure>, analysis: Arc<Analysis>) {
        // The structure may already be set: it is the same.
        let _ = self.structure.set(structure);
        self.analysis = Some(analysis);
    }

    /// Applies changes in their order.
    pub fn change(
        &mut self,
        version: i32,
        changes: Vec<TextDocumentContentChangeEvent>,
        encoding: Encoding,
    ) {
        self.version = version;
        self.structure = OnceLock::new();
        for change in changes {
            match change.range {
                None => self.text = Arc::new(TextDocument::new(change.text)),
                Some(range) => {
                    let text = Arc::make_mut(&mut self.text);
                    let from = encoding.to_text(text, range.start);
                    let to = encoding.to_text(text, range.end);
                    text.apply(&TextChange {
                        from,
                        to,
                        text: change.text,
                    });
                }
            }
        }
    }

    /// Starts a new analysis and cancels the running one. Returns its cancel flag.
    pub fn begin_look(&mut self) -> Arc<AtomicBool> {
        self.give_up_look();
        self.analysis = None;
        self.wanted = Arc::new(AtomicBool::new(true));
        Arc::clone(&self.wanted)
    }

    /// Cancels the running analysis.
    pub fn give_up_look(&self) {
        self.wanted.store(false, Ordering::Relaxed);
    }

    /// The sequence numbers that M99 P in programs of other files returns to, in the order
    /// of those programs.
    pub fn led_from_outside(&self) -> Vec<u16> {
        let texts = self
            .found
            .iter()
            .map(|found| TextDocument::new(found.text.as_str()));
        let leads = texts.flat_map(|text| Structure::read(&text).references);
        leads
            .filter_map(|lead| match lead.target {
                ReferenceTarget::Caller(number) => Some(number),
                _ => None,
            })
            .collect()
    }
}
