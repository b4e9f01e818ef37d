//! The library as comma-separated values, RFC 4180, with a line of column names.

use gsk_messages::{Message, say};
use gsk_units::Diameter;
use gsk_workpiece::job::DiameterPoint;

use super::{ImportedTools, short_number};
use crate::description::{parse_description, tool_description};
use crate::library::{LibraryTool, ToolLibrary};
use crate::life::ToolLife;

/// The columns in the order in which they are written.
const COLUMNS: [&str; 11] = [
    "id", "name", "code", "tool", "station", "x", "z", "minutes", "edges", "edge", "used",
];

/// Writes a library. Column `tool` has all dimensions, `code` what was entered.
pub fn csv_text(library: &ToolLibrary) -> String {
    let mut out = COLUMNS.join(",") + "\n";
    for (id, tool) in &library.tools {
        let point = |value: fn(DiameterPoint) -> f64| {
            let value = tool.length.map(value);
            value.map(short_number).unwrap_or_default()
        };
        let life = |value: fn(&ToolLife) -> String| tool.life.as_ref().map(value);
        let fields = [
            id.clone(),
            tool.name.clone(),
            tool.code.clone(),
            tool_description(&tool.tool),
            tool.station.map(|it| it.to_string()).unwrap_or_default(),
            point(|it| it.x.0),
            point(|it| it.z),
            life(|it| it.minutes.to_string()).unwrap_or_default(),
            life(|it| it.edges.to_string()).unwrap_or_default(),
            life(|it| it.edge.to_string()).unwrap_or_default(),
            life(|it| it.used_minutes.to_string()).unwrap_or_default(),
        ];
        out += &(fields.map(|field| quoted(&field)).join(",") + "\n");
    }
    out
}

/// A field in quotes where it needs them.
fn quoted(field: &str) -> String {
    match field.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", field.replace('"', "\"\"")),
        false => field.to_owned(),
    }
}

/// Reads a table with a line of column names in any order; commas or semicolons separate.
///
/// # Errors
/// The table has neither a column `tool` nor a column `code`, or quotes that do not end.
pub fn read_csv(text: &str) -> Result<ImportedTools, Message> {
    let text = text.trim_start_matches('\u{feff}');
    let first_line = text.lines().next().unwrap_or_default();
    let separator = match first_line.contains(';') && !first_line.contains(',') {
        true => ';',
        false => ',',
    };
    let mut rows = split_rows(text, separator)?.into_iter();
    let (_, header) = rows.next().unwrap_or_default();
    let header: Vec<String> = header.iter().map(|it| it.trim().to_lowercase()).collect();
    let column = |name: &str| header.iter().position(|it| it == name);
    if column("tool").is_none() && column("code").is_none() {
        return Err(say::tool_table_columns());
    }
    let mut imported = ImportedTools::default();
    for (line, row) in rows {
        let field = |name: &str| {
            column(name)
                .and_then(|it| row.get(it))
                .map_or("", |it| it.trim())
        };
        match read_row(field) {
            Ok(tool) => imported.tools.push((field("id").to_owned(), tool)),
            Err(why) => imported.notes.push(say::tool_table_line(line, why)),
        }
    }
    Ok(imported)
}

fn read_row<'a>(field: impl Fn(&str) -> &'a str) -> Result<LibraryTool, Message> {
    let code = field("code");
    let tool = match field("tool") {
        "" => parse_description(code)?,
        text => parse_description(text)?,
    };
    let number = |name: &str| match field(name) {
        "" => Ok(None),
        text => text
            .replace(',', ".")
            .parse()
            .map(Some)
            .map_err(|_| say::tool_word_unknown(text, name)),
    };
    let small = |name: &str| {
        let value: Option<f64> = number(name)?;
        Ok::<_, Message>(value.map(|it| it.clamp(0.0, 255.0) as u8))
    };
    let (x, z) = (number("x")?, number("z")?);
    let life = match number("minutes")? {
        None => None,
        Some(minutes) => Some(ToolLife {
            minutes,
            edges: small("edges")?.unwrap_or(1),
            edge: small("edge")?.unwrap_or(1),
            used_minutes: number("used")?.unwrap_or(0.0),
        }),
    };
    Ok(LibraryTool {
        name: field("name").to_owned(),
        code: code.to_owned(),
        station: small("station")?,
        length: (x.is_some() || z.is_some()).then(|| DiameterPoint {
            x: Diameter(x.unwrap_or(0.0)),
            z: z.unwrap_or(0.0),
        }),
        life,
        ..LibraryTool::new(tool)
    })
}

/// A row with the number of its first line.
type NumberedRow = (usize, Vec<String>);

/// Splits a table into rows, without empty ones.
fn split_rows(text: &str, separator: char) -> Result<Vec<NumberedRow>, Message> {
    let mut rows = Vec::new();
    let (mut row, mut field) = (Vec::new(), String::new());
    let (mut line, mut first_line, mut is_quoted) = (1, 1, false);
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        if character == '\n' {
            line += 1;
        }
        match character {
            '"' if is_quoted && characters.peek() == Some(&'"') => {
                characters.next();
                field.push('"');
            }
            '"' if is_quoted || field.is_empty() => is_quoted = !is_quoted,
            _ if is_quoted => field.push(character),
            _ if character == separator => row.push(core::mem::take(&mut field)),
            '\r' => {}
            '\n' => {
                row.push(core::mem::take(&mut field));
                rows.push((first_line, core::mem::take(&mut row)));
                first_line = line;
            }
            _ => field.push(character),
        }
    }
    if is_quoted {
        return Err(say::tool_table_line(first_line, say::tool_table_quotes()));
    }
    row.push(field);
    rows.push((first_line, row));
    rows.retain(|(_, row)| row.iter().any(|it| !it.trim().is_empty()));
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn a_library_survives_a_round_trip_through_csv() {
        let mut library = ToolLibrary::default();
        let mut rough = LibraryTool::from_description("CNMG 120408 PCLNR 2020K12").unwrap();
        rough.name = "rough, \"80\"\n粗车".to_owned();
        rough.station = Some(1);
        rough.life = Some(ToolLife {
            used_minutes: 3.25,
            edge: 2,
            ..ToolLife::new(15.0, 4)
        });
        rough.length = Some(DiameterPoint {
            x: Diameter(-2.5),
            z: 1.25,
        });
        library.insert("rough", rough).unwrap();
        library
            .insert("d5", LibraryTool::from_description("drill 5").unwrap())
            .unwrap();
        let read = read_csv(&csv_text(&library)).unwrap();
        assert_eq!(read.notes, []);
        assert_eq!(
            read.tools
                .into_iter()
                .collect::<std::collections::BTreeMap<_, _>>(),
            library.tools
        );
    }

    #[test]
    fn a_foreign_table_gives_tools_and_names_bad_lines() {
        let table =
            "\u{feff}Code;Name;Station\r\nCNMG 120408;rough;1\r\nCNMX;bad;2\r\n\r\ndrill 5;;\r\n";
        let read = read_csv(table).unwrap();
        assert_eq!(read.tools.len(), 2);
        assert_eq!(read.tools[0].1.station, Some(1));
        let note = read.notes[0].text(Language::En);
        assert!(
            note.contains("line 3") && note.contains("position 5"),
            "{note}"
        );
        assert!(read_csv("a,b\n1,2\n").is_err());
        assert!(read_csv("code\n\"CNMG").is_err());
    }
}
