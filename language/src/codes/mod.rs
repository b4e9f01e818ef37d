//! The words that codes read, and the code that reads the words of a block.

mod in_force;
mod snippets;
mod word_table;

pub(crate) use in_force::{BlockForm, ModalCodes, code_in_force, is_motion};
pub(crate) use snippets::{letters, snippet};
pub(crate) use word_table::find_word;
pub use word_table::{CodeForm, CodeWord, code_forms};
