//! Messages that are made of others: what the control, the compiler of ladders several
//! files or a board have to say.

use std::fmt::Display;
use std::io::{self, ErrorKind};

use gsk_core::plc::{CompileError, CompileErrors, compile_summary};
use gsk_link::SettingDifference;
use gsk_messages::{Message, say};

use crate::platform::DeviceName;

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
pub fn differs(difference: &SettingDifference) -> Message {
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
    let summary = compile_summary(errors.errors.len(), errors.warnings.len());
    lines(found.map(of_finding).chain([summary]))
}

/// What the system said of a file, a port or a network address: in its own words, in Chinese
/// with what they mean before them.
pub fn of_system(error: &io::Error) -> Message {
    if let Some(DeviceName(name)) = error.get_ref().and_then(|inner| inner.downcast_ref()) {
        return say::file_name_device(name);
    }
    of_kind(error.kind(), error)
}

/// The same of a serial port.
pub fn of_port(error: &serialport::Error) -> Message {
    match error.kind() {
        serialport::ErrorKind::Io(kind) => of_kind(kind, error),
        _ => say::as_written(error),
    }
}

fn of_kind(kind: ErrorKind, written: impl Display) -> Message {
    match kind {
        ErrorKind::NotFound => say::system_none(written),
        ErrorKind::PermissionDenied => say::system_access(written),
        ErrorKind::AlreadyExists => say::system_exists(written),
        ErrorKind::IsADirectory => say::system_folder(written),
        ErrorKind::NotADirectory => say::system_no_folder(written),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => say::system_full(written),
        ErrorKind::ReadOnlyFilesystem => say::system_read_only(written),
        ErrorKind::ResourceBusy | ErrorKind::WouldBlock => say::system_busy(written),
        ErrorKind::ConnectionRefused => say::system_refused(written),
        ErrorKind::TimedOut => say::system_timeout(written),
        ErrorKind::AddrInUse => say::system_address_busy(written),
        ErrorKind::AddrNotAvailable => say::system_no_address(written),
        ErrorKind::HostUnreachable | ErrorKind::NetworkUnreachable => {
            say::system_unreachable(written)
        }
        ErrorKind::InvalidInput => say::system_not_an_address(written),
        _ => say::as_written(written),
    }
}

#[cfg(test)]
mod tests {
    use gsk_messages::Language;

    use super::*;

    #[test]
    fn what_the_system_says_is_kept_and_has_its_meaning_in_chinese() {
        let error = io::Error::from(ErrorKind::NotFound);
        let said = of_system(&error);
        assert_eq!(said.text(Language::En), error.to_string());
        let chinese = said.text(Language::Zh);
        assert!(chinese.starts_with("没有该文件") && chinese.contains(&error.to_string()));
        let port = serialport::Error::new(serialport::ErrorKind::NoDevice, "gone");
        assert_eq!(of_port(&port).text(Language::Zh), "gone");
    }
}
