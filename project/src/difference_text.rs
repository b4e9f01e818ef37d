//! Describes differences between two projects in words.

use std::sync::Arc;

use gsk_messages::{Language, Message, say};

use crate::difference::ProjectDifference;
use crate::key::{DataSet, ProjectKey, ProjectTable};
use crate::label::{label, unit};
use crate::ladder_diff::{changed_range, describe_ladder_changes};
use crate::project_state::ProjectState;
use crate::value::ProjectValue;

/// Returns a line that describes a difference: `No.022 X rapid speed: 3800 → 7600 mm/min`. The
/// name comes from `new`, or from `old` if the value is missing in `new`.
pub fn describe_difference(
    difference: &ProjectDifference,
    old: &ProjectState,
    new: &ProjectState,
    language: Language,
) -> String {
    let state = if difference.new.is_some() { new } else { old };
    let name = label(difference.key, state, language);
    let details = describe_text_changes(difference);
    if !details.is_empty() {
        let texts: Vec<String> = details.iter().map(|it| it.text(language)).collect();
        return format!("{name}: {}", texts.join("; "));
    }
    let shown = |value: &Option<ProjectValue>| {
        let value = value.as_ref();
        value.map_or_else(|| "–".to_owned(), ToString::to_string)
    };
    let (old, new) = (shown(&difference.old), shown(&difference.new));
    let unit = unit(difference.key, state.memory().model.id());
    format!("{name}: {old} → {new} {unit}")
        .trim_end()
        .to_owned()
}

/// Returns the electronic disk that this difference adds or removes; `None` if it does
/// neither. A disk is added or removed with all its values, so such differences are only
/// applied together.
pub fn find_whole_disk(difference: &ProjectDifference) -> Option<DataSet> {
    let (ProjectTable::Parameters(set) | ProjectTable::Offsets(set) | ProjectTable::Pitch(set)) =
        difference.key.table()?
    else {
        return None;
    };
    let is_one_sided = difference.old.is_none() || difference.new.is_none();
    (set != DataSet::Control && is_one_sided).then_some(set)
}

/// Returns messages about the changes of a text value: the lines of a program, or the
/// messages, comments, start values and rungs of a ladder. Empty for values that are not
/// texts.
pub fn describe_text_changes(difference: &ProjectDifference) -> Vec<Message> {
    let text = |value: &Option<ProjectValue>| match value {
        Some(ProjectValue::Text(text)) => Some(Arc::clone(text)),
        _ => None,
    };
    match (text(&difference.old), text(&difference.new)) {
        (None, Some(new)) => vec![say::project_added(new.lines().count())],
        (Some(old), None) => vec![say::project_removed(old.lines().count())],
        (Some(old), Some(new)) if difference.key == ProjectKey::Ladder => {
            describe_ladder_changes(&old, &new)
        }
        (Some(old), Some(new)) => vec![describe_line_changes(&old, &new)],
        (None, None) => Vec::new(),
    }
}

const MAX_SHOWN_CHARS: usize = 60;

fn shown_line(lines: &[&str], at: usize) -> String {
    let line = lines.get(at).copied().unwrap_or_default().trim();
    match line.char_indices().nth(MAX_SHOWN_CHARS) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// Returns a message about the lines from the first to the last difference of two texts.
fn describe_line_changes(old: &str, new: &str) -> Message {
    let [old, new] = [old, new].map(|text| text.lines().collect::<Vec<_>>());
    let (first, old_count, new_count) = changed_range(&old, &new);
    if old_count == 0 && new_count == 0 {
        return say::project_line_ends();
    }
    say::project_lines(
        first + 1,
        old_count,
        new_count,
        shown_line(&old, first),
        shown_line(&new, first),
    )
}
