//! A course: exercises that a learning platform gives to a learner, and how far he has come.
//!
//! ```text
//! course.json ──► Course ──► CourseProgress ──► score, state, text for the platform
//! ```
//!
//! [`scorm`] writes a course as a package for platforms, and the values that they store.

pub mod scorm;
mod zip_archive;

use std::sync::Arc;

use base64ct::{Base64, Encoding};
use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::task::{ExerciseTask, TaskHash};

/// Name of the file with the course, in the folder of the page.
pub const COURSE_FILE: &str = "course.json";
/// Number of characters of a task's key in the stored text of the progress.
const KEY_CHARACTERS: usize = 8;

/// A course as written in its file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CourseFile {
    /// Title of the course.
    pub title: String,
    /// Score from which the course is passed, per cent; `None` if the course has no pass mark and
    /// is only completed.
    pub mastery_per_cent: Option<u32>,
    /// The exercises of the course, in their order.
    pub tasks: Vec<CourseTaskFile>,
}

/// A task in the file of a course.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CourseTaskFile {
    /// Name of the task, which is the name of its folder.
    pub id: String,
    /// The text of its `task.ron`.
    pub text: String,
    /// A hand-made drawing, PNG in base64; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawing: Option<String>,
}

impl CourseTaskFile {
    /// Creates a task from the text of its file and its drawing.
    pub fn new(id: String, text: String, drawing: Option<&[u8]>) -> Self {
        let drawing = drawing.map(Base64::encode_string);
        Self { id, text, drawing }
    }

    /// Reads the task. Messages call its file `file`.
    ///
    /// # Errors
    /// The task breaks a rule, or its drawing is damaged.
    pub fn read_task(&self, file: &str) -> Result<ExerciseTask, Message> {
        let task = ExerciseTask::read(&self.id, file, &self.text);
        let mut task = task.map_err(|error| error.message())?;
        if let Some(drawing) = &self.drawing {
            let drawing = Base64::decode_vec(drawing);
            let drawing = drawing.map_err(|_| say::exercise_drawing_damaged(&self.id))?;
            task.drawing = Some(Arc::from(drawing));
        }
        Ok(task)
    }
}

/// A course whose tasks were read without errors.
#[derive(Clone, Debug)]
pub struct Course {
    /// Title of the course.
    pub title: String,
    /// Score from which the course is passed, per cent; `None` if the course has no pass mark and
    /// is only completed.
    pub mastery_per_cent: Option<u32>,
    /// The checked exercises of the course, in their order, at least one.
    pub tasks: Vec<ExerciseTask>,
    /// The unchecked files of the exercises, in the same order.
    sources: Vec<CourseTaskFile>,
}

impl Course {
    /// Reads the file of a course.
    ///
    /// # Errors
    /// It is damaged, or a task breaks a rule.
    pub fn from_json(bytes: &[u8]) -> Result<Self, Message> {
        let damaged = |reason: Message| say::subject_reason(COURSE_FILE, reason);
        let file: CourseFile =
            serde_json::from_slice(bytes).map_err(|error| damaged(say::as_written(error)))?;
        Self::read(file)
    }

    /// Checks the tasks of a course file.
    ///
    /// # Errors
    ///
    /// A task breaks a rule or occurs twice, there is no task, or the text of the progress would be
    /// too long for a learning platform.
    pub fn read(file: CourseFile) -> Result<Self, Message> {
        let mut tasks: Vec<ExerciseTask> = Vec::new();
        for source in &file.tasks {
            let key = task_key(&source.id);
            if tasks.iter().any(|known| task_key(&known.id) == key) {
                return Err(say::course_task_twice(&source.id));
            }
            tasks.push(source.read_task(&source.id)?);
        }
        let course = Self {
            title: file.title,
            mastery_per_cent: file.mastery_per_cent,
            tasks,
            sources: file.tasks,
        };
        let longest = CourseProgress::start(&course).longest_text();
        if course.tasks.is_empty() || longest > scorm::MAX_SUSPEND_CHARACTERS {
            let count = course.tasks.len();
            return Err(say::course_task_count(
                count,
                longest,
                scorm::MAX_SUSPEND_CHARACTERS,
            ));
        }
        Ok(course)
    }
}

impl Course {
    /// Returns the course in the form in which it is stored.
    fn to_file(&self) -> CourseFile {
        CourseFile {
            title: self.title.clone(),
            mastery_per_cent: self.mastery_per_cent,
            tasks: self.sources.clone(),
        }
    }
}

/// Whether a learner has completed, passed or failed a course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CourseState {
    /// At least one exercise was not handed in yet.
    Incomplete,
    /// All exercises were handed in, and the course has no pass mark.
    Completed,
    /// All exercises were handed in, and the score reaches the pass mark.
    Passed,
    /// All exercises were handed in, and the score is below the pass mark.
    Failed,
}

/// The progress of a learner in one exercise: attempts and best points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskProgress {
    /// Name of the task, which is the name of its folder.
    pub id: String,
    /// Greatest number of points of the task.
    pub max_points: u32,
    /// Number of solutions that the learner may hand in for the task.
    pub permitted: u32,
    /// Number of solutions that the learner has handed in for the task.
    pub attempts: u32,
    /// Greatest number of points of a handed-in solution.
    pub best: u32,
}

/// The progress of a learner in all exercises of a course.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CourseProgress {
    mastery_per_cent: Option<u32>,
    tasks: Vec<TaskProgress>,
}

impl CourseProgress {
    /// Creates the progress of a learner who has not handed in anything.
    pub fn start(course: &Course) -> Self {
        let tasks = course.tasks.iter().map(|task| TaskProgress {
            id: task.id.clone(),
            max_points: task.max_points(),
            permitted: task.attempts,
            attempts: 0,
            best: 0,
        });
        Self {
            mastery_per_cent: course.mastery_per_cent,
            tasks: tasks.collect(),
        }
    }

    /// Restores the progress from the text that a learning platform has stored. Unreadable entries
    /// and entries of unknown tasks are ignored.
    pub fn resume(course: &Course, text: &str) -> Self {
        let mut progress = Self::start(course);
        for word in text.split(' ') {
            let Some((key, attempts, best)) = read_word(word) else {
                continue;
            };
            let mut tasks = progress.tasks.iter_mut();
            if let Some(task) = tasks.find(|task| task_key(&task.id) == key) {
                task.attempts = attempts;
                task.best = best.min(task.max_points);
            }
        }
        progress
    }

    /// Returns the progress as text for [`Self::resume`]: for each exercise that was handed in its
    /// key, attempts and best points, as `a1b2c3d4=2/7`.
    pub fn to_text(&self) -> String {
        let begun = self.tasks.iter().filter(|task| task.attempts > 0);
        let words: Vec<String> = begun.map(write_word).collect();
        words.join(" ")
    }

    /// Returns the greatest length that the text of the progress can have, characters.
    fn longest_text(&self) -> usize {
        let full = self.tasks.iter().map(|task| TaskProgress {
            attempts: task.permitted,
            best: task.max_points,
            ..task.clone()
        });
        full.map(|task| write_word(&task).len() + 1).sum()
    }

    /// Returns the progress of an exercise; `None` if it is not part of the course.
    pub fn task(&self, id: &str) -> Option<&TaskProgress> {
        self.tasks.iter().find(|task| task.id == id)
    }

    /// Records the points of a solution that was handed in. More attempts than permitted do not
    /// count.
    pub fn record(&mut self, id: &str, points: u32) {
        let mut tasks = self.tasks.iter_mut();
        if let Some(task) = tasks.find(|task| task.id == id && task.has_attempts_left()) {
            task.attempts += 1;
            task.best = task.best.max(points.min(task.max_points));
        }
    }

    /// Returns the number of exercises that were handed in, and the number of all exercises.
    pub fn handed_in(&self) -> (usize, usize) {
        let begun = self.tasks.iter().filter(|task| task.attempts > 0);
        (begun.count(), self.tasks.len())
    }

    /// Returns the sum of the best points, and the greatest possible sum.
    fn points(&self) -> (u64, u64) {
        let best = self.tasks.iter().map(|task| u64::from(task.best)).sum();
        let most = self.tasks.iter().map(|task| u64::from(task.max_points));
        (best, most.sum::<u64>().max(1))
    }

    /// Returns the score: the best points of all exercises as a share of all points, per cent.
    pub fn score_per_cent(&self) -> f64 {
        let (best, most) = self.points();
        best as f64 * 100.0 / most as f64
    }

    /// Returns the score from which the course is passed, per cent; `None` if the course has no
    /// pass mark.
    pub const fn mastery_per_cent(&self) -> Option<u32> {
        self.mastery_per_cent
    }

    /// Returns whether the course is incomplete, completed, passed or failed.
    pub fn state(&self) -> CourseState {
        let (done, count) = self.handed_in();
        let (best, most) = self.points();
        match self.mastery_per_cent {
            _ if done < count => CourseState::Incomplete,
            None => CourseState::Completed,
            Some(mastery) if best * 100 >= u64::from(mastery) * most => CourseState::Passed,
            Some(_) => CourseState::Failed,
        }
    }
}

impl TaskProgress {
    /// Whether the learner may hand in another solution.
    pub const fn has_attempts_left(&self) -> bool {
        self.attempts < self.permitted
    }
}

/// Returns the key of a task in the text of the progress: a hash, because platforms restrict the
/// characters of the text and a task name may have any.
fn task_key(id: &str) -> String {
    let mut key = TaskHash::from_bytes(id.as_bytes()).to_string();
    key.truncate(KEY_CHARACTERS);
    key
}

fn write_word(task: &TaskProgress) -> String {
    format!("{}={}/{}", task_key(&task.id), task.attempts, task.best)
}

fn read_word(word: &str) -> Option<(&str, u32, u32)> {
    let (key, values) = word.split_once('=')?;
    let (attempts, best) = values.split_once('/')?;
    Some((key, attempts.parse().ok()?, best.parse().ok()?))
}

#[cfg(test)]
mod tests;
