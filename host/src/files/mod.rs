//! Files on the disk: programs, jobs, lessons, exercises and the data directory.

pub mod atomic;
pub mod data_dir;
pub mod decode;
pub mod exams;
pub mod exercise_key;
pub mod exercises;
pub mod folders;
pub mod lessons;
mod manifest;
pub mod mirrored_files;
pub mod models;
pub mod overwrite_guard;
pub mod pitch;
pub mod program_file;
pub mod subprograms;
pub mod time;
pub mod tool_library;
pub mod tool_tables;
