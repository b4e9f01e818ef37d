//! The functions that the editor supports, and those that this server provides.

use gsk_core::setup::Setup;
use gsk_language::ReadingContext;
use gsk_messages::Language;
use lsp_types::{
    CodeActionKind, CodeActionOptions, CodeActionProviderCapability, CodeLensOptions,
    CompletionOptions, DiagnosticTag, FoldingRangeProviderCapability, HoverProviderCapability,
    InitializeParams, MarkupKind, OneOf, RenameOptions, SaveOptions, SemanticTokensFullOptions,
    SemanticTokensOptions, ServerCapabilities, SignatureHelpOptions, TextDocumentSyncCapability,
    TextDocumentSyncKind, TextDocumentSyncOptions, TextDocumentSyncSaveOptions,
    WorkDoneProgressOptions,
};

use super::convert::ColumnEncoding;
use super::hints;
use super::server_state::EditorCapabilities;
use crate::cli::is_chinese;

/// Reads from the initialization message what the editor supports.
pub fn read_capabilities(
    params: &InitializeParams,
    setup: &Setup,
    language: Option<Language>,
) -> EditorCapabilities {
    let general = params.capabilities.general.as_ref();
    let offered = general.and_then(|it| it.position_encodings.as_deref());
    let text_document = params.capabilities.text_document.as_ref();
    let item = text_document
        .and_then(|it| it.completion.as_ref())
        .and_then(|it| it.completion_item.as_ref());
    let hover = text_document.and_then(|it| it.hover.as_ref());
    let formats = [
        hover.and_then(|it| it.content_format.as_deref()),
        item.and_then(|it| it.documentation_format.as_deref()),
    ];
    let [hover, proposal] =
        formats.map(|it| it.is_some_and(|it| it.contains(&MarkupKind::Markdown)));
    let actions = text_document
        .and_then(|it| it.code_action.as_ref())
        .is_some_and(|it| it.code_action_literal_support.is_some());
    let tags = text_document
        .and_then(|it| it.publish_diagnostics.as_ref())
        .and_then(|it| it.tag_support.as_ref())
        .is_some_and(|it| it.value_set.contains(&DiagnosticTag::UNNECESSARY));
    let chinese = params.locale.as_deref().is_some_and(is_chinese);
    let by_locale = if chinese { Language::Zh } else { Language::En };
    EditorCapabilities {
        encoding: ColumnEncoding::select(offered),
        snippets: item.and_then(|it| it.snippet_support).unwrap_or(false),
        markdown: (hover, proposal),
        actions,
        tags,
        reading: ReadingContext {
            model: setup.memory.model.id(),
            macro_b: setup.memory.settings.macro_b || setup.memory.model.id().is_mill(),
            language: language.unwrap_or(by_locale),
        },
    }
}

/// The characters after which an editor shows the words of a code: the blank before a word, and
/// its letter.
const SIGNATURE_TRIGGERS: [&str; 15] = [
    " ", "F", "H", "I", "J", "K", "L", "P", "Q", "R", "S", "U", "W", "X", "Z",
];

/// Returns the list of functions that this server supports.
pub fn provided_functions(editor: &EditorCapabilities) -> ServerCapabilities {
    let triggers = ["G", "M", "T", "P", "Q", " "];
    ServerCapabilities {
        position_encoding: Some(editor.encoding.to_protocol()),
        text_document_sync: Some(TextDocumentSyncCapability::Options(
            TextDocumentSyncOptions {
                open_close: Some(true),
                change: Some(TextDocumentSyncKind::INCREMENTAL),
                save: Some(TextDocumentSyncSaveOptions::SaveOptions(
                    SaveOptions::default(),
                )),
                ..TextDocumentSyncOptions::default()
            },
        )),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(triggers.map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        document_highlight_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        folding_range_provider: Some(FoldingRangeProviderCapability::Simple(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        document_range_formatting_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        })),
        code_action_provider: editor.actions.then(|| {
            CodeActionProviderCapability::Options(CodeActionOptions {
                code_action_kinds: Some(vec![CodeActionKind::QUICKFIX]),
                ..CodeActionOptions::default()
            })
        }),
        signature_help_provider: Some(SignatureHelpOptions {
            trigger_characters: Some(SIGNATURE_TRIGGERS.map(str::to_owned).to_vec()),
            ..SignatureHelpOptions::default()
        }),
        inlay_hint_provider: Some(OneOf::Left(true)),
        semantic_tokens_provider: Some(
            SemanticTokensOptions {
                legend: hints::token_legend(),
                range: Some(true),
                full: Some(SemanticTokensFullOptions::Bool(true)),
                ..SemanticTokensOptions::default()
            }
            .into(),
        ),
        workspace_symbol_provider: Some(OneOf::Left(true)),
        code_lens_provider: Some(CodeLensOptions {
            resolve_provider: Some(false),
        }),
        ..ServerCapabilities::default()
    }
}
