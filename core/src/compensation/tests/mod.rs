//! Worked cases and properties.

mod cases;
mod clearance;
