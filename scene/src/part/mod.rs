//! The part that is cut: its outline, threads and material.

pub mod material;
pub mod outline;
pub mod threads;
