//! Help: what every symbol of the control means, in Chinese and English.
//!
//! A *topic* is what a user meets and may ask for: an alarm, a parameter or its bit, a
//! code, a key or lamp, a page or one of its fields, a signal of the PLC, a notion. What a
//! table of the control knows of it (range, unit, cause, way out) is taken from there
//! ([`facts`]); what more there is to say stands in `assets/help/`.
//!
//! ```
//! use gsk_help::{Subject, ask, topic};
//! let alarm = topic(Subject::Alarm(7)).unwrap();
//! assert_eq!(alarm.subject.to_string(), "alarm 007");
//! // Who asks for a number means whatever has it.
//! assert!(ask("31").len() >= 2);
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

pub use article::{Article, article, called};
pub use document::document;
pub use facts::{direction, facts, name};
pub use lcd::on_screen;
pub use models::{topic_of, topics_of};
pub use search::{ask, ask_among, ask_of};
pub use subject::Subject;
pub use table::{Topic, topic, topics};
