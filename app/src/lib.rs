//! The edge of the program: window, kernel thread, command line, files.

pub mod board;
pub mod carrier;
pub mod cli;
pub mod commands;
pub mod ending;
pub mod execution;
pub mod files;
pub mod hint;
pub mod kernel;
pub mod loading;
pub mod moves;
pub mod pace;
pub mod picture;
pub mod ports;
pub mod report;
pub mod retained;
pub mod setup_args;
pub mod transfer;
pub mod window;
