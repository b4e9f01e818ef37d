//! The programs beside a document: open ones before those on the disk.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use gsk_core::model::ControlModel;
use gsk_language::TextDocument;

use super::documents::Document;
use crate::files::program_file;
use crate::files::subprograms::{self, Found};

/// Files larger than this are not looked into for words that lead to a program.
const LARGEST_OTHER: usize = 4 * 1024 * 1024;

/// The programs of folders by their numbers, found once and kept until files have changed.
#[derive(Default)]
pub struct Folders {
    by_main: BTreeMap<PathBuf, BTreeMap<u16, PathBuf>>,
}

impl Folders {
    /// Files may have changed.
    pub fn forget(&mut self) {
        self.by_main.clear();
    }

    /// The programs beside a document, by number.
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

/// An open document of the same folder, and the number it is called by.
fn numbered_beside(path: &Path, document: &Document) -> Option<(u16, PathBuf)> {
    let other = document.path.as_deref()?;
    if other == path || other.parent() != path.parent() {
        return None;
    }
    let number = subprograms::number_in_name(other);
    let number = number.or_else(|| document.structure().parts.first()?.number)?;
    Some((number, other.to_owned()))
}

/// The text of a program that is open, or on the disk.
pub fn text_of<'a>(path: &Path, mut open: impl Iterator<Item = &'a Document>) -> Option<String> {
    let open = open.find(|it| it.path.as_deref() == Some(path));
    match open {
        Some(document) => Some(document.text.as_str().to_owned()),
        None => program_file::read(path).ok().map(|file| file.text),
    }
}

/// The programs beside a text that it calls, and those that they call.
pub fn called(
    text: &TextDocument,
    index: &BTreeMap<u16, PathBuf>,
    model: &ControlModel,
    read: &dyn Fn(&Path) -> Option<String>,
) -> Vec<Found> {
    let calls = subprograms::calls(text.as_str(), model);
    subprograms::find_among(index, calls, &BTreeSet::new(), model, read)
}

/// Whether a file is small enough to be looked into for a word.
pub fn is_small(text: &str) -> bool {
    text.len() <= LARGEST_OTHER
}
