//! Dictionaries of boards met before: they need not be read again.
//!
//! A dictionary comes packed, and its last bytes check all of it: a board whose first
//! bytes and last ones are those of a known dictionary has that one.

use super::dictionary::Dictionary;

/// Bytes at the end that are compared, fewer than are asked for: what comes behind
/// would show.
const END: usize = 36;
/// No more are kept.
const MOST: usize = 16;

/// Known dictionaries, packed.
#[derive(Clone, Debug, Default)]
pub(super) struct DictionaryCache(Vec<Vec<u8>>);

impl DictionaryCache {
    /// Puts one there, unless it is damaged.
    pub(super) fn insert(&mut self, packed: Vec<u8>) {
        if packed.len() > END && !self.0.contains(&packed) && Dictionary::unpack(&packed).is_ok() {
            self.0.insert(0, packed);
            self.0.truncate(MOST);
        }
    }

    /// The next one, from this index on, that begins so.
    pub(super) fn find(&self, from: usize, begin: &[u8]) -> Option<usize> {
        let rest = self.0.iter().enumerate().skip(from);
        let mut rest = rest.filter(|(_, known)| known.starts_with(begin));
        rest.next().map(|(index, _)| index)
    }

    /// Its end, and where that begins.
    pub(super) fn end(&self, index: usize) -> Option<(usize, &[u8])> {
        let known = self.0.get(index)?;
        let from = known.len().checked_sub(END)?;
        Some((from, known.get(from..)?))
    }

    pub(super) fn get(&self, index: usize) -> Option<&[u8]> {
        self.0.get(index).map(Vec::as_slice)
    }
}
