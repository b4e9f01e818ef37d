//! Finds names of PLC signals for the bit rows of the pages.

use std::sync::LazyLock;

use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{Ladder, PlcAddress};
use gsk_messages::Language;

use crate::signals::{self, Signal};

/// The signals of the signal table whose address is one bit, sorted by address.
static ROWS: LazyLock<Vec<(BitAddress, &'static Signal)>> = LazyLock::new(|| {
    let bit = |row: &'static Signal| Some((row.address.parse().ok()?, row));
    let mut rows: Vec<_> = signals::rows().iter().filter_map(bit).collect();
    rows.sort_by_key(|(address, _)| *address);
    rows
});

fn row(address: BitAddress) -> Option<&'static Signal> {
    let at = ROWS.binary_search_by_key(&address, |(bit, _)| *bit).ok()?;
    ROWS.get(at).map(|(_, row)| *row)
}

/// Returns the short name of a PLC bit for a row of eight names: of several the first, or `-`
/// without a name.
pub fn short(address: BitAddress) -> &'static str {
    let name = row(address).map_or("", |row| row.symbol);
    match name.split('/').next() {
        Some(name) if !name.is_empty() => name,
        _ => "-",
    }
}

/// Returns the meaning of a PLC bit: the ladder's comment, or else the text of the signal
/// table.
pub fn meaning(ladder: &Ladder, address: BitAddress, language: Language) -> String {
    let english = language == Language::En;
    let comment = ladder.comment(PlcAddress::Bit(address));
    match (comment, row(address)) {
        (Some(comment), _) if english && !comment.english.is_empty() => comment.english.clone(),
        (_, Some(row)) if english => row.text_en.to_owned(),
        (Some(comment), _) if !comment.chinese.is_empty() => comment.chinese.clone(),
        (_, Some(row)) => row.text_zh.to_owned(),
        _ => String::new(),
    }
}

/// Returns the meaning of a PLC bit from the signal table; empty if the table has none.
pub fn signal_meaning(address: BitAddress, language: Language) -> &'static str {
    row(address).map_or("", |row| match language {
        Language::Zh => row.text_zh,
        Language::En => row.text_en,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::plc::Area;

    #[test]
    fn most_rows_of_the_table_name_a_bit() {
        assert!(ROWS.len() > 400, "{}", ROWS.len());
        assert_eq!(short(BitAddress::new(Area::X, 0, 3)), "*DECX");
        assert_eq!(short(BitAddress::new(Area::X, 0, 0)), "T03");
        assert_eq!(short(BitAddress::new(Area::R, 999, 7)), "-");
    }
}
