//! Macros: operations of G65 H on whole numbers (macro A), statements and formulas of macro B,
//! their variables, and reading ahead past them.
//!
//! ```text
//!   macro A   macro_block --> arithmetic          variable (#200 …, signals)
//!   macro B   statement   --> formula --> variable_access --> levels (#1–#33)
//!                                                      --> system, variable; the mill's
//! ```

pub(super) mod arithmetic;
pub(super) mod formula;
pub(super) mod levels;
pub(super) mod lookahead;
pub(super) mod macro_block;
pub(super) mod statement;
pub(super) mod system;
pub(super) mod variable;
pub(super) mod variable_access;
