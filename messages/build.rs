//! Generates a function for every row of the message table. Its parameters are the row's
//! placeholders, so a caller with a missing or surplus value does not compile.

#[path = "src/template.rs"]
mod template;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::{env, fs, path::Path};

use template::{Kind, Piece, TemplateError, pieces};

const TABLE: &str = "../assets/tables/messages.tsv";
const HEADER: &str = "id\ten\tzh";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed={TABLE}");
    println!("cargo::rerun-if-changed=src/template.rs");
    let table = fs::read_to_string(TABLE)?;
    let mut lines = table.lines().zip(1..);
    if lines.next().map(|(line, _)| line) != Some(HEADER) {
        return Err(Wrong::Header.into());
    }
    let mut rows: Vec<Row> = Vec::new();
    for (line, number) in lines {
        let row = parse(line).map_err(|wrong| Wrong::Line(number, wrong))?;
        // Alphabetical order keeps rows of the same subject together.
        if let Some(last) = rows.last()
            && last.id >= row.id
        {
            let wrong = RowError::Order(last.id.clone(), row.id);
            return Err(Wrong::Line(number, wrong).into());
        }
        rows.push(row);
    }
    let out = Path::new(&env::var("OUT_DIR")?).join("messages.rs");
    fs::write(out, sources(&rows)?)?;
    Ok(())
}

/// Why the table cannot be compiled.
#[derive(Debug, thiserror::Error)]
enum Wrong {
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

struct Row {
    id: String,
    en: String,
    zh: String,
    /// Name and kind of each placeholder, in the order of the English text.
    values: Vec<(String, Kind)>,
}

/// Parses a line of the table. Both languages must use the same placeholders.
fn parse(line: &str) -> Result<Row, RowError> {
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
    let mut values: Vec<(String, Kind)> = Vec::new();
    for piece in pieces(&en)? {
        if let Piece::Value { name, kind } = piece
            && !values.iter().any(|(known, _)| known == name)
        {
            values.push((name.to_owned(), kind));
        }
    }
    let names = |text: &str| -> Result<BTreeMap<String, ()>, TemplateError> {
        let named = pieces(text)?.into_iter().filter_map(|piece| match piece {
            Piece::Value { name, .. } => Some((name.to_owned(), ())),
            Piece::Text(_) => None,
        });
        Ok(named.collect())
    };
    if names(&en)? != names(&zh)? {
        return Err(RowError::Placeholders);
    }
    Ok(Row {
        id: id.to_owned(),
        en,
        zh,
        values,
    })
}

fn sources(rows: &[Row]) -> Result<String, std::fmt::Error> {
    let mut enumeration = String::new();
    let mut table = String::new();
    let mut functions = String::new();
    for row in rows {
        let variant = camel_case(&row.id);
        let names: Vec<&str> = row.values.iter().map(|(name, _)| name.as_str()).collect();
        writeln!(enumeration, "    /// {}\n    {variant},", in_docs(&row.en))?;
        writeln!(
            table,
            "    Row {{ name: {:?}, en: {:?}, zh: {:?}, values: &{names:?} }},",
            row.id, row.en, row.zh
        )?;
        let parameters: Vec<String> = row.values.iter().map(parameter).collect();
        let values: Vec<String> = row.values.iter().map(value).collect();
        writeln!(
            functions,
            "/// {}\n///\n/// {}\n#[must_use]\npub fn {}({}) -> Message {{\n    \
             Message::of(Id::{variant}, vec![{}])\n}}\n",
            in_docs(&row.en),
            in_docs(&row.zh),
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
            .map(|row| format!("Id::{}", camel_case(&row.id)))
            .collect::<Vec<_>>()
            .join(", "),
        rows.len(),
    ))
}

/// Quotes a text for a doc comment and escapes everything that makes a link or a tag.
fn in_docs(text: &str) -> String {
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

fn parameter((name, kind): &(String, Kind)) -> String {
    match kind {
        Kind::Plain(_) => format!("{name}: impl Display"),
        Kind::Message => format!("{name}: impl Into<Message>"),
        Kind::Messages => format!("{name}: impl IntoIterator<Item = Message>"),
    }
}

fn value((name, kind): &(String, Kind)) -> String {
    match kind {
        Kind::Plain(spec) if spec.is_empty() => format!("Value::Text({name}.to_string())"),
        Kind::Plain(spec) => format!("Value::Text(format!(\"{{{name}:{spec}}}\"))"),
        Kind::Message => format!("Value::Message({name}.into())"),
        Kind::Messages => format!("Value::List({name}.into_iter().collect())"),
    }
}

fn camel_case(id: &str) -> String {
    let words = id.split('_').map(|word| {
        let mut letters = word.chars();
        let first = letters.next().map(|first| first.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    });
    words.collect()
}
