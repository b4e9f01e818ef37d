//! Replays a recording: simulates it from its states and inputs, and compares the hashes.

use std::collections::VecDeque;

use gsk_runner::machining::CollisionFinding;

use crate::board_exchange::{BoardStep, ExchangeSummary, ReplayedBoard};
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
    /// The first tick at which the hashes differ.
    pub tick: u64,
}

/// A recording that is being replayed.
#[derive(Debug)]
pub struct Replay {
    /// Version of the program that has recorded.
    pub program: String,
    /// Number of inputs in the recording.
    pub input_count: usize,
    /// Replayed machine time, ticks (ms).
    pub replayed_ticks: u64,
    /// Number of hashes that were equal.
    pub equal_hashes: usize,
    /// The first difference from the recorded session; `None` if all hashes were equal.
    pub difference: Option<HashDifference>,
    /// The exchange with a pulse board; `None` if no board was connected.
    pub exchange: Option<ExchangeSummary>,
    /// Whether the program has ended the recording: `false` after a crash.
    pub is_complete: bool,
    /// The reason for which the rest of the file was not read; `None` if all of it was read.
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

    /// A pulse board was connected to the machine or disconnected from it. While it is connected
    /// the machine cannot be simulated from a state and the inputs alone.
    fn change_board(&mut self, _moment: &MachineMoment, _is_linked: bool) {}

    /// The replay has ended with the machine in this state. Not called without a state.
    fn end(&mut self, moment: MachineMoment);
}

impl<O: ReplayObserver + ?Sized> ReplayObserver for &mut O {
    fn begin(&mut self, moment: &MachineMoment) -> bool {
        (**self).begin(moment)
    }

    fn before_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput) -> bool {
        (**self).before_input(moment, recorded)
    }

    fn after_tick(&mut self, moment: &MachineMoment, collision: Option<&CollisionFinding>) -> bool {
        (**self).after_tick(moment, collision)
    }

    fn change_board(&mut self, moment: &MachineMoment, is_linked: bool) {
        (**self).change_board(moment, is_linked);
    }

    fn end(&mut self, moment: MachineMoment) {
        (**self).end(moment);
    }
}

/// Replays a recording up to its end or to the first damage, and stores its history.
///
/// # Errors
/// The bytes are no recording, or one of a newer format.
pub fn replay(bytes: &[u8]) -> Result<Replay, RecordingError> {
    let mut keeper = HistoryKeeper::default();
    let replayed = replay_observed(bytes, &mut keeper)?;
    Ok(Replay {
        history: keeper.history,
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
    let mut budget = u64::MAX;
    let error = loop {
        let offset = reader.offset();
        match reader.next_event() {
            Ok(Some(event)) => match player.play(event, &mut budget) {
                PlayedEvent::Done => {}
                PlayedEvent::Stopped | PlayedEvent::Waiting(_) => break None,
                PlayedEvent::OutOfOrder => break Some(RecordingError::OutOfOrder(offset)),
            },
            Ok(None) => break None,
            Err(newer @ RecordingError::NewerFormat(_)) => return Err(newer),
            Err(error) => break Some(error),
        }
    };
    Ok(player.finish(error))
}

/// A replay in slices. Its events are in memory, which fits a recording of this computer.
#[derive(Debug)]
pub struct SlicedReplay<O> {
    player: Player<O>,
    /// The events that have not been played, with their positions in the recording.
    events: VecDeque<(usize, RecordingEvent)>,
    /// The reason for which the rest of the recording is not played; `None` if all of it is played.
    error: Option<RecordingError>,
    /// Ticks of the last event.
    end: u64,
}

impl<O: ReplayObserver> SlicedReplay<O> {
    /// Reads a recording.
    ///
    /// # Errors
    /// The bytes are no recording, or one of a newer format.
    pub fn new(bytes: &[u8], observer: O) -> Result<Self, RecordingError> {
        let mut reader = RecordingReader::new(bytes)?;
        let (mut events, mut end) = (VecDeque::new(), 0);
        let error = loop {
            let offset = reader.offset();
            match reader.next_event() {
                Ok(Some(event)) => {
                    end = event_tick(&event).unwrap_or(end);
                    events.push_back((offset, event));
                }
                Ok(None) => break None,
                Err(newer @ RecordingError::NewerFormat(_)) => return Err(newer),
                Err(error) => break Some(error),
            }
        };
        Ok(Self {
            player: Player::new(observer),
            events,
            error,
            end,
        })
    }

    /// Replays at most `budget` ticks; returns whether the replay has ended.
    pub fn advance(&mut self, mut budget: u64) -> bool {
        while let Some((offset, event)) = self.events.pop_front() {
            self.error = match self.player.play(event, &mut budget) {
                PlayedEvent::Done => continue,
                PlayedEvent::Stopped => None,
                PlayedEvent::OutOfOrder => Some(RecordingError::OutOfOrder(offset)),
                PlayedEvent::Waiting(event) => {
                    self.events.push_front((offset, event));
                    return false;
                }
            };
            self.events.clear();
        }
        true
    }

    /// Returns the replay and its observer after its end.
    pub fn finish(mut self) -> (Replay, O) {
        let replay = self.player.finish(self.error);
        (replay, self.player.observer)
    }

    /// Returns the share of the machine time that is replayed, 0 to 1.
    pub fn progress(&self) -> f32 {
        let Some(moment) = &self.player.moment else {
            return 0.0;
        };
        let replayed = self.player.replayed_ticks as f32;
        let left = self.end.saturating_sub(moment.ticks()) as f32;
        replayed / (replayed + left).max(1.0)
    }
}

/// Stores the history of the replayed session since its last state, without the time with a
/// board.
#[derive(Default)]
struct HistoryKeeper {
    history: Option<History>,
    has_board: bool,
}

impl HistoryKeeper {
    const fn followed(&mut self) -> Option<&mut History> {
        match self.has_board {
            true => None,
            false => self.history.as_mut(),
        }
    }
}

impl ReplayObserver for HistoryKeeper {
    fn begin(&mut self, moment: &MachineMoment) -> bool {
        self.history = Some(History::new(moment.clone(), DEFAULT_BUDGET_BYTES));
        self.has_board = false;
        true
    }

    fn before_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput) -> bool {
        if let Some(history) = self.followed() {
            if recorded.input.is_expensive() {
                history.store_state(&moment.emulator, &moment.part);
            }
            history.record(recorded.clone());
        }
        true
    }

    fn after_tick(&mut self, moment: &MachineMoment, _: Option<&CollisionFinding>) -> bool {
        if let Some(history) = self.followed() {
            history.follow(&moment.emulator, &moment.part);
        }
        true
    }

    fn change_board(&mut self, moment: &MachineMoment, is_linked: bool) {
        match is_linked {
            true => self.has_board = true,
            false => {
                self.begin(moment);
            }
        }
    }

    fn end(&mut self, _: MachineMoment) {}
}

#[derive(Debug)]
struct Player<O> {
    observer: O,
    program: String,
    input_count: usize,
    replayed_ticks: u64,
    equal_hashes: usize,
    last_equal: Option<u64>,
    difference: Option<HashDifference>,
    is_complete: bool,
    /// The machine since the last state.
    moment: Option<MachineMoment>,
    /// The link to a board; `None` while none is connected.
    board: Option<ReplayedBoard>,
    exchange: Option<ExchangeSummary>,
}

/// The result of playing one event of a recording.
enum PlayedEvent {
    /// The event has been applied.
    Done,
    /// The observer has stopped the replay.
    Stopped,
    /// The event is out of order.
    OutOfOrder,
    /// The budget was used before the machine reached it.
    Waiting(RecordingEvent),
}

/// How far the machine has run.
enum ReplayRunEnd {
    Reached,
    Stopped,
    OutOfOrder,
    OverBudget,
}

/// The tick before which an event acts; `None` if it acts at once.
fn event_tick(event: &RecordingEvent) -> Option<u64> {
    match event {
        RecordingEvent::Start { .. } | RecordingEvent::State { .. } | RecordingEvent::Board(_) => {
            None
        }
        RecordingEvent::Input(recorded) => Some(recorded.tick),
        RecordingEvent::Reached(tick)
        | RecordingEvent::BoardLinked(tick)
        | RecordingEvent::Hash { tick, .. }
        | RecordingEvent::End(tick) => Some(*tick),
    }
}

impl<O: ReplayObserver> Player<O> {
    const fn new(observer: O) -> Self {
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
            board: None,
            exchange: None,
        }
    }

    /// Runs the machine to an event, at most `budget` ticks, and plays it.
    fn play(&mut self, event: RecordingEvent, budget: &mut u64) -> PlayedEvent {
        if let RecordingEvent::Board(step) = event {
            return self.play_board(*step, budget);
        }
        if let Some(tick) = event_tick(&event) {
            match self.run_until(tick, budget) {
                ReplayRunEnd::Reached => {}
                ReplayRunEnd::Stopped => return PlayedEvent::Stopped,
                ReplayRunEnd::OutOfOrder => return PlayedEvent::OutOfOrder,
                ReplayRunEnd::OverBudget => return PlayedEvent::Waiting(event),
            }
        }
        match self.act(event) {
            true => PlayedEvent::Done,
            false => PlayedEvent::Stopped,
        }
    }

    /// Plays an event that is due and returns whether the replay continues.
    fn act(&mut self, event: RecordingEvent) -> bool {
        match event {
            RecordingEvent::Start { program, .. } => self.program = program,
            RecordingEvent::State { emulator, part } => {
                let mut moment = MachineMoment {
                    emulator: *emulator,
                    part: MachinePart::default(),
                };
                part.into_iter().for_each(|input| moment.part.apply(input));
                self.board = None;
                let continues = self.observer.begin(&moment);
                self.moment = Some(moment);
                return continues;
            }
            RecordingEvent::Input(recorded) => {
                if let Some(moment) = &mut self.moment {
                    let continues = self.observer.before_input(moment, &recorded);
                    moment.apply(recorded.input);
                    self.input_count += 1;
                    return continues;
                }
            }
            RecordingEvent::BoardLinked(_) => {
                self.board = None;
                if let Some(moment) = &self.moment {
                    self.observer.change_board(moment, true);
                }
            }
            RecordingEvent::Reached(_) | RecordingEvent::Board(_) => {}
            RecordingEvent::Hash { tick, hash } => {
                let emulator = self.moment.as_ref().map(|moment| &moment.emulator);
                let is_equal = emulator.and_then(state_hash) == Some(hash);
                self.compare(tick, is_equal);
            }
            RecordingEvent::End(_) => self.is_complete = true,
        }
        true
    }

    /// Plays a step of the exchange with a board.
    fn play_board(&mut self, step: BoardStep, budget: &mut u64) -> PlayedEvent {
        let Some(moment) = &mut self.moment else {
            return PlayedEvent::OutOfOrder;
        };
        let summary = self.exchange.get_or_insert_default();
        match (step, &mut self.board) {
            (
                BoardStep::Opened {
                    config,
                    dictionaries,
                },
                None,
            ) => {
                self.board = ReplayedBoard::open(*config, dictionaries, moment);
                if self.board.is_none() {
                    return PlayedEvent::OutOfOrder;
                }
                self.observer.change_board(moment, true);
            }
            (BoardStep::Closed, board @ Some(_)) => {
                if let Some(board) = board.take() {
                    board.close(moment);
                }
                self.observer.change_board(moment, false);
            }
            (BoardStep::Ticked(count, is_refused), Some(board)) => {
                for done in 0..count {
                    if *budget == 0 {
                        let rest = BoardStep::Ticked(count - done, is_refused);
                        return PlayedEvent::Waiting(RecordingEvent::Board(Box::new(rest)));
                    }
                    *budget -= 1;
                    board.before_tick(moment, summary);
                    let collision = moment.tick();
                    board.after_tick(moment);
                    self.replayed_ticks += 1;
                    if !self.observer.after_tick(moment, collision.as_ref()) {
                        return PlayedEvent::Stopped;
                    }
                }
                if is_refused {
                    board.refuse_tick(moment, summary);
                }
            }
            (step, Some(board)) => board.play(&step, moment, summary),
            (_, None) => return PlayedEvent::OutOfOrder,
        }
        PlayedEvent::Done
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

    /// Runs the machine to a tick. It is out of order without a state, or if the tick is in the
    /// past or too far ahead.
    fn run_until(&mut self, tick: u64, budget: &mut u64) -> ReplayRunEnd {
        let Some(moment) = &mut self.moment else {
            return ReplayRunEnd::OutOfOrder;
        };
        let gap = tick.checked_sub(moment.ticks());
        // With a board the steps of the exchange make the ticks.
        let is_ahead = |gap| gap > MAX_GAP_TICKS || (gap > 0 && self.board.is_some());
        if gap.is_none_or(is_ahead) {
            return ReplayRunEnd::OutOfOrder;
        }
        while moment.ticks() < tick {
            if *budget == 0 {
                return ReplayRunEnd::OverBudget;
            }
            *budget -= 1;
            let collision = moment.tick();
            self.replayed_ticks += 1;
            if !self.observer.after_tick(moment, collision.as_ref()) {
                return ReplayRunEnd::Stopped;
            }
        }
        ReplayRunEnd::Reached
    }

    /// Shows the observer where the replay has ended, and returns the result.
    fn finish(&mut self, error: Option<RecordingError>) -> Replay {
        if let Some(moment) = self.moment.take() {
            self.observer.end(moment);
        }
        Replay {
            program: core::mem::take(&mut self.program),
            input_count: self.input_count,
            replayed_ticks: self.replayed_ticks,
            equal_hashes: self.equal_hashes,
            difference: self.difference,
            exchange: self.exchange,
            is_complete: self.is_complete,
            error,
            history: None,
        }
    }
}
