//! Writes rows of the ladder's tables as lines of the instruction list: `.MSG`, `.CMT`,
//! `.INIT`.

use gsk_core::plc::PlcAddress;
use gsk_core::plc::address::{BitAddress, ByteAddress};

use gsk_messages::{Message, say};

/// A table of a ladder, by its directive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// `.MSG`.
    Messages,
    /// `.CMT`.
    Comments,
    /// `.INIT`.
    StartValues,
}

impl Table {
    const fn directive(self) -> &'static str {
        match self {
            Self::Messages => ".MSG",
            Self::Comments => ".CMT",
            Self::StartValues => ".INIT",
        }
    }

    /// Headings of the fields of a row, the address first.
    pub fn fields(self) -> Vec<Message> {
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

    /// The line of a row; the error if a field contains a quotation mark.
    fn line(self, fields: &[String]) -> Result<String, Message> {
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

    /// The instruction list with a row added. It replaces the row with the same address.
    pub fn with(self, list: &str, fields: &[String]) -> Result<String, Message> {
        let line = self.line(fields)?;
        let subject = fields.first().and_then(|address| subject(address));
        Ok(self.replaced(list, subject, Some(&line)))
    }

    /// The instruction list without the row of an address.
    pub fn without(self, list: &str, address: &str) -> String {
        self.replaced(list, subject(address), None)
    }

    fn replaced(self, list: &str, wanted: Option<PlcAddress>, line: Option<&str>) -> String {
        let row = |text: &str| self.subject_of(text);
        let known = wanted.and_then(|wanted| {
            list.lines()
                .position(|text| row(text) == Some(Some(wanted)))
        });
        // A new row is inserted after the last of its table, or at the start of the list.
        let behind = list
            .lines()
            .enumerate()
            .filter(|(_, text)| row(text).is_some());
        let behind = behind.map(|(at, _)| at).last();
        let mut changed: Vec<&str> = list.lines().collect();
        match (known, line) {
            (Some(at), Some(line)) => changed[at] = line,
            (Some(at), None) => {
                changed.remove(at);
            }
            (None, Some(line)) => changed.insert(behind.map_or(0, |at| at + 1), line),
            (None, None) => {}
        }
        let mut text = changed.join("\n");
        text.push('\n');
        text
    }

    /// The address in a line of this table: the outer `None` means another line, the inner an
    /// invalid address.
    fn subject_of(self, line: &str) -> Option<Option<PlcAddress>> {
        let mut words = line.split_whitespace();
        let name = words.next()?;
        name.eq_ignore_ascii_case(self.directive())
            .then(|| words.next().and_then(subject))
    }
}

fn subject(address: &str) -> Option<PlcAddress> {
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
        let with = |table: Table, texts: &[&str]| {
            let text = table.with(LIST, &fields(texts)).unwrap();
            Ladder::compile(&text).unwrap();
            text
        };
        let text = with(Table::Messages, &["a0.1", "1005", " five "]);
        assert_eq!(
            text,
            LIST.replace(".msg A0.1 1001 \"二\"", ".MSG a0.1 1005 \"five\"")
        );
        let text = with(Table::Messages, &["A3.0", "1030", "three"]);
        assert!(
            text.contains("\"二\"\n.MSG A3.0 1030 \"three\"\n.CMT"),
            "{text}"
        );
        let text = with(Table::StartValues, &["D300", "7"]);
        assert!(text.starts_with(".INIT D300 7\n; head\n"), "{text}");
        let text = Table::Comments.without(LIST, "X000.5");
        assert_eq!(text, LIST.replace(".CMT X0.5 \"急停\" \"stop\"\n", ""));
        assert_eq!(Table::Comments.without(LIST, "X7.7"), LIST);
    }

    #[test]
    fn quotation_marks_are_refused() {
        let row = fields(&["A0.0", "1000", "a \"b\""]);
        assert!(Table::Messages.with(LIST, &row).is_err());
    }
}
