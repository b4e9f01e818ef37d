//! What the line of messages says. It is put into words when it is drawn: who changes
//! the language reads the last message in the new one.

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

/// What the line of messages says.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// A sentence of somebody else.
    Said(gsk_messages::Message),
    /// The tool has hit something; it goes with the stock.
    Collided(gsk_messages::Message),
    /// Why a key did nothing; it goes with the next key that acts.
    KeyRefused(gsk_messages::Message),
    /// The control refused what was asked of it.
    Refused(Alarm),
    /// The control has sent something.
    Sent(String),
    /// A program was opened: its file's name.
    Opened(String, Place),
    /// A program was looked through: its file's name, and where it stands when that is
    /// known already.
    Looked(String, Option<Place>, Box<FirstLook>),
    /// A file hangs over the window.
    DropHere,
    /// A right click does not keep this key.
    NotKept(Key),
    /// The kernel has ended without being asked to.
    KernelGone,
}

impl Message {
    /// A program was opened; what is known of it already stays.
    pub fn opened(before: Option<Self>, file: String, place: Place) -> Self {
        match before {
            Some(Self::Looked(looked_at, _, look)) if looked_at == file => {
                Self::Looked(file, Some(place), look)
            }
            _ => Self::Opened(file, place),
        }
    }

    /// A program was looked through; where it stands stays known.
    pub fn looked(before: Option<Self>, file: String, look: Box<FirstLook>) -> Self {
        match before {
            Some(Self::Opened(opened, place)) if opened == file => {
                Self::Looked(file, Some(place), look)
            }
            _ => Self::Looked(file, None, look),
        }
    }

    /// Takes the machine time of a newer preview of the program, s: parameters, offsets or
    /// the start position have changed since it was opened.
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

    /// Whether it is what was found in this program of the memory.
    pub fn is_about(&self, program: ProgramId) -> bool {
        match (self, program) {
            (Self::Looked(_, Some(Place::OnlyRun(_)), _), _) => false,
            (Self::Looked(_, _, look), ProgramId::Stored(number)) => {
                look.name == format!("O{number:04}")
            }
            _ => false,
        }
    }

    /// Whether it is a warning.
    pub fn is_warning(&self) -> bool {
        match self {
            Self::Sent(_) | Self::DropHere | Self::Opened(_, Place::Stored(_)) => false,
            Self::Looked(_, place, look) => {
                look.has_alarm() || matches!(place, Some(Place::OnlyRun(_)))
            }
            _ => true,
        }
    }

    /// Its words.
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

/// Why a program is not in the memory.
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
