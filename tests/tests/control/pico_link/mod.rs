//! Tests the link with our own pulse board against its twin, which runs the engine of the
//! firmware: threads on the true angle of the spindle, lease, guards, encoders.

mod faults;
mod machine;
mod random_faults;
mod restart;
mod stops;
mod taps;
mod threads;
mod wheel;
