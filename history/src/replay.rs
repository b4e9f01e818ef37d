//! Replays a recording: simulates it from its states and inputs, and compares the hashes.

use crate::history::{DEFAULT_BUDGET_BYTES, History};
use crate::machine_part::MachinePart;
use crate::moment::{MachineMoment, state_hash};
use crate::recording::{RecordingError, RecordingEvent, RecordingReader};

/// Greatest number of ticks between two events. The recorder writes one a second, in which no
/// computer simulates as many.
const MAX_GAP_TICKS: u64 = 100_000_000;

/// Where a replay has left the recorded session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HashDifference {
    /// The last tick whose hash was the recorded one; `None` if no hash was.
    pub last_equal: Option<u64>,
    /// The first tick whose hash was another one.
    pub tick: u64,
}

/// A replayed recording.
#[derive(Debug)]
pub struct Replay {
    /// Version of the program that has recorded.
    pub program: String,
    /// Number of inputs.
    pub input_count: usize,
    /// Replayed machine time, ticks (ms).
    pub replayed_ticks: u64,
    /// Number of hashes that were equal.
    pub equal_hashes: usize,
    /// The first difference from the recorded session; `None` if all hashes were equal.
    pub difference: Option<HashDifference>,
    /// Whether the program has ended the recording: `false` after a crash.
    pub is_complete: bool,
    /// Why the rest of the file was not read; `None` if all of it was.
    pub error: Option<RecordingError>,
    /// The session since the last state in the recording; `None` if there was no state.
    pub history: Option<History>,
}

/// Replays a recording up to its end or to the first damage.
///
/// # Errors
/// The bytes are no recording, or one of a newer format.
pub fn replay(bytes: &[u8]) -> Result<Replay, RecordingError> {
    let mut reader = RecordingReader::new(bytes)?;
    let mut player = Player::default();
    let error = loop {
        let offset = reader.offset();
        match reader.next_event() {
            Ok(Some(event)) => {
                if player.play(event).is_none() {
                    break Some(RecordingError::OutOfOrder(offset));
                }
            }
            Ok(None) => break None,
            Err(newer @ RecordingError::NewerFormat(_)) => return Err(newer),
            Err(error) => break Some(error),
        }
    };
    Ok(Replay {
        program: player.program,
        input_count: player.input_count,
        replayed_ticks: player.replayed_ticks,
        equal_hashes: player.equal_hashes,
        difference: player.difference,
        is_complete: player.is_complete,
        error,
        history: player.section.map(|(_, history)| history),
    })
}

#[derive(Debug, Default)]
struct Player {
    program: String,
    input_count: usize,
    replayed_ticks: u64,
    equal_hashes: usize,
    last_equal: Option<u64>,
    difference: Option<HashDifference>,
    is_complete: bool,
    /// The machine, and its history since the last state.
    section: Option<(MachineMoment, History)>,
}

impl Player {
    /// Plays an event; `None` if it is out of order.
    fn play(&mut self, event: RecordingEvent) -> Option<()> {
        match event {
            RecordingEvent::Start { program, .. } => self.program = program,
            RecordingEvent::State { emulator, part } => {
                let mut moment = MachineMoment {
                    emulator: *emulator,
                    part: MachinePart::default(),
                };
                part.into_iter().for_each(|input| moment.part.apply(input));
                let history = History::new(moment.clone(), DEFAULT_BUDGET_BYTES);
                self.section = Some((moment, history));
            }
            RecordingEvent::Input(recorded) => {
                self.run_until(recorded.tick)?;
                let (moment, history) = self.section.as_mut()?;
                if recorded.input.is_expensive() {
                    history.store_state(&moment.emulator, &moment.part);
                }
                moment.apply(recorded.input.clone());
                history.record(*recorded);
                self.input_count += 1;
            }
            RecordingEvent::Reached(tick) | RecordingEvent::BoardLinked(tick) => {
                self.run_until(tick)?;
            }
            RecordingEvent::Hash { tick, hash } => {
                self.run_until(tick)?;
                let (moment, _) = self.section.as_ref()?;
                self.compare(tick, state_hash(&moment.emulator) == Some(hash));
            }
            RecordingEvent::End(tick) => {
                self.run_until(tick)?;
                self.is_complete = true;
            }
        }
        Some(())
    }

    fn compare(&mut self, tick: u64, is_equal: bool) {
        if is_equal {
            self.equal_hashes += 1;
            self.last_equal = Some(tick);
        } else if self.difference.is_none() {
            self.difference = Some(HashDifference {
                last_equal: self.last_equal,
                tick,
            });
        }
    }

    /// Runs the machine to a tick; `None` without a state, or if the tick is in the past or too
    /// far ahead.
    fn run_until(&mut self, tick: u64) -> Option<()> {
        let (moment, history) = self.section.as_mut()?;
        let gap = tick.checked_sub(moment.ticks())?;
        if gap > MAX_GAP_TICKS {
            return None;
        }
        while moment.ticks() < tick {
            moment.tick();
            self.replayed_ticks += 1;
            history.follow(&moment.emulator, &moment.part);
        }
        Some(())
    }
}
