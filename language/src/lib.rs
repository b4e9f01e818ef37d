//! A part program as an editor sees it: what is wrong with it, what its words mean and
//! where they lead, what may follow, how it is written, how long it takes. Plain functions
//! from a text and a place in it to plain data; who speaks with an editor, and where files
//! come from, is somebody else's business.
//!
//! Lines and bytes of a line count from 0 here, as editors count them.
//!
//! ```
//! use gsk_language::{Position, Structure, Text, definition};
//!
//! let text = Text::new("O0001\nG71 P10 Q20 U0.5\nN10 G00 X20\nN20 G01 Z-30\n");
//! let structure = Structure::read(&text);
//! let led = definition(&structure, Position { line: 1, byte: 5 });
//! assert_eq!(led.blocks[0].line, 2);
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod complete;
mod diagnose;
mod fold;
mod format;
mod hover;
mod leads;
mod lens;
mod line_times;
mod locate;
pub mod meaning;
mod plain_block;
mod refer;
mod rename;
mod snippets;
mod structure;
mod symbols;
mod text;
pub mod words;

pub use complete::{Completion, CompletionKind, complete};
pub use diagnose::{Analysis, Extents, Finding, Level, analyse, analyse_mill};
pub use fold::folds;
pub use format::{Casing, Formatted, Numbering, Spacing, Style, format};
pub use hover::{Hover, hover, without_markup};
pub use leads::{Aim, aim_of};
pub use lens::{Lens, lenses};
pub use line_times::LineTimes;
pub use locate::{Located, locate};
pub use refer::{Led, Under, definition, programs_called, references, under};
pub use rename::{renamable, rename};
pub use structure::{Cycle, Lead, Loop, Numbered, Part, Structure, Title, ToolWord};
pub use symbols::{Symbol, SymbolKind, symbols};
pub use text::{Edit, Place, Position, Text};

use gsk_core::model::ModelId;
use gsk_messages::Language;

/// Whose programs are read, and in which language it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reader {
    /// The control model.
    pub model: ModelId,
    /// Whether macro B is on.
    pub macro_b: bool,
    /// The language of texts.
    pub language: Language,
}

/// The reader of most tests.
#[cfg(test)]
const READER: Reader = Reader {
    model: ModelId::Gsk980td,
    macro_b: false,
    language: Language::En,
};
