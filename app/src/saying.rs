//! Messages that are made of others: what the control, the compiler of ladders several
//! files or a board have to say.

use gsk_core::plc::{CompileError, CompileErrors, summary};
use gsk_link::Difference;
use gsk_messages::{Message, say};

/// Messages one under the other.
pub fn lines(messages: impl IntoIterator<Item = Message>) -> Message {
    let under = messages.into_iter().reduce(say::on_two_lines);
    under.unwrap_or_else(|| say::as_written(""))
}

/// Messages one after the other.
pub fn listed(messages: impl IntoIterator<Item = Message>) -> Message {
    let listed = messages.into_iter().reduce(say::on_one_line);
    listed.unwrap_or_else(|| say::as_written(""))
}

/// A setting of a board that is not as it must be.
pub fn differs(difference: &Difference) -> Message {
    let board = difference.board.as_deref();
    let board = board.map_or_else(say::link_page_setting_missing, say::as_written);
    say::link_page_setting_differs(&difference.name, board, &difference.wanted)
}

/// An error of a ladder, with its line.
pub fn of_finding(error: &CompileError) -> Message {
    say::ladder_rule_broken(error.line, error.rung, error.code, error.message.clone())
}

/// All that is wrong with a ladder, a line each, and how many they are.
pub fn of_ladder(errors: &CompileErrors) -> Message {
    let found = errors.errors.iter().chain(&errors.warnings);
    let summary = summary(errors.errors.len(), errors.warnings.len());
    lines(found.map(of_finding).chain([summary]))
}
