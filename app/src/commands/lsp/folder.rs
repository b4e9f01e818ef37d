//! The programs in the folder of a document. An open document replaces its file on the disk.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use gsk_core::model::ControlModel;
use gsk_host::files::program_file;
use gsk_host::files::subprograms::{self, FoundSubprogram};
use gsk_language::TextDocument;

use super::documents::OpenDocument;

/// Size limit for files that are searched for calls, bytes.
const MAX_SEARCHED_BYTES: usize = 4 * 1024 * 1024;

/// The programs in folders, indexed by program number; cached until files change.
#[derive(Default)]
pub struct FolderIndexes {
    by_main: BTreeMap<PathBuf, BTreeMap<u16, PathBuf>>,
}

impl FolderIndexes {
    /// Clears the cache, because files may have changed.
    pub fn clear(&mut self) {
        self.by_main.clear();
    }

    /// Lists the programs in the folder of the document `path`, by program number; `open` are
    /// the documents in the editor.
    pub fn index_for<'a>(
        &mut self,
        path: &Path,
        open: impl Iterator<Item = &'a OpenDocument>,
    ) -> BTreeMap<u16, PathBuf> {
        let known = self.by_main.entry(path.to_owned());
        let mut index = known
            .or_insert_with(|| subprograms::index_folder(path))
            .clone();
        for (number, other) in open.filter_map(|it| numbered_beside(path, it)) {
            index.entry(number).or_insert(other);
        }
        index
    }
}

/// Program number and path of an open document if it is in the same folder as `path` and has a
/// number; otherwise `None`.
fn numbered_beside(path: &Path, document: &OpenDocument) -> Option<(u16, PathBuf)> {
    let other = document.path.as_deref()?;
    if other == path || other.parent() != path.parent() {
        return None;
    }
    let number = subprograms::parse_number_in_name(other);
    let number = number.or_else(|| document.structure().parts.first()?.number)?;
    Some((number, other.to_owned()))
}

/// Reads the text of a program: from the editor if it is open, else from the disk; `None` if
/// it cannot be read.
pub fn read_text<'a>(
    path: &Path,
    mut open: impl Iterator<Item = &'a OpenDocument>,
) -> Option<String> {
    let open = open.find(|it| it.path.as_deref() == Some(path));
    match open {
        Some(document) => Some(document.text.as_str().to_owned()),
        None => program_file::read(path).ok().map(|file| file.text),
    }
}

/// Finds the programs that a text calls in `index`, and those that these call in turn; `read`
/// returns the text of a file.
pub fn find_called_programs(
    text: &TextDocument,
    index: &BTreeMap<u16, PathBuf>,
    model: &ControlModel,
    read: &dyn Fn(&Path) -> Option<String>,
) -> Vec<FoundSubprogram> {
    let calls = subprograms::find_calls(text.as_str(), model);
    subprograms::find_in_index(index, calls, &BTreeSet::new(), model, read)
}

/// Whether a text is small enough to be searched for calls of programs.
pub fn is_small(text: &str) -> bool {
    text.len() <= MAX_SEARCHED_BYTES
}
