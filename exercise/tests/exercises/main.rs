//! The shipped exercises with their solutions, and altered results.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod alterations;
mod drafts;
mod limits;
mod overload;
mod part_drafts;
mod shipped;

use std::fs;
use std::path::{Path, PathBuf};

use gsk_exercise::task::ExerciseTask;

fn exercises_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/exercises")
}

fn read_file(name: &str, file: &str) -> String {
    fs::read_to_string(exercises_folder().join(name).join(file)).expect("a file of an exercise")
}

fn read_task(name: &str) -> ExerciseTask {
    ExerciseTask::read(name, name, &read_file(name, "task.ron")).expect("a task")
}
