//! Searches a ladder for an address, an instruction or a comment (manual PLC-III 3.2.2, 查找).

use gsk_core::plc::address::{BitAddress, ByteAddress};
use gsk_core::plc::{Ladder, Operand, PlcAddress, Statement};
use gsk_messages::{Language, Message, say};

use super::address_text::address_comment;

/// The part of the ladder that a search covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SearchDirection {
    /// 全部: the whole program.
    #[default]
    All,
    /// 向上: from this row upwards, the last match first.
    Up(u32),
    /// 向下: from this row downwards.
    Down(u32),
}

/// One place where the searched text was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LadderMatch {
    /// Index of the statement in the program, from 0.
    pub statement: usize,
    /// Number of the rung, from 1.
    pub row: u32,
    /// Column of the contact or output in the rung, from 1.
    pub column: usize,
}

/// The result of a search.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LadderMatches {
    /// The address that was searched for; `None` if the text is not an address.
    pub address: Option<PlcAddress>,
    /// The matches, in the order of the search.
    pub matches: Vec<LadderMatch>,
}

impl LadderMatches {
    /// Returns the lines of the output window of GSKCC: one for each match, then their number.
    /// `text` is what was searched for.
    pub fn messages(&self, text: &str) -> Vec<Message> {
        let found = self.matches.iter().zip(1..);
        let found = found.map(|(found, number)| found.message(number));
        let text = self
            .address
            .map_or_else(|| text.to_owned(), |address| address.to_string());
        let last = say::ladder_search_end(text, self.matches.len());
        found.chain([last]).collect()
    }
}

impl LadderMatch {
    /// Returns the line of this match in the output window of GSKCC; `number` counts from 1.
    pub fn message(&self, number: usize) -> Message {
        say::ladder_search_match(number, self.row, self.column)
    }
}

/// Searches a ladder for an address, the name of an instruction, or a word of a comment in
/// either language; ignores case. An empty text finds nothing.
pub fn search_ladder(ladder: &Ladder, text: &str, direction: SearchDirection) -> LadderMatches {
    let text = text.trim().to_uppercase();
    let address = parse_address(&text);
    let mut matches: Vec<LadderMatch> = match address {
        _ if text.is_empty() => Vec::new(),
        Some(address) => {
            let references = ladder.references(address).into_iter();
            let found = references.map(|reference| (reference.statement, reference.rung));
            locate(ladder, found)
        }
        None => {
            let statements = ladder.statements().iter().enumerate();
            let found = statements.filter(|(_, statement)| contains(ladder, statement, &text));
            locate(ladder, found.map(|(at, statement)| (at, statement.rung)))
        }
    };
    match direction {
        SearchDirection::All => {}
        SearchDirection::Down(row) => matches.retain(|found| found.row >= row),
        SearchDirection::Up(row) => {
            matches.retain(|found| found.row <= row);
            matches.reverse();
        }
    }
    LadderMatches { address, matches }
}

/// Adds the column to each statement, given by its index and its rung.
fn locate(ladder: &Ladder, found: impl Iterator<Item = (usize, u32)>) -> Vec<LadderMatch> {
    let at_column = |(statement, row)| {
        let network = ladder.network(row);
        let column = network.map_or(1, |network| network.column(statement - network.first));
        LadderMatch {
            statement,
            row,
            column,
        }
    };
    found.map(at_column).collect()
}

/// Whether a statement is the instruction `text`, or an address of it has `text` in a comment.
fn contains(ladder: &Ladder, statement: &Statement, text: &str) -> bool {
    let is_commented = |address: PlcAddress| {
        [Language::Zh, Language::En].into_iter().any(|language| {
            let comment = address_comment(ladder, address, language);
            comment.to_uppercase().contains(text)
        })
    };
    let mut addresses = statement
        .operands
        .iter()
        .filter_map(|operand| match operand {
            Operand::Bit(bit) => Some(PlcAddress::Bit(*bit)),
            Operand::Byte(byte) => Some(PlcAddress::Byte(*byte)),
            _ => None,
        });
    statement.mnemonic.row().name == text || addresses.any(is_commented)
}

/// Parses an address of a bit or byte; `None` if the text is not one.
fn parse_address(text: &str) -> Option<PlcAddress> {
    let bit = text.parse::<BitAddress>().ok().map(PlcAddress::Bit);
    bit.or_else(|| text.parse::<ByteAddress>().ok().map(PlcAddress::Byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ladder() -> Ladder {
        let source = ".CMT X0.5 \"急停\" \"Emergency stop\"\nEND1\nLDI X0.5\nLD R1.0\nOR R1.1\nANB\n\
                      AND R2.0\nOUT R2.0\nLD R2.0\nOUT Y1.0\nEND2";
        Ladder::compile(source).expect("a ladder")
    }

    fn found(text: &str, direction: SearchDirection) -> Vec<(u32, usize)> {
        let matches = search_ladder(&ladder(), text, direction).matches;
        matches
            .iter()
            .map(|found| (found.row, found.column))
            .collect()
    }

    #[test]
    fn addresses_instructions_and_comments_are_found_with_row_and_column() {
        let all = SearchDirection::All;
        assert_eq!(found("r2.0", all), [(2, 3), (2, 4), (3, 1)]);
        assert_eq!(found("R2", all), [(2, 3), (2, 4), (3, 1)]);
        assert_eq!(found("R1.1", all), [(2, 2)]);
        assert_eq!(found("out", all), [(2, 4), (3, 2)]);
        assert_eq!(found("急停", all), [(2, 1)]);
        assert_eq!(found("emergency", all), [(2, 1)]);
        assert_eq!(found("K7.7", all), []);
        assert_eq!(found(" ", all), []);
    }

    #[test]
    fn the_direction_limits_and_orders_the_matches() {
        assert_eq!(found("R2.0", SearchDirection::Down(3)), [(3, 1)]);
        let up = found("R2.0", SearchDirection::Up(2));
        assert_eq!(up, [(2, 4), (2, 3)]);
    }

    #[test]
    fn the_output_window_reports_as_in_the_manual() {
        // 000:12995-12997: a ladder that uses G8.4 once, in row 8 and column 1.
        let rungs = "LD R1.0\nOUT R2.0\n".repeat(6);
        let source = format!("END1\n{rungs}LD G8.4\nOUT R3.0\nEND2");
        let ladder = Ladder::compile(&source).expect("a ladder");
        let matches = search_ladder(&ladder, "g8.4", SearchDirection::All);
        let lines: Vec<String> = matches
            .messages("g8.4")
            .iter()
            .map(|line| line.text(Language::Zh))
            .collect();
        assert_eq!(
            lines,
            [
                "找到第 1 项：[行(8) 列(1)]",
                "查找 G0008.4 完毕：共找到 1 项结果"
            ]
        );
    }
}
