//! Threads and tapping on the simulated lathe: program, control, ladder, spindle.

#[path = "../bench/mod.rs"]
mod bench;
#[path = "../bench/program.rs"]
mod program;

mod alarms;
mod paths;
mod phase;
mod run;
mod stops;
mod tables;
mod taps;
