//! Constants from a table: one for every row whose column `id` names it; `-` leaves a row
//! without.

use std::fmt::Write as _;

/// Returns the source with the constants of all rows with an `id`; a range has two, its first
/// number and its last. `subject` begins the module's first line.
///
/// # Errors
///
/// Returns the fault of the table, with the line.
pub fn generate(table: &str, subject: &str) -> Result<String, String> {
    let mut lines = table.lines();
    let heading: Vec<&str> = lines.next().unwrap_or_default().split('\t').collect();
    let column = |name: &str| {
        let place = heading.iter().position(|title| *title == name);
        place.ok_or_else(|| format!("no column {name}"))
    };
    let (number, id, meaning) = (column("number")?, column("id")?, column("meaning_en")?);
    let mut source = format!(
        "//! {subject}, as constants: the column `id` of the table, written by `cargo xtask tables`.\n"
    );
    for line in lines {
        let fields: Vec<&str> = line.split('\t').collect();
        let field = |place: usize| fields.get(place).copied().unwrap_or_default();
        let (id, meaning) = (field(id), field(meaning));
        if id == "-" {
            continue;
        }
        if !is_name(id) {
            return Err(format!("{id:?} is no name of a constant: {line}"));
        }
        let (first, last) = match field(number).split_once("..") {
            Some((first, last)) => (first, Some(last)),
            None => (field(number), None),
        };
        let value = parse(first, line)?;
        // Writing to a string cannot fail.
        let _ = write!(
            source,
            "\n/// {first}: {meaning}.\npub const {id}: u16 = {value};\n"
        );
        if let Some(last) = last {
            let value = parse(last, line)?;
            let _ = write!(
                source,
                "\n/// {last}: the last one of these.\npub const {id}_LAST: u16 = {value};\n"
            );
        }
    }
    Ok(source)
}

fn parse(number: &str, line: &str) -> Result<u16, String> {
    let parsed = number.parse();
    parsed.map_err(|_| format!("{number:?} is not a number: {line}"))
}

fn is_name(id: &str) -> bool {
    id.starts_with(|first: char| first.is_ascii_uppercase())
        && id
            .chars()
            .all(|letter| letter.is_ascii_uppercase() || letter.is_ascii_digit() || letter == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_two_constants() {
        let table =
            "number\tid\tmeaning_en\n007\tARC\tbad arc\n500..599\tUSER\tuser alarm\n8\t-\tx\n";
        let source = generate(table, "Alarm numbers").unwrap();
        let constants: Vec<&str> = source
            .lines()
            .filter(|line| line.starts_with("pub const"))
            .collect();
        assert_eq!(
            constants,
            [
                "pub const ARC: u16 = 7;",
                "pub const USER: u16 = 500;",
                "pub const USER_LAST: u16 = 599;"
            ]
        );
    }

    #[test]
    fn a_fault_has_its_line() {
        for row in ["1\tsmall\tx", "one\tONE\tx"] {
            let fault = generate(&format!("number\tid\tmeaning_en\n{row}\n"), "").unwrap_err();
            assert!(fault.contains(row), "{fault}");
        }
    }
}
