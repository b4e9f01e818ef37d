//! `replay`: replays a recording and compares the states in it.

use gsk_history::history::History;
use gsk_history::replay::{HashDifference, Replay, replay as replay_bytes};
use gsk_host::files::program_file;
use gsk_messages::{Language, Message, say};
use gsk_runner::report::message_text;
use gsk_runner::text_format::format_time;

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::ReplayArgs;

/// Machine time of one tick, s.
const TICK_S: f64 = 0.001;

pub fn replay(args: &ReplayArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let bytes = program_file::read_bytes(&args.file)?;
    let named = |message: Message| say::subject_reason(args.file.display(), message);
    let replayed = replay_bytes(&bytes).map_err(|error| named(error.message()))?;
    if let Some(tick) = args.at {
        let history = replayed.history.as_ref();
        let screen = history.and_then(|history| screen_at(history, tick));
        let outside = || {
            let (first, last) = history.map_or((0, 0), |history| (history.start(), history.end()));
            named(say::replay_outside(first, last))
        };
        output::print(&format!("{}\n", screen.ok_or_else(outside)?));
    }
    for message in summarize(&replayed) {
        output::print(&format!("{}\n", message_text(&message, language)));
    }
    if let Some(error) = &replayed.error {
        output::report_error(&named(error.message()));
    }
    match (&replayed.error, replayed.difference) {
        (None, None) => Ok(EXIT_OK),
        _ => Ok(EXIT_ALARM),
    }
}

fn screen_at(history: &History, tick: u64) -> Option<String> {
    let moment = history.seek(tick)?;
    Some(moment.emulator.screen().to_string())
}

/// Returns what the replay found: version, length, inputs, equal states, the first difference.
fn summarize(replayed: &Replay) -> Vec<Message> {
    let time = format_time(replayed.replayed_ticks as f64 * TICK_S);
    let mut messages = vec![
        say::replay_recorded_by(&replayed.program, env!("CARGO_PKG_VERSION")),
        say::replay_summary(time, replayed.input_count, replayed.equal_hashes),
    ];
    messages.extend(replayed.difference.map(describe_difference));
    if !replayed.is_complete {
        messages.push(say::replay_not_ended());
    }
    messages
}

fn describe_difference(difference: HashDifference) -> Message {
    match difference.last_equal {
        Some(last) => say::replay_differs(difference.tick, last),
        None => say::replay_differs_at_once(difference.tick),
    }
}
