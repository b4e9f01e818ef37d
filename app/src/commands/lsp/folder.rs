//! The programs in the folder of a document. An open document replaces its file on the disk.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use gsk_core::model::ControlModel;
use gsk_language::TextDocument;

use super::documents::Document;
use crate::files::program_file;
use crate::files::subprograms::{self, Found};

/// Size limit for files that are searched for calls, bytes.
const LARGEST_OTHER: usize = 4 * 1024 * 1024;

/// Indexes of folders by program number, cached until files change.
#[derive(Default)]
pub struct Folders {
    by_main: BTreeMap<PathBuf, BTreeMap<u16, PathBuf>>,
}

impl Folders {
    /// Clears the cache, because files may have changed.
    pub fn forget(&mut self) {
        self.by_main.clear();
    }

    /// The programs in the folder of a document, by number.
    pub fn beside<'a>(
        &mut self,
        path: &Path,
        open: impl Iterator<Item = &'a Document>,
    ) -> BTreeMap<u16, PathBuf> {
        let known = self.by_main.entry(path.to_owned());
        let mut index = known.or_insert_with(|| subprograms::beside(path)).clone();
        for (number, other) in open.filter_map(|it| numbered_beside(path, it)) {
            index.entry(number).or_insert(other);
        }
        index
    }
}

/// Number and path of an open document in the same folder.
fn numbered_beside(path: &Path, document: &Document) -> Option<(u16, PathBuf)> {
    let other = document.path.as_deref()?;
    if other == path || other.parent() != path.parent() {
        return None;
    }
    let number = subprograms::number_in_name(other);
    let number = number.or_else(|| document.structure().parts.first()?.number)?;
    Some((number, other.to_owned()))
}

/// The text of a program: from the editor if it is open, else from the disk.
pub fn text_of<'a>(path: &Path, mut open: impl Iterator<Item = &'a Document>) -> Option<String> {
    let open = open.find(|it| it.path.as_deref() == Some(path));
    match open {
        Some(document) => Some(document.text.as_str().to_owned()),
        None => program_file::read(path).ok().map(|file| file.text),
    }
}

/// The called programs in the folder of a text, and those that they call in turn.
pub fn called(
    text: &TextDocument,
    index: &BTreeMap<u16, PathBuf>,
    model: &ControlModel,
    read: &dyn Fn(&Path) -> Option<String>,
) -> Vec<Found> {
    let calls = subprograms::calls(text.as_str(), model);
    subprograms::find_among(index, calls, &BTreeSet::new(), model, read)
}

/// Whether a text is small enough to be searched for calls.
pub fn is_small(text: &str) -> bool {
    text.len() <= LARGEST_OTHER
}
