//! Replays a solution from the start state of its task, and refuses what is no work of an operator.

use gsk_history::moment::{MachineMoment, RecordedInput};
use gsk_history::recording::RecordingError;
use gsk_history::replay::{Replay, ReplayObserver, SlicedReplay, replay_observed};
use gsk_messages::{Message, say};
use gsk_runner::machining::CollisionFinding;

use crate::input_guard::is_by_operator;

/// The reason why a recording is not a solution of the task.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub enum JudgeError {
    /// The start state of the task cannot be created; the value is the message about the cause.
    Start(Message),
    /// The recording is damaged; the value is the error.
    Recording(RecordingError),
    /// The recording does not begin in the start state of the task, or contains a second state.
    ForeignState,
    /// The recording contains an input that no operator can make, at this time, ms.
    ForeignInput(u64),
    /// The replay differs from the recorded states from this time on, ms.
    Differs(u64),
    /// The recording contains no hash to compare, or has no end.
    Incomplete,
}

impl JudgeError {
    /// Returns the message about the reason.
    pub fn message(&self) -> Message {
        match self {
            Self::Start(reason) => reason.clone(),
            Self::Recording(error) => error.message(),
            Self::ForeignState => say::exercise_foreign_state(),
            Self::ForeignInput(tick) => say::exercise_foreign_input(*tick as f64 / 1000.0),
            Self::Differs(tick) => say::exercise_replay_differs(*tick as f64 / 1000.0),
            Self::Incomplete => say::exercise_incomplete(),
        }
    }
}

/// Observes the replay of a solution, input by input and tick by tick.
pub trait SolutionFollower {
    /// Called before the machine executes an input.
    fn before_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput);

    /// Called after each tick, with the first collision in it; returns whether the replay
    /// continues.
    fn after_tick(&mut self, moment: &MachineMoment, collision: Option<&CollisionFinding>) -> bool;
}

/// Follows a replay of which only the end matters.
impl SolutionFollower for () {
    fn before_input(&mut self, _: &MachineMoment, _: &RecordedInput) {}

    fn after_tick(&mut self, _: &MachineMoment, _: Option<&CollisionFinding>) -> bool {
        true
    }
}

/// A replayed solution, with its observer and the final machine state.
pub struct ReplayedSolution<J> {
    /// The observer of the replay.
    pub judge: J,
    /// The machine state at the end of the replay; `None` if the recording contains no state.
    pub end: Option<MachineMoment>,
    /// Whether the recording has an end, and hashes that were equal in the replay.
    pub is_whole: bool,
}

/// Replays a recording that begins in the state `start`.
///
/// # Errors
/// The recording is damaged or was not made by an operator in that state.
pub fn replay_solution<J: SolutionFollower>(
    start: MachineMoment,
    judge: J,
    recording: &[u8],
) -> Result<ReplayedSolution<J>, JudgeError> {
    let mut observer = RecordingObserver::new(start, judge);
    let replayed = replay_observed(recording, &mut observer).map_err(JudgeError::Recording)?;
    observer.finish(replayed)
}

/// Replays a solution in slices, so that the caller can do other work between them.
#[derive(Debug)]
pub struct SlicedSolution<J>(SlicedReplay<RecordingObserver<J>>);

impl<J: SolutionFollower> SlicedSolution<J> {
    /// Prepares the replay of a recording that begins in the state `start`.
    ///
    /// # Errors
    ///
    /// The bytes are not a recording.
    pub fn new(start: MachineMoment, judge: J, recording: &[u8]) -> Result<Self, JudgeError> {
        let observer = RecordingObserver::new(start, judge);
        let replay = SlicedReplay::new(recording, observer).map_err(JudgeError::Recording)?;
        Ok(Self(replay))
    }

    /// Replays at most `ticks` ticks; returns whether the replay has ended.
    pub fn advance(&mut self, ticks: u64) -> bool {
        self.0.advance(ticks)
    }

    /// Returns the replayed solution after the end of the replay.
    ///
    /// # Errors
    ///
    /// The recording is damaged or was not made by an operator in the start state.
    pub fn finish(self) -> Result<ReplayedSolution<J>, JudgeError> {
        let (replayed, observer) = self.0.finish();
        observer.finish(replayed)
    }

    /// Returns the share of the machine time that has been replayed, 0 to 1.
    pub fn progress(&self) -> f32 {
        self.0.progress()
    }
}

impl<J> RecordingObserver<J> {
    const fn new(start: MachineMoment, judge: J) -> Self {
        Self {
            judge,
            start,
            has_begun: false,
            cut_faults_at: None,
            flaw: None,
            end: None,
        }
    }

    /// Returns the solution after the replay has ended.
    ///
    /// # Errors
    ///
    /// The recording is damaged, was not made by an operator, or differs from the replay.
    fn finish(self, replayed: Replay) -> Result<ReplayedSolution<J>, JudgeError> {
        if let Some(flaw) = self.flaw {
            return Err(flaw);
        }
        if let Some(error) = replayed.error {
            return Err(JudgeError::Recording(error));
        }
        if replayed.exchange.is_some() {
            return Err(JudgeError::ForeignInput(0));
        }
        if let Some(difference) = replayed.difference {
            return Err(JudgeError::Differs(difference.tick));
        }
        Ok(ReplayedSolution {
            judge: self.judge,
            end: self.end,
            is_whole: replayed.is_complete && replayed.equal_hashes > 0,
        })
    }
}

/// Forwards the inputs and ticks of a replay to the observer, and refuses inputs that no operator
/// can make.
#[derive(Debug)]
struct RecordingObserver<J> {
    judge: J,
    start: MachineMoment,
    has_begun: bool,
    /// Tick of the last collision or cut above the limits; `None` without one.
    cut_faults_at: Option<u64>,
    flaw: Option<JudgeError>,
    /// Machine state after the last tick or input; `None` before the first one.
    end: Option<MachineMoment>,
}

impl<J: SolutionFollower> ReplayObserver for RecordingObserver<J> {
    fn begin(&mut self, moment: &MachineMoment) -> bool {
        let part = |moment: &MachineMoment| moment.part.inputs_for_uncut();
        let is_start = !self.has_begun
            && moment.emulator == self.start.emulator
            && part(moment) == part(&self.start);
        self.has_begun = true;
        if !is_start {
            self.flaw = Some(JudgeError::ForeignState);
        }
        is_start
    }

    fn before_input(&mut self, moment: &MachineMoment, recorded: &RecordedInput) -> bool {
        let after_cut = self.cut_faults_at == Some(moment.ticks());
        if !is_by_operator(&recorded.input, after_cut) {
            let tick = moment.ticks().saturating_sub(self.start.ticks());
            self.flaw = Some(JudgeError::ForeignInput(tick));
            return false;
        }
        self.judge.before_input(moment, recorded);
        true
    }

    fn after_tick(&mut self, moment: &MachineMoment, collision: Option<&CollisionFinding>) -> bool {
        let effect = (moment.part).cut_effect(collision, moment.emulator.simulation());
        if collision.is_some() || effect.cut_fault.is_some() {
            self.cut_faults_at = Some(moment.ticks());
        }
        self.judge.after_tick(moment, collision)
    }

    fn end(&mut self, moment: MachineMoment) {
        self.end = Some(moment);
    }
}
