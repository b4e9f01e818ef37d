//! The text in the editor, where it came from, and how it goes back there.

use std::path::{Path, PathBuf};

use gsk_core::program::Program;

use crate::files::decode::{Encoding, encode};
use crate::files::program_file::ProgramFile;

/// Above this a text is shown and not edited: an editor that lays the whole text out
/// would be slow.
pub const LARGEST_EDITED: usize = 300_000;

/// Where a text came from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Origin {
    /// Nowhere: it is new.
    #[default]
    New,
    /// A file, with its encoding.
    File(PathBuf, Encoding),
    /// A program of the control's memory.
    Memory(u16),
}

/// How the lines of a text end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineEnd {
    /// LF.
    #[default]
    Lf,
    /// CR and LF.
    CrLf,
    /// CR alone, the EOB of EIA.
    Cr,
}

impl LineEnd {
    const fn text(self) -> &'static str {
        match self {
            Self::Lf => "\n",
            Self::CrLf => "\r\n",
            Self::Cr => "\r",
        }
    }

    /// That of most lines of a text.
    fn of(text: &str) -> Self {
        let both = text.matches("\r\n").count();
        let feeds = text.matches('\n').count() - both;
        let returns = text.matches('\r').count() - both;
        if both > 0 && both >= feeds.max(returns) {
            Self::CrLf
        } else if returns > feeds {
            Self::Cr
        } else {
            Self::Lf
        }
    }
}

/// The text in the editor.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// Where it came from.
    pub origin: Origin,
    /// Its lines end with LF here.
    pub text: String,
    /// Counts the changes.
    pub revision: u64,
    line_end: LineEnd,
    /// The text as it was read or saved last.
    kept: String,
    unsaved: bool,
    /// Where lines begin, bytes.
    lines: Vec<usize>,
}

impl Document {
    /// A text from somewhere.
    pub fn new(origin: Origin, text: &str) -> Self {
        let line_end = LineEnd::of(text);
        let text = with_line_feeds(text);
        let mut document = Self {
            origin,
            kept: text.clone(),
            text,
            line_end,
            ..Self::default()
        };
        document.lines = line_starts(&document.text);
        document
    }

    /// A file.
    pub fn of_file(file: &ProgramFile) -> Self {
        Self::new(Origin::File(file.path.clone(), file.encoding), &file.text)
    }

    /// The text has been changed.
    pub fn changed(&mut self) {
        self.revision += 1;
        self.unsaved = self.text != self.kept;
        self.lines = line_starts(&self.text);
    }

    /// Whether it differs from what was read or saved last.
    pub const fn is_unsaved(&self) -> bool {
        self.unsaved
    }

    /// Whether it may be edited.
    pub const fn is_edited(&self) -> bool {
        self.text.len() <= LARGEST_EDITED
    }

    /// What a text was saved as, somewhere; what was typed since is unsaved.
    pub fn saved(&mut self, text: String, origin: Origin) {
        self.kept = text;
        self.origin = origin;
        self.unsaved = self.text != self.kept;
    }

    /// The bytes of its file: in its encoding, with its line ends.
    pub fn bytes(&self, encoding: Encoding) -> Vec<u8> {
        encode(&self.with_its_line_ends(), encoding)
    }

    /// The encoding of its file; a new one is UTF-8.
    pub const fn encoding(&self) -> Encoding {
        match self.origin {
            Origin::File(_, encoding) => encoding,
            Origin::New | Origin::Memory(_) => Encoding::Utf8,
        }
    }

    /// The program as the control would read it.
    pub fn program(&self) -> Program {
        Program::new(self.text.as_str())
    }

    /// How many lines it has.
    pub const fn line_count(&self) -> usize {
        self.lines.len()
    }

    /// A line, from 0, without its end.
    pub fn line(&self, index: usize) -> &str {
        let Some(from) = self.lines.get(index).copied() else {
            return "";
        };
        let to = self
            .lines
            .get(index + 1)
            .map_or(self.text.len(), |next| next - 1);
        self.text.get(from..to).unwrap_or_default()
    }

    /// Where a line begins, bytes.
    pub fn line_start(&self, index: usize) -> usize {
        self.lines.get(index).copied().unwrap_or(self.text.len())
    }

    /// The line at a byte, from 0.
    pub fn line_at(&self, byte: usize) -> usize {
        let after = self.lines.partition_point(|start| *start <= byte);
        after.saturating_sub(1)
    }

    /// The byte of a character.
    pub fn byte_of(&self, character: usize) -> usize {
        let mut letters = self.text.char_indices();
        letters.nth(character).map_or(self.text.len(), |(at, _)| at)
    }

    /// The character at a byte.
    pub fn character_of(&self, byte: usize) -> usize {
        let before = self.text.get(..byte).unwrap_or(&self.text);
        before.chars().count()
    }

    /// What it is called: the name of its file, or its number.
    pub fn name(&self) -> String {
        match &self.origin {
            Origin::File(path, _) => file_name(path),
            Origin::Memory(number) => format!("O{number:04}"),
            Origin::New => String::new(),
        }
    }

    fn with_its_line_ends(&self) -> String {
        match self.line_end {
            LineEnd::Lf => self.text.clone(),
            end => self.text.replace('\n', end.text()),
        }
    }
}

/// A text whose lines end with LF.
pub fn with_line_feeds(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n")
}

/// The last part of a path.
pub fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn line_starts(text: &str) -> Vec<usize> {
    let after = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
    core::iter::once(0)
        .chain(after.map(|(at, _)| at + 1))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::decode::decode;

    #[test]
    fn a_file_goes_back_as_it_came() {
        let texts = ["O0001\r\n(粗车)\r\nM30\r\n", "O1\nM30\n", "O1\rG0X1\rM30"];
        let encodings = [
            Encoding::Gb18030,
            Encoding::Utf8Marked,
            Encoding::Utf16Little,
        ];
        for text in texts {
            for encoding in encodings {
                let bytes = encode(text, encoding);
                let decoded = decode(bytes.clone()).expect("text");
                let origin = Origin::File(PathBuf::from("a.CNC"), decoded.encoding);
                let document = Document::new(origin, &decoded.text);
                assert!(!document.text.contains('\r'));
                if decoded.encoding == encoding {
                    assert_eq!(document.bytes(document.encoding()), bytes);
                }
            }
        }
    }

    #[test]
    fn what_is_typed_and_taken_back_is_not_unsaved() {
        let mut document = Document::new(Origin::New, "G00 X1\nM30\n");
        document.text.push_str("G00");
        document.changed();
        assert!(document.is_unsaved());
        document.text.truncate(11);
        document.changed();
        assert!(!document.is_unsaved());
        assert_eq!((document.revision, document.line_count()), (2, 3));
        document.text.insert(0, '车');
        document.changed();
        document.saved(document.text.clone(), Origin::Memory(3));
        assert!(!document.is_unsaved() && document.name() == "O0003");
    }

    #[test]
    fn lines_bytes_and_characters_agree() {
        let document = Document::new(Origin::New, "(车)\nG00\n\nM30");
        assert_eq!(document.line_count(), 4);
        let lines: Vec<&str> = (0..5).map(|index| document.line(index)).collect();
        assert_eq!(lines, ["(车)", "G00", "", "M30", ""]);
        let byte = document.line_start(1);
        assert_eq!((byte, document.character_of(byte)), (6, 4));
        assert_eq!((document.byte_of(4), document.line_at(8)), (6, 1));
    }
}
