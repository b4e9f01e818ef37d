//! The edge of the program: window, kernel thread, command line, files. The only crate that
//! does I/O.

#![deny(clippy::print_stdout, clippy::print_stderr)]
#![allow(
    missing_docs,
    reason = "only this package uses its items: a name that says enough needs no comment"
)]

#[macro_use]
pub mod output;

pub mod board;
pub mod cli;
pub mod commands;
pub mod dnc;
pub mod files;
pub mod guard;
pub mod host_clock;
pub mod input_watch;
mod job;
pub mod kernel;
pub mod loading;
pub mod log;
mod message_format;
pub mod overwrite_guard;
pub mod pace;
pub mod pc;
pub mod picture;
pub mod pitch;
pub mod platform;
pub mod port_io;
pub mod ports;
pub mod project;
pub mod retained;
pub mod serial;
pub mod setup_args;
pub mod sound;
pub mod terminal;
pub mod termination;
pub mod transfer;
pub mod usage_hint;
pub mod window;
pub mod work_limit;
