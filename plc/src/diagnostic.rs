//! What the compiler has to say: errors and warnings, with their place and the rule.

use std::fmt;

use gsk_messages::{Language, Message, say};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The rule that a ladder breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Rule {
    /// The line is neither an instruction nor a directive.
    E00,
    /// END1 or END2 is missing, repeated or in the wrong order.
    E01,
    /// A rung has no single result at its output, or goes on after it.
    E02,
    /// An operand names an area, bit or value that the instruction cannot use.
    E03,
    /// A label, subprogram or timer number is used twice, or a label or
    /// subprogram is missing.
    E04,
    /// A jump or call leaves its program part.
    E05,
    /// Wrong number of operands, length code or table size.
    E06,
    /// The program, or its level 1, is too long.
    E07,
    /// A coil is written by two OUT.
    W01,
    /// No JMPB uses the label.
    W02,
    /// The rung has no effect.
    W03,
    /// Level 1 takes more than 400 steps.
    W04,
}

/// A finding in one line, before its place is known.
pub(crate) type RuleViolation = (Rule, Message);

impl Rule {
    /// Whether a ladder that breaks it compiles all the same.
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
    /// Rung (network) of the program, from 1; 0 before the first.
    pub rung: u32,
    /// The rule: E for an error, W for a warning.
    pub code: Rule,
    /// What is wrong and what the manual wants, in one sentence.
    pub message: Message,
}

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        say::ladder_rule_broken(self.line, self.rung, self.code, self.message.clone()).fmt(f)
    }
}

impl std::error::Error for CompileError {}

/// Why a ladder does not compile: every error found, and the warnings beside them.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub struct CompileErrors {
    /// The errors in line order; never empty.
    pub errors: Vec<CompileError>,
    /// The warnings in line order.
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

/// The closing line of a compilation, in Chinese in the words of the programming
/// software.
#[must_use]
pub fn compile_summary(errors: usize, warnings: usize) -> Message {
    if errors == 0 {
        say::ladder_compiled(errors, warnings)
    } else {
        say::ladder_not_compiled(errors, warnings)
    }
}
