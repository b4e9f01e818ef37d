//! Checks a task: its reference solution gets all points, its wrong solutions lose those that they
//! name, and every criterion can fail.

use std::collections::BTreeSet;

use gsk_messages::{Message, say};
use gsk_workpiece::region::Region;

use crate::drawing::check_outline;
use crate::judge::{JudgeError, judge};
use crate::report::ExerciseReport;
use crate::solution_replay::replay_solution;
use crate::solve::{SolutionScript, make_part, record_solution};
use crate::task::ExerciseTask;

/// Begins the comment in a wrong solution that names the criteria which it does not meet.
const FAILS: &str = "# fails:";

/// Name of the file with the script that reaches all points.
pub const REFERENCE_SCRIPT: &str = "reference.txt";
/// Name of the file with the recording that reaches all points.
pub const REFERENCE_RECORDING: &str = "reference.gskrec";

/// A solution in the folder of a task: a script or a recording.
#[derive(Clone, Debug)]
pub struct SolutionFile {
    /// Name of the file, as `wrong-1.txt`.
    pub name: String,
    /// The script or recording in the file.
    pub content: SolutionContent,
}

/// The content of a solution file: a script or a recording.
#[derive(Clone, Debug)]
pub enum SolutionContent {
    /// An operator script.
    Script(String),
    /// A recording that was made in the window.
    Recording(Vec<u8>),
}

impl SolutionFile {
    /// Returns whether the file is the reference solution.
    pub fn is_reference(&self) -> bool {
        self.name == REFERENCE_SCRIPT || self.name == REFERENCE_RECORDING
    }

    /// Judges the solution.
    ///
    /// # Errors
    /// The script cannot be played, or the recording is refused.
    pub fn judge(&self, task: &ExerciseTask) -> Result<ExerciseReport, Message> {
        match &self.content {
            SolutionContent::Script(text) => judge_script(task, text),
            SolutionContent::Recording(recording) => {
                judge(task, recording).map_err(|error| error.message())
            }
        }
    }

    /// Plays the solution and returns the half section of the part that it makes; `None` if the
    /// task has no part.
    ///
    /// # Errors
    /// The script cannot be played, or the recording is refused.
    pub fn make_part(&self, task: &ExerciseTask) -> Result<Option<Region>, Message> {
        match &self.content {
            SolutionContent::Script(text) => make_part(task, &SolutionScript::read(text)?),
            SolutionContent::Recording(recording) => {
                replay_part(task, recording).map_err(|error| error.message())
            }
        }
    }

    /// Returns the criteria that the solution names as not met; `None` without the comment.
    fn stated_failures(&self) -> Option<BTreeSet<&str>> {
        let SolutionContent::Script(text) = &self.content else {
            return None;
        };
        let mut lines = text.lines();
        let stated = lines.find_map(|line| line.trim().strip_prefix(FAILS))?;
        Some(stated.split_whitespace().collect())
    }
}

/// The result of checking a task with its solutions.
#[derive(Clone, Debug, Default)]
pub struct TaskCheck {
    /// The report of each solution that could be judged, by the name of its file.
    pub reports: Vec<(String, ExerciseReport)>,
    /// Notes for the author that are not faults of the task.
    pub notes: Vec<Message>,
    /// Faults of the task or of its solutions; empty if the task can be used.
    pub faults: Vec<Message>,
}

/// Plays and judges the script of a solution.
///
/// # Errors
///
/// The script cannot be played, or its recording is refused.
pub fn judge_script(task: &ExerciseTask, text: &str) -> Result<ExerciseReport, Message> {
    let script = SolutionScript::read(text)?;
    let recording = record_solution(task, &script, env!("CARGO_PKG_VERSION"))?;
    judge(task, &recording).map_err(|error| error.message())
}

/// Replays a recording and returns the half section of the part that it makes; `None` if the task
/// has no part.
fn replay_part(task: &ExerciseTask, recording: &[u8]) -> Result<Option<Region>, JudgeError> {
    let start = task.create_start().map_err(JudgeError::Start)?;
    let end = replay_solution(start, (), recording)?.end;
    let end = end.ok_or(JudgeError::Incomplete)?;
    let machining = end.part.machining();
    Ok(machining.map(|it| it.scene().part().section().clone()))
}

/// Plays all solutions of a task and reports its faults.
pub fn check_task(task: &ExerciseTask, solutions: &[SolutionFile]) -> TaskCheck {
    let stop_keys = task.unlisted_stop_keys.join(" ");
    let note = (!stop_keys.is_empty()).then(|| say::exercise_stop_keys_stay(stop_keys));
    let mut check = TaskCheck {
        notes: Vec::from_iter(note),
        faults: check_outline(task),
        ..TaskCheck::default()
    };
    if !solutions.iter().any(SolutionFile::is_reference) {
        check.faults.push(say::exercise_no_reference());
    }
    let mut failed: BTreeSet<String> = BTreeSet::new();
    for solution in solutions {
        let named = |message: Message| say::subject_reason(&solution.name, message);
        match solution.judge(task) {
            Ok(report) => {
                let fault = match solution.is_reference() {
                    true => check_reference(&report),
                    false => check_wrong(solution, &report),
                };
                check.faults.extend(fault.map(named));
                failed.extend(report.unmet().into_iter().map(str::to_owned));
                check.reports.push((solution.name.clone(), report));
            }
            Err(message) => check.faults.push(named(message)),
        }
    }
    check_idle(task, &mut failed, &mut check.faults);
    let always_met = task
        .criteria
        .iter()
        .filter(|criterion| !failed.contains(&criterion.id));
    check
        .faults
        .extend(always_met.map(|criterion| say::exercise_always_met(&criterion.id)));
    check
}

fn check_reference(report: &ExerciseReport) -> Option<Message> {
    let unmet = report.unmet();
    (!unmet.is_empty()).then(|| say::exercise_reference_fails(unmet.join(" ")))
}

fn check_wrong(solution: &SolutionFile, report: &ExerciseReport) -> Option<Message> {
    let Some(stated) = solution.stated_failures() else {
        return Some(say::exercise_no_stated_failure());
    };
    let unmet: BTreeSet<&str> = report.unmet().into_iter().collect();
    let list = |names: &BTreeSet<&str>| {
        let names: Vec<&str> = names.iter().copied().collect();
        names.join(" ")
    };
    (stated != unmet || unmet.is_empty())
        .then(|| say::exercise_fails_otherwise(list(&stated), list(&unmet)))
}

/// Judges a solution without any input. Adds the criteria that it fails to `failed`, and a fault if
/// it gets points.
fn check_idle(task: &ExerciseTask, failed: &mut BTreeSet<String>, faults: &mut Vec<Message>) {
    match judge_script(task, "wait 1s") {
        Ok(report) => {
            if report.points > 0 {
                faults.push(say::exercise_points_for_nothing(report.points));
            }
            let demands = task.criteria.iter().filter(|it| !it.is_exclusion());
            let unmet = report.unmet();
            let ids = demands.map(|criterion| criterion.id.as_str());
            failed.extend(ids.filter(|id| unmet.contains(id)).map(str::to_owned));
        }
        Err(message) => faults.push(message),
    }
}
