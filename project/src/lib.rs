//! The project: all that a control holds, as one folder of readable text.
//!
//! A [`State`] is what the battery keeps, with the ladder. Each value of it has a [`Key`]
//! (parameter 022, bit 4 of parameter 001, X of offset 01, …), and everything here goes by
//! these: [`export`] writes a line for each, [`import`] reads the lines, [`diff`] lists the
//! keys whose values differ, [`apply`] changes some of them.
//!
//! ```
//! use gsk_core::setup::Setup;
//! use gsk_messages::Language;
//! use gsk_project::{State, apply, diff, export, import};
//!
//! let before = State::of(&Setup::delivered());
//! let mut files = export(&before, Language::En);
//! let text = &files["parameters.txt"];
//! let changed = text.replace("022 = 3800", "022 = 7600");
//! files.insert("parameters.txt".to_owned(), changed);
//! let after = import(&files).unwrap();
//! let differences = diff(&before, &after);
//! assert_eq!(differences.len(), 1);
//! assert_eq!(apply(&before, &differences).unwrap(), after);
//! ```
//!
//! The format is described in `docs/project.md`. Nothing here touches a disk: files are
//! their names and texts.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod build;
mod details;
mod difference;
mod key;
mod label;
mod ladder;
mod rights;
mod state;
mod text;
mod value;

pub use build::{Fault, build};
pub use details::{details, sentence, whole_disk};
pub use difference::{Difference, apply, diff};
pub use key::{Count, Key, OffsetWord, PanelWord, Section, Set, Switch, Table};
pub use label::{label, refused, unit};
pub use rights::{Denied, denied};
pub use state::{State, lasts};
pub use text::{Files, MOST_PROBLEMS, Problem, export, import, is_own};
pub use value::Value;
