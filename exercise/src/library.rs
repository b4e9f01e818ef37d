//! The exercises that come with the program.

use crate::task::ExerciseTask;

macro_rules! exercises {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../assets/exercises/", $name, "/task.ron")))),*]
    };
}

/// Names and texts of the built-in tasks, in the order in which a learner takes them.
pub static EXERCISES: &[(&str, &str)] = exercises![
    "01-reference",
    "02-spindle",
    "03-face-and-turn",
];

/// Reads the built-in tasks. A test checks that every one of them is valid.
pub fn built_in_tasks() -> Vec<ExerciseTask> {
    let read = EXERCISES
        .iter()
        .map(|(name, text)| ExerciseTask::read(name, name, text));
    read.filter_map(Result::ok).collect()
}
