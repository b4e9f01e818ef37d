//! Writes the last minutes of the session into a file.

use std::path::{Path, PathBuf};

use gsk_history::recording::encode_session;
use gsk_messages::{Message, say};

use crate::files::atomic;
use crate::kernel::{Kernel, Notice};
use crate::message_format::describe_io_error;
use crate::platform;

/// Number of ticks in a minute of machine time.
const MINUTE_TICKS: u64 = 60_000;

impl Kernel {
    /// Writes the last minutes of the session into a file, in the background. A notice reports
    /// the result.
    pub(super) fn save_session(&mut self, minutes: Option<u64>, path: PathBuf) {
        self.follow_with_recorders();
        let timeline = &self.timeline;
        let history = (timeline.history.as_ref()).filter(|_| !timeline.has_linked_states);
        let Some(history) = history else {
            return self.notify(Notice::Message(say::timeline_nothing_to_save()));
        };
        let ticks = minutes.map_or(u64::MAX, |minutes| minutes.saturating_mul(MINUTE_TICKS));
        let session = history.since(history.end().saturating_sub(ticks));
        let notices = self.notices.clone();
        let begun = platform::run_in_background("recording", move || {
            let saved = encode_session(&session, env!("CARGO_PKG_VERSION"))
                .map_err(say::as_written)
                .and_then(|bytes| write_recording(&path, &bytes));
            // A window that is gone needs no message.
            let _ = notices.try_send(Notice::Message(saved.unwrap_or_else(|error| error)));
        });
        if let Err(error) = begun {
            self.notify(Notice::Message(say::as_written(error)));
        }
    }
}

fn write_recording(path: &Path, bytes: &[u8]) -> Result<Message, Message> {
    match atomic::write(path, bytes) {
        Ok(()) => Ok(say::timeline_saved(path.display())),
        Err(error) => Err(say::file_not_written(
            path.display(),
            describe_io_error(&error),
        )),
    }
}
