//! Explains every symbol of the control in Chinese and English.
//!
//! A *topic* is something a user meets and can query: an alarm, a parameter or its bit, a
//! code, a key or lamp, a page or one of its fields, a PLC signal, a notion. Range, unit,
//! cause and remedy come from the control's tables ([`facts`]). Further texts are in
//! `assets/help/`.
//!
//! ```
//! use gsk_help::{Subject, search, topic};
//! let alarm = topic(Subject::Alarm(7)).unwrap();
//! assert_eq!(alarm.subject.to_string(), "alarm 007");
//! // A number matches every subject with that number.
//! assert!(search("31").len() >= 2);
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod article;
mod document;
mod facts;
mod lcd;
mod models;
mod search;
mod subject;
mod table;

pub use article::{Article, article, designation};
pub use document::document;
pub use facts::{facts, signal_direction, subject_name};
pub use lcd::{address_topic, topic_at};
pub use models::{topic_of, topics_of};
pub use search::{search, search_among, search_model};
pub use subject::Subject;
pub use table::{Topic, topic, topics};
