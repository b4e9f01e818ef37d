//! A task: start state, texts, limits, hints and criteria.

mod file;

use core::fmt;
use std::sync::Arc;

use blake2::{Blake2b256, Digest};
use gsk_core::machine::LatheFault;
use gsk_history::machine_part::{MachinePart, NamedJob, PartInput};
use gsk_history::moment::MachineMoment;
use gsk_lesson::{LessonStart, LessonText};
use gsk_messages::{Message, say};
use gsk_panel::panel::limits::PanelLimits;
use gsk_workpiece::job::Job;

use crate::criterion::ExerciseCriterion;
use crate::outline::TaskOutline;

/// A task that was read without errors.
#[derive(Clone, Debug)]
pub struct ExerciseTask {
    /// Name of the task's folder; identifies the task.
    pub id: String,
    /// Title in the list of tasks.
    pub title: LessonText,
    /// What the learner has to do.
    pub text: LessonText,
    /// Machine time after which nothing counts, ms.
    pub time_limit_ms: u64,
    /// Number of results that a learner may hand in.
    pub attempts: u32,
    /// Hints with their cost.
    pub hints: Vec<ExerciseHint>,
    /// The faults of the lathe that the learner has to find.
    pub faults: Vec<LatheFault>,
    /// What is marked, at least one.
    pub criteria: Vec<ExerciseCriterion>,
    /// Hash of the task's file.
    pub hash: TaskHash,
    pub(crate) start: LessonStart,
    /// The keys and pages that the task refuses.
    pub(crate) limits: PanelLimits,
    /// Keys that the list of permitted keys leaves out, but that no task can refuse.
    pub(crate) unlisted_stop_keys: Vec<&'static str>,
    pub(crate) job: Option<Job>,
    /// The finished part, for the drawing.
    pub(crate) outline: Option<TaskOutline>,
    /// A hand-made drawing beside the file, PNG; it is shown instead of that of the outline.
    pub drawing: Option<Arc<[u8]>>,
}

/// A hint and the points that it costs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExerciseHint {
    /// The text of the hint.
    pub text: LessonText,
    /// Points that reading the hint costs.
    pub cost: u32,
}

/// Hash of the text of a task: BLAKE2b with 256 bits, line ends as LF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaskHash([u8; 32]);

impl TaskHash {
    /// Computes the hash of the text of a task.
    pub fn from_text(text: &str) -> Self {
        Self::from_bytes(text.replace("\r\n", "\n").as_bytes())
    }

    /// Computes the hash of bytes.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        Self(Blake2b256::digest(bytes).into())
    }
}

impl fmt::Display for TaskHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl ExerciseTask {
    /// Creates the machine on which every solution of the task starts.
    ///
    /// # Errors
    /// The preparation script of the task fails.
    pub fn create_start(&self) -> Result<MachineMoment, Message> {
        let mut emulator = self.start.create_machine()?;
        for fault in &self.faults {
            emulator.set_fault(*fault, true);
        }
        if !self.limits.is_empty() {
            emulator.limit_panel(&self.limits);
        }
        let mut part = MachinePart::default();
        for input in self.part_inputs() {
            part.apply(input);
        }
        Ok(MachineMoment { emulator, part })
    }

    /// Returns the inputs that clamp the stock of the task.
    pub(crate) fn part_inputs(&self) -> [PartInput; 2] {
        let named = self.job.as_ref().map(|job| {
            Box::new(NamedJob {
                job: job.clone(),
                name: Some(self.id.clone()),
            })
        });
        [PartInput::Job(named), PartInput::CrashStops(true)]
    }

    /// Returns whether a part is cut in the exercise.
    pub const fn cuts_part(&self) -> bool {
        self.job.is_some()
    }

    /// Returns the greatest number of points.
    pub fn max_points(&self) -> u32 {
        self.criteria.iter().map(|criterion| criterion.points).sum()
    }

    /// Returns the points that the hints with these numbers, from 1, cost.
    ///
    /// # Errors
    /// The task has no hint with one of the numbers.
    pub fn hint_cost(&self, numbers: &[u32]) -> Result<u32, Message> {
        let mut unique = numbers.to_vec();
        unique.sort_unstable();
        unique.dedup();
        let costs = unique.iter().map(|number| {
            let index = usize::try_from(*number)
                .ok()
                .and_then(|it| it.checked_sub(1));
            let hint = index.and_then(|index| self.hints.get(index));
            hint.map(|hint| hint.cost)
                .ok_or_else(|| say::exercise_no_hint(number, self.hints.len()))
        });
        costs.sum()
    }
}
