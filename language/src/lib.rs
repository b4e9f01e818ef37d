//! Analyses part programs for editors: errors, meanings of words, references, completions,
//! formatting and machine time.
//!
//! The functions take a text and a position and return plain data. The caller handles the
//! editor protocol and the files.
//!
//! Lines and bytes of a line count from 0 here, as in editors.
//!
//! ```
//! use gsk_language::{Position, Structure, TextDocument, definition};
//!
//! let text = TextDocument::new("O0001\nG71 P10 Q20 U0.5\nN10 G00 X20\nN20 G01 Z-30\n");
//! let structure = Structure::read(&text);
//! let definition = definition(&structure, Position { line: 1, byte: 5 });
//! assert_eq!(definition.blocks[0].line, 2);
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod codes;
mod complete;
mod diagnose;
mod fixes;
mod fold;
mod format;
mod hints;
mod hover;
mod lens;
mod line_times;
mod locate;
pub mod meaning;
mod plain_block;
mod reference_target;
mod references;
mod rename;
mod structure;
mod symbols;
mod text;
pub mod words;

pub use codes::{CodeForm, CodeWord, code_forms};
pub use complete::{CompletionKind, CompletionProposal, complete};
pub use diagnose::{Analysis, Extents, ProgramFinding, Severity, analyse, analyse_mill};
pub use fixes::QuickFix;
pub use fold::folds;
pub use format::{Casing, Formatted, Numbering, Spacing, Style, format};
pub use hints::{
    CodeSignature, ModalHint, SemanticToken, SignatureHelp, SignatureWord, TokenKind, modal_hints,
    semantic_tokens, signature_help,
};
pub use hover::{Hover, hover, without_markup};
pub use lens::{Lens, lenses};
pub use line_times::LineTimes;
pub use locate::{LineSpan, locate_alarm};
pub use reference_target::{ReferenceTarget, reference_target};
pub use references::{
    CursorTarget, Definition, definition, programs_called, references, target_at,
};
pub use rename::{renamable, rename};
pub use structure::{
    MacroLoop, NumberedBlock, ProfileCycle, ProgramPart, Structure, Title, ToolCall, WordReference,
};
pub use symbols::{Symbol, SymbolKind, named_symbols, symbols};
pub use text::{Position, TextChange, TextDocument, TextRange};

use gsk_core::model::ModelId;
use gsk_messages::Language;

/// The settings that determine how a program is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadingContext {
    /// The control model that reads the program.
    pub model: ModelId,
    /// Whether the control accepts the statements of macro B.
    pub macro_b: bool,
    /// The language in which messages are written.
    pub language: Language,
}

/// The reading settings that most tests use.
#[cfg(test)]
const CONTEXT: ReadingContext = ReadingContext {
    model: ModelId::Gsk980td,
    macro_b: false,
    language: Language::En,
};
