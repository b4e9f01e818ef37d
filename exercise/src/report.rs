//! The report of a judge: points for each criterion with the evidence.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The marks of one solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExerciseReport {
    /// Name of the task.
    pub task: String,
    /// Hash of the task's file, hexadecimal.
    pub task_hash: String,
    /// Sum of the points, without the cost of hints.
    pub points: u32,
    /// Greatest number of points.
    pub max_points: u32,
    /// Machine time of the solution, ms.
    pub duration_ms: u64,
    /// The result of each criterion, in the order of the task.
    pub verdicts: Vec<CriterionVerdict>,
    /// Presses of keys that the task has refused; `None` without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<RefusedPresses>,
}

/// Presses of keys that a task has refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefusedPresses {
    /// Number of presses.
    pub count: u32,
    /// Machine time of the first one since the start of the solution, ms.
    pub first_tick: u64,
    /// Why the first one was refused.
    pub first: Message,
}

impl RefusedPresses {
    /// Returns the presses as a message.
    pub fn message(&self) -> Message {
        let at = self.first_tick as f64 / 1000.0;
        say::exercise_refused_presses(self.count, at, self.first.clone())
    }
}

/// The result of one criterion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CriterionVerdict {
    /// Name of the criterion.
    pub id: String,
    /// Points for it.
    pub points: u32,
    /// Greatest number of points.
    pub max_points: u32,
    /// Whether the criterion is met.
    pub is_met: bool,
    /// What decided it.
    pub evidence: MarkEvidence,
}

/// The moment and the value that decided a criterion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkEvidence {
    /// Machine time since the start of the solution, ms; `None` if no moment decided.
    pub tick: Option<u64>,
    /// The block that was executed, as `O0001:12 N30`.
    pub block: Option<String>,
    /// The measured value, mm or degrees.
    pub measured: Option<f64>,
    /// What was found instead.
    pub found: Option<Message>,
}

impl ExerciseReport {
    /// Returns the names of the criteria that are not met.
    pub fn unmet(&self) -> Vec<&str> {
        let unmet = self.verdicts.iter().filter(|verdict| !verdict.is_met);
        unmet.map(|verdict| verdict.id.as_str()).collect()
    }
}
