//! Converts the findings of an analysis to diagnostics with their positions.

use gsk_core::command::ProgramId;
use gsk_language::{
    Analysis, ProgramFinding, ReferenceTarget, Severity, Structure, TextDocument, TextRange,
};
use gsk_messages::{Language, say};
use lsp_types::{
    Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, Location, NumberOrString, Range,
};

use super::convert::{Encoding, uri_of};
use super::documents::Document;

/// The source name that the editor shows.
const SOURCE: &str = "gsk980td";

pub fn diagnostics(
    document: &Document,
    analysis: &Analysis,
    encoding: Encoding,
    language: Language,
) -> Vec<Diagnostic> {
    let findings = analysis.findings.iter();
    findings
        .map(|it| diagnostic(document, it, encoding, language))
        .collect()
}

fn diagnostic(
    document: &Document,
    finding: &ProgramFinding,
    encoding: Encoding,
    language: Language,
) -> Diagnostic {
    let (text, structure) = (&*document.text, &**document.structure());
    let mut message = finding.text.clone();
    let (place, related) = match (finding.program, &finding.at) {
        (ProgramId::Stored(number), Some(_)) if !is_own(structure, number) => {
            message = format!("O{number:04}: {message}");
            let place = call_of(structure, number).unwrap_or_else(|| first(text, structure));
            let related = elsewhere(document, number, finding, encoding, language);
            (place, related)
        }
        (_, Some(at)) => {
            let line = at.line.saturating_sub(1);
            (TextRange::new(line, &at.bytes), None)
        }
        (_, None) => (first(text, structure), None),
    };
    Diagnostic {
        range: widened(encoding, text, &place),
        severity: Some(match finding.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        }),
        code: Some(NumberOrString::String(finding.code.clone())),
        source: Some(SOURCE.to_owned()),
        message,
        related_information: related.map(|it| vec![it]),
        ..Diagnostic::default()
    }
}

/// The range of a finding, at least one character wide to be visible.
fn widened(encoding: Encoding, text: &TextDocument, place: &TextRange) -> Range {
    let mut range = encoding.range(text, place);
    if range.start == range.end && place.to < text.line(place.line).len() as u32 {
        range.end.character += 1;
    }
    range
}

/// Whether a program is part of the text.
fn is_own(structure: &Structure, number: u16) -> bool {
    structure
        .parts
        .iter()
        .any(|part| part.number == Some(number))
}

/// The first word of the text that calls a program. If only another program calls it, the
/// first call of the text.
fn call_of(structure: &Structure, number: u16) -> Option<TextRange> {
    let calls = || {
        let leads = structure.references.iter();
        leads.filter(|lead| matches!(lead.target, ReferenceTarget::Program(_)))
    };
    let direct = calls().find(|lead| lead.target == ReferenceTarget::Program(number));
    direct
        .or_else(|| calls().next())
        .map(|lead| lead.word.clone())
}

/// The first line that the control reads.
fn first(text: &TextDocument, structure: &Structure) -> TextRange {
    let line = structure.block_lines.0;
    TextRange::new(line, &(0..text.line(line).len()))
}

/// The position of a finding in another file.
fn elsewhere(
    document: &Document,
    number: u16,
    finding: &ProgramFinding,
    encoding: Encoding,
    language: Language,
) -> Option<DiagnosticRelatedInformation> {
    let found = document.found.iter().find(|it| it.number == number)?;
    let text = TextDocument::new(found.text.as_str());
    let at = finding.at.as_ref()?;
    let line = at.line.saturating_sub(1);
    let place = TextRange::new(line, &at.bytes);
    let message = say::in_line(at.line, say::as_written(text.line(line).trim()));
    Some(DiagnosticRelatedInformation {
        location: Location::new(uri_of(&found.path)?, encoding.range(&text, &place)),
        message: message.text(language),
    })
}
