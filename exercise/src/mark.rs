//! Marks results: replays each one and compares it with what it claims.

use std::collections::BTreeMap;

use gsk_messages::{Message, say};

use crate::exam::ExamNote;
use crate::judge::judge;
use crate::report::ExerciseReport;
use crate::result_file::{ExerciseResult, read_result};
use crate::seal::KeyNumber;
use crate::task::{ExerciseTask, TaskHash};

/// The mark of one result file.
#[derive(Clone, Debug)]
pub struct ResultMark {
    /// Name of the result file.
    pub file: String,
    /// Name of the learner, as the result states it.
    pub learner: String,
    /// Name of the task, as the result states it.
    pub task: String,
    /// Points that the result file claims.
    pub claimed_points: u32,
    /// Points that are deducted for hints that the learner read.
    pub hint_cost: u32,
    /// Pauses, interruptions and wrong PINs of the exam; `None` if the result is not from an exam.
    pub exam: Option<ExamNote>,
    /// Report of the replayed recording; `None` if the recording was refused.
    pub report: Option<ExerciseReport>,
    /// Number of the key that sealed the result; `None` if the file is not a result.
    pub key: Option<KeyNumber>,
    /// Hash of the recording, which is equal in copies; `None` if the file is not a result.
    recording_hash: Option<TaskHash>,
    /// Number of results that a learner may hand in for the task.
    attempts: u32,
    /// Reasons why the result is suspect; empty if it is as claimed.
    pub flags: Vec<Message>,
}

impl ResultMark {
    /// Returns the points of the replayed recording before the deduction for hints; 0 if the
    /// recording was refused.
    pub fn points(&self) -> u32 {
        let points = self.report.as_ref().map_or(0, |report| report.points);
        points.saturating_sub(self.hint_cost)
    }

    /// Returns the greatest number of points of the task; 0 if the recording was refused.
    pub fn max_points(&self) -> u32 {
        self.report.as_ref().map_or(0, |report| report.max_points)
    }

    /// Returns the hash of the recording; `None` if the file is not a result.
    pub(crate) const fn recording_hash(&self) -> Option<TaskHash> {
        self.recording_hash
    }

    /// Creates the mark of a file that cannot be marked, with the reason.
    pub fn refused(file: &str, flag: Message) -> Self {
        Self {
            file: file.to_owned(),
            learner: String::new(),
            task: String::new(),
            claimed_points: 0,
            hint_cost: 0,
            exam: None,
            report: None,
            key: None,
            recording_hash: None,
            attempts: 0,
            flags: vec![flag],
        }
    }
}

/// Marks one result file. `tasks` are the tasks to which it may belong.
pub fn mark_result(file: &str, bytes: &[u8], tasks: &[ExerciseTask]) -> ResultMark {
    match read_result(bytes) {
        Ok(result) => mark_read(file, result, tasks),
        Err(message) => ResultMark::refused(file, message),
    }
}

fn mark_read(file: &str, result: ExerciseResult, tasks: &[ExerciseTask]) -> ResultMark {
    let ExerciseResult {
        head,
        recording,
        key,
        is_sealed,
    } = result;
    let mut mark = ResultMark {
        learner: head.learner,
        task: head.report.task.clone(),
        claimed_points: head.report.points,
        exam: head.exam,
        key: Some(key),
        recording_hash: Some(TaskHash::from_bytes(&recording)),
        flags: Vec::new(),
        ..ResultMark::refused(file, say::exercise_not_result())
    };
    if !is_sealed {
        mark.flags.push(say::exercise_flag_seal());
    }
    let Some(task) = tasks.iter().find(|task| task.id == mark.task) else {
        let names: Vec<&str> = tasks.iter().map(|task| task.id.as_str()).collect();
        let unknown = say::exercise_unknown(&mark.task, names.join(" "));
        mark.flags.push(unknown);
        return mark;
    };
    mark.attempts = task.attempts;
    if head.report.task_hash != task.hash.to_string() {
        mark.flags.push(say::exercise_flag_task(&task.id));
        return mark;
    }
    match task.hint_cost(&head.hints) {
        Ok(cost) => mark.hint_cost = cost,
        Err(message) => mark.flags.push(message),
    }
    match judge(task, &recording) {
        Ok(report) => {
            if !is_claimed(&report, &head.report) {
                let claimed = head.report.points;
                mark.flags
                    .push(say::exercise_flag_report(claimed, report.points));
            }
            mark.report = Some(report);
        }
        Err(error) => mark.flags.push(error.message()),
    }
    mark
}

/// Returns whether a result file claims this report. A reader of JSON may change the last digit of a
/// measured value, so the report is compared as it is read from a file.
fn is_claimed(report: &ExerciseReport, claimed: &ExerciseReport) -> bool {
    let written = serde_json::to_vec(report);
    let read = written.and_then(|text| serde_json::from_slice::<ExerciseReport>(&text));
    read.is_ok_and(|read| read == *claimed)
}

/// Flags what only a comparison of all marks shows: copies, and more results than permitted.
pub fn flag_repetitions(marks: &mut [ResultMark]) {
    let mut recordings: BTreeMap<String, String> = BTreeMap::new();
    let mut attempts: BTreeMap<(String, String), u32> = BTreeMap::new();
    for mark in marks {
        let Some(hash) = mark.recording_hash else {
            continue;
        };
        match recordings.get(&hash.to_string()) {
            Some(first) => mark.flags.push(say::exercise_flag_same(first)),
            None => {
                recordings.insert(hash.to_string(), mark.file.clone());
            }
        }
        let author = (mark.learner.clone(), mark.task.clone());
        let count = attempts.entry(author).or_default();
        *count += 1;
        if mark.attempts > 0 && *count > mark.attempts {
            let flag = say::exercise_flag_attempts(*count, mark.attempts);
            mark.flags.push(flag);
        }
    }
}
