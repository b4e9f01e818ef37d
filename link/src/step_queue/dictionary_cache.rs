//! Caches dictionaries of known boards, to save the time of reading them.
//!
//! A compressed dictionary ends with a checksum. If the first and the last bytes of a board's
//! dictionary equal those of a known one, the dictionaries are equal.

use super::dictionary::Dictionary;

/// Number of bytes at the end of a dictionary that are compared with a known one. A query requests
/// more bytes: further ones show that the dictionary is longer.
const END: usize = 36;
/// Greatest number of dictionaries that the cache stores.
const MOST: usize = 16;

/// Dictionaries of boards that were opened before, compressed.
#[derive(Clone, Debug, Default)]
pub(super) struct DictionaryCache(Vec<Vec<u8>>);

impl DictionaryCache {
    /// Adds a compressed dictionary unless it is damaged or known; drops the oldest one if the
    /// cache is full.
    pub(super) fn insert(&mut self, packed: Vec<u8>) {
        if packed.len() > END && !self.0.contains(&packed) && Dictionary::unpack(&packed).is_ok() {
            self.0.insert(0, packed);
            self.0.truncate(MOST);
        }
    }

    /// Returns the index of the first dictionary from the index `from` on that begins with the
    /// bytes `begin`; `None` without one.
    pub(super) fn find(&self, from: usize, begin: &[u8]) -> Option<usize> {
        let rest = self.0.iter().enumerate().skip(from);
        let mut rest = rest.filter(|(_, known)| known.starts_with(begin));
        rest.next().map(|(index, _)| index)
    }

    /// Returns the offset of the last [`END`] bytes of a dictionary, and these bytes; `None`
    /// for an unknown index.
    pub(super) fn end(&self, index: usize) -> Option<(usize, &[u8])> {
        let known = self.0.get(index)?;
        let from = known.len().checked_sub(END)?;
        Some((from, known.get(from..)?))
    }

    pub(super) fn get(&self, index: usize) -> Option<&[u8]> {
        self.0.get(index).map(Vec::as_slice)
    }
}
