//! Reads the declarations of a ladder without compiling it.

use crate::directive::{MCode, StartValue};
use crate::parser;

/// The declarations of a ladder text that can be read without compiling it: start values and M
/// codes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LadderDeclarations {
    /// Initial values of retained addresses, for an empty retained memory.
    pub start_values: Vec<StartValue>,
    /// M codes that the ladder implements in addition to those of the control.
    pub m_codes: Vec<MCode>,
}

impl LadderDeclarations {
    /// Reads the declarations of a ladder text. Errors in the text are ignored:
    /// [`Ladder::compile`](crate::Ladder::compile) reports them.
    #[must_use]
    pub fn read(source: &str) -> Self {
        let directives = parser::parse_declarations(source);
        Self {
            start_values: directives.start_values,
            m_codes: directives.m_codes,
        }
    }
}
