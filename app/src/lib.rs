//! The command line: parses it and carries out its commands. The binary is built here.

#![deny(clippy::print_stdout, clippy::print_stderr)]
#![allow(
    missing_docs,
    reason = "only this package uses its items: a name that says enough needs no comment"
)]

#[macro_use]
extern crate gsk_host;

pub mod cli;
pub mod commands;
pub mod picture;
pub mod terminal;
pub mod usage_hint;
