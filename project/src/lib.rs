//! Exports, imports and compares the retained data of a control as one folder of text files.
//!
//! A [`ProjectState`] stores what the battery retains, and the ladder. Each of its values has a
//! [`ProjectKey`] (parameter 022, bit 4 of parameter 001, X of offset 01). [`export`] writes a
//! line for each key and [`import`] parses the lines. [`diff`] lists the keys whose values
//! differ, and [`apply`] changes them.
//!
//! ```
//! use gsk_core::setup::Setup;
//! use gsk_messages::Language;
//! use gsk_project::{ProjectState, apply, diff, export, import};
//!
//! let before = ProjectState::from_setup(&Setup::delivered());
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
//! `docs/project.md` describes the format. This crate does no I/O: a file is a path and a text.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod builder;
mod denied_changes;
mod difference;
mod difference_text;
mod files;
mod key;
mod label;
mod ladder_diff;
mod project_state;
mod value;

pub use builder::{InvalidValue, build_state};
pub use denied_changes::{DeniedChange, find_denied_changes};
pub use difference::{ProjectDifference, apply, diff};
pub use difference_text::{describe_difference, describe_text_changes, find_whole_disk};
pub use files::{MAX_PROBLEMS, ProjectFiles, ProjectProblem, export, import, is_project_file};
pub use key::{
    DataSet, OffsetColumn, PanelSetting, ProjectCounter, ProjectKey, ProjectSection, ProjectTable,
    SettingSwitch,
};
pub use label::{label, refusal_message, unit};
pub use project_state::{ProjectState, is_retained_variable};
pub use value::ProjectValue;
