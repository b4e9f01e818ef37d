//! What the files of a data directory must be: length and checksum of each, so that
//! a file that was damaged or deleted is noticed, whatever its text still says.
//!
//! While files are being written the manifest names both contents, the old and the
//! new one: a kill at any moment leaves one of the two.
//!
//! ```text
//!   manifest {old, new}  ->  the files, one after the other  ->  manifest {new}
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What a content is known by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mark {
    length: u64,
    crc32: u32,
}

impl Mark {
    /// Of a content.
    pub fn of(bytes: &[u8]) -> Self {
        Self {
            length: bytes.len() as u64,
            crc32: crc32fast::hash(bytes),
        }
    }
}

/// A file, or its absence.
pub type State = Option<Mark>;

/// The states each file may be in, by its name in the directory. A file without a
/// mark may be anything: it was put there by hand, or by a version without manifest.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    files: BTreeMap<String, Vec<State>>,
}

impl Manifest {
    /// Whether a file may be as it was found.
    pub fn allows(&self, name: &str, found: State) -> bool {
        match self.files.get(name) {
            None => true,
            Some(states) => states.is_empty() || states.contains(&found),
        }
    }

    /// The state of a file, when it is known.
    pub fn state(&self, name: &str) -> Option<State> {
        self.files.get(name)?.last().copied()
    }

    /// A file is about to get another content. What stands in its place now, if that
    /// is not known, may still be there after a kill.
    pub fn begin(&mut self, name: &str, next: State) {
        let states = self
            .state(name)
            .map_or_else(Vec::new, |now| vec![now, next]);
        self.files.insert(name.to_owned(), states);
    }

    /// A file has this content now.
    pub fn settle(&mut self, name: &str, now: State) {
        match now {
            Some(_) => self.files.insert(name.to_owned(), vec![now]),
            None => self.files.remove(name),
        };
    }

    /// A file was found in a state that is allowed. After a writing that was broken
    /// off nobody knows whether its copy is the old or the new one: the file counts
    /// as unknown, so that the next commit writes both, or deletes both.
    pub fn found(&mut self, name: &str, state: State) {
        let broken_off = self.files.get(name).is_some_and(|states| states.len() > 1);
        match state {
            None if broken_off => drop(self.files.remove(name)),
            Some(_) if broken_off => drop(self.files.insert(name.to_owned(), Vec::new())),
            Some(_) => self.adopt(name),
            None => {}
        }
    }

    /// There is such a file; what stands in it is not known.
    pub fn adopt(&mut self, name: &str) {
        self.files.entry(name.to_owned()).or_default();
    }

    /// The names of all files.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// As text: the checksum of the rest, then the rest.
    ///
    /// # Errors
    /// What the writer of RON says.
    pub fn to_text(&self) -> Result<String, ron::Error> {
        let style = ron::ser::PrettyConfig::new().depth_limit(2);
        let body = ron::ser::to_string_pretty(self, style)?;
        let sum = crc32fast::hash(body.as_bytes());
        Ok(format!("// {sum:08x}\n{body}"))
    }

    /// Reads what [`Manifest::to_text`] wrote; `None` if it is damaged.
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
    fn both_contents_are_good_while_one_takes_the_place_of_the_other() {
        let [old, new, other] = [b"old", b"new", b"odd"].map(|bytes| Some(Mark::of(bytes)));
        let mut manifest = Manifest::default();
        assert!(manifest.allows("a", old) && manifest.allows("a", None));
        manifest.settle("a", old);
        assert!(manifest.allows("a", old) && !manifest.allows("a", None));
        manifest.begin("a", new);
        assert!(manifest.allows("a", old) && manifest.allows("a", new));
        assert!(!manifest.allows("a", other) && !manifest.allows("a", None));
        manifest.settle("a", new);
        assert!(!manifest.allows("a", old));
        manifest.begin("b", new);
        assert!(manifest.allows("b", None) && manifest.allows("b", old));
        manifest.settle("b", new);
        manifest.begin("b", None);
        assert!(manifest.allows("b", None) && !manifest.allows("b", old));
    }

    #[test]
    fn a_flipped_bit_in_the_manifest_is_noticed() {
        let mut manifest = Manifest::default();
        manifest.settle("parameters.ron", Some(Mark::of(b"1")));
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
