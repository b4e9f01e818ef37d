//! Answers what an editor shows at words: kinds, signatures of codes, modal codes.

use gsk_language::{TokenKind, modal_hints, semantic_tokens, signature_help};
use lsp_types::{
    InlayHint, InlayHintLabel, InlayHintParams, ParameterInformation, ParameterLabel,
    SemanticToken, SemanticTokenModifier, SemanticTokenType, SemanticTokens, SemanticTokensLegend,
    SignatureInformation, TextDocumentPositionParams, Uri,
};

use super::request::{RequestAnswer, document_position, find_document, to_answer};
use super::server_state::ServerState;

/// Bit of the modifier `rapid` in a token.
const RAPID: u32 = 1;
/// Bit of the modifier `unread` in a token.
const UNREAD: u32 = 2;

/// The kinds and modifiers of tokens in the order of their numbers.
pub fn token_legend() -> SemanticTokensLegend {
    SemanticTokensLegend {
        token_types: TokenKind::ALL.into_iter().map(token_type).collect(),
        token_modifiers: vec![
            SemanticTokenModifier::new("rapid"),
            SemanticTokenModifier::new("unread"),
        ],
    }
}

/// The kind of the protocol for a kind of word, for which every colour scheme has a colour.
const fn token_type(kind: TokenKind) -> SemanticTokenType {
    match kind {
        TokenKind::Name => SemanticTokenType::TYPE,
        TokenKind::Code => SemanticTokenType::KEYWORD,
        TokenKind::Function => SemanticTokenType::FUNCTION,
        TokenKind::Setting => SemanticTokenType::PARAMETER,
        TokenKind::Axis => SemanticTokenType::PROPERTY,
        TokenKind::Word => SemanticTokenType::VARIABLE,
        TokenKind::Statement => SemanticTokenType::MACRO,
        TokenKind::Comment => SemanticTokenType::COMMENT,
    }
}

/// Answers the tokens of a document, or of its lines `lines` (from 0).
pub fn on_tokens(
    desk: &ServerState,
    uri: &Uri,
    lines: Option<std::ops::Range<u32>>,
) -> RequestAnswer {
    let document = find_document(desk, uri)?;
    let text = &document.text;
    let lines = lines.unwrap_or(0..text.line_count());
    let model = desk.editor.reading.model;
    let tokens = semantic_tokens(text, document.structure(), lines, model);
    let mut data = Vec::with_capacity(tokens.len());
    let (mut line, mut column) = (0, 0);
    for token in &tokens {
        let range = desk.editor.encoding.to_range(text, &token.range);
        let start = range.start;
        if start.line != line {
            column = 0;
        }
        let kind = TokenKind::ALL.iter().position(|it| *it == token.kind);
        let modifier = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        data.push(SemanticToken {
            delta_line: start.line - line,
            delta_start: start.character - column,
            length: range.end.character - start.character,
            token_type: kind.unwrap_or_default() as u32,
            token_modifiers_bitset: modifier(token.is_rapid, RAPID)
                | modifier(token.is_unread, UNREAD),
        });
        (line, column) = (start.line, start.character);
    }
    to_answer(&SemanticTokens {
        result_id: None,
        data,
    })
}

pub fn on_signature(desk: &ServerState, params: &TextDocumentPositionParams) -> RequestAnswer {
    let (document, position) = document_position(desk, params)?;
    let found = signature_help(&document.text, position, desk.editor.reading);
    let found = found.map(|help| {
        let signatures = help.signatures.into_iter().map(|it| SignatureInformation {
            label: it.label,
            documentation: Some(lsp_types::Documentation::String(it.about)),
            parameters: Some(it.words.into_iter().map(to_parameter).collect()),
            active_parameter: None,
        });
        lsp_types::SignatureHelp {
            signatures: signatures.collect(),
            active_signature: Some(help.active as u32),
            active_parameter: help.active_word.map(|it| it as u32),
        }
    });
    to_answer(&found)
}

fn to_parameter(word: gsk_language::SignatureWord) -> ParameterInformation {
    let (from, to) = word.label_range;
    ParameterInformation {
        // The label is ASCII: bytes are characters.
        label: ParameterLabel::LabelOffsets([from, to]),
        documentation: Some(lsp_types::Documentation::String(word.meaning)),
    }
}

/// Answers the modal codes in force; none if the setting `hints.modal` is off.
pub fn on_inlay_hints(desk: &ServerState, params: &InlayHintParams) -> RequestAnswer {
    let document = find_document(desk, &params.text_document.uri)?;
    if !desk.settings.modal_hints {
        return to_answer(&Vec::<InlayHint>::new());
    }
    let text = &document.text;
    let lines = params.range.start.line..params.range.end.line.saturating_add(1);
    let model = desk.editor.reading.model;
    let hints = modal_hints(text, document.structure(), lines, model);
    let shown = hints.into_iter().map(|it| InlayHint {
        position: desk.editor.encoding.to_editor(text, it.at),
        label: InlayHintLabel::String(it.label),
        kind: None,
        text_edits: None,
        tooltip: None,
        padding_left: Some(it.is_after),
        padding_right: Some(!it.is_after),
        data: None,
    });
    to_answer(&shown.collect::<Vec<_>>())
}
