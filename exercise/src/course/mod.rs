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

/// Name of the file of a course beside the page.
pub const COURSE_FILE: &str = "course.json";
/// Number of characters of the key of a task in the text of a progress.
const KEY_CHARACTERS: usize = 8;

/// A course as written in its file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CourseFile {
    /// Title of the course.
    pub title: String,
    /// Score from which the course is passed, per cent; `None` if it is only completed.
    pub mastery_per_cent: Option<u32>,
    /// The exercises in their order.
    pub tasks: Vec<CourseTaskFile>,
}

/// A task in the file of a course.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CourseTaskFile {
    /// Name of the task.
    pub id: String,
    /// The text of its `task.ron`.
    pub text: String,
    /// A hand-made drawing, PNG in base64; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    drawing: Option<String>,
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
    /// Score from which the course is passed, per cent; `None` if it is only completed.
    pub mastery_per_cent: Option<u32>,
    /// The exercises in their order, at least one.
    pub tasks: Vec<ExerciseTask>,
    /// The files of the exercises.
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

    /// Reads the tasks of a course.
    ///
    /// # Errors
    /// A task breaks a rule or is there twice, there is none, or their progress is too long for
    /// a platform.
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
    /// Returns the course as its file.
    fn to_file(&self) -> CourseFile {
        CourseFile {
            title: self.title.clone(),
            mastery_per_cent: self.mastery_per_cent,
            tasks: self.sources.clone(),
        }
    }
}

/// State of a course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CourseState {
    /// An exercise was not handed in yet.
    Incomplete,
    /// All exercises were handed in, and no score decides.
    Completed,
    /// All exercises were handed in, and the score is reached.
    Passed,
    /// All exercises were handed in, and the score is not reached.
    Failed,
}

/// How far a learner has come with one exercise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskProgress {
    /// Name of the task.
    pub id: String,
    /// Greatest number of points.
    pub max_points: u32,
    /// Number of solutions that the learner may hand in.
    pub permitted: u32,
    /// Number of solutions that he has handed in.
    pub attempts: u32,
    /// Points of his best solution.
    pub best: u32,
}

/// How far a learner has come with a course.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CourseProgress {
    mastery_per_cent: Option<u32>,
    tasks: Vec<TaskProgress>,
}

impl CourseProgress {
    /// Starts a course.
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

    /// Continues a course from the text that a platform has stored. What the text says about
    /// other tasks, and what cannot be read, is ignored.
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

    /// Returns the text from which [`Self::resume`] continues: for each exercise that was handed
    /// in its key, attempts and best points, as `a1b2c3d4=2/7`.
    pub fn to_text(&self) -> String {
        let begun = self.tasks.iter().filter(|task| task.attempts > 0);
        let words: Vec<String> = begun.map(write_word).collect();
        words.join(" ")
    }

    /// Greatest length of the text, characters.
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

    /// Records a solution that was handed in. An attempt too many does not count.
    pub fn record(&mut self, id: &str, points: u32) {
        let mut tasks = self.tasks.iter_mut();
        if let Some(task) = tasks.find(|task| task.id == id && task.has_attempts_left()) {
            task.attempts += 1;
            task.best = task.best.max(points.min(task.max_points));
        }
    }

    /// Returns the numbers of exercises that were handed in, and of all.
    pub fn handed_in(&self) -> (usize, usize) {
        let begun = self.tasks.iter().filter(|task| task.attempts > 0);
        (begun.count(), self.tasks.len())
    }

    /// Returns the sum of the best points and the greatest sum.
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

    /// Returns the score from which the course is passed, per cent; `None` if it is only
    /// completed.
    pub const fn mastery_per_cent(&self) -> Option<u32> {
        self.mastery_per_cent
    }

    /// Returns the state.
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

/// The key of a task in the text of a progress: platforms restrict the characters of a text, a
/// folder may have any name.
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
