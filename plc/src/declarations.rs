//! What can be said of a ladder before it is compiled.

use crate::directive::{MCode, StartValue};
use crate::parser;

/// What a text declares for those who need none of its steps.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LadderDeclarations {
    /// Values of retained addresses for a blank store.
    pub start_values: Vec<StartValue>,
    /// M codes that the ladder carries out beside the control's own.
    pub m_codes: Vec<MCode>,
}

impl LadderDeclarations {
    /// Reads the declarations of a text and nothing else of it; what is wrong with it is
    /// left to [`Ladder::compile`](crate::Ladder::compile).
    #[must_use]
    pub fn read(source: &str) -> Self {
        let directives = parser::parse_declarations(source);
        Self {
            start_values: directives.start_values,
            m_codes: directives.m_codes,
        }
    }
}
