//! The execution of the selected program beside the control, for the machine view.

pub(super) mod changed_jobs;
pub(super) mod exchange;
mod placed_path;
mod thread;
pub(super) mod worker;
