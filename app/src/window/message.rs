//! The messages of the message line. They become text when they are drawn: a change of the
//! language also translates the current message.

use std::path::Path;

use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_core::memory::Refusal;
use gsk_core::preview::End;
use gsk_panel::keys::Key;
use gsk_runner::first_look::FirstLook;

use super::{alarm_line, key_label};
use crate::kernel::{NotStored, Place};
use gsk_messages::{Language, say};

/// A message of the message line.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// A finished sentence of another module.
    Said(gsk_messages::Message),
    /// The tool has collided; cleared by a new stock.
    Collided(gsk_messages::Message),
    /// Why a key had no effect; cleared by the next key that acts.
    KeyRefused(gsk_messages::Message),
    /// The control refused a command with this alarm.
    Refused(Alarm),
    /// What the control has sent over the serial port.
    Sent(String),
    /// A program was opened: its file name and where it is stored.
    Opened(String, Place),
    /// A program was previewed: its file name, where it is stored if that is known, and the
    /// result.
    Looked(String, Option<Place>, Box<FirstLook>),
    /// The operator drags a file over the window.
    DropHere,
    /// A right click does not latch this key.
    NotKept(Key),
    /// The kernel has ended unexpectedly.
    KernelGone,
}

impl Message {
    /// The message for an opened program. The result of a preview of the same file in `before`
    /// is kept.
    pub fn opened(before: Option<Self>, file: String, place: Place) -> Self {
        match before {
            Some(Self::Looked(looked_at, _, look)) if looked_at == file => {
                Self::Looked(file, Some(place), look)
            }
            _ => Self::Opened(file, place),
        }
    }

    /// The message for a previewed program. The storage of the same file in `before` is kept.
    pub fn looked(before: Option<Self>, file: String, look: Box<FirstLook>) -> Self {
        match before {
            Some(Self::Opened(opened, place)) if opened == file => {
                Self::Looked(file, Some(place), look)
            }
            _ => Self::Looked(file, None, look),
        }
    }

    /// Replaces the machine time by that of a newer preview of the program, s. Parameters,
    /// offsets or the start position have changed since it was opened.
    pub fn update_time(&mut self, opened_file: &Path, time_s: f64) {
        if let Self::Looked(file, _, look) = self
            && opened_file
                .file_name()
                .is_some_and(|name| name == file.as_str())
            && look.end != End::Limit
            && !look.has_alarm()
        {
            look.time_s = time_s;
        }
    }

    /// Whether this is the preview of `program`, as it is stored in the memory.
    pub fn is_about(&self, program: ProgramId) -> bool {
        match (self, program) {
            (Self::Looked(_, Some(Place::OnlyRun(_)), _), _) => false,
            (Self::Looked(_, _, look), ProgramId::Stored(number)) => {
                look.name == format!("O{number:04}")
            }
            _ => false,
        }
    }

    /// Whether the message is drawn as a warning.
    pub fn is_warning(&self) -> bool {
        match self {
            Self::Sent(_) | Self::DropHere | Self::Opened(_, Place::Stored(_)) => false,
            Self::Looked(_, place, look) => {
                look.has_alarm() || matches!(place, Some(Place::OnlyRun(_)))
            }
            _ => true,
        }
    }

    /// The text of the message line.
    pub fn text(&self, language: Language) -> String {
        match self {
            Self::Said(said) | Self::Collided(said) | Self::KeyRefused(said) => said.text(language),
            Self::Refused(alarm) => alarm_line::short(alarm, language),
            Self::Sent(what) => say::window_sent(what).text(language),
            Self::Opened(name, Place::Stored(number)) => {
                say::window_opened_stored(name, number).text(language)
            }
            Self::Opened(name, Place::OnlyRun(why)) => {
                say::window_opened_only_to_run(name, why_not(why, language)).text(language)
            }
            Self::Looked(_, Some(Place::OnlyRun(why)), look) => {
                let why = why_not(why, language);
                say::window_looked_only_to_run(look.line(language), why).text(language)
            }
            Self::Looked(_, _, look) => look.line(language),
            Self::DropHere => say::window_drop_here().text(language),
            Self::NotKept(key) => say::window_key_not_kept(key_label(*key)).text(language),
            Self::KernelGone => say::window_kernel_stopped().text(language),
        }
    }
}

/// The reason why a program is not stored in the memory.
pub fn why_not(why: &NotStored, language: Language) -> gsk_messages::Message {
    match why {
        NotStored::NoNumber => say::window_file_has_no_number(),
        NotStored::NumberTaken(number) => say::window_memory_keeps_its_own(number),
        NotStored::Alarm(alarm) => say::as_written(alarm_line::short(alarm, language)),
        NotStored::Refused(Refusal::ProgramSwitch) => say::window_program_switch_off(),
        NotStored::Refused(Refusal::Level) => say::window_level_too_low(),
        NotStored::Refused(_) => say::window_memory_locked(),
    }
}
