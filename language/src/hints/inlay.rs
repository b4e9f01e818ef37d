//! Inlay hints: modal codes that a block does not show.

use std::ops::Range;

use gsk_core::model::ModelId;

use crate::codes::{ModalCodes, code_in_force};
use crate::structure::Structure;
use crate::text::{Position, TextDocument};
use crate::words::{Span, SpanKind, spans, word_of};

/// A text that an editor shows between the words of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModalHint {
    /// The position before which the text is shown.
    pub at: Position,
    /// The shown text, such as `G01` or `mm/min`.
    pub label: String,
    /// Whether the hint follows a word, and not precedes it.
    pub is_after: bool,
}

/// Returns the hints of the lines `lines`: the motion code in force before the coordinates of a
/// block without one, the unit of F and S, and the tool at a cycle.
pub fn modal_hints(
    text: &TextDocument,
    structure: &Structure,
    lines: Range<u32>,
    model: ModelId,
) -> Vec<ModalHint> {
    let (begin, end) = structure.block_lines;
    let last = lines.end.min(text.line_count()).min(end);
    let first = lines.start.max(begin).min(last);
    let part = structure.parts.get(structure.part_at_line(first));
    let mut modal = ModalCodes::above(text, part.map_or(0, |it| it.from), first, model);
    let mut hints = Vec::new();
    for index in first..last {
        modal.read_line(text, index, model);
        line_hints(text, index, &modal, model, &mut hints);
    }
    hints
}

fn line_hints(
    text: &TextDocument,
    index: u32,
    modal: &ModalCodes,
    model: ModelId,
    hints: &mut Vec<ModalHint>,
) {
    let line = text.line(index);
    let spans = spans(line);
    let hint = |byte: usize, label: String, is_after| ModalHint {
        at: Position {
            line: index,
            byte: byte as u32,
        },
        label,
        is_after,
    };
    let is_code = |it: &&Span| matches!(it.kind, SpanKind::Code | SpanKind::Statement);
    let has_code = spans.iter().any(|it| is_code(&it));
    let first_axis = spans.iter().find(|it| it.kind == SpanKind::Axis);
    if let (false, Some(axis), Some((code, _))) = (has_code, first_axis, modal.motion) {
        hints.push(hint(axis.range.start, format!("G{code:02}"), false));
    }
    let code = code_in_force(text, index, line, &spans, model);
    let number = code.map(|it| it.number);
    let is_thread = matches!(number, Some(32..=34 | 76 | 92));
    for span in spans.iter().filter(|it| it.kind == SpanKind::Setting) {
        let unit = match word_of(line, span).map(|word| word.address) {
            Some('F') if !is_thread => match modal.feed {
                Some((94 | 98, _)) => "mm/min",
                Some((95 | 99, _)) => "mm/r",
                _ => continue,
            },
            Some('S') if number != Some(50) => match modal.speed {
                Some((96, _)) => "m/min",
                Some((97, _)) => "r/min",
                _ => continue,
            },
            _ => continue,
        };
        hints.push(hint(span.range.end, unit.to_owned(), true));
    }
    let own_tool = spans
        .iter()
        .any(|it| word_of(line, it).is_some_and(|word| word.address == 'T'));
    let is_cycle = has_code && matches!(number, Some(70..=76 | 90 | 92 | 94));
    if let (true, false, Some((tool, _))) = (is_cycle, own_tool, &modal.tool) {
        let end = spans.last().map_or(0, |it| it.range.end);
        hints.push(hint(end, format!("T{tool}"), true));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modal_codes_are_shown_where_they_are_omitted() {
        let text = TextDocument::new(
            "O1\nT0101 G99 G96 S150\nG00 X50 Z2\nX20\nG01 Z-5 F0.2\nX30 (edge)\nG92 X20 Z-9 F2\n\
             X19.5\nG50 S2000\n",
        );
        let structure = Structure::read(&text);
        let shown = |lines| -> Vec<(u32, u32, String)> {
            let hints = modal_hints(&text, &structure, lines, ModelId::default());
            let all = hints.into_iter();
            all.map(|it| (it.at.line, it.at.byte, it.label)).collect()
        };
        let wanted = [
            (1, 18, "m/min"),
            (3, 0, "G00"),
            (4, 12, "mm/r"),
            (5, 0, "G01"),
            (6, 14, "T0101"),
            (7, 0, "G92"),
        ];
        let wanted = wanted.map(|(line, byte, label)| (line, byte, label.to_owned()));
        assert_eq!(shown(0..9), wanted);
        assert_eq!(shown(5..6), wanted[3..4]);
        assert_eq!(shown(50..60), []);
    }
}
