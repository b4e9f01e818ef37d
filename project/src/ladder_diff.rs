//! Compares two ladder programs by their meaning.

use std::collections::BTreeMap;

use gsk_core::plc::{Ladder, Mnemonic, Operand, Rung};
use gsk_messages::{Message, say};

/// A rung's title and statements, without its source lines.
#[derive(PartialEq)]
struct RungContent {
    title: Option<String>,
    statements: Vec<(Mnemonic, Vec<Operand>, Vec<i32>)>,
}

fn rung_content(rung: Rung<'_>) -> RungContent {
    let statements = rung.statements.iter();
    let statements = statements.map(|it| (it.mnemonic, it.operands.clone(), it.table.clone()));
    RungContent {
        title: rung.title.map(str::to_owned),
        statements: statements.collect(),
    }
}

/// Returns messages about the changes between two ladder texts: header, messages, comments,
/// start values, M codes, rungs. If only remarks differ, there is one message for that.
pub(crate) fn describe_ladder_changes(old: &str, new: &str) -> Vec<Message> {
    // Both compile: the import has compiled them.
    let (Ok(old), Ok(new)) = (Ladder::compile(old), Ladder::compile(new)) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    let header = |ladder: &Ladder| {
        let header = ladder.header();
        let (unit, author) = (header.unit.clone(), header.author.clone());
        let (version, remark) = (header.version.clone(), header.remark.clone());
        [
            (".UNIT".to_owned(), unit),
            (".AUTHOR".to_owned(), author),
            (".VERSION".to_owned(), version),
            (".REMARK".to_owned(), remark),
        ]
        .into()
    };
    compare_named(&mut found, header(&old), header(&new));
    let messages = |ladder: &Ladder| {
        let rows = ladder.messages().iter();
        let rows = rows.map(|it| (it.bit.to_string(), format!("{} {}", it.number, it.text)));
        rows.collect()
    };
    compare_named(&mut found, messages(&old), messages(&new));
    let comments = |ladder: &Ladder| {
        let rows = ladder.comments().iter();
        let rows = rows.map(|it| {
            let name = format!(".CMT {}", it.subject);
            (name, format!("{} / {}", it.chinese, it.english))
        });
        rows.collect()
    };
    compare_named(&mut found, comments(&old), comments(&new));
    let start_values = |ladder: &Ladder| {
        let rows = ladder.start_values().iter();
        let rows = rows.map(|it| (format!(".INIT {}", it.address), it.value.to_string()));
        rows.collect()
    };
    compare_named(&mut found, start_values(&old), start_values(&new));
    let m_codes = |ladder: &Ladder| {
        let rows = ladder.m_codes().iter();
        rows.map(|it| (format!("M{:02}", it.code), it.text.clone()))
            .collect()
    };
    compare_named(&mut found, m_codes(&old), m_codes(&new));
    let [before, after] = [&old, &new].map(|it| it.rungs().map(rung_content).collect::<Vec<_>>());
    let (first, old_count, new_count) = changed_range(&before, &after);
    if old_count + new_count > 0 {
        found.push(say::project_rungs(first + 1, old_count, new_count));
    }
    if found.is_empty() {
        found.push(say::project_remarks());
    }
    found
}

fn compare_named(
    found: &mut Vec<Message>,
    old: BTreeMap<String, String>,
    mut new: BTreeMap<String, String>,
) {
    for (name, before) in old {
        match new.remove(&name) {
            None => found.push(say::project_named_removed(name, before)),
            Some(after) if after != before => {
                found.push(say::project_named_changed(name, before, after));
            }
            Some(_) => {}
        }
    }
    for (name, after) in new {
        found.push(say::project_named_added(name, after));
    }
}

/// Returns the range that differs between two lists: the index of the first difference, and
/// the number of differing items in `old` and in `new`. The items after the range are equal.
pub(crate) fn changed_range<T: PartialEq>(old: &[T], new: &[T]) -> (usize, usize, usize) {
    let count_equal = |pairs: &mut dyn Iterator<Item = (&T, &T)>| {
        let mut count = 0;
        for (one, other) in pairs {
            if one != other {
                break;
            }
            count += 1;
        }
        count
    };
    let first_changed = count_equal(&mut old.iter().zip(new));
    let equal_at_end = count_equal(
        &mut old[first_changed..]
            .iter()
            .rev()
            .zip(new[first_changed..].iter().rev()),
    );
    (
        first_changed,
        old.len() - first_changed - equal_at_end,
        new.len() - first_changed - equal_at_end,
    )
}
