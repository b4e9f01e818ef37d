//! Converts the findings of an analysis to diagnostics with their positions.

use gsk_core::command::ProgramId;
use gsk_core::preview::Lint;
use gsk_language::{
    Analysis, ProgramFinding, ReferenceTarget, Severity, Structure, TextDocument, TextRange,
};
use gsk_messages::{Language, say};
use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Location,
    NumberOrString, Range,
};

use super::convert::{ColumnEncoding, path_to_uri};
use super::documents::OpenDocument;
use super::server_state::EditorCapabilities;

/// The name that the editor shows as the source of a diagnostic.
const SOURCE: &str = "gsk980td";

/// Findings about text that has no effect: an editor shows it faded.
const WITHOUT_EFFECT: [Lint; 4] = [
    Lint::IgnoredWord,
    Lint::AfterEnd,
    Lint::UnreachableBlock,
    Lint::MillWord,
];

pub fn diagnostics(
    document: &OpenDocument,
    analysis: &Analysis,
    editor: &EditorCapabilities,
) -> Vec<Diagnostic> {
    let findings = analysis.findings.iter();
    findings
        .map(|it| to_diagnostic(document, it, editor))
        .collect()
}

/// Whether a finding is in the text of the document, and not in a program that it calls.
pub fn is_finding_in_text(document: &OpenDocument, finding: &ProgramFinding) -> bool {
    match finding.program {
        ProgramId::Stored(number) => is_part_of_text(document.structure(), number),
        _ => true,
    }
}

pub fn to_diagnostic(
    document: &OpenDocument,
    finding: &ProgramFinding,
    editor: &EditorCapabilities,
) -> Diagnostic {
    let (encoding, language) = (editor.encoding, editor.reading.language);
    let naming = editor.reading.model.record().program_naming();
    let fades = editor.tags && WITHOUT_EFFECT.iter().any(|lint| lint.id() == finding.code);
    let (text, structure) = (&*document.text, &**document.structure());
    let mut message = finding.text.clone();
    let (text_range, related) = match (finding.program, &finding.at) {
        (ProgramId::Stored(number), Some(_)) if !is_part_of_text(structure, number) => {
            message = format!("{}: {message}", naming.name(number));
            let text_range =
                find_call(structure, number).unwrap_or_else(|| first_block_line(text, structure));
            let related = related_position(document, number, finding, encoding, language);
            (text_range, related)
        }
        (_, Some(at)) => {
            let line = at.line.saturating_sub(1);
            (TextRange::new(line, &at.bytes), None)
        }
        (_, None) => (first_block_line(text, structure), None),
    };
    Diagnostic {
        range: to_visible_range(encoding, text, &text_range),
        severity: Some(match finding.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        }),
        code: Some(NumberOrString::String(finding.code.clone())),
        source: Some(SOURCE.to_owned()),
        message,
        related_information: related.map(|it| vec![it]),
        tags: fades.then(|| vec![DiagnosticTag::UNNECESSARY]),
        ..Diagnostic::default()
    }
}

/// Converts the range of a finding to one of the protocol; an empty range is widened to one
/// character, so that it is visible.
fn to_visible_range(
    encoding: ColumnEncoding,
    text: &TextDocument,
    text_range: &TextRange,
) -> Range {
    let mut range = encoding.to_range(text, text_range);
    if range.start == range.end && text_range.to < text.line(text_range.line).len() as u32 {
        range.end.character += 1;
    }
    range
}

/// Whether the text contains the program with this number.
fn is_part_of_text(structure: &Structure, number: u16) -> bool {
    structure
        .parts
        .iter()
        .any(|part| part.number == Some(number))
}

/// The range of the first word that calls program `number`. If only another program calls it, the
/// range of the first call in the text; `None` without a call.
fn find_call(structure: &Structure, number: u16) -> Option<TextRange> {
    let calls = || {
        let references = structure.references.iter();
        references.filter(|reference| matches!(reference.target, ReferenceTarget::Program(_)))
    };
    let direct = calls().find(|reference| reference.target == ReferenceTarget::Program(number));
    direct
        .or_else(|| calls().next())
        .map(|reference| reference.word.clone())
}

/// Returns the range of the first line that the control executes.
fn first_block_line(text: &TextDocument, structure: &Structure) -> TextRange {
    let line = structure.block_lines.0;
    TextRange::new(line, &(0..text.line(line).len()))
}

/// The position of a finding in another file: the program `number` that the document calls.
/// `None` if the document does not call it or the finding has no position.
fn related_position(
    document: &OpenDocument,
    number: u16,
    finding: &ProgramFinding,
    encoding: ColumnEncoding,
    language: Language,
) -> Option<DiagnosticRelatedInformation> {
    let found = document
        .called_programs
        .iter()
        .find(|it| it.number == number)?;
    let text = TextDocument::new(found.text.as_str());
    let at = finding.at.as_ref()?;
    let line = at.line.saturating_sub(1);
    let text_range = TextRange::new(line, &at.bytes);
    let message = say::in_line(at.line, say::as_written(text.line(line).trim()));
    Some(DiagnosticRelatedInformation {
        location: Location::new(
            path_to_uri(&found.path)?,
            encoding.to_range(&text, &text_range),
        ),
        message: message.text(language),
    })
}
