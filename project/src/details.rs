//! What has changed in a text.

use std::sync::Arc;

use gsk_messages::{Language, Message, say};

use crate::difference::Difference;
use crate::key::{Key, Set, Table};
use crate::label::{label, unit};
use crate::ladder::{self, between};
use crate::state::State;
use crate::value::Value;

/// A difference in words: `No.022 X rapid speed: 3800 → 7600 mm/min`. Names come from the
/// state that has the value.
pub fn sentence(difference: &Difference, old: &State, new: &State, language: Language) -> String {
    let state = if difference.new.is_some() { new } else { old };
    let name = label(difference.key, state, language);
    let details = details(difference);
    if !details.is_empty() {
        let texts: Vec<String> = details.iter().map(|it| it.text(language)).collect();
        return format!("{name}: {}", texts.join("; "));
    }
    let shown = |value: &Option<Value>| {
        let value = value.as_ref();
        value.map_or_else(|| "–".to_owned(), ToString::to_string)
    };
    let (old, new) = (shown(&difference.old), shown(&difference.new));
    let unit = unit(difference.key, state.memory().model.id());
    format!("{name}: {old} → {new} {unit}")
        .trim_end()
        .to_owned()
}

/// The electronic disk that comes or goes as a whole with this difference: it has all of its
/// values or none.
pub fn whole_disk(difference: &Difference) -> Option<Set> {
    let (Table::Parameters(set) | Table::Offsets(set) | Table::Pitch(set)) =
        difference.key.table()?
    else {
        return None;
    };
    let one_sided = difference.old.is_none() || difference.new.is_none();
    (set != Set::Control && one_sided).then_some(set)
}

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

/// Characters of a line that are shown.
const SHOWN: usize = 60;

fn shown(lines: &[&str], at: usize) -> String {
    let line = lines.get(at).copied().unwrap_or_default().trim();
    match line.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
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
        shown(&old, first),
        shown(&new, first),
    )
}
