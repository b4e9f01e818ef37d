//! What connects control and computer: kernel thread, ports and boards, the guard of a
//! board, files, retained memory, sound, and everything that differs by system.

#![deny(clippy::print_stdout, clippy::print_stderr)]
#![allow(
    missing_docs,
    reason = "only this workspace uses its items: a name that says enough needs no comment"
)]

#[macro_use]
pub mod output;

pub mod board;
pub mod files;
pub mod flight;
pub mod guard;
pub mod input_watch;
pub mod job;
pub mod kernel;
pub mod loading;
pub mod log;
pub mod message_format;
pub mod network;
pub mod pc;
pub mod platform;
pub mod ports;
pub mod preview;
pub mod project;
pub mod retained;
pub mod serial;
pub mod setup_args;
pub mod sound;
pub mod termination;
pub mod transfer;
