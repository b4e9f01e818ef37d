//! Worked cases and property tests of compensation C.

mod cases;
mod clearance;
mod distances;
mod random_programs;
mod tangents;
