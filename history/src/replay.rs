//! Replays a recording: simulates it from its states and inputs, and compares the hashes.

use gsk_runner::machining::CollisionFinding;

use crate::history::{DEFAULT_BUDGET_BYTES, History};
use crate::machine_part::MachinePart;
use crate::moment::{MachineMoment, RecordedInput, state_hash};
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

/// Follows a replay tick by tick. Every method returns whether the replay continues.
pub trait ReplayObserver {
    /// The machine is in a state that the recording contains.
    fn begin(&mut self, moment: &MachineMoment) -> bool;

    /// An input is about to act on the machine.
    fn before_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput) -> bool;

    /// A tick has passed, with the first collision in it, if any.
    fn after_tick(&mut self, moment: &MachineMoment, collision: Option<&CollisionFinding>) -> bool;

    /// The replay has ended with the machine in this state. Not called without a state.
    fn end(&mut self, moment: MachineMoment);
}

/// Replays a recording up to its end or to the first damage, and stores its history.
///
/// # Errors
/// The bytes are no recording, or one of a newer format.
pub fn replay(bytes: &[u8]) -> Result<Replay, RecordingError> {
    let mut keeper = HistoryKeeper::default();
    let replayed = replay_observed(bytes, &mut keeper)?;
    Ok(Replay {
        history: keeper.0,
        ..replayed
    })
}

/// Replays a recording and shows every input and tick to `observer`, until it stops the replay.
/// The history of the result is empty.
///
/// # Errors
/// The bytes are no recording, or one of a newer format.
pub fn replay_observed(
    bytes: &[u8],
    observer: &mut dyn ReplayObserver,
) -> Result<Replay, RecordingError> {
    let mut reader = RecordingReader::new(bytes)?;
    let mut player = Player::new(observer);
    let error = loop {
        let offset = reader.offset();
        match reader.next_event() {
            Ok(Some(event)) => match player.play(event) {
                Some(true) => {}
                Some(false) => break None,
                None => break Some(RecordingError::OutOfOrder(offset)),
            },
            Ok(None) => break None,
            Err(newer @ RecordingError::NewerFormat(_)) => return Err(newer),
            Err(error) => break Some(error),
        }
    };
    if let Some(moment) = player.moment.take() {
        player.observer.end(moment);
    }
    Ok(Replay {
        program: player.program,
        input_count: player.input_count,
        replayed_ticks: player.replayed_ticks,
        equal_hashes: player.equal_hashes,
        difference: player.difference,
        is_complete: player.is_complete,
        error,
        history: None,
    })
}

/// Stores the history of the replayed session since its last state.
#[derive(Default)]
struct HistoryKeeper(Option<History>);

impl ReplayObserver for HistoryKeeper {
    fn begin(&mut self, moment: &MachineMoment) -> bool {
        self.0 = Some(History::new(moment.clone(), DEFAULT_BUDGET_BYTES));
        true
    }

    fn before_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput) -> bool {
        if let Some(history) = &mut self.0 {
            if recorded.input.is_expensive() {
                history.store_state(&moment.emulator, &moment.part);
            }
            history.record(recorded.clone());
        }
        true
    }

    fn after_tick(&mut self, moment: &MachineMoment, _: Option<&CollisionFinding>) -> bool {
        if let Some(history) = &mut self.0 {
            history.follow(&moment.emulator, &moment.part);
        }
        true
    }

    fn end(&mut self, _: MachineMoment) {}
}

struct Player<'a> {
    observer: &'a mut dyn ReplayObserver,
    program: String,
    input_count: usize,
    replayed_ticks: u64,
    equal_hashes: usize,
    last_equal: Option<u64>,
    difference: Option<HashDifference>,
    is_complete: bool,
    /// The machine since the last state.
    moment: Option<MachineMoment>,
}

impl<'a> Player<'a> {
    const fn new(observer: &'a mut dyn ReplayObserver) -> Self {
        Self {
            observer,
            program: String::new(),
            input_count: 0,
            replayed_ticks: 0,
            equal_hashes: 0,
            last_equal: None,
            difference: None,
            is_complete: false,
            moment: None,
        }
    }

    /// Plays an event and returns whether the replay continues; `None` if the event is out of
    /// order.
    fn play(&mut self, event: RecordingEvent) -> Option<bool> {
        match event {
            RecordingEvent::Start { program, .. } => {
                self.program = program;
                Some(true)
            }
            RecordingEvent::State { emulator, part } => {
                let mut moment = MachineMoment {
                    emulator: *emulator,
                    part: MachinePart::default(),
                };
                part.into_iter().for_each(|input| moment.part.apply(input));
                let continues = self.observer.begin(&moment);
                self.moment = Some(moment);
                Some(continues)
            }
            RecordingEvent::Input(recorded) => {
                if !self.run_until(recorded.tick)? {
                    return Some(false);
                }
                let moment = self.moment.as_mut()?;
                let continues = self.observer.before_input(moment, &recorded);
                moment.apply(recorded.input);
                self.input_count += 1;
                Some(continues)
            }
            RecordingEvent::Reached(tick) | RecordingEvent::BoardLinked(tick) => {
                self.run_until(tick)
            }
            RecordingEvent::Hash { tick, hash } => {
                let continues = self.run_until(tick)?;
                if continues {
                    let moment = self.moment.as_ref()?;
                    self.compare(tick, state_hash(&moment.emulator) == Some(hash));
                }
                Some(continues)
            }
            RecordingEvent::End(tick) => {
                let continues = self.run_until(tick)?;
                self.is_complete = continues;
                Some(continues)
            }
        }
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

    /// Runs the machine to a tick and returns whether the replay continues; `None` without a
    /// state, or if the tick is in the past or too far ahead.
    fn run_until(&mut self, tick: u64) -> Option<bool> {
        let moment = self.moment.as_mut()?;
        let gap = tick.checked_sub(moment.ticks())?;
        if gap > MAX_GAP_TICKS {
            return None;
        }
        while moment.ticks() < tick {
            let collision = moment.tick();
            self.replayed_ticks += 1;
            if !self.observer.after_tick(moment, collision.as_ref()) {
                return Some(false);
            }
        }
        Some(true)
    }
}
