//! Parses formulas and comparisons that are entered outside a program, as conditions and
//! watches of a debugger.

use gsk_messages::say;

use super::super::lexer::{Lexer, skip_blanks};
use super::super::syntax::BlockError;
use super::expression::{FormulaCode, formula_error};
use super::statement::{MacroRelation, skip_relation};

/// A formula of macro B, or a comparison of two formulas, that no program contains:
/// `#100 GT 5`.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchFormula {
    pub(crate) left: FormulaCode,
    /// The relation and the right side of a comparison; `None` for a formula.
    pub(crate) comparison: Option<(MacroRelation, FormulaCode)>,
}

impl WatchFormula {
    /// Parses a formula (`#100+1`) or a comparison (`#100 GT 5`). A comparison may be in
    /// brackets, as after `IF`.
    ///
    /// # Errors
    /// 114 for an invalid formula, 118 for brackets that are nested too deep.
    pub fn parse(text: &str) -> Result<Self, BlockError> {
        let whole = parse_text(text);
        let inner = text.trim().strip_prefix('[');
        let inner = inner.and_then(|inner| inner.strip_suffix(']'));
        match (whole, inner) {
            (Err(error), Some(inner)) => parse_text(inner).map_err(|_| error),
            (parsed, _) => parsed,
        }
        .map_err(|error| error.with_character_column(text))
    }

    /// Whether the formula is a comparison.
    pub const fn is_comparison(&self) -> bool {
        self.comparison.is_some()
    }
}

fn parse_text(text: &str) -> Result<WatchFormula, BlockError> {
    let mut lexer = Lexer::new(text);
    let left = FormulaCode::read(&mut lexer)?;
    skip_blanks(&mut lexer)?;
    let comparison = match skip_relation(&mut lexer) {
        Some(relation) => Some((relation, FormulaCode::read(&mut lexer)?)),
        None => None,
    };
    skip_blanks(&mut lexer)?;
    if lexer.at < text.len() {
        return Err(formula_error(&lexer, say::formula_relation_missing()));
    }
    Ok(WatchFormula { left, comparison })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_and_comparisons_are_read() {
        let sum = WatchFormula::parse(" #100+1 ").expect("formula");
        assert!(!sum.is_comparison());
        for text in ["#100 GT 5", "[#100 GT 5]", "#[1+2] EQ #0"] {
            assert!(WatchFormula::parse(text).expect(text).is_comparison());
        }
        assert!(
            !WatchFormula::parse("[#1+2]*[3]")
                .expect("product")
                .is_comparison()
        );
    }

    #[test]
    fn what_is_left_over_is_refused_with_its_column() {
        for (text, column) in [("#100 > 5", 6), ("#100 GT 5 6", 11), ("", 1), ("#", 2)] {
            let error = WatchFormula::parse(text).expect_err(text);
            assert_eq!((error.alarm, error.column), (114, column), "{text}");
        }
    }
}
