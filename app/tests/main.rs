//! Tests of window, kernel and command line in one binary: a test is `subject::name`.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

mod acceptance;
mod command_line;
mod common;

mod crash;
mod dap;
mod data_view;
mod exercise_from_part;
mod first_start;
mod focus;
mod ladder_transfer;
mod lathe_view;
mod layouts;
mod lease;
mod lessons;
mod lsp;
mod machine_view;
mod network;
mod notices;
mod overwriting;
mod part;
mod pitch;
#[path = "common/process.rs"]
mod process;
mod program_debug;
mod program_forms;
mod program_port;
mod program_start;
mod program_view;
mod project;
#[cfg(unix)]
mod serial;
mod speed;
mod stop_keys;
mod streams;
mod timeline;
mod tips;
mod transfer;
#[cfg(unix)]
mod transfer_faults;
#[cfg(unix)]
mod transfer_view;
#[cfg(unix)]
mod transfer_worker;
mod trial_cuts;
#[cfg(unix)]
mod unix_files;
mod views;
mod window;
mod window_rows;
