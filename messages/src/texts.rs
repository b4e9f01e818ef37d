//! The texts of the messages, which the program hands over when it starts.

use std::sync::OnceLock;

use crate::{Id, Language};

/// Lines of the message table, without the heading: a line for each [`Id`], in its order.
static LINES: OnceLock<Vec<&'static str>> = OnceLock::new();

/// Takes the message table as the source of all texts, `assets/tables/messages.tsv` as a whole.
/// A program calls it first of all. The first call counts; later ones change nothing.
///
/// Without it a message shows the name of its row. A build with debug assertions reads the
/// table from the sources instead, because the tests of a library have no program.
pub fn install_texts(table: &'static str) {
    LINES.get_or_init(|| split_table(table));
}

/// Splits the table into its lines, without the heading.
fn split_table(table: &'static str) -> Vec<&'static str> {
    table.lines().skip(1).collect()
}

/// Returns the table of the sources, for tests. It is empty in a program for users.
fn table_of_the_sources() -> &'static str {
    #[cfg(debug_assertions)]
    {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/tables/messages.tsv");
        let table = std::fs::read_to_string(path).unwrap_or_default();
        String::leak(table)
    }
    #[cfg(not(debug_assertions))]
    ""
}

/// Returns the text of a row in a language, with its placeholders; `\n` of the table is a line
/// feed. A row that the table does not have is its own text.
pub(crate) fn template(id: Id, language: Language) -> String {
    let lines = LINES.get_or_init(|| split_table(table_of_the_sources()));
    let name = id.name();
    let mut fields = lines.get(id as usize).copied().unwrap_or("").split('\t');
    let found = fields.next() == Some(name);
    let text = match language {
        Language::En => fields.next(),
        Language::Zh => fields.nth(1),
    };
    let text = text.filter(|_| found).unwrap_or(name);
    text.replace("\\n", "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::say;

    #[test]
    fn a_row_has_a_text_in_each_language() {
        let id = say::program_exists(12).id();
        assert_eq!(template(id, Language::En), "O{program:04} exists");
        assert_eq!(template(id, Language::Zh), "O{program} 已存在");
    }
}
