//! Keys and pages that an exercise refuses, although the control has them.

use std::collections::BTreeSet;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::face::{PageId, find_page, page_names};
use crate::keys::{self, Key, KeyRole};

/// Keys that stop the machine: no exercise can refuse them.
const STOP_KEYS: [Key; 3] = [Key::EmergencyStop, Key::Reset, Key::FeedHold];

/// The keys and pages that an exercise refuses. Part of the state of the panel, so that a replay
/// refuses them, too.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PanelLimits {
    keys: BTreeSet<Key>,
    pages: BTreeSet<PageId>,
}

/// The names of keys or pages that an exercise permits or excludes.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub enum PermittedNames {
    /// Only keys or pages with these names are permitted.
    Only(Vec<String>),
    /// All keys or pages are permitted except those with these names.
    AllBut(Vec<String>),
}

/// A name that cannot be in the list of an exercise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameFault {
    /// The invalid name as written in the exercise.
    pub name: String,
    /// Message about the rule that the name breaks.
    pub rule: Message,
}

impl PanelLimits {
    /// Refuses keys, by their names in operator scripts. The keys that stop the machine remain
    /// permitted.
    ///
    /// # Errors
    /// A name is unknown, or the list refuses a key that stops the machine.
    pub fn limit_keys(&mut self, names: &PermittedNames) -> Result<(), NameFault> {
        let all = keys::all_rows().map(|row| row.key);
        let mut keys = refused_items(names, all, find_key)?;
        if let PermittedNames::AllBut(_) = names {
            let mut refused = keys.iter();
            if let Some(key) = refused.find(|key| STOP_KEYS.contains(key)) {
                return Err(NameFault {
                    name: key.id().to_owned(),
                    rule: say::limit_stop_key(key.id()),
                });
            }
        }
        keys.retain(|key| !STOP_KEYS.contains(key));
        self.keys = keys;
        Ok(())
    }

    /// Refuses pages, by their names on the command line.
    ///
    /// # Errors
    /// A name is unknown.
    pub fn limit_pages(&mut self, names: &PermittedNames) -> Result<(), NameFault> {
        let all = page_names().filter_map(find_page).map(|row| row.page);
        self.pages = refused_items(names, all, find_page_id)?;
        Ok(())
    }

    /// Returns true if no key and no page is refused.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty() && self.pages.is_empty()
    }

    /// Returns whether any page is refused.
    pub(crate) fn refuses_pages(&self) -> bool {
        !self.pages.is_empty()
    }

    /// Returns why a key is refused; `None` if it is permitted.
    pub(crate) fn key_refusal(&self, key: Key) -> Option<Message> {
        self.keys
            .contains(&key)
            .then(|| say::limit_key_refused(join_legend(key.row().legend)))
    }

    /// Returns why a typed character is refused: no permitted key enters it. `None` if it is
    /// permitted.
    pub(crate) fn character_refusal(&self, character: char) -> Option<Message> {
        let character = character.to_ascii_uppercase();
        let enters = |role: KeyRole| match role {
            KeyRole::Character(first, second) => first == character || second == Some(character),
            _ => false,
        };
        let mut rows = keys::all_rows();
        let entering = match character {
            ';' => Some(Key::Eob),
            _ => rows.find(|row| enters(row.role)).map(|row| row.key),
        };
        self.key_refusal(entering?)
    }

    /// Returns why a key that opens a page is refused; `None` if it is permitted.
    pub(crate) fn page_refusal(&self, page: PageId) -> Option<Message> {
        self.pages
            .contains(&page)
            .then(|| say::limit_page_refused(page.title(), page.name()))
    }
}

/// Returns the names of the keys that stop the machine and that a list of permitted keys leaves
/// out: they stay permitted.
pub fn unlisted_stop_keys(names: &PermittedNames) -> Vec<&'static str> {
    match names {
        PermittedNames::AllBut(_) => Vec::new(),
        PermittedNames::Only(listed) => {
            let is_listed = |key: &Key| listed.iter().any(|it| Key::from_id(it) == Some(*key));
            let unlisted = STOP_KEYS.into_iter().filter(|key| !is_listed(key));
            unlisted.map(Key::id).collect()
        }
    }
}

fn refused_items<T: Copy + Ord>(
    names: &PermittedNames,
    all: impl Iterator<Item = T>,
    find: impl Fn(&str) -> Result<T, Message>,
) -> Result<BTreeSet<T>, NameFault> {
    let read = |names: &[String]| -> Result<BTreeSet<T>, NameFault> {
        let found = names.iter().map(|name| {
            find(name).map_err(|rule| NameFault {
                name: name.clone(),
                rule,
            })
        });
        found.collect()
    };
    match names {
        PermittedNames::AllBut(refused) => read(refused),
        PermittedNames::Only(permitted) => {
            let permitted = read(permitted)?;
            Ok(all.filter(|item| !permitted.contains(item)).collect())
        }
    }
}

/// Joins the lines of a legend: Chinese lines form one name, without a blank between them.
fn join_legend(legend: &[&str]) -> String {
    let is_chinese = legend.iter().all(|line| !line.is_ascii());
    legend.join(if is_chinese { "" } else { " " })
}

fn find_key(name: &str) -> Result<Key, Message> {
    Key::from_id(name).ok_or_else(|| match keys::near_ids(name) {
        near if near.is_empty() => say::script_key_unknown(name),
        near => say::script_key_near(name, near.join(" ")),
    })
}

fn find_page_id(name: &str) -> Result<PageId, Message> {
    let row = find_page(name).ok_or_else(|| {
        let names: Vec<&str> = page_names().collect();
        say::script_unknown_page(name, names.join(" "))
    })?;
    Ok(row.page)
}

#[cfg(test)]
mod tests;
