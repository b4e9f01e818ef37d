//! Programs as text: their blocks and words, editing, and the program memory.
//!
//! A *line* is a line of the file, counted from 1; every source position shown to the user
//! is a line. A *block* is what the control executes at once. It ends at the end of its line
//! or at a `;` or `*` (manual I-2.1), so a line can contain several blocks. Lines without
//! words are not blocks, except for a single `;`. The interpreter executes block by block:
//!
//! ```
//! use gsk_core::program::{Program, Syntax};
//!
//! let program = Program::new("O0001;\n(外圆)\nN10 G00 X50 Z2; G01 Z-20 F100;\n");
//! let mut index = program.block_from_line(1);
//! let mut lines = Vec::new();
//! while index < program.block_count() {
//!     let block = program.parse(index, Syntax::default())?;
//!     lines.push(block.line);
//!     index += 1;
//! }
//! assert_eq!(lines, [1, 3, 3]);
//! # Ok::<(), gsk_core::program::BlockError>(())
//! ```

mod block;
mod code_call;
mod edit;
mod foreign;
mod head;
mod index;
mod inflow;
mod lexer;
mod listing;
mod macro_b;
mod mdi;
mod number;
mod parse;
mod places;
mod plain_words;
mod points;
mod read_number;
mod recent;
mod store;
mod syntax;
#[cfg(test)]
mod tests;
mod text;

pub use block::{Block, Word, limits};
pub(crate) use code_call::CodeCall;
pub use edit::{Completion, Editing};
pub(crate) use foreign::further_foreign_words;
pub use inflow::{Inflow, LineTooLong};
pub use listing::without_end;
pub(crate) use macro_b::{
    Assignment, Condition, Expression, Function, MacroCall, Operator, Relation, Statement, Step,
    Then,
};
pub use mdi::MdiBlock;
pub use number::{Number, Variable};
pub(crate) use parse::parse_block;
pub use points::with_points;
pub(crate) use recent::Recent;
pub use store::{ProgramMemory, RANGE};
pub use syntax::{BlockError, Syntax};
pub use text::{Program, split};
