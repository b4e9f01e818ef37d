//! Finds the recording of a session that did not end properly, and offers it.

use std::path::Path;

use gsk_history::recording::{RecordingEvent, RecordingReader};
use gsk_messages::{Message, say};
use tracing::warn;

use super::disk::{MAX_FOLDER_BYTES, newest_recording};
use crate::platform;

/// Calls `notify` in the background if the last session recorded in a folder did not end
/// properly. Call it before the next recording starts.
pub fn offer_unfinished(folder: &Path, notify: impl FnOnce(Message) + Send + 'static) {
    let Some(path) = newest_recording(folder) else {
        return;
    };
    let begun = platform::run_in_background("last session", move || {
        if is_unfinished(&path) {
            notify(say::flight_not_ended(path.display()));
        }
    });
    if let Err(error) = begun {
        warn!("the last session is not checked: {error}");
    }
}

/// Returns whether a recording has a session without its end. A session with a pulse board ends
/// where the board was connected.
fn is_unfinished(path: &Path) -> bool {
    let Ok(bytes) = platform::read(path, MAX_FOLDER_BYTES) else {
        return false;
    };
    let Ok(mut reader) = RecordingReader::new(&bytes) else {
        return false;
    };
    let mut last = None;
    while let Ok(Some(event)) = reader.next_event() {
        last = Some(event);
    }
    last.is_some_and(|last| {
        !matches!(
            last,
            RecordingEvent::End(_) | RecordingEvent::BoardLinked(_)
        )
    })
}
