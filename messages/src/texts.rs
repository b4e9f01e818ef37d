//! The texts of the messages, which the program hands over when it starts.

use std::sync::OnceLock;

use crate::rows::IDS;
use crate::{Id, Language};

/// The text of the message table, `assets/tables/messages.tsv` as a whole, with the positions of
/// its lines: a heading and a line for each [`Id`]. A program computes them when it is compiled:
/// there are thousands, and a command shows few.
#[derive(Debug)]
pub struct MessageTable {
    text: &'static str,
    /// Position of the byte after each line feed: the first is the start of the line of the
    /// first [`Id`], after the heading.
    line_starts: [u32; IDS.len()],
}

/// The source of all texts.
static TABLE: OnceLock<&'static MessageTable> = OnceLock::new();

impl MessageTable {
    /// Finds the lines of a table.
    pub const fn new(text: &'static str) -> Self {
        let mut line_starts = [text.len() as u32; IDS.len()];
        let (mut bytes, mut line) = (text.as_bytes(), 0);
        while let [byte, rest @ ..] = bytes {
            bytes = rest;
            if *byte == b'\n' && line < line_starts.len() {
                line_starts[line] = (text.len() - rest.len()) as u32;
                line += 1;
            }
        }
        Self { text, line_starts }
    }

    /// The line of a row, without its line end; empty if the table does not have it.
    pub(crate) fn line(&self, id: Id) -> &'static str {
        let start = self.line_starts.get(id as usize).copied();
        let rest = start.and_then(|start| self.text.get(start as usize..));
        rest.and_then(|rest| rest.lines().next()).unwrap_or("")
    }
}

/// Takes a message table as the source of all texts. A program calls it first of all. The first
/// call counts; later ones change nothing.
///
/// Without it a message shows the name of its row. A build with debug assertions reads the
/// table from the sources instead, because the tests of a library have no program.
pub fn install_texts(table: &'static MessageTable) {
    TABLE.get_or_init(|| table);
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
    let of_sources = || &*Box::leak(Box::new(MessageTable::new(table_of_the_sources())));
    let name = id.name();
    let mut fields = TABLE.get_or_init(of_sources).line(id).split('\t');
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
        assert_eq!(template(id, Language::En), "program {program:04} exists");
        assert_eq!(template(id, Language::Zh), "程序 {program} 已存在");
    }
}
