//! The manifest of a data directory: length and checksum of each file. It detects damaged
//! and deleted files, even if their text can still be parsed.
//!
//! While files are written the manifest lists both contents, the old and the new one: a kill
//! at any moment leaves one of the two.
//!
//! ```text
//!   manifest {old, new}  ->  the files, one after the other  ->  manifest {new}
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Length and checksum that identify the contents of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ContentMark {
    length: u64,
    crc32: u32,
}

impl ContentMark {
    /// Computes the mark of a file's contents.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        Self {
            length: bytes.len() as u64,
            crc32: crc32fast::hash(bytes),
        }
    }
}

/// The state of a file; `None` if it is absent.
pub type FileState = Option<ContentMark>;

/// The allowed states of each file, by its name in the directory. A file without an entry
/// may have any contents: the user or a version without manifest put it there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    files: BTreeMap<String, Vec<FileState>>,
}

impl Manifest {
    /// Whether the manifest allows a file to be in the state `found`.
    pub fn allows(&self, name: &str, found: FileState) -> bool {
        match self.files.get(name) {
            None => true,
            Some(states) => states.is_empty() || states.contains(&found),
        }
    }

    /// The newest recorded state of a file; `None` if it is unknown.
    pub fn state(&self, name: &str) -> Option<FileState> {
        self.files.get(name)?.last().copied()
    }

    /// Prepares a write: from now on both the current state and `next` are allowed. If the
    /// current state is unknown, any is allowed, because a kill may leave it.
    pub fn begin_write(&mut self, name: &str, next: FileState) {
        let states = self
            .state(name)
            .map_or_else(Vec::new, |now| vec![now, next]);
        self.files.insert(name.to_owned(), states);
    }

    /// Records the current state of a file, the only one allowed. `None` removes the file
    /// from the manifest: then any state is allowed.
    pub fn record_state(&mut self, name: &str, now: FileState) {
        match now {
            Some(_) => self.files.insert(name.to_owned(), vec![now]),
            None => self.files.remove(name),
        };
    }

    /// Records that a file was read in an allowed state. After an interrupted write the copy
    /// may be older or newer than the file. The state becomes unknown, so that the next
    /// commit writes or deletes both.
    pub fn record_found_state(&mut self, name: &str, state: FileState) {
        let was_interrupted = self.files.get(name).is_some_and(|states| states.len() > 1);
        match state {
            None if was_interrupted => drop(self.files.remove(name)),
            Some(_) if was_interrupted => drop(self.files.insert(name.to_owned(), Vec::new())),
            Some(_) => self.record_unknown_state(name),
            None => {}
        }
    }

    /// Records that a file exists, but that its contents are unknown.
    pub fn record_unknown_state(&mut self, name: &str) {
        self.files.entry(name.to_owned()).or_default();
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// Formats the manifest as text: a checksum line, then the RON that it covers.
    ///
    /// # Errors
    /// The manifest cannot be written as RON.
    pub fn to_text(&self) -> Result<String, ron::Error> {
        let style = ron::ser::PrettyConfig::new().depth_limit(2);
        let body = ron::ser::to_string_pretty(self, style)?;
        let sum = crc32fast::hash(body.as_bytes());
        Ok(format!("// {sum:08x}\n{body}"))
    }

    /// Parses the text of [`Manifest::to_text`]; `None` if the text is damaged.
    pub fn from_text(text: &str) -> Option<Self> {
        let (head, body) = text.split_once('\n')?;
        let sum = u32::from_str_radix(head.strip_prefix("// ")?, 16).ok()?;
        (sum == crc32fast::hash(body.as_bytes()))
            .then(|| ron::from_str(body).ok())
            .flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_contents_are_allowed_during_a_write() {
        let [old, new, other] =
            [b"old", b"new", b"odd"].map(|bytes| Some(ContentMark::from_bytes(bytes)));
        let mut manifest = Manifest::default();
        assert!(manifest.allows("a", old) && manifest.allows("a", None));
        manifest.record_state("a", old);
        assert!(manifest.allows("a", old) && !manifest.allows("a", None));
        manifest.begin_write("a", new);
        assert!(manifest.allows("a", old) && manifest.allows("a", new));
        assert!(!manifest.allows("a", other) && !manifest.allows("a", None));
        manifest.record_state("a", new);
        assert!(!manifest.allows("a", old));
        manifest.begin_write("b", new);
        assert!(manifest.allows("b", None) && manifest.allows("b", old));
        manifest.record_state("b", new);
        manifest.begin_write("b", None);
        assert!(manifest.allows("b", None) && !manifest.allows("b", old));
    }

    #[test]
    fn a_flipped_bit_in_the_manifest_is_detected() {
        let mut manifest = Manifest::default();
        manifest.record_state("parameters.ron", Some(ContentMark::from_bytes(b"1")));
        let text = manifest.to_text().unwrap();
        assert_eq!(Manifest::from_text(&text), Some(manifest));
        for byte in 0..text.len() {
            let mut bytes = text.clone().into_bytes();
            bytes[byte] ^= 1;
            if let Ok(damaged) = String::from_utf8(bytes) {
                assert_eq!(Manifest::from_text(&damaged), None, "byte {byte}");
            }
        }
    }
}
