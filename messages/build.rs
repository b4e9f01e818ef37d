//! Generates a function for every row of the message table. Its parameters are the row's
//! placeholders, so a caller with a missing or surplus value does not compile.

#[path = "src/template.rs"]
mod template;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::{env, fs, path::Path};

use template::{PlaceholderKind, TemplateError, TemplatePiece, split_template};

const TABLE: &str = "../assets/tables/messages.tsv";
const HEADER: &str = "id\ten\tzh";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed={TABLE}");
    println!("cargo::rerun-if-changed=src/template.rs");
    let table = fs::read_to_string(TABLE)?;
    let mut lines = table.lines().zip(1..);
    if lines.next().map(|(line, _)| line) != Some(HEADER) {
        return Err(TableError::Header.into());
    }
    let mut rows: Vec<TableRow> = Vec::new();
    for (line, number) in lines {
        let row = parse_row(line).map_err(|error| TableError::Line(number, error))?;
        // Alphabetical order keeps rows of the same subject together.
        if let Some(last) = rows.last()
            && last.id >= row.id
        {
            let error = RowError::Order(last.id.clone(), row.id);
            return Err(TableError::Line(number, error).into());
        }
        rows.push(row);
    }
    let out = Path::new(&env::var("OUT_DIR")?).join("messages.rs");
    fs::write(out, generate_sources(&rows)?)?;
    Ok(())
}

/// Why the table cannot be compiled.
#[derive(Debug, thiserror::Error)]
enum TableError {
    #[error("{TABLE} does not begin with the line `{HEADER}`")]
    Header,
    #[error("{TABLE}, line {0}: {1}")]
    Line(u32, RowError),
}

/// Why a line of the table is invalid.
#[derive(Debug, thiserror::Error)]
enum RowError {
    #[error("`{0}` must stand after `{1}`, once")]
    Order(String, String),
    #[error("{0} columns in place of 3")]
    Columns(usize),
    #[error("`{0}` is not an id: small letters, digits and _")]
    Id(String),
    #[error("a text is missing")]
    Text,
    #[error("the two texts have not the same placeholders")]
    Placeholders,
    #[error(transparent)]
    Template(#[from] TemplateError),
}

struct TableRow {
    id: String,
    en: String,
    zh: String,
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
    let names = |text: &str| -> Result<BTreeMap<String, ()>, TemplateError> {
        let named = split_template(text)?
            .into_iter()
            .filter_map(|piece| match piece {
                TemplatePiece::Value { name, .. } => Some((name.to_owned(), ())),
                TemplatePiece::Text(_) => None,
            });
        Ok(named.collect())
    };
    if names(&en)? != names(&zh)? {
        return Err(RowError::Placeholders);
    }
    Ok(TableRow {
        id: id.to_owned(),
        en,
        zh,
        values,
    })
}

fn generate_sources(rows: &[TableRow]) -> Result<String, std::fmt::Error> {
    let mut enumeration = String::new();
    let mut table = String::new();
    let mut functions = String::new();
    for row in rows {
        let variant = to_camel_case(&row.id);
        let names: Vec<&str> = row.values.iter().map(|(name, _)| name.as_str()).collect();
        writeln!(
            enumeration,
            "    /// {}\n    {variant},",
            quote_for_docs(&row.en)
        )?;
        writeln!(
            table,
            "    Row {{ name: {:?}, en: {:?}, zh: {:?}, values: &{names:?} }},",
            row.id, row.en, row.zh
        )?;
        let parameters: Vec<String> = row.values.iter().map(function_parameter).collect();
        let values: Vec<String> = row.values.iter().map(value_expression).collect();
        writeln!(
            functions,
            "/// {}\n///\n/// {}\n#[must_use]\npub fn {}({}) -> Message {{\n    \
             Message::of(Id::{variant}, vec![{}])\n}}\n",
            quote_for_docs(&row.en),
            quote_for_docs(&row.zh),
            row.id,
            parameters.join(", "),
            values.join(", ")
        )?;
    }
    Ok(format!(
        "/// Which message it is: a row of the table.\n\
         #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]\n\
         pub enum Id {{\n{enumeration}}}\n\n\
         const IDS: [Id; {}] = [{}];\n\n\
         static ROWS: [Row; {}] = [\n{table}];\n\n\
         /// A function for every row of the table.\n\
         pub mod say {{\n\
         #![allow(clippy::all, clippy::pedantic, rustdoc::all, reason = \"made from the table\")]\n\
         use super::{{Id, Message, Value}};\n\
         use core::fmt::Display;\n\n\
         {functions}}}\n",
        rows.len(),
        rows.iter()
            .map(|row| format!("Id::{}", to_camel_case(&row.id)))
            .collect::<Vec<_>>()
            .join(", "),
        rows.len(),
    ))
}

/// Quotes a text for a doc comment and escapes everything that makes a link or a tag.
fn quote_for_docs(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        if letter == '\n' {
            quoted.push_str("\\\\n");
            continue;
        }
        if matches!(letter, '[' | ']' | '<' | '>' | '`' | '*' | '_' | '\\') {
            quoted.push('\\');
        }
        quoted.push(letter);
    }
    quoted.push('"');
    quoted
}

fn function_parameter((name, kind): &(String, PlaceholderKind)) -> String {
    match kind {
        PlaceholderKind::Plain(_) => format!("{name}: impl Display"),
        PlaceholderKind::Message => format!("{name}: impl Into<Message>"),
        PlaceholderKind::Messages => format!("{name}: impl IntoIterator<Item = Message>"),
    }
}

fn value_expression((name, kind): &(String, PlaceholderKind)) -> String {
    match kind {
        PlaceholderKind::Plain(spec) if spec.is_empty() => {
            format!("Value::Text({name}.to_string())")
        }
        PlaceholderKind::Plain(spec) => format!("Value::Text(format!(\"{{{name}:{spec}}}\"))"),
        PlaceholderKind::Message => format!("Value::Message({name}.into())"),
        PlaceholderKind::Messages => format!("Value::List({name}.into_iter().collect())"),
    }
}

fn to_camel_case(id: &str) -> String {
    let words = id.split('_').map(|word| {
        let mut letters = word.chars();
        let first = letters.next().map(|first| first.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    });
    words.collect()
}
