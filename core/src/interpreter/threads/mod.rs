//! Threads: single passes and cycles (G32, G33, G34, G76, G92, and those of the Huaxing
//! lathes).

pub(super) mod compound_thread;
pub(super) mod counted_thread;
pub(super) mod lead_word;
pub(super) mod single_pass;
pub(super) mod tapping;
pub(super) mod thread;
pub(super) mod thread_cycle;
