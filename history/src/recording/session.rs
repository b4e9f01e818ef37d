//! Writes a session that is kept in memory as a recording.

use super::{FORMAT, RecordingEncoder, RecordingEvent};
use crate::history::History;
use crate::moment::{RecordedInput, state_hash};

/// Encodes a session as a recording: its first state, its inputs, and a hash at each later full
/// state. `program` is the version of the program that has recorded.
///
/// # Errors
/// A state cannot be represented in MessagePack.
pub fn encode_session(
    history: &History,
    program: &str,
) -> Result<Vec<u8>, rmp_serde::encode::Error> {
    let mut bytes = Vec::new();
    let mut encoder = RecordingEncoder::new(&mut bytes);
    let mut add = |event: &RecordingEvent| encoder.encode(event, &mut bytes);
    add(&RecordingEvent::Start {
        format: FORMAT,
        program: program.to_owned(),
    })?;
    let mut written = 0;
    let as_event = |input: &RecordedInput| RecordingEvent::Input(Box::new(input.clone()));
    for (index, (moment, next_input)) in history.states().enumerate() {
        if index == 0 {
            add(&RecordingEvent::State {
                emulator: Box::new(moment.emulator.clone()),
                part: moment.part.inputs_for_uncut(),
            })?;
            continue;
        }
        let before = history.inputs().get(written..next_input);
        for input in before.unwrap_or_default() {
            add(&as_event(input))?;
        }
        written = next_input;
        if let Some(hash) = state_hash(&moment.emulator) {
            let tick = moment.ticks();
            add(&RecordingEvent::Hash { tick, hash })?;
        }
    }
    for input in history.inputs().get(written..).unwrap_or_default() {
        add(&as_event(input))?;
    }
    add(&RecordingEvent::End(history.end()))?;
    Ok(bytes)
}
