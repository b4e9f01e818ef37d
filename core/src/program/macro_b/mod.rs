//! Macro statements of custom macro B: variables, formulas, jumps, loops, calls with
//! arguments.
//!
//! ```text
//!   #1=#2+SIN[#3*2]        IF [#1 GT 5] GOTO 10      G65 P9010 A1.0 B#2
//!   GOTO 10                IF [#1 EQ #0] THEN #2=1   G66 P9110 Z-20.0
//!   X[#1/2] Z-#3           WHILE [#1 LE 10] DO 1     G67
//!                          END 1
//! ```
//!
//! Macro B is an option of the control. These modules only parse: a statement stores its
//! formulas as postfix code.

mod expression;
mod statement;
mod usage;
mod watch_formula;

pub(super) use expression::read_word_formula;
pub(crate) use expression::{FormulaCode, FormulaFunction, FormulaOperator, FormulaStep};
pub(crate) use statement::{
    IfAction, MacroAssignment, MacroCall, MacroCondition, MacroRelation, MacroStatement,
};
pub(super) use statement::{is_statement_start, read_arguments};
pub(super) use usage::uses_macro_b;
pub use watch_formula::WatchFormula;
