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
mod block_cache;
mod block_head;
mod block_positions;
mod byte_scan;
mod code_call;
mod decimal_points;
mod dnc_buffer;
mod edit;
mod foreign_words;
mod lexer;
mod listing;
mod macro_b;
mod mdi;
mod number;
mod parse;
mod plain_words;
mod program_text;
mod read_number;
mod store;
mod syntax;
#[cfg(test)]
mod tests;
mod text_index;

pub(crate) use block::address_bits;
pub use block::{ProgramBlock, ProgramWord, word_limits};
pub(crate) use block_cache::BlockCache;
pub use byte_scan::{find_call_candidate, has_control_characters};
pub(crate) use code_call::CodeCall;
pub use decimal_points::append_points;
pub use dnc_buffer::{DncBuffer, LineTooLong};
pub use edit::{Completion, ProgramEditor};
pub(crate) use foreign_words::further_foreign_words;
pub use listing::without_end_sign;
pub use macro_b::WatchFormula;
pub(crate) use macro_b::{
    FormulaCode, FormulaFunction, FormulaOperator, FormulaStep, IfAction, MacroAssignment,
    MacroCall, MacroCondition, MacroRelation, MacroStatement,
};
pub use mdi::MdiBlock;
pub use number::{VariableReference, WordNumber};
pub(crate) use parse::parse_block;
pub(crate) use plain_words::{PlainToken, PlainWords};
pub use program_text::{Program, split_programs};
pub use store::{PROGRAM_NUMBERS, ProgramMemory};
pub use syntax::{BlockError, Syntax};
