//! The documents that are open in the editor.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use gsk_language::{Analysis, ReferenceTarget, Structure, TextChange, TextDocument};
use lsp_server::RequestId;
use lsp_types::{TextDocumentContentChangeEvent, Uri};

use super::convert::Encoding;
use crate::files::subprograms::Found;

/// A document that is open.
pub struct Document {
    /// What the editor calls it.
    pub uri: Uri,
    /// Its file; none for one that was never saved.
    pub path: Option<PathBuf>,
    /// The editor's count of its changes.
    pub version: i32,
    /// Its text.
    pub text: Arc<TextDocument>,
    structure: OnceLock<Arc<Structure>>,
    /// Programs of other files that it calls.
    pub found: Arc<Vec<Found>>,
    /// What the last look through this text found.
    pub analysis: Option<Arc<Analysis>>,
    /// Whether the look that is under way is still wanted.
    wanted: Arc<AtomicBool>,
    /// Requests that wait for the look.
    pub waiting: Vec<RequestId>,
}

impl Document {
    /// As the editor opens it.
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

    /// Its structure, read when it is asked for.
    pub fn structure(&self) -> &Arc<Structure> {
        let read = || Arc::new(Structure::read(&self.text));
        self.structure.get_or_init(read)
    }

    /// Takes over what a look through this text found.
    pub fn looked(&mut self, structure: Arc<Structure>, analysis: Arc<Analysis>) {
        // It may have been read meanwhile, and is the same then.
        let _ = self.structure.set(structure);
        self.analysis = Some(analysis);
    }

    /// Takes over changes in their order.
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

    /// A new look begins: one that is under way is no longer wanted.
    pub fn begin_look(&mut self) -> Arc<AtomicBool> {
        self.give_up_look();
        self.analysis = None;
        self.wanted = Arc::new(AtomicBool::new(true));
        Arc::clone(&self.wanted)
    }

    /// Nobody waits for the look any more.
    pub fn give_up_look(&self) {
        self.wanted.store(false, Ordering::Relaxed);
    }

    /// The numbers that P of M99 in programs of other files leads to, in the order of
    /// those programs.
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
