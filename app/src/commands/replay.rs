//! `replay`: replays a recording and compares the states in it.

use gsk_history::board_exchange::BoardStep;
use gsk_history::history::History;
use gsk_history::recording::{RecordingEvent, RecordingReader};
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
    if args.exchange {
        output::print(&exchange_lines(&bytes));
    }
    for message in summarize(&replayed) {
        output::print(&format!("{}\n", message_text(&message, language)));
    }
    if let Some(error) = &replayed.error {
        output::report_error(&named(error.message()));
    }
    let exchange = replayed.exchange.unwrap_or_default();
    match (
        &replayed.error,
        replayed.difference,
        exchange.first_difference,
    ) {
        (None, None, None) => Ok(EXIT_OK),
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
    if let Some(exchange) = replayed.exchange {
        let (sent, received) = (exchange.sent_bytes, exchange.received_bytes);
        messages.push(match exchange.first_difference {
            None => say::replay_exchange(sent, received),
            Some(tick) => say::replay_exchange_differs(sent, received, tick),
        });
    }
    if !replayed.is_complete {
        messages.push(say::replay_not_ended());
    }
    messages
}

/// Returns the exchange with a board as lines: machine time in s, `>` to the board or `<` from
/// it, and the bytes as text. The lines end at a damage of the recording, which the replay
/// reports.
fn exchange_lines(bytes: &[u8]) -> String {
    let mut lines = String::new();
    let Ok(mut reader) = RecordingReader::new(bytes) else {
        return lines;
    };
    let mut ticks: u64 = 0;
    while let Ok(Some(event)) = reader.next_event() {
        let step = match event {
            RecordingEvent::State { emulator, .. } => {
                ticks = emulator.ticks();
                continue;
            }
            RecordingEvent::Reached(tick) => {
                ticks = tick;
                continue;
            }
            RecordingEvent::Board(step) => *step,
            _ => continue,
        };
        let (direction, exchanged) = match step {
            BoardStep::Ticked(count, _) => {
                ticks = ticks.saturating_add(count.into());
                continue;
            }
            BoardStep::Read(_, exchanged) => ('<', exchanged),
            BoardStep::Written(exchanged) => ('>', exchanged),
            _ => continue,
        };
        for line in exchanged.0.split_inclusive(|byte| *byte == b'\n') {
            let time_s = ticks as f64 * TICK_S;
            lines.push_str(&format!(
                "{time_s:.3} {direction} {}\n",
                line.escape_ascii()
            ));
        }
    }
    lines
}

fn describe_difference(difference: HashDifference) -> Message {
    match difference.last_equal {
        Some(last) => say::replay_differs(difference.tick, last),
        None => say::replay_differs_at_once(difference.tick),
    }
}
