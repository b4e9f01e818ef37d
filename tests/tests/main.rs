//! Tests that cases cannot express: properties, coverage of tables, determinism. A test is
//! `subject::name`.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

mod alarm_coverage;
mod board_path;
mod board_recording;
mod causes;
mod code_words;
mod collisions;
mod decisions;
mod dependencies;
mod determinism;
mod documents;
mod edit_keys;
mod fault_coverage;
mod fuzz_corpus;
mod help;
mod hostile_input;
mod language;
mod machine_files;
mod model_facts;
mod models;
mod numbers;
mod pages;
mod parameter_coverage;
mod port;
mod project;
mod properties;
mod protections;
mod runner;
mod samples;
mod saved_state;
mod signal_facts;
mod type_names;
mod vocabulary;
mod window_texts;
