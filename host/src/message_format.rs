//! Builds messages from other messages and from errors of ladders, boards, files and ports.

use std::fmt::Display;
use std::io::{self, ErrorKind};

use gsk_core::plc::{CompileError, CompileErrors, compile_summary};
use gsk_link::SettingDifference;
use gsk_messages::{Message, say};

use crate::platform::DeviceName;

/// Joins messages, one per line.
pub fn join_lines(messages: impl IntoIterator<Item = Message>) -> Message {
    let joined = messages.into_iter().reduce(say::on_two_lines);
    joined.unwrap_or_else(|| say::as_written(""))
}

/// Joins messages on one line, as a list.
pub fn join_on_one_line(messages: impl IntoIterator<Item = Message>) -> Message {
    let joined = messages.into_iter().reduce(say::on_one_line);
    joined.unwrap_or_else(|| say::as_written(""))
}

/// Reports a setting of a board that differs from the required one.
pub fn describe_setting_difference(difference: &SettingDifference) -> Message {
    let board = difference.board.as_deref();
    let board = board.map_or_else(say::link_page_setting_missing, say::as_written);
    say::link_page_setting_differs(&difference.name, board, &difference.wanted)
}

/// Reports an error of a ladder with its line, rung and error code.
pub fn describe_ladder_error(error: &CompileError) -> Message {
    say::ladder_rule_broken(error.line, error.rung, error.code, error.message.clone())
}

/// Reports all errors and warnings of a ladder, one per line, and their numbers.
pub fn describe_ladder_errors(errors: &CompileErrors) -> Message {
    let found = errors.errors.iter().chain(&errors.warnings);
    let summary = compile_summary(errors.errors.len(), errors.warnings.len());
    join_lines(found.map(describe_ladder_error).chain([summary]))
}

/// Reports an error of the operating system about a file, a port or a network address.
/// English repeats the text of the system; Chinese puts the meaning before it.
pub fn describe_io_error(error: &io::Error) -> Message {
    if let Some(DeviceName(name)) = error.get_ref().and_then(|inner| inner.downcast_ref()) {
        return say::file_name_device(name);
    }
    describe_error_kind(error.kind(), error)
}

/// Reports an error of a serial port in the same form as [`describe_io_error`].
pub fn describe_port_error(error: &serialport::Error) -> Message {
    match error.kind() {
        serialport::ErrorKind::Io(kind) => describe_error_kind(kind, error),
        _ => say::as_written(error),
    }
}

fn describe_error_kind(kind: ErrorKind, text: impl Display) -> Message {
    match kind {
        ErrorKind::NotFound => say::system_none(text),
        ErrorKind::PermissionDenied => say::system_access(text),
        ErrorKind::AlreadyExists => say::system_exists(text),
        ErrorKind::IsADirectory => say::system_folder(text),
        ErrorKind::NotADirectory => say::system_no_folder(text),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => say::system_full(text),
        ErrorKind::ReadOnlyFilesystem => say::system_read_only(text),
        ErrorKind::ResourceBusy | ErrorKind::WouldBlock => say::system_busy(text),
        ErrorKind::ConnectionRefused => say::system_refused(text),
        ErrorKind::TimedOut => say::system_timeout(text),
        ErrorKind::AddrInUse => say::system_address_busy(text),
        ErrorKind::AddrNotAvailable => say::system_no_address(text),
        ErrorKind::HostUnreachable | ErrorKind::NetworkUnreachable => say::system_unreachable(text),
        ErrorKind::InvalidInput => say::system_not_an_address(text),
        _ => say::as_written(text),
    }
}

#[cfg(test)]
mod tests {
    use gsk_messages::Language;

    use super::*;

    #[test]
    fn io_errors_keep_their_text_and_get_a_chinese_meaning() {
        let error = io::Error::from(ErrorKind::NotFound);
        let message = describe_io_error(&error);
        assert_eq!(message.text(Language::En), error.to_string());
        let chinese = message.text(Language::Zh);
        assert!(chinese.starts_with("没有该文件") && chinese.contains(&error.to_string()));
        let port = serialport::Error::new(serialport::ErrorKind::NoDevice, "gone");
        assert_eq!(describe_port_error(&port).text(Language::Zh), "gone");
    }
}
