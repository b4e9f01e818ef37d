//! The text in the editor, its source, and how it is written back there.

use std::path::{Path, PathBuf};

use gsk_core::model::ProgramNaming;
use gsk_core::program::Program;
use gsk_host::files::decode::{TextEncoding, encode};
use gsk_host::files::program_file::ProgramFile;

/// Maximum size of a text that can be edited, bytes. The editor lays out the whole text and
/// would be slow with a larger one.
pub const MAX_EDITABLE_BYTES: usize = 300_000;

/// The source of a text, to which it is saved, too.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum TextOrigin {
    /// A new text that has no file or program yet.
    #[default]
    New,
    /// The text is from the file at this path, with this encoding.
    File(PathBuf, TextEncoding),
    /// The text is from the program memory, with this program number.
    Memory(u16),
}

/// The characters with which the lines of a text end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LineEnd {
    #[default]
    Lf,
    CrLf,
    /// Lines end with CR alone, the end of block of EIA.
    Cr,
}

impl LineEnd {
    const fn terminator(self) -> &'static str {
        match self {
            Self::Lf => "\n",
            Self::CrLf => "\r\n",
            Self::Cr => "\r",
        }
    }

    /// Detects the line end that most lines of a text have.
    fn detect(text: &str) -> Self {
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

/// A program text in the editor, with its origin.
#[derive(Clone, Debug, Default)]
pub struct ProgramDocument {
    pub origin: TextOrigin,
    /// The text of the document; its lines end with LF.
    pub text: String,
    /// Number that increases with each change of the text.
    pub revision: u64,
    original_line_end: LineEnd,
    /// The text as it was last read or saved.
    saved_text: String,
    is_changed: bool,
    /// Byte offset at which each line starts.
    line_starts: Vec<usize>,
}

impl ProgramDocument {
    /// Creates a document with an unchanged text.
    pub fn new(origin: TextOrigin, text: &str) -> Self {
        let line_end = LineEnd::detect(text);
        let text = with_line_feeds(text);
        let mut document = Self {
            origin,
            saved_text: text.clone(),
            text,
            original_line_end: line_end,
            ..Self::default()
        };
        document.line_starts = find_line_starts(&document.text);
        document
    }

    /// Creates a document from a program file that was read.
    pub fn from_file(file: &ProgramFile) -> Self {
        Self::new(
            TextOrigin::File(file.path.clone(), file.encoding),
            &file.text,
        )
    }

    /// Updates the line starts and other derived data. The caller calls this after each change
    /// of `text`.
    pub fn update_after_change(&mut self) {
        self.revision += 1;
        self.is_changed = self.text != self.saved_text;
        self.line_starts = find_line_starts(&self.text);
    }

    /// Whether the text differs from the one that was read or saved last.
    pub const fn is_unsaved(&self) -> bool {
        self.is_changed
    }

    /// Whether the text is small enough to be edited.
    pub const fn is_editable(&self) -> bool {
        self.text.len() <= MAX_EDITABLE_BYTES
    }

    /// Records that `text` was saved to `origin`. Later changes remain unsaved.
    pub fn mark_saved(&mut self, text: String, origin: TextOrigin) {
        self.saved_text = text;
        self.origin = origin;
        self.is_changed = self.text != self.saved_text;
    }

    /// Encodes the text for a file, with this encoding and the original line ends.
    pub fn to_bytes(&self, encoding: TextEncoding) -> Vec<u8> {
        encode(&self.with_original_line_ends(), encoding)
    }

    /// The encoding of the document's file; UTF-8 if it has no file.
    pub const fn encoding(&self) -> TextEncoding {
        match self.origin {
            TextOrigin::File(_, encoding) => encoding,
            TextOrigin::New | TextOrigin::Memory(_) => TextEncoding::Utf8,
        }
    }

    /// Returns the text as a program of the control.
    pub fn to_program(&self) -> Program {
        Program::new(self.text.as_str())
    }

    pub const fn line_count(&self) -> usize {
        self.line_starts.len()
    }

    /// The line with this index, from 0, without its end; empty after the last line.
    pub fn line(&self, index: usize) -> &str {
        let Some(from) = self.line_starts.get(index).copied() else {
            return "";
        };
        let to = self
            .line_starts
            .get(index + 1)
            .map_or(self.text.len(), |next| next - 1);
        self.text.get(from..to).unwrap_or_default()
    }

    /// The byte offset at which a line begins, index from 0; the end of the text after the
    /// last line.
    pub fn line_start(&self, index: usize) -> usize {
        self.line_starts
            .get(index)
            .copied()
            .unwrap_or(self.text.len())
    }

    /// The index of the line that contains a byte offset, from 0.
    pub fn line_at(&self, byte: usize) -> usize {
        let after = self.line_starts.partition_point(|start| *start <= byte);
        after.saturating_sub(1)
    }

    /// The byte offset at which a character begins, both from 0.
    pub fn byte_of_character(&self, character: usize) -> usize {
        let mut letters = self.text.char_indices();
        letters.nth(character).map_or(self.text.len(), |(at, _)| at)
    }

    /// Returns the number of characters before a byte offset.
    pub fn character_at_byte(&self, byte: usize) -> usize {
        let before = self.text.get(..byte).unwrap_or(&self.text);
        before.chars().count()
    }

    /// The name of the document: its file name or program number; empty for a new text.
    pub fn name(&self, naming: ProgramNaming) -> String {
        match &self.origin {
            TextOrigin::File(path, _) => file_name(path),
            TextOrigin::Memory(number) => naming.name(*number),
            TextOrigin::New => String::new(),
        }
    }

    fn with_original_line_ends(&self) -> String {
        match self.original_line_end {
            LineEnd::Lf => self.text.clone(),
            end => self.text.replace('\n', end.terminator()),
        }
    }
}

/// Returns the text with each line end replaced by LF.
pub fn with_line_feeds(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n")
}

/// Returns the last component of a path.
pub fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn find_line_starts(text: &str) -> Vec<usize> {
    let after = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
    core::iter::once(0)
        .chain(after.map(|(at, _)| at + 1))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_host::files::decode::decode;

    #[test]
    fn a_file_is_written_back_unchanged() {
        let texts = ["O0001\r\n(粗车)\r\nM30\r\n", "O1\nM30\n", "O1\rG0X1\rM30"];
        let encodings = [
            TextEncoding::Gb18030,
            TextEncoding::Utf8Marked,
            TextEncoding::Utf16Little,
        ];
        for text in texts {
            for encoding in encodings {
                let bytes = encode(text, encoding);
                let decoded = decode(bytes.clone()).expect("text");
                let origin = TextOrigin::File(PathBuf::from("a.CNC"), decoded.encoding);
                let document = ProgramDocument::new(origin, &decoded.text);
                assert!(!document.text.contains('\r'));
                if decoded.encoding == encoding {
                    assert_eq!(document.to_bytes(document.encoding()), bytes);
                }
            }
        }
    }

    #[test]
    fn an_undone_change_is_not_unsaved() {
        let mut document = ProgramDocument::new(TextOrigin::New, "G00 X1\nM30\n");
        document.text.push_str("G00");
        document.update_after_change();
        assert!(document.is_unsaved());
        document.text.truncate(11);
        document.update_after_change();
        assert!(!document.is_unsaved());
        assert_eq!((document.revision, document.line_count()), (2, 3));
        document.text.insert(0, '车');
        document.update_after_change();
        document.mark_saved(document.text.clone(), TextOrigin::Memory(3));
        assert!(!document.is_unsaved() && document.name(ProgramNaming::Letter) == "O0003");
    }

    #[test]
    fn lines_bytes_and_characters_agree() {
        let document = ProgramDocument::new(TextOrigin::New, "(车)\nG00\n\nM30");
        assert_eq!(document.line_count(), 4);
        let lines: Vec<&str> = (0..5).map(|index| document.line(index)).collect();
        assert_eq!(lines, ["(车)", "G00", "", "M30", ""]);
        let byte = document.line_start(1);
        assert_eq!((byte, document.character_at_byte(byte)), (6, 4));
        assert_eq!((document.byte_of_character(4), document.line_at(8)), (6, 1));
    }
}
