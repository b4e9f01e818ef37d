//! Finds the texts of an address: the comment of the ladder, the row of the signal table.

use gsk_core::plc::address::ByteAddress;
use gsk_core::plc::{Ladder, PlcAddress};
use gsk_messages::Language;
use gsk_panel::pages::signal_meaning;
use gsk_panel::signals::{self, Signal};

/// Returns the comment of an address in the ladder, or its meaning in the signal table if it has
/// none.
pub fn address_comment(ladder: &Ladder, address: PlcAddress, language: Language) -> String {
    let own = ladder.comment(address).map(|comment| match language {
        Language::Zh => comment.chinese.as_str(),
        Language::En => comment.english.as_str(),
    });
    match (own, address) {
        (Some(own), _) if !own.is_empty() => own.to_owned(),
        (_, PlcAddress::Bit(bit)) => signal_meaning(bit, language).to_owned(),
        (_, PlcAddress::Byte(byte)) => byte_meaning(byte, language).to_owned(),
    }
}

/// Returns the meaning of a byte or entry in the signal table; empty without a row.
fn byte_meaning(address: ByteAddress, language: Language) -> &'static str {
    signal(PlcAddress::Byte(address)).map_or("", |signal| match language {
        Language::Zh => signal.text_zh,
        Language::En => signal.text_en,
    })
}

/// The row of an address in the signal table.
pub(super) fn signal(address: PlcAddress) -> Option<&'static Signal> {
    signals::rows().iter().find(|row| match address {
        PlcAddress::Bit(bit) => row.address.parse() == Ok(bit),
        PlcAddress::Byte(byte) => row.address.parse() == Ok(byte),
    })
}
