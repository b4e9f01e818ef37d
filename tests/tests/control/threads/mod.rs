//! Threads and tapping on the simulated lathe: program, control, ladder, spindle.

mod alarms;
mod paths;
mod phase;
mod run;
mod stops;
mod tables;
mod taps;
