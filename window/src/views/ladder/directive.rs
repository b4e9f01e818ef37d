//! Writes rows of the ladder's tables as lines of the instruction list: `.MSG`, `.CMT`,
//! `.INIT`.

use gsk_core::plc::PlcAddress;
use gsk_core::plc::address::{BitAddress, ByteAddress};

use gsk_messages::{Message, say};

/// A table of a ladder, which the instruction list writes with a directive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LadderTable {
    /// Table of the ladder's messages (`.MSG`).
    Messages,
    /// Table of the names of addresses (`.CMT`).
    Comments,
    /// Table of the start values of addresses (`.INIT`).
    StartValues,
}

impl LadderTable {
    const fn directive(self) -> &'static str {
        match self {
            Self::Messages => ".MSG",
            Self::Comments => ".CMT",
            Self::StartValues => ".INIT",
        }
    }

    /// Headings of the fields of a row, the address first.
    pub fn field_names(self) -> Vec<Message> {
        match self {
            Self::Messages => vec![
                say::ladder_column_message_address(),
                say::ladder_column_message_number(),
                say::ladder_column_message_text(),
            ],
            Self::Comments => vec![
                say::ladder_column_address(),
                say::ladder_column_chinese_comment(),
                say::ladder_column_english_comment(),
            ],
            Self::StartValues => vec![
                say::ladder_column_address(),
                say::ladder_column_initial_value(),
            ],
        }
    }

    /// Formats a row as a line of the instruction list. The error is the message that a field
    /// contains a quotation mark.
    fn format_row(self, fields: &[String]) -> Result<String, Message> {
        let quoted = |text: &str| format!("\"{}\"", text.trim());
        if fields.iter().any(|field| field.contains(['"', '\n'])) {
            return Err(say::ladder_text_has_quotation_mark());
        }
        let directive = self.directive();
        Ok(match (self, fields) {
            (Self::Messages, [address, number, text]) => {
                format!(
                    "{directive} {} {} {}",
                    address.trim(),
                    number.trim(),
                    quoted(text)
                )
            }
            (Self::Comments, [address, zh, en]) => {
                format!(
                    "{directive} {} {} {}",
                    address.trim(),
                    quoted(zh),
                    quoted(en)
                )
            }
            (_, [address, value, ..]) => format!("{directive} {} {}", address.trim(), value.trim()),
            _ => String::new(),
        })
    }

    /// Returns the instruction list with a row added, which replaces the row with the same
    /// address. The error is the message that a field is invalid.
    pub fn with_row(self, list: &str, fields: &[String]) -> Result<String, Message> {
        let line = self.format_row(fields)?;
        let subject = fields.first().and_then(|address| parse_address(address));
        Ok(self.replace_row(list, subject, Some(&line)))
    }

    /// Returns the instruction list without the row of an address.
    pub fn without_row(self, list: &str, address: &str) -> String {
        self.replace_row(list, parse_address(address), None)
    }

    fn replace_row(self, list: &str, address: Option<PlcAddress>, line: Option<&str>) -> String {
        let address_of = |text: &str| self.row_address(text);
        let existing_row = address.and_then(|wanted| {
            list.lines()
                .position(|text| address_of(text) == Some(Some(wanted)))
        });
        // A new row is inserted after the last of its table, or at the start of the list.
        let table_rows = list
            .lines()
            .enumerate()
            .filter(|(_, text)| address_of(text).is_some());
        let last_row = table_rows.map(|(at, _)| at).last();
        let mut changed: Vec<&str> = list.lines().collect();
        match (existing_row, line) {
            (Some(at), Some(line)) => changed[at] = line,
            (Some(at), None) => {
                changed.remove(at);
            }
            (None, Some(line)) => changed.insert(last_row.map_or(0, |at| at + 1), line),
            (None, None) => {}
        }
        let mut text = changed.join("\n");
        text.push('\n');
        text
    }

    /// The address in a line of the instruction list. The outer `None` means that the line is
    /// not in this table, the inner one that the address is invalid.
    fn row_address(self, line: &str) -> Option<Option<PlcAddress>> {
        let mut words = line.split_whitespace();
        let name = words.next()?;
        name.eq_ignore_ascii_case(self.directive())
            .then(|| words.next().and_then(parse_address))
    }
}

fn parse_address(address: &str) -> Option<PlcAddress> {
    let address = address.trim().to_ascii_uppercase();
    let bit = address.parse::<BitAddress>().ok().map(PlcAddress::Bit);
    bit.or_else(|| address.parse::<ByteAddress>().ok().map(PlcAddress::Byte))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::plc::Ladder;

    const LIST: &str = "; head\n.MSG A0.0 1000 \"一\"\n.msg A0.1 1001 \"二\"\n.CMT X0.5 \"急停\" \"stop\"\nEND1\nEND2\n";

    fn fields(texts: &[&str]) -> Vec<String> {
        texts.iter().map(|text| (*text).to_owned()).collect()
    }

    #[test]
    fn a_row_is_replaced_added_and_deleted_and_nothing_else_changes() {
        let with = |table: LadderTable, texts: &[&str]| {
            let text = table.with_row(LIST, &fields(texts)).unwrap();
            Ladder::compile(&text).unwrap();
            text
        };
        let text = with(LadderTable::Messages, &["a0.1", "1005", " five "]);
        assert_eq!(
            text,
            LIST.replace(".msg A0.1 1001 \"二\"", ".MSG a0.1 1005 \"five\"")
        );
        let text = with(LadderTable::Messages, &["A3.0", "1030", "three"]);
        assert!(
            text.contains("\"二\"\n.MSG A3.0 1030 \"three\"\n.CMT"),
            "{text}"
        );
        let text = with(LadderTable::StartValues, &["D300", "7"]);
        assert!(text.starts_with(".INIT D300 7\n; head\n"), "{text}");
        let text = LadderTable::Comments.without_row(LIST, "X000.5");
        assert_eq!(text, LIST.replace(".CMT X0.5 \"急停\" \"stop\"\n", ""));
        assert_eq!(LadderTable::Comments.without_row(LIST, "X7.7"), LIST);
    }

    #[test]
    fn quotation_marks_are_refused() {
        let row = fields(&["A0.0", "1000", "a \"b\""]);
        assert!(LadderTable::Messages.with_row(LIST, &row).is_err());
    }
}
