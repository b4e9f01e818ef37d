//! Constants from a table, for build scripts: one for every row whose column `id` names
//! it; `-` leaves a row without.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

/// Reads a table, seen from the package, and writes a file of constants for `include!`.
pub fn write(table: &str, file: &str) -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed={table}");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../assets/tables/constants.rs");
    let constants = constants(&fs::read_to_string(table)?);
    let constants = constants.map_err(|why| format!("{table}: {why}"))?;
    fs::write(Path::new(&env::var("OUT_DIR")?).join(file), constants)?;
    Ok(())
}

/// The constants of all rows with an `id`; a range has two, its first number and its
/// last.
fn constants(table: &str) -> Result<String, Box<dyn Error>> {
    let mut lines = table.lines();
    let heading: Vec<&str> = lines.next().unwrap_or_default().split('\t').collect();
    let column = |name: &str| {
        let place = heading.iter().position(|title| *title == name);
        place.ok_or_else(|| format!("no column {name}"))
    };
    let (number, id, meaning) = (column("number")?, column("id")?, column("meaning_en")?);
    let mut constants = String::new();
    for line in lines {
        let fields: Vec<&str> = line.split('\t').collect();
        let field = |place: usize| fields.get(place).copied().unwrap_or_default();
        let (id, meaning) = (field(id), field(meaning));
        if id == "-" {
            continue;
        }
        if !is_name(id) {
            return Err(format!("{id:?} is no name of a constant: {line}").into());
        }
        let (first, last) = match field(number).split_once("..") {
            Some((first, last)) => (first, Some(last)),
            None => (field(number), None),
        };
        let value: u16 = first.parse()?;
        writeln!(
            constants,
            "/// {first}: {meaning}.\npub const {id}: u16 = {value};"
        )?;
        if let Some(last) = last {
            let value: u16 = last.parse()?;
            writeln!(
                constants,
                "/// {last}: the last one of these.\npub const {id}_LAST: u16 = {value};"
            )?;
        }
    }
    Ok(constants)
}

fn is_name(id: &str) -> bool {
    id.starts_with(|first: char| first.is_ascii_uppercase())
        && id
            .chars()
            .all(|letter| letter.is_ascii_uppercase() || letter.is_ascii_digit() || letter == '_')
}
