//! The documents that are open in the editor.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use gsk_host::files::subprograms::FoundSubprogram;
use gsk_language::{Analysis, ReferenceTarget, Structure, TextChange, TextDocument};
use lsp_server::RequestId;
use lsp_types::{TextDocumentContentChangeEvent, Uri};

use super::convert::ColumnEncoding;

/// A document that is open in the editor.
pub struct OpenDocument {
    pub uri: Uri,
    /// Path of the document's file; `None` if it was never saved.
    pub path: Option<PathBuf>,
    /// The version number that the editor assigned.
    pub version: i32,
    pub text: Arc<TextDocument>,
    structure: OnceLock<Arc<Structure>>,
    /// The programs in other files that the text calls.
    pub called_programs: Arc<Vec<FoundSubprogram>>,
    /// The analysis of the current text; `None` until the checker has finished.
    pub analysis: Option<Arc<Analysis>>,
    /// Set to false to cancel the running analysis.
    is_analysis_wanted: Arc<AtomicBool>,
    /// Ids of the code lens requests that wait for the analysis.
    pub waiting_requests: Vec<RequestId>,
}

impl OpenDocument {
    pub fn new(uri: Uri, path: Option<PathBuf>, version: i32, text: String) -> Self {
        Self {
            uri,
            path,
            version,
            text: Arc::new(TextDocument::new(text)),
            structure: OnceLock::new(),
            called_programs: Arc::default(),
            analysis: None,
            is_analysis_wanted: Arc::default(),
            waiting_requests: Vec::new(),
        }
    }

    /// Returns the structure of the text, which is parsed on first use.
    pub fn structure(&self) -> &Arc<Structure> {
        let read = || Arc::new(Structure::read(&self.text));
        self.structure.get_or_init(read)
    }

    /// Stores the analysis of the current text.
    pub fn store_analysis(&mut self, structure: Arc<Structure>, analysis: Arc<Analysis>) {
        // The structure may already be set: it is the same.
        let _ = self.structure.set(structure);
        self.analysis = Some(analysis);
    }

    /// Applies changes of the text in their order and stores the version number of the result.
    pub fn apply_changes(
        &mut self,
        version: i32,
        changes: Vec<TextDocumentContentChangeEvent>,
        encoding: ColumnEncoding,
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

    /// Cancels the running analysis and returns the flag of a new one; false in it cancels
    /// that one.
    pub fn begin_analysis(&mut self) -> Arc<AtomicBool> {
        self.cancel_analysis();
        self.analysis = None;
        self.is_analysis_wanted = Arc::new(AtomicBool::new(true));
        Arc::clone(&self.is_analysis_wanted)
    }

    /// Cancels the running analysis.
    pub fn cancel_analysis(&self) {
        self.is_analysis_wanted.store(false, Ordering::Relaxed);
    }

    /// The sequence numbers (N) to which M99 P in programs of other files returns, in the
    /// order of those programs.
    pub fn external_return_targets(&self) -> Vec<u16> {
        let texts = self
            .called_programs
            .iter()
            .map(|found| TextDocument::new(found.text.as_str()));
        let references = texts.flat_map(|text| Structure::read(&text).references);
        references
            .filter_map(|reference| match reference.target {
                ReferenceTarget::Caller(number) => Some(number),
                _ => None,
            })
            .collect()
    }
}
