//! What has changed from one ladder to another.

use std::collections::BTreeMap;

use gsk_core::plc::{Ladder, Mnemonic, Operand, Rung};
use gsk_messages::{Message, say};

/// What a rung does, without where its text stands.
#[derive(PartialEq)]
struct Does {
    title: Option<String>,
    statements: Vec<(Mnemonic, Vec<Operand>, Vec<i32>)>,
}

fn does(rung: Rung<'_>) -> Does {
    let statements = rung.statements.iter();
    let statements = statements.map(|it| (it.mnemonic, it.operands.clone(), it.table.clone()));
    Does {
        title: rung.title.map(str::to_owned),
        statements: statements.collect(),
    }
}

/// The changes by meaning: head, messages, comments, start values, M codes, rungs. A text
/// that differs in its remarks alone is said to.
pub(crate) fn changes(old: &str, new: &str) -> Vec<Message> {
    // Both were compiled when they were read.
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
    compare(&mut found, header(&old), header(&new));
    let messages = |ladder: &Ladder| {
        let rows = ladder.messages().iter();
        let rows = rows.map(|it| (it.bit.to_string(), format!("{} {}", it.number, it.text)));
        rows.collect()
    };
    compare(&mut found, messages(&old), messages(&new));
    let comments = |ladder: &Ladder| {
        let rows = ladder.comments().iter();
        let rows = rows.map(|it| {
            let name = format!(".CMT {}", it.subject);
            (name, format!("{} / {}", it.chinese, it.english))
        });
        rows.collect()
    };
    compare(&mut found, comments(&old), comments(&new));
    let starts = |ladder: &Ladder| {
        let rows = ladder.start_values().iter();
        let rows = rows.map(|it| (format!(".INIT {}", it.address), it.value.to_string()));
        rows.collect()
    };
    compare(&mut found, starts(&old), starts(&new));
    let codes = |ladder: &Ladder| {
        let rows = ladder.m_codes().iter();
        rows.map(|it| (format!("M{:02}", it.code), it.text.clone()))
            .collect()
    };
    compare(&mut found, codes(&old), codes(&new));
    let [before, after] = [&old, &new].map(|it| it.rungs().map(does).collect::<Vec<_>>());
    let (first, old_count, new_count) = between(&before, &after);
    if old_count + new_count > 0 {
        found.push(say::project_rungs(first + 1, old_count, new_count));
    }
    if found.is_empty() {
        found.push(say::project_remarks());
    }
    found
}

fn compare(
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

/// Where two lists begin to differ, and how many each has from there to where they are the
/// same again up to their end.
pub(crate) fn between<T: PartialEq>(old: &[T], new: &[T]) -> (usize, usize, usize) {
    let same = |pairs: &mut dyn Iterator<Item = (&T, &T)>| {
        let mut count = 0;
        for (one, other) in pairs {
            if one != other {
                break;
            }
            count += 1;
        }
        count
    };
    let first = same(&mut old.iter().zip(new));
    let last = same(&mut old[first..].iter().rev().zip(new[first..].iter().rev()));
    (first, old.len() - first - last, new.len() - first - last)
}
