//! Previews of programs: the setup they start with, and the limits of their work.

pub(crate) mod setup;
pub mod work_limit;
