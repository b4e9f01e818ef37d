//! The report of a judge: points for each criterion with the evidence.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The verdicts on one solution, with its points and its machine time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExerciseReport {
    /// Name of the task that was solved.
    pub task: String,
    /// Hash of the task's file, hexadecimal.
    pub task_hash: String,
    /// Sum of the points, before the deduction for hints.
    pub points: u32,
    /// Greatest number of points of the task.
    pub max_points: u32,
    /// Machine time that the solution took, ms.
    pub duration_ms: u64,
    /// The result of each criterion, in the order of the task.
    pub verdicts: Vec<CriterionVerdict>,
    /// Key presses that the task has refused; `None` without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<RefusedPresses>,
}

/// Number of key presses that a task has refused, and the reason of the first one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefusedPresses {
    /// Number of refused key presses.
    pub count: u32,
    /// Time of the first refused press, ms of machine time since the start of the solution.
    pub first_tick: u64,
    /// Reason why the first key press was refused.
    pub first: Message,
}

impl RefusedPresses {
    /// Returns the refused key presses as a message.
    pub fn message(&self) -> Message {
        let at = self.first_tick as f64 / 1000.0;
        say::exercise_refused_presses(self.count, at, self.first.clone())
    }
}

/// The verdict on one criterion: met or not, with its points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriterionVerdict {
    /// Name of the criterion.
    pub id: String,
    /// Points that the solution gets for the criterion.
    pub points: u32,
    /// Greatest number of points of the criterion.
    pub max_points: u32,
    /// Whether the criterion is met.
    pub is_met: bool,
    /// Moment and value that decided the verdict.
    pub evidence: MarkEvidence,
}

/// The moment and the value that decided a criterion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkEvidence {
    /// Machine time since the start of the solution, ms; `None` if no moment decided.
    pub tick: Option<u64>,
    /// The block that was executed at that moment, as `O0001:12 N30`; `None` without one.
    pub block: Option<String>,
    /// The measured value that decided, mm or degrees; `None` without a measurement.
    pub measured: Option<f64>,
    /// Message about what was found instead of what the criterion requires; `None` if there is
    /// nothing to add.
    pub found: Option<Message>,
}

impl ExerciseReport {
    /// Returns the names of the criteria that are not met.
    pub fn unmet(&self) -> Vec<&str> {
        let unmet = self.verdicts.iter().filter(|verdict| !verdict.is_met);
        unmet.map(|verdict| verdict.id.as_str()).collect()
    }
}
