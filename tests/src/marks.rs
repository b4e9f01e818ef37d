//! Marks results of exercises and replays recordings. The text is the same on every system.

use gsk_exercise::library::built_in_tasks;
use gsk_exercise::mark::{flag_repetitions, mark_result};
use gsk_exercise::mark_table::{MarkFormat, MarkTable};
use gsk_exercise::result_file::RESULT_EXTENSION;
use gsk_history::moment::state_hash;
use gsk_history::replay::replay;
use gsk_messages::Language;
use serde_json::{Value, json};

/// A file of a learner: its name and its bytes.
pub type NamedFile = (String, Vec<u8>);

/// Marks the results among the files, as `exercise mark --format json` does, and replays the other
/// files, which are recordings. Returns the JSON of both lists.
pub fn mark_and_replay(files: &[NamedFile]) -> String {
    let is_result = |file: &&NamedFile| file.0.ends_with(RESULT_EXTENSION);
    let tasks = built_in_tasks();
    let results = files.iter().filter(is_result);
    let mut marks: Vec<_> = results
        .map(|(name, bytes)| mark_result(name, bytes, &tasks))
        .collect();
    flag_repetitions(&mut marks);
    let table = MarkTable {
        marks: &marks,
        tasks: &tasks,
        language: Language::En,
    };
    // Not read again: a reader of JSON may change the last digit of a measured value.
    let marks = table.write(MarkFormat::Json);
    let recordings = files.iter().filter(|file| !is_result(file));
    let replays: Vec<Value> = recordings
        .map(|(name, bytes)| describe_replay(name, bytes))
        .collect();
    let replays = Value::Array(replays);
    format!("{{\n\"marks\": {marks},\n\"replays\": {replays:#}\n}}\n")
}

/// Replays a recording and describes what it found, with the hash of the last state.
fn describe_replay(name: &str, bytes: &[u8]) -> Value {
    let replayed = match replay(bytes) {
        Ok(replayed) => replayed,
        Err(error) => return json!({ "file": name, "error": error.to_string() }),
    };
    let history = replayed.history.as_ref();
    let end = history.and_then(|history| history.seek(history.end()));
    let end = end.and_then(|moment| state_hash(&moment.emulator));
    json!({
        "file": name,
        "ticks": replayed.replayed_ticks,
        "inputs": replayed.input_count,
        "equal_states": replayed.equal_hashes,
        "differs_at": replayed.difference.map(|difference| difference.tick),
        "is_complete": replayed.is_complete,
        "error": replayed.error.map(|error| error.to_string()),
        "end": end.map(|hash| format!("{hash:016x}")),
    })
}
