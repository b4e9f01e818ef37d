//! The exercises that come with the program.

use crate::task::ExerciseTask;

macro_rules! exercises {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../assets/exercises/", $name, "/task.ron")))),*]
    };
}

/// Names and texts of the built-in tasks, in the recommended order.
pub static EXERCISES: &[(&str, &str)] = exercises![
    "01-reference",
    "02-jog",
    "03-handwheel",
    "04-spindle",
    "05-tool-change",
    "06-mdi-move",
    "07-emergency-stop",
    "08-overtravel",
    "09-offset-entry",
    "10-offset-correction",
    "11-program-entry",
    "12-program-edit",
    "13-single-block",
    "14-feed-hold",
    "15-face-and-turn",
    "16-tool-setting",
    "17-size-correction",
    "18-groove",
    "19-taper",
    "20-radius",
    "21-thread",
    "22-roughing-cycle",
    "23-two-tools",
    "24-bore",
    "25-manual-example",
    "f01-turret-blocked",
    "f02-turret-unclamped",
    "f03-turret-contacts",
    "f04-spindle-blocked",
    "f05-encoder-lost",
    "f06-no-spindle-index",
    "f07-dog-stuck-x",
    "f08-no-index-z",
    "f09-limit-x",
    "f10-drive-z",
    "f11-slide-x-jammed",
    "f12-e-stop",
];

/// Reads the built-in tasks. A test checks that every one of them is valid.
pub fn built_in_tasks() -> Vec<ExerciseTask> {
    let read = EXERCISES
        .iter()
        .map(|(name, text)| ExerciseTask::read(name, name, text));
    read.filter_map(Result::ok).collect()
}
