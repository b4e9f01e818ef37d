//! What has changed in a text.

use std::sync::Arc;

use gsk_messages::{Message, say};

use crate::difference::Difference;
use crate::key::Key;
use crate::ladder::{self, between};
use crate::value::Value;

/// What has changed in a text: of a program its lines, of a ladder its messages, comments,
/// start values and rungs. Empty for a number.
pub fn details(difference: &Difference) -> Vec<Message> {
    let text = |value: &Option<Value>| match value {
        Some(Value::Text(text)) => Some(Arc::clone(text)),
        _ => None,
    };
    match (text(&difference.old), text(&difference.new)) {
        (None, Some(new)) => vec![say::project_added(new.lines().count())],
        (Some(old), None) => vec![say::project_removed(old.lines().count())],
        (Some(old), Some(new)) if difference.key == Key::Ladder => ladder::changes(&old, &new),
        (Some(old), Some(new)) => vec![lines(&old, &new)],
        (None, None) => Vec::new(),
    }
}

/// Where two texts differ: what is the same at their head and at their end is left out.
fn lines(old: &str, new: &str) -> Message {
    let [old, new] = [old, new].map(|text| text.lines().collect::<Vec<_>>());
    let (first, old_count, new_count) = between(&old, &new);
    if old_count == 0 && new_count == 0 {
        return say::project_line_ends();
    }
    say::project_lines(
        first + 1,
        old_count,
        new_count,
        old.get(first).copied().unwrap_or_default().trim(),
        new.get(first).copied().unwrap_or_default().trim(),
    )
}
