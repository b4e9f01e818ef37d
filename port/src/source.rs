//! Splits a text into blocks and what stands between them, and turns comments of other forms
//! into comments in brackets.

use crate::block::{ForeignBlock, LinePiece, split_block};

/// A foreign block, and the text between it and the next block.
#[derive(Clone, Debug)]
pub(crate) struct SourcePart {
    /// The block, split into its pieces.
    pub block: ForeignBlock,
    /// The text after the block: `;`, the end of the line, or both.
    pub separator: String,
    /// The characters that end a line of the foreign text; the porter ends added lines with the
    /// same.
    pub line_end: &'static str,
}

/// Splits a text into its blocks. With `semicolon_comments` a `;` begins a comment, else it
/// ends a block.
pub(crate) fn read_source(text: &str, semicolon_comments: bool) -> Vec<SourcePart> {
    let line_end = match text.contains("\r\n") {
        true => "\r\n",
        false => "\n",
    };
    let mut parts = Vec::new();
    for (line, whole) in (1..).zip(text.split_inclusive('\n')) {
        let content = whole.trim_end_matches(['\n', '\r']);
        let end = &whole[content.len()..];
        let mut push = |text: &str, separator: String| {
            parts.push(SourcePart {
                block: split_block(line, text),
                separator,
                line_end,
            });
        };
        if semicolon_comments {
            push(&bracket_comment(content), end.to_owned());
            continue;
        }
        let mut rest = content;
        while let Some(at) = find_outside(rest, b';') {
            let next = rest[at + 1..].trim();
            if next.is_empty() {
                push(&rest[..at], format!("{}{end}", &rest[at..]));
                rest = "";
                break;
            }
            if is_prose(next) {
                push(&rest[..at], format!("; ({}){end}", without_brackets(next)));
                rest = "";
                break;
            }
            push(&rest[..at], ";".to_owned());
            rest = &rest[at + 1..];
        }
        if !rest.is_empty() || content.is_empty() {
            push(rest, end.to_owned());
        }
    }
    parts
}

/// Returns the position of the first byte `wanted` outside comments; `None` if there is none.
fn find_outside(text: &str, wanted: u8) -> Option<usize> {
    let mut depth = 0;
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'(' => depth += 1,
            b')' => depth -= 1,
            _ if byte == wanted && depth <= 0 => return Some(at),
            _ => {}
        }
    }
    None
}

/// Whether the text after a `;` is a remark and not a block.
fn is_prose(text: &str) -> bool {
    let block = split_block(0, text);
    let letters = |piece: &LinePiece| match piece {
        LinePiece::Formula(formula) => formula.bytes().filter(u8::is_ascii_alphabetic).count(),
        LinePiece::Text(_) | LinePiece::Word(_) => 0,
    };
    let has_formula = text.contains(['#', '[', '=']);
    !has_formula && block.pieces.iter().map(letters).sum::<usize>() > 1
}

/// Rewrites a comment after `;` or `//` as a comment in brackets.
fn bracket_comment(line: &str) -> String {
    let slashes = line.find("//");
    let semicolon = find_outside(line, b';');
    let (at, width) = match (semicolon, slashes) {
        (Some(one), Some(two)) if two < one => (two, 2),
        (Some(one), _) => (one, 1),
        (None, Some(two)) => (two, 2),
        (None, None) => return line.to_owned(),
    };
    let comment = line[at + width..].trim();
    match comment {
        "" => line[..at].to_owned(),
        _ => format!("{}({})", &line[..at], without_brackets(comment)),
    }
}

/// Replaces round brackets by square ones, because a comment ends at the first closing round
/// bracket.
pub(crate) fn without_brackets(text: &str) -> String {
    text.replace('(', "[").replace(')', "]")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, semicolon_comments: bool) -> String {
        let parts = read_source(text, semicolon_comments);
        parts
            .iter()
            .map(|it| format!("{}{}", it.block.text(), it.separator))
            .collect()
    }

    #[test]
    fn a_text_keeps_its_layout() {
        for text in [
            "",
            "%\nO1;\nG0 X1.; Z2.;\n\nM30",
            "G0 X1 (A;B);\r\nM30;\r\n",
        ] {
            assert_eq!(read(text, false), text);
        }
    }

    #[test]
    fn comments_of_other_forms_get_brackets() {
        assert_eq!(
            read("G0 X1 ; go (fast)\n;\n", true),
            "G0 X1 (go [fast])\n\n"
        );
        assert_eq!(read("G0 X1 // go\n", true), "G0 X1 (go)\n");
        assert_eq!(read("G0 X1; rough turn\n", false), "G0 X1; (rough turn)\n");
    }
}
