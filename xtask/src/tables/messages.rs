//! The list of messages: name and placeholders of each row of the message table.

#[path = "../../../messages/src/template.rs"]
mod template;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use template::{PlaceholderKind, TemplateError, TemplatePiece, split_template};

const HEADER: &str = "id\ten\tzh";

/// Returns the source of the list.
///
/// # Errors
///
/// Returns the fault of the table, with the line.
pub fn generate(table: &str) -> Result<String, String> {
    generate_list(table).map_err(|error| error.to_string())
}

/// Returns the source of the list of a table.
fn generate_list(table: &str) -> Result<String, TableError> {
    let mut lines = table.lines().zip(1..);
    if lines.next().map(|(line, _)| line) != Some(HEADER) {
        return Err(TableError::Header);
    }
    let mut rows: Vec<TableRow> = Vec::new();
    for (line, number) in lines {
        let row = parse_row(line).map_err(|error| TableError::Line(number, error))?;
        // Alphabetical order keeps rows of the same subject together.
        if let Some(last) = rows.last()
            && last.id >= row.id
        {
            let error = RowError::Order(last.id.clone(), row.id);
            return Err(TableError::Line(number, error));
        }
        rows.push(row);
    }
    let mut list = String::from(
        "//! Name and placeholders of each row of the message table: written by `cargo xtask tables`.\n\n\
         use crate::{Message, MessageTable, Value};\n\n\
         message_rows! {\n",
    );
    for row in &rows {
        let values: Vec<String> = row.values.iter().map(list_entry).collect();
        let variant = to_camel_case(&row.id);
        // Writing to a string cannot fail.
        let _ = writeln!(list, "    {} {variant}({});", row.id, values.join(", "));
    }
    list.push_str("}\n");
    Ok(list)
}

/// Returns a placeholder as the list has it: `name`, `name: message`, `name: "{:04}"`.
fn list_entry((name, kind): &(String, PlaceholderKind)) -> String {
    match kind {
        PlaceholderKind::Plain(format) if format.is_empty() => name.clone(),
        PlaceholderKind::Plain(format) => format!("{name}: \"{{:{format}}}\""),
        PlaceholderKind::Message => format!("{name}: message"),
        PlaceholderKind::Messages => format!("{name}: messages"),
    }
}

/// The reason for which the table cannot be compiled.
#[derive(Debug, thiserror::Error)]
enum TableError {
    /// The first line is not the heading.
    #[error("the table does not begin with the line `{HEADER}`")]
    Header,
    /// A line, counted from 1, has a fault.
    #[error("line {0}: {1}")]
    Line(u32, RowError),
}

/// The reason for which a line of the table is invalid.
#[derive(Debug, thiserror::Error)]
enum RowError {
    /// The second id must stand before the first and only once.
    #[error("`{0}` must stand after `{1}`, once")]
    Order(String, String),
    /// The line has this number of columns.
    #[error("{0} columns in place of 3")]
    Columns(usize),
    /// This id has other characters.
    #[error("`{0}` is not an id: small letters, digits and _")]
    Id(String),
    /// A text is empty.
    #[error("a text is missing")]
    Text,
    /// The texts differ in their placeholders.
    #[error("the two texts have not the same placeholders")]
    Placeholders,
    /// A placeholder is invalid.
    #[error(transparent)]
    Template(#[from] TemplateError),
}

struct TableRow {
    id: String,
    /// Name and kind of each placeholder, in the order of the English text.
    values: Vec<(String, PlaceholderKind)>,
}

/// Parses a line of the table. Both languages must use the same placeholders.
fn parse_row(line: &str) -> Result<TableRow, RowError> {
    let fields: Vec<&str> = line.split('\t').collect();
    let [id, en, zh] = fields[..] else {
        return Err(RowError::Columns(fields.len()));
    };
    let plain = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_';
    if !id.starts_with(|first: char| first.is_ascii_lowercase()) || !id.bytes().all(plain) {
        return Err(RowError::Id(id.to_owned()));
    }
    if en.trim().is_empty() || zh.trim().is_empty() {
        return Err(RowError::Text);
    }
    let [en, zh] = [en, zh].map(|text| text.replace("\\n", "\n"));
    let mut values: Vec<(String, PlaceholderKind)> = Vec::new();
    for piece in split_template(&en)? {
        if let TemplatePiece::Value { name, kind } = piece
            && !values.iter().any(|(known, _)| known == name)
        {
            values.push((name.to_owned(), kind));
        }
    }
    let names = |text: &str| -> Result<BTreeSet<String>, TemplateError> {
        let named = split_template(text)?
            .into_iter()
            .filter_map(|piece| match piece {
                TemplatePiece::Value { name, .. } => Some(name.to_owned()),
                TemplatePiece::Text(_) => None,
            });
        Ok(named.collect())
    };
    if names(&en)? != names(&zh)? {
        return Err(RowError::Placeholders);
    }
    Ok(TableRow {
        id: id.to_owned(),
        values,
    })
}

fn to_camel_case(id: &str) -> String {
    let words = id.split('_').map(|word| {
        let mut letters = word.chars();
        let first = letters.next().map(|first| first.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    });
    words.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_becomes_a_line_with_its_placeholders() {
        let table = format!("{HEADER}\nfirst_row\t{{at:04}} {{why:message}}\t{{why}}，{{at}}\n");
        let list = generate_list(&table).unwrap();
        assert!(
            list.contains("    first_row FirstRow(at: \"{:04}\", why: message);\n"),
            "{list}"
        );
    }

    #[test]
    fn a_fault_of_the_table_has_its_line() {
        for (row, fault) in [
            ("a\tb", "line 2: 2 columns in place of 3"),
            ("A\tb\tc", "line 2: `A` is not an id"),
            ("a\t\tc", "line 2: a text is missing"),
            ("a\t{b}\tc", "line 2: the two texts"),
            ("a\t{b\tc", "line 2: a { without"),
            ("b\tb\tc\na\tb\tc", "line 3: `b` must stand after `a`"),
        ] {
            let error = generate_list(&format!("{HEADER}\n{row}\n")).unwrap_err();
            assert!(error.to_string().contains(fault), "{error}");
        }
        assert!(generate_list("id\n").is_err());
    }
}
