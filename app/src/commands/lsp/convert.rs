//! Converts positions and files between the protocol and the program: columns in UTF-8 or
//! UTF-16, paths and URIs.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use gsk_language::{Position, TextChange, TextDocument, TextRange};
use lsp_types::{PositionEncodingKind, Range, TextEdit, Uri};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, percent_encode};

/// The unit in which the protocol counts columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColumnEncoding {
    /// Columns count bytes of UTF-8.
    Utf8,
    /// Columns count code units of UTF-16, which every editor supports.
    #[default]
    Utf16,
}

impl ColumnEncoding {
    /// Selects the fastest encoding that the editor offers: UTF-8 if it is offered, else
    /// UTF-16.
    pub fn select(offered: Option<&[PositionEncodingKind]>) -> Self {
        let bytes = offered.is_some_and(|it| it.contains(&PositionEncodingKind::UTF8));
        if bytes { Self::Utf8 } else { Self::Utf16 }
    }

    /// Returns the name of the encoding in the protocol.
    pub const fn to_protocol(self) -> PositionEncodingKind {
        match self {
            Self::Utf8 => PositionEncodingKind::UTF8,
            Self::Utf16 => PositionEncodingKind::UTF16,
        }
    }

    /// Converts a byte offset in `line` to a column, both from 0.
    fn to_column(self, line: &str, byte: usize) -> u32 {
        let byte = line.floor_char_boundary(byte.min(line.len()));
        let before = line.get(..byte).unwrap_or(line);
        let column = match self {
            Self::Utf8 => before.len(),
            Self::Utf16 => before.chars().map(char::len_utf16).sum(),
        };
        u32::try_from(column).unwrap_or(u32::MAX)
    }

    /// Converts a column of `line` (from 0) to a byte offset; the end of the line if the
    /// column is beyond it.
    fn to_byte(self, line: &str, column: u32) -> usize {
        let column = column as usize;
        match self {
            Self::Utf8 => line.floor_char_boundary(column.min(line.len())),
            Self::Utf16 => {
                let mut units = 0;
                for (byte, character) in line.char_indices() {
                    if units >= column {
                        return byte;
                    }
                    units += character.len_utf16();
                }
                line.len()
            }
        }
    }

    pub fn to_editor(self, text: &TextDocument, at: Position) -> lsp_types::Position {
        let column = self.to_column(text.line(at.line), at.byte as usize);
        lsp_types::Position::new(at.line, column)
    }

    pub fn to_text(self, text: &TextDocument, at: lsp_types::Position) -> Position {
        let byte = self.to_byte(text.line(at.line), at.character);
        Position {
            line: at.line,
            byte: u32::try_from(byte).unwrap_or(u32::MAX),
        }
    }

    pub fn to_range(self, text: &TextDocument, text_range: &TextRange) -> Range {
        let (from, to) = text_range.start_and_end();
        Range::new(self.to_editor(text, from), self.to_editor(text, to))
    }

    pub fn to_text_edit(self, text: &TextDocument, edit: &TextChange) -> TextEdit {
        let (from, to) = (
            self.to_editor(text, edit.from),
            self.to_editor(text, edit.to),
        );
        TextEdit::new(Range::new(from, to), edit.text.clone())
    }
}

/// The path of a `file:` URI; `None` for any other URI, such as that of an unsaved text.
pub fn uri_to_path(uri: &Uri) -> Option<PathBuf> {
    let rest = uri.as_str().strip_prefix("file://")?;
    let path = rest.strip_prefix("localhost").unwrap_or(rest);
    let path = path.starts_with('/').then_some(path)?;
    let decoded = percent_decode_str(path).decode_utf8().ok()?;
    // Windows: `/c:/parts` is `c:/parts`.
    let has_drive = matches!(decoded.as_bytes(), [b'/', letter, b':', b'/', ..] if letter.is_ascii_alphabetic());
    Some(PathBuf::from(if has_drive {
        &decoded[1..]
    } else {
        &decoded[..]
    }))
}

/// The bytes of a path that a URI encodes: all but letters, digits, `-._~` and the slash.
const ENCODED_IN_PATH: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~')
    .remove(b'/');

pub fn path_to_uri(path: &Path) -> Option<Uri> {
    // Windows: the separators of a URI are slashes.
    let bytes: Vec<u8> = (path.as_os_str().as_encoded_bytes().iter())
        .map(|byte| if *byte == b'\\' { b'/' } else { *byte })
        .collect();
    let root = if bytes.starts_with(b"/") { "" } else { "/" };
    let encoded = percent_encode(&bytes, ENCODED_IN_PATH);
    Uri::from_str(&format!("file://{root}{encoded}")).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_bytes_or_units_of_utf_16() {
        let text = TextDocument::new("G1\n(车𝄞) X2\n");
        let at = Position { line: 1, byte: 8 };
        let wide = ColumnEncoding::Utf16.to_editor(&text, at);
        assert_eq!((wide.line, wide.character), (1, 4));
        assert_eq!(ColumnEncoding::Utf16.to_text(&text, wide), at);
        assert_eq!(ColumnEncoding::Utf8.to_editor(&text, at).character, 8);
        let beyond = lsp_types::Position::new(1, 99);
        assert_eq!(ColumnEncoding::Utf16.to_text(&text, beyond).byte, 12);
        let within = lsp_types::Position::new(1, 3);
        assert_eq!(
            ColumnEncoding::Utf16.to_text(&text, within).byte,
            8,
            "half a character"
        );
    }

    #[test]
    fn files_are_uris_and_back() {
        let path = Path::new("/tmp/Teile 1/车削%.CNC");
        let uri = path_to_uri(path).expect("uri");
        assert!(
            uri.as_str().starts_with("file:///tmp/Teile%201/%E8"),
            "{uri:?}"
        );
        assert_eq!(uri_to_path(&uri).as_deref(), Some(path));
        let drive = Uri::from_str("file:///c%3A/parts/a.CNC").expect("uri");
        assert_eq!(uri_to_path(&drive), Some(PathBuf::from("c:/parts/a.CNC")));
        for none in ["untitled:Untitled-1", "file:///%zz", "file://host/x"] {
            let uri = Uri::from_str(none);
            assert_eq!(uri.ok().as_ref().and_then(uri_to_path), None, "{none}");
        }
    }
}
