//! Exercises that mark themselves: the file of a task, the judge that replays a recording of a
//! learner's work, and the report with the points.
//!
//! ```text
//! task.ron ──► ExerciseTask ──► start state
//!                   │               │
//!   recording ──────┴──► judge ◄────┘ ──► ExerciseReport
//! ```
//!
//! The judge reads the machine after every tick and never the screen. The same task and the
//! same recording give the same report on every computer.

#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod check;
pub mod course;
pub mod criterion;
mod criterion_file;
pub mod draft;
pub mod drawing;
pub mod exam;
mod input_guard;
pub mod judge;
pub mod library;
pub mod mark;
pub mod mark_table;
mod outline;
pub mod outline_writer;
pub mod part_size;
mod procedure;
pub mod report;
pub mod result_file;
pub mod seal;
pub mod solution_recorder;
mod solution_replay;
pub mod solve;
pub mod task;
