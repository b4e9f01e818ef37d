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

/// An exercise that was read without errors: task, start state and criteria.
#[derive(Clone, Debug)]
pub struct ExerciseTask {
    /// Name of the task's folder; identifies the task.
    pub id: String,
    /// Title of the exercise in the list of tasks.
    pub title: LessonText,
    /// The task of the learner, as text.
    pub text: LessonText,
    /// Machine time after which the solution ends, ms.
    pub time_limit_ms: u64,
    /// Number of results that a learner may hand in for the task.
    pub attempts: u32,
    /// Hints for the learner, each with the points that it costs.
    pub hints: Vec<ExerciseHint>,
    /// The faults of the lathe that the learner has to find.
    pub faults: Vec<LatheFault>,
    /// The criteria that give points, at least one.
    pub criteria: Vec<ExerciseCriterion>,
    /// Hash of the task file, by which results refer to it.
    pub hash: TaskHash,
    pub(crate) start: LessonStart,
    /// The keys and pages of the panel that the task refuses.
    pub(crate) limits: PanelLimits,
    /// Keys missing in the task's list of permitted keys that stay permitted, because they stop the
    /// machine.
    pub(crate) unlisted_stop_keys: Vec<&'static str>,
    pub(crate) job: Option<Job>,
    /// Outline of the finished part, for the drawing; `None` without one.
    pub(crate) outline: Option<TaskOutline>,
    /// A drawing made by hand, PNG; it is shown instead of the drawing of the outline. `None`
    /// without one.
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

/// Hash of the text of a task file: BLAKE2b with 256 bits, line ends as LF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaskHash([u8; 32]);

impl TaskHash {
    /// Computes the hash of the text of a task file.
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

    /// Returns the inputs that clamp the stock of the task in the chuck.
    pub(crate) fn part_inputs(&self) -> [PartInput; 2] {
        let named = self.job.as_ref().map(|job| {
            Box::new(NamedJob {
                job: job.clone(),
                name: Some(self.id.clone()),
            })
        });
        [PartInput::Job(named), PartInput::CrashStops(true)]
    }

    /// Returns whether the exercise has stock from which a part is cut.
    pub const fn cuts_part(&self) -> bool {
        self.job.is_some()
    }

    /// Returns the greatest number of points that a solution can reach.
    pub fn max_points(&self) -> u32 {
        self.criteria.iter().map(|criterion| criterion.points).sum()
    }

    /// Returns the points that the hints with these numbers (from 1) cost together.
    ///
    /// # Errors
    ///
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
