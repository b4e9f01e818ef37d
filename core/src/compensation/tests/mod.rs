//! Worked cases and properties.

mod cases;
mod clearance;
mod distances;
mod random_programs;
mod tangents;
