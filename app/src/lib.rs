//! The edge of the program: window, kernel thread, command line, files. The only crate that
//! does I/O.

#![deny(clippy::print_stdout, clippy::print_stderr)]

#[macro_use]
pub mod output;

pub mod apart;
pub mod board;
pub mod carrier;
pub mod cli;
pub mod commands;
pub mod dnc;
pub mod ending;
pub mod files;
pub mod guard;
pub mod hint;
pub mod host_clock;
pub mod input_watch;
mod job;
pub mod kernel;
pub mod loading;
pub mod log;
pub mod pace;
pub mod pc;
pub mod person;
pub mod picture;
pub mod pitch;
pub mod platform;
pub mod ports;
pub mod project;
pub mod retained;
mod saying;
pub mod serial;
pub mod setup_args;
pub mod sound;
pub mod transfer;
pub mod window;
pub mod work_limit;
