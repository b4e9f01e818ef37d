//! A machine that is saved and restored as a recording does it.

use gsk_history::recording::{FORMAT, RecordingEncoder, RecordingEvent, RecordingReader};
use gsk_panel::emulator::Emulator;

/// Saves a machine in a recording and returns what the recording restores.
///
/// # Errors
/// Returns a message if the state cannot be encoded or read back.
pub fn restore(emulator: &Emulator) -> Result<Emulator, String> {
    let start = RecordingEvent::Start {
        format: FORMAT,
        program: String::new(),
    };
    let state = RecordingEvent::State {
        emulator: Box::new(emulator.clone()),
        part: Vec::new(),
    };
    let mut bytes = Vec::new();
    let mut encoder = RecordingEncoder::new(&mut bytes);
    for event in [start, state] {
        encoder
            .encode(&event, &mut bytes)
            .map_err(|error| error.to_string())?;
    }
    let mut reader = RecordingReader::new(&bytes).map_err(|error| error.to_string())?;
    while let Some(event) = reader.next_event().map_err(|error| error.to_string())? {
        if let RecordingEvent::State { emulator, .. } = event {
            return Ok(*emulator);
        }
    }
    Err("the recording has no state".to_owned())
}
