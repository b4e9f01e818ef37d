//! Semantic tokens: the words of a text with their kinds.

use std::ops::Range;

use gsk_core::model::{GCode, ModelId};

use crate::codes::{ModalCodes, is_motion};
use crate::structure::Structure;
use crate::text::{TextDocument, TextRange};
use crate::words::{SpanKind, spans, word_of};

/// The kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// An N or O word, which names a block or a program.
    Name,
    /// A G word.
    Code,
    /// An M word.
    Function,
    /// An S, T or F word.
    Setting,
    /// The coordinate of an axis.
    Axis,
    /// Any other word.
    Word,
    /// A statement of macro B.
    Statement,
    /// A comment.
    Comment,
}

impl TokenKind {
    /// All kinds in the order of their indices.
    pub const ALL: [Self; 8] = [
        Self::Name,
        Self::Code,
        Self::Function,
        Self::Setting,
        Self::Axis,
        Self::Word,
        Self::Statement,
        Self::Comment,
    ];

    const fn from_span(kind: SpanKind) -> Option<Self> {
        Some(match kind {
            SpanKind::Name => Self::Name,
            SpanKind::Code => Self::Code,
            SpanKind::Function => Self::Function,
            SpanKind::Setting => Self::Setting,
            SpanKind::Axis => Self::Axis,
            SpanKind::Other => Self::Word,
            SpanKind::Statement => Self::Statement,
            SpanKind::Comment => Self::Comment,
            SpanKind::Mark | SpanKind::Foreign => return None,
        })
    }
}

/// A word or comment with its kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SemanticToken {
    /// Range of the token.
    pub range: TextRange,
    /// The kind of the token.
    pub kind: TokenKind,
    /// Whether the coordinate is the end of a rapid: G00 is in force.
    pub is_rapid: bool,
    /// Whether the control does not read the text: it is outside the program.
    pub is_unread: bool,
}

/// Returns the tokens of the lines `lines` of a text, in their order.
pub fn semantic_tokens(
    text: &TextDocument,
    structure: &Structure,
    lines: Range<u32>,
    model: ModelId,
) -> Vec<SemanticToken> {
    let last = lines.end.min(text.line_count());
    let first = lines.start.min(last);
    let part = structure.parts.get(structure.part_at_line(first));
    let mut modal = ModalCodes::above(text, part.map_or(0, |it| it.from), first, model);
    let record = model.record();
    let mut tokens = Vec::new();
    for index in first..last {
        modal.read_line(text, index, model);
        let line = text.line(index);
        let spans = spans(line);
        let is_cycle_block = spans.iter().any(|span| {
            let word = word_of(line, span).filter(|_| span.kind == SpanKind::Code);
            let code = word.and_then(|word| record.g_code(word.number()?.into()));
            code.is_some_and(|code| !is_motion(code) && !is_setting(code))
        });
        let rapid = modal
            .motion
            .and_then(|(code, _)| record.g_code(code.into()));
        let is_rapid =
            !is_cycle_block && matches!(rapid, Some(GCode::Rapid | GCode::StraightRapid));
        let (from, to) = structure.block_lines;
        for span in spans {
            if let Some(kind) = TokenKind::from_span(span.kind) {
                tokens.push(SemanticToken {
                    range: TextRange::new(index, &span.range),
                    kind,
                    is_rapid: is_rapid && kind == TokenKind::Axis,
                    is_unread: !(from..to).contains(&index),
                });
            }
        }
    }
    tokens
}

/// Whether a code sets a modal state and reads no coordinates.
const fn is_setting(code: GCode) -> bool {
    matches!(
        code,
        GCode::FeedPerMinute
            | GCode::FeedPerRevolution
            | GCode::SurfaceSpeed
            | GCode::SpindleSpeed
            | GCode::NoseOff
            | GCode::NoseLeft
            | GCode::NoseRight
            | GCode::Absolute
            | GCode::Incremental
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str, lines: Range<u32>) -> Vec<(String, TokenKind, bool, bool)> {
        let text = TextDocument::new(text);
        let structure = Structure::read(&text);
        let tokens = semantic_tokens(&text, &structure, lines, ModelId::default());
        let shown = |it: SemanticToken| {
            let line = text.line(it.range.line);
            let word = &line[it.range.from as usize..it.range.to as usize];
            (word.to_owned(), it.kind, it.is_rapid, it.is_unread)
        };
        tokens.into_iter().map(shown).collect()
    }

    #[test]
    fn coordinates_are_rapid_where_g00_is_in_force() {
        let text = "O1\nG00 X50\nZ2 (near)\nG50 S2000\nG71 U2 R1\nG01 Z-5 F100\n%\nG00 X1\n";
        let word = |text: &str, kind, rapid| (text.to_owned(), kind, rapid, false);
        let all = found(text, 0..7);
        assert_eq!(all[0], word("O1", TokenKind::Name, false));
        assert_eq!(all[2], word("X50", TokenKind::Axis, true));
        assert_eq!(all[3], word("Z2", TokenKind::Axis, true));
        assert_eq!(all[4], word("(near)", TokenKind::Comment, false));
        assert_eq!(all[8], word("U2", TokenKind::Axis, false), "{all:?}");
        assert_eq!(all[11], word("Z-5", TokenKind::Axis, false), "{all:?}");
        // The lines of a range alone are the same, and text after the end is not read.
        assert_eq!(found(text, 2..3), all[3..5]);
        assert!(found(text, 7..8).iter().all(|it| it.3));
    }
}
