//! The program with virtual boards in processes of their own, at the pace of the wall
//! clock. They mostly wait: on a quiet computer `RUST_TEST_THREADS=4` lets more of
//! them wait at a time.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

#[path = "common/at_board.rs"]
mod at_board;
mod board;
mod link_command;
mod operate_link;
mod partner_gone;
#[path = "common/process.rs"]
mod process;
mod run_link;
#[path = "common/twin.rs"]
mod twin;
