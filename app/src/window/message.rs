//! What the line of messages says. It is put into words when it is drawn: who changes
//! the language reads the last message in the new one.

use gsk_core::alarm::Alarm;
use gsk_core::memory::Refusal;
use gsk_panel::keys::Key;

use super::{alarm_line, key_label};
use crate::kernel::{NotStored, Place};
use gsk_messages::{Language, say};

/// What the line of messages says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Message {
    /// A sentence of somebody else.
    Said(gsk_messages::Message),
    /// Why a key did nothing; it goes with the next key that acts.
    KeyRefused(gsk_messages::Message),
    /// The control refused what was asked of it.
    Refused(Alarm),
    /// The control has sent something.
    Sent(String),
    /// A program was opened: its file's name.
    Opened(String, Place),
    /// A file hangs over the window.
    DropHere,
    /// A right click does not keep this key.
    NotKept(Key),
    /// The kernel has ended without being asked to.
    KernelGone,
}

impl Message {
    /// Whether it is a warning.
    pub const fn is_warning(&self) -> bool {
        !matches!(
            self,
            Self::Sent(_) | Self::DropHere | Self::Opened(_, Place::Stored(_))
        )
    }

    /// Its words.
    pub fn text(&self, language: Language) -> String {
        match self {
            Self::Said(said) | Self::KeyRefused(said) => said.text(language),
            Self::Refused(alarm) => alarm_line::short(alarm, language),
            Self::Sent(what) => say::window_sent(what).text(language),
            Self::Opened(name, Place::Stored(number)) => {
                say::window_opened_stored(name, number).text(language)
            }
            Self::Opened(name, Place::OnlyRun(why)) => {
                say::window_opened_only_to_run(name, why_not(why, language)).text(language)
            }
            Self::DropHere => say::window_drop_here().text(language),
            Self::NotKept(key) => say::window_key_not_kept(key_label(*key)).text(language),
            Self::KernelGone => say::window_kernel_stopped().text(language),
        }
    }
}

fn why_not(why: &NotStored, language: Language) -> gsk_messages::Message {
    match why {
        NotStored::NoNumber => say::window_file_has_no_number(),
        NotStored::NumberTaken(number) => say::window_memory_keeps_its_own(number),
        NotStored::Alarm(alarm) => say::as_written(alarm_line::short(alarm, language)),
        NotStored::Refused(Refusal::ProgramSwitch) => say::window_program_switch_off(),
        NotStored::Refused(Refusal::Level) => say::window_level_too_low(),
        NotStored::Refused(_) => say::window_memory_locked(),
    }
}
