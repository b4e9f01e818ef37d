//! An exercise under way: its task and the recording of the solution.

use std::path::PathBuf;
use std::sync::Arc;

use gsk_exercise::solution_recorder::SolutionRecorder;
use gsk_exercise::task::ExerciseTask;
use gsk_history::moment::{MachineMoment, RecordedInput};
use gsk_lesson::LessonText;
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;

use crate::flight::solution_log::SolutionLog;

/// Machine time between two parcels of an exam's recording for the disk, ticks.
const LOG_INTERVAL_TICKS: u64 = 1000;

/// The state of the current exercise that the window shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExerciseState {
    /// Name of the current task.
    pub id: String,
    /// Title of the current task.
    pub title: LessonText,
    /// Tick of the kernel at which it began: another one means another attempt.
    pub begun_at: u64,
    /// Machine time until the solution is handed in, whole seconds.
    pub remaining_s: u64,
    /// Whether the learner has handed in, or the time is over. The machine continues to run, but
    /// nothing counts any more.
    pub is_handed_in: bool,
    /// Whether the exercise is part of an exam.
    pub is_exam: bool,
    /// Whether the instructor has paused the exam, so that machine time is halted.
    pub is_paused: bool,
}

impl ExerciseState {
    /// Formats the time until the solution is handed in, as `12:05`.
    pub fn remaining_text(&self) -> String {
        format!("{}:{:02}", self.remaining_s / 60, self.remaining_s % 60)
    }
}

/// An exercise of an exam that begins or continues.
#[derive(Clone, Debug)]
pub struct ExamTask {
    /// The task of the exercise.
    pub task: Arc<ExerciseTask>,
    /// Path of the file with the recording of the exercise.
    pub recording_file: PathBuf,
    /// The recording as far as it has come; `None` at its beginning.
    pub recorded: Option<Arc<[u8]>>,
    /// Whether the instructor has paused the exam.
    pub is_paused: bool,
}

/// The solution that a learner hands in.
#[derive(Clone, Debug)]
pub struct HandedInSolution {
    /// The task that was solved.
    pub task: Arc<ExerciseTask>,
    /// The recording of the solution.
    pub recording: Vec<u8>,
}

impl PartialEq for HandedInSolution {
    fn eq(&self, other: &Self) -> bool {
        self.task.hash == other.task.hash && self.recording == other.recording
    }
}

/// An exercise that is being solved or was handed in.
#[derive(Debug)]
pub(super) struct ExerciseRun {
    task: Arc<ExerciseTask>,
    /// Recorder of the solution; `None` after the solution was handed in.
    recorder: Option<SolutionRecorder>,
    start_tick: u64,
    begun_at: u64,
    /// The state of the exam; `None` outside an exam.
    exam: Option<ExamRun>,
}

/// The state that an exercise has in addition if it is part of an exam.
#[derive(Debug)]
struct ExamRun {
    /// The file of the recording; `None` after the solution was handed in.
    log: Option<SolutionLog>,
    is_paused: bool,
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
            exam: None,
        };
        Ok((run, start))
    }

    /// Starts or continues an exercise of an exam; returns it with its machine and part.
    pub(super) fn begin_in_exam(
        exam: &ExamTask,
        begun_at: u64,
    ) -> Result<(Self, MachineMoment), Message> {
        let (mut run, mut moment) = Self::begin(Arc::clone(&exam.task), begun_at)?;
        if let Some(recorded) = &exam.recorded {
            let resumed = SolutionRecorder::resume(&exam.task, recorded);
            let (recorder, end) = resumed.map_err(|error| error.message())?;
            run.recorder = Some(recorder);
            moment = end;
            moment.emulator.record_inputs();
        }
        let recording = run
            .recorder
            .as_ref()
            .map_or(&[][..], SolutionRecorder::bytes);
        run.exam = Some(ExamRun {
            log: Some(SolutionLog::start(&exam.recording_file, recording)?),
            is_paused: exam.is_paused,
        });
        Ok((run, moment))
    }

    /// Returns the state of the exercise for the window.
    pub(super) fn state(&self, emulator: &Emulator) -> ExerciseState {
        let elapsed_s = emulator.ticks().saturating_sub(self.start_tick) / 1000;
        ExerciseState {
            id: self.task.id.clone(),
            title: self.task.title.clone(),
            begun_at: self.begun_at,
            remaining_s: (self.task.time_limit_ms / 1000).saturating_sub(elapsed_s),
            is_handed_in: self.is_handed_in(),
            is_exam: self.is_exam(),
            is_paused: self.is_paused(),
        }
    }

    /// Whether the exercise is part of an exam.
    pub(super) const fn is_exam(&self) -> bool {
        self.exam.is_some()
    }

    /// Whether the instructor has paused the exam.
    pub(super) fn is_paused(&self) -> bool {
        self.exam.as_ref().is_some_and(|exam| exam.is_paused)
    }

    /// Pauses the exam (`true`) or continues it (`false`).
    pub(super) const fn set_paused(&mut self, is_paused: bool) {
        if let Some(exam) = &mut self.exam {
            exam.is_paused = is_paused;
        }
    }

    /// Whether the solution was handed in, so that nothing more is recorded.
    pub(super) const fn is_handed_in(&self) -> bool {
        self.recorder.is_none()
    }

    /// The tick of the machine at which the exercise began.
    pub(super) const fn start_tick(&self) -> u64 {
        self.start_tick
    }

    /// Whether the task is to find a fault, so that the window must hide faults.
    pub(super) fn hides_faults(&self) -> bool {
        !self.task.faults.is_empty()
    }

    /// Whether the learner still works, but the time is over.
    pub(super) fn is_time_over(&self, emulator: &Emulator) -> bool {
        let end = self.start_tick + self.task.time_limit_ms;
        self.recorder.is_some() && emulator.ticks() >= end
    }

    /// Records inputs, and a hash of the machine if one is due.
    pub(super) fn record(
        &mut self,
        emulator: &Emulator,
        inputs: Vec<RecordedInput>,
    ) -> Result<(), Message> {
        let Some(recorder) = &mut self.recorder else {
            return Ok(());
        };
        recorder.add_inputs(inputs)?;
        recorder.follow_tick(emulator)?;
        let log = self.exam.as_mut().and_then(|exam| exam.log.as_mut());
        if let Some(log) = log.filter(|_| emulator.ticks().is_multiple_of(LOG_INTERVAL_TICKS)) {
            recorder.mark_tick(emulator)?;
            if let Some(failure) = log.write(recorder.bytes()) {
                return Err(say::exam_log_failed(failure));
            }
        }
        Ok(())
    }

    /// Ends the recording and returns the solution; `None` if it was handed in before.
    pub(super) fn hand_in(
        &mut self,
        emulator: &Emulator,
    ) -> Option<Result<HandedInSolution, Message>> {
        let recording = self.recorder.take()?.finish(emulator);
        let log = self.exam.as_mut().and_then(|exam| exam.log.take());
        if let (Some(log), Ok(recording)) = (log, &recording) {
            // A solution is handed in whole although its file could not be written. The result
            // goes into the same folder, and reports what is wrong there.
            let _ = log.finish(recording);
        }
        let task = Arc::clone(&self.task);
        Some(recording.map(|recording| HandedInSolution { task, recording }))
    }
}
