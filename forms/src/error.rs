//! Why a form cannot be filled in, written or read.

use gsk_messages::{Message, say};

/// A value that breaks a rule, with the id of its field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormError {
    /// The id of the field; empty if the error is not about one field.
    pub field: &'static str,
    /// The rule that is broken.
    pub rule: Message,
}

impl FormError {
    /// An error of a field.
    pub const fn new(field: &'static str, rule: Message) -> Self {
        Self { field, rule }
    }

    /// The message: the field, then the rule.
    pub fn message(&self) -> Message {
        match self.field {
            "" => self.rule.clone(),
            field => say::subject_reason(field, self.rule.clone()),
        }
    }
}
