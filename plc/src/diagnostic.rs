//! Errors and warnings of the ladder compiler, with their rule, line and rung.

use std::fmt;

use gsk_messages::{Language, Message, say};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A rule of the ladder compiler: E00 to E07 are errors, W01 to W04 are warnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Rule {
    /// Error: the line is neither an instruction nor a directive.
    E00,
    /// Error: END1 or END2 is missing, repeated or in the wrong order.
    E01,
    /// A rung has not exactly one result at its output, or has contacts after it.
    E02,
    /// Error: the instruction cannot use the area, bit or value of an operand.
    E03,
    /// A label, subprogram or timer number is duplicate, or a label or subprogram is
    /// missing.
    E04,
    /// Error: a jump or call leaves its program section.
    E05,
    /// Error: the number of operands, the length code or the table size is wrong.
    E06,
    /// Error: the program or its level 1 has too many steps.
    E07,
    /// Warning: two OUT instructions write the same coil.
    W01,
    /// Warning: no JMPB jumps to the label.
    W02,
    /// Warning: the rung has no output and therefore no effect.
    W03,
    /// Warning: level 1 has more than 400 steps.
    W04,
}

/// A rule that a line breaks, with the message about it.
pub(crate) type RuleViolation = (Rule, Message);

impl Rule {
    /// Returns whether the rule is a warning, so that the ladder still compiles.
    #[must_use]
    pub const fn is_warning(self) -> bool {
        matches!(self, Self::W01 | Self::W02 | Self::W03 | Self::W04)
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

/// One error or warning of the compiler.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompileError {
    /// Line of the source text, from 1.
    pub line: u32,
    /// Number of the rung, from 1; 0 before the first rung.
    pub rung: u32,
    /// The rule that the line breaks.
    pub code: Rule,
    /// Message about the error and the rule of the manual.
    pub message: Message,
}

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        say::ladder_rule_broken(self.line, self.rung, self.code, self.message.clone()).fmt(f)
    }
}

impl std::error::Error for CompileError {}

/// The result of a failed compilation: all errors and warnings.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub struct CompileErrors {
    /// The errors, in line order; never empty.
    pub errors: Vec<CompileError>,
    /// The warnings, in line order.
    pub warnings: Vec<CompileError>,
}

impl fmt::Display for CompileErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for error in self.errors.iter().chain(&self.warnings) {
            writeln!(f, "{error}")?;
        }
        let summary = compile_summary(self.errors.len(), self.warnings.len());
        f.write_str(&summary.text(Language::Zh))
    }
}

/// Returns the last line of the compiler output with the number of errors and warnings. The
/// Chinese text is that of the programming software.
#[must_use]
pub fn compile_summary(errors: usize, warnings: usize) -> Message {
    if errors == 0 {
        say::ladder_compiled(errors, warnings)
    } else {
        say::ladder_not_compiled(errors, warnings)
    }
}
