//! The messages of the message line. They become text when they are drawn: a change of the
//! language also translates the current message.

use std::path::Path;

use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_core::memory::WriteRefusal;
use gsk_core::model::ProgramNaming;
use gsk_core::preview::PreviewEnd;
use gsk_host::kernel::{NotStored, ProgramPlacement};
use gsk_panel::keys::Key;
use gsk_runner::program_summary::ProgramSummary;

use super::alarm_text;
use super::key_label::key_label;
use super::severity::MessageSeverity;
use gsk_messages::{Language, say};

/// A message that the message line shows.
#[derive(Clone, Debug, PartialEq)]
pub enum StatusMessage {
    /// A message of another module, ready to be shown.
    Text(gsk_messages::Message),
    /// An event after which the operator need not act.
    Done(gsk_messages::Message),
    /// The tool has collided, as the message describes; cleared by new stock.
    Collided(gsk_messages::Message),
    /// A key had no effect for this reason; cleared by the next key that acts.
    KeyRefused(gsk_messages::Message),
    /// The control has refused a command with this alarm.
    Refused(Alarm),
    /// The control has sent files over the serial port; the text names them and their folder.
    Sent(String),
    /// A program was opened; holds its file name, where it is stored, and how the model names it.
    Opened(String, ProgramPlacement, ProgramNaming),
    /// A program was previewed; holds its file name, where it is stored (`None` if unknown),
    /// and the result.
    Previewed(String, Option<ProgramPlacement>, Box<ProgramSummary>),
    /// The operator drags a file over the window and can drop it.
    DropHere,
    /// A right click on this key has no effect: the key cannot be latched.
    KeyNotLatched(Key),
    /// The kernel thread has ended unexpectedly.
    KernelEnded,
}

impl StatusMessage {
    /// Creates the message for an opened program. If `previous` is a preview of the same file,
    /// its result is kept.
    pub fn for_opened(
        previous: Option<Self>,
        file: String,
        storage: ProgramPlacement,
        naming: ProgramNaming,
    ) -> Self {
        match previous {
            Some(Self::Previewed(looked_at, _, look)) if looked_at == file => {
                Self::Previewed(file, Some(storage), look)
            }
            _ => Self::Opened(file, storage, naming),
        }
    }

    /// Creates the message for a previewed program. If `previous` names the storage of the
    /// same file, it is kept.
    pub fn for_preview(previous: Option<Self>, file: String, look: Box<ProgramSummary>) -> Self {
        match previous {
            Some(Self::Opened(opened, place, _)) if opened == file => {
                Self::Previewed(file, Some(place), look)
            }
            _ => Self::Previewed(file, None, look),
        }
    }

    /// Replaces the machine time of a preview of `opened_file` by `time_s` of a newer one, s,
    /// because parameters, offsets or the start position have changed since.
    pub fn update_time(&mut self, opened_file: &Path, time_s: f64) {
        if let Self::Previewed(file, _, look) = self
            && opened_file
                .file_name()
                .is_some_and(|name| name == file.as_str())
            && look.end != PreviewEnd::Limit
            && !look.has_alarm()
        {
            look.time_s = time_s;
        }
    }

    /// Whether this message is the preview of `program`, as it is stored in the memory.
    pub fn is_about(&self, program: ProgramId) -> bool {
        match (self, program) {
            (Self::Previewed(_, Some(ProgramPlacement::OnlyRun(_)), _), _) => false,
            (Self::Previewed(_, _, look), ProgramId::Stored(number)) => {
                let names = [ProgramNaming::Letter, ProgramNaming::Percent];
                names.iter().any(|naming| look.name == naming.name(number))
            }
            _ => false,
        }
    }

    /// Returns the severity of the message.
    pub fn severity(&self) -> MessageSeverity {
        match self {
            Self::KernelEnded => MessageSeverity::Safety,
            Self::Collided(_) => MessageSeverity::Collision,
            Self::Done(_)
            | Self::Sent(_)
            | Self::DropHere
            | Self::Opened(_, ProgramPlacement::Stored(_), _) => MessageSeverity::Information,
            Self::Previewed(_, place, look)
                if !look.has_alarm() && !matches!(place, Some(ProgramPlacement::OnlyRun(_))) =>
            {
                MessageSeverity::Information
            }
            _ => MessageSeverity::Refusal,
        }
    }

    /// Formats the message in a language for the message line.
    pub fn text(&self, language: Language) -> String {
        match self {
            Self::Text(message)
            | Self::Done(message)
            | Self::Collided(message)
            | Self::KeyRefused(message) => message.text(language),
            Self::Refused(alarm) => alarm_text::one_line(alarm, language),
            Self::Sent(what) => say::window_sent(what).text(language),
            Self::Opened(name, ProgramPlacement::Stored(number), naming) => {
                say::window_opened_stored(name, naming.name(*number)).text(language)
            }
            Self::Opened(name, ProgramPlacement::OnlyRun(why), _) => {
                say::window_opened_only_to_run(name, not_stored_reason(why, language))
                    .text(language)
            }
            Self::Previewed(_, Some(ProgramPlacement::OnlyRun(reason)), look) => {
                let why = not_stored_reason(reason, language);
                say::window_looked_only_to_run(look.summary_line(language), why).text(language)
            }
            Self::Previewed(_, _, look) => look.summary_line(language),
            Self::DropHere => say::window_drop_here().text(language),
            Self::KeyNotLatched(key) => {
                say::window_key_not_kept(key_label(*key, language)).text(language)
            }
            Self::KernelEnded => say::window_kernel_stopped().text(language),
        }
    }
}

/// Returns the reason why a program is not stored in the memory.
pub fn not_stored_reason(reason: &NotStored, language: Language) -> gsk_messages::Message {
    match reason {
        NotStored::NoNumber => say::window_file_has_no_number(),
        NotStored::NumberTaken(number) => say::window_memory_keeps_its_own(number),
        NotStored::Alarm(alarm) => say::as_written(alarm_text::one_line(alarm, language)),
        NotStored::Refused(WriteRefusal::ProgramSwitch) => say::window_program_switch_off(),
        NotStored::Refused(WriteRefusal::Level) => say::window_level_too_low(),
        NotStored::Refused(_) => say::window_memory_locked(),
    }
}
