//! Macro blocks (G65), their variables, and reading ahead past them.

pub(super) mod arithmetic;
pub(super) mod lookahead;
pub(super) mod macro_block;
pub(super) mod variable;
