//! Advice for codes of other controls: what this control uses instead (alarms 006, 009,
//! 010, 019 and 043).

use gsk_messages::{Message, say};

/// Returns advice what to use instead of a G code that this control does not have (table 3-7);
/// `None` for codes without advice.
pub(crate) fn advice_for_g_code(code: i64) -> Option<Message> {
    Some(match code {
        17..=19 => say::instead_of_plane(),
        20 | 21 => say::instead_of_inch_code(),
        36 | 37 => say::instead_of_tool_measuring(),
        43 | 44 | 49 => say::instead_of_tool_length(),
        53 => say::instead_of_machine_coordinates(),
        54..=59 => say::instead_of_work_coordinates(),
        61 | 64 => say::instead_of_exact_stop(),
        66 | 67 => say::instead_of_macro_call(),
        80..=89 => say::instead_of_drilling(),
        91 => say::instead_of_increments(),
        95 => say::instead_of_feed_code(),
        _ => return None,
    })
}

/// Returns advice what to use instead of an M code that this control does not have (manual I-3.3);
/// `None` for codes without advice.
pub(crate) fn advice_for_m_code(code: u8) -> Option<Message> {
    Some(match code {
        1 => say::instead_of_optional_stop(),
        2 => say::instead_of_end(),
        6 => say::instead_of_tool_change(),
        7 => say::instead_of_coolant(),
        17 => say::instead_of_return(),
        _ => return None,
    })
}

/// Returns advice what to use instead of a letter that is not an address (table 2-1); `None` for
/// letters without advice.
pub(crate) fn advice_for_address(letter: u8) -> Option<Message> {
    Some(match letter {
        b'A' => say::instead_of_angle(),
        b'C' => say::instead_of_chamfer_address(),
        b'E' => say::instead_of_lead_address(),
        b'B' | b'V' | b'Y' => say::instead_of_axis(),
        _ => return None,
    })
}

/// Returns advice what to use instead of a character that programs of this control cannot contain;
/// `None` for characters without advice.
pub(crate) fn advice_for_character(character: u8) -> Option<Message> {
    Some(match character {
        b',' => say::instead_of_comma(),
        b'#' | b'=' | b'[' | b']' => say::instead_of_variable_formula(),
        _ => return None,
    })
}

/// Returns advice for a number above 9999 after this address; `None` for all addresses but O.
pub(crate) fn advice_for_number(address: u8) -> Option<Message> {
    match address {
        b'O' => Some(say::instead_of_long_number()),
        _ => None,
    }
}

/// The edit that makes a foreign word mean the same on this control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForeignWordEdit {
    /// The control always behaves so: the word is left out.
    Delete,
    /// This word means the same.
    Replace(&'static str),
}

/// Returns the edit for a G code that this control does not have; `None` if no edit of the
/// word alone is right.
pub const fn edit_for_g_code(code: u32) -> Option<ForeignWordEdit> {
    match code {
        17 | 18 | 21 | 49 | 61 | 64 | 80 => Some(ForeignWordEdit::Delete),
        95 => Some(ForeignWordEdit::Replace("G99")),
        _ => None,
    }
}

/// Returns the edit for an M code that this control does not have; `None` if no edit of the
/// word alone is right.
pub const fn edit_for_m_code(code: u32) -> Option<ForeignWordEdit> {
    Some(match code {
        1 => ForeignWordEdit::Replace("M00"),
        2 => ForeignWordEdit::Replace("M30"),
        6 => ForeignWordEdit::Delete,
        7 => ForeignWordEdit::Replace("M08"),
        17 => ForeignWordEdit::Replace("M99"),
        _ => return None,
    })
}

/// Joins the message of a broken rule and the advice for it into one message.
pub(crate) fn with_advice(rule: Message, advice: Option<Message>) -> Message {
    match advice {
        Some(advice) => say::several([rule, advice]),
        None => rule,
    }
}
