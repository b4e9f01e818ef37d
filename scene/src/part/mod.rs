//! The part that is cut: its outline, threads, material and cut faces.

pub mod details;
pub mod material;
pub mod outline;
pub mod section_cut;
pub mod threads;
