//! An exercise under way: its task and the recording of the solution.

use std::sync::Arc;

use gsk_exercise::solution_recorder::SolutionRecorder;
use gsk_exercise::task::ExerciseTask;
use gsk_history::moment::{MachineMoment, RecordedInput};
use gsk_messages::Message;
use gsk_panel::emulator::Emulator;

/// The state of the current exercise, for the window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExerciseState {
    /// Name of the task.
    pub id: String,
    /// Tick of the kernel at which it began: another one means another attempt.
    pub begun_at: u64,
    /// Machine time since the beginning, whole seconds.
    pub elapsed_s: u64,
    /// Whether the learner has handed in, or the time is over. The machine continues to run, but
    /// nothing counts any more.
    pub is_handed_in: bool,
}

/// What a learner hands in.
#[derive(Clone, Debug)]
pub struct HandedInSolution {
    /// The task.
    pub task: Arc<ExerciseTask>,
    /// The recording of the solution.
    pub recording: Vec<u8>,
}

impl PartialEq for HandedInSolution {
    fn eq(&self, other: &Self) -> bool {
        self.task.hash == other.task.hash && self.recording == other.recording
    }
}

/// An exercise under way.
#[derive(Debug)]
pub(super) struct ExerciseRun {
    task: Arc<ExerciseTask>,
    /// `None` after the solution was handed in.
    recorder: Option<SolutionRecorder>,
    start_tick: u64,
    begun_at: u64,
}

impl ExerciseRun {
    /// Starts a task at a tick of the kernel; returns it with its machine and part.
    pub(super) fn begin(
        task: Arc<ExerciseTask>,
        begun_at: u64,
    ) -> Result<(Self, MachineMoment), Message> {
        let mut start = task.create_start()?;
        let recorder = SolutionRecorder::begin(&start, env!("CARGO_PKG_VERSION"))?;
        start.emulator.record_inputs();
        let run = Self {
            task,
            recorder: Some(recorder),
            start_tick: start.ticks(),
            begun_at,
        };
        Ok((run, start))
    }

    /// Returns the state for the window.
    pub(super) fn state(&self, emulator: &Emulator) -> ExerciseState {
        ExerciseState {
            id: self.task.id.clone(),
            begun_at: self.begun_at,
            elapsed_s: emulator.ticks().saturating_sub(self.start_tick) / 1000,
            is_handed_in: self.is_handed_in(),
        }
    }

    /// Whether nothing counts any more.
    pub(super) const fn is_handed_in(&self) -> bool {
        self.recorder.is_none()
    }

    /// The tick of the machine at which the exercise began.
    pub(super) const fn start_tick(&self) -> u64 {
        self.start_tick
    }

    /// Whether the learner has to find a fault.
    pub(super) fn hides_faults(&self) -> bool {
        !self.task.faults.is_empty()
    }

    /// Whether the learner still works, but the time is over.
    pub(super) fn is_time_over(&self, emulator: &Emulator) -> bool {
        let end = self.start_tick + self.task.time_limit_ms;
        self.recorder.is_some() && emulator.ticks() >= end
    }

    /// Records inputs, and a hash if one is due.
    pub(super) fn record(
        &mut self,
        emulator: &Emulator,
        inputs: Vec<RecordedInput>,
    ) -> Result<(), Message> {
        let Some(recorder) = &mut self.recorder else {
            return Ok(());
        };
        recorder.add_inputs(inputs)?;
        recorder.follow_tick(emulator)
    }

    /// Ends the recording; `None` if it has ended before.
    pub(super) fn hand_in(
        &mut self,
        emulator: &Emulator,
    ) -> Option<Result<HandedInSolution, Message>> {
        let recording = self.recorder.take()?.finish(emulator);
        let task = Arc::clone(&self.task);
        Some(recording.map(|recording| HandedInSolution { task, recording }))
    }
}
