//! Writes the lists in the sources that come from the tables of `assets/tables`: `cargo xtask
//! tables`.
//!
//! The lists have names, numbers and placeholders, and no text that users read. They are part of
//! the sources, so a text that is reworded does not compile all packages anew.

mod constants;
mod factory;
mod messages;

use std::fs;
use std::path::Path;

use crate::error::TaskError;

/// Makes the source of a list from the text of its table, or returns the fault of the table.
type GenerateList = fn(&str) -> Result<String, String>;

/// Path of each table, path of the list that is generated from it, and the function that generates
/// it.
const LISTS: [(&str, &str, GenerateList); 4] = [
    ("messages.tsv", "messages/src/rows.rs", messages::generate),
    ("alarms.tsv", "units/src/alarm.rs", |table| {
        constants::generate(table, "Alarm numbers")
    }),
    ("parameters.tsv", "core/src/memory/parameter.rs", |table| {
        constants::generate(table, "Numbers of data parameters that modules pass on")
    }),
    (
        "parameters.tsv",
        "core/src/memory/factory_values.rs",
        factory::generate,
    ),
];

/// Writes every list anew from its table.
///
/// # Errors
/// Returns the first fault of a table, or why a file cannot be read or written.
pub fn write(root: &Path) -> Result<(), TaskError> {
    for (table, list, generate) in LISTS {
        let text = read(&root.join("assets/tables").join(table))?;
        let source = generate(&text).map_err(|fault| TaskError::Table { table, fault })?;
        let path = root.join(list);
        if !read(&path).is_ok_and(|old| old == source) {
            fs::write(&path, source).map_err(|error| TaskError::Write { path, error })?;
        }
    }
    Ok(())
}

fn read(path: &Path) -> Result<String, TaskError> {
    fs::read_to_string(path).map_err(|error| TaskError::Write {
        path: path.to_owned(),
        error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_list_is_the_one_of_its_table() {
        let root = crate::root();
        for (table, list, generate) in LISTS {
            let text = read(&root.join("assets/tables").join(table)).unwrap();
            let same = read(&root.join(list)).unwrap() == generate(&text).unwrap();
            assert!(
                same,
                "{list} is older than {table}: run `cargo xtask tables`"
            );
        }
    }
}
