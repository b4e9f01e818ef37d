//! Threads (G32, G33, G34, G76, G92): one pass, and the cycles of them.

pub(super) mod compound_thread;
pub(super) mod counted_thread;
pub(super) mod lead_word;
pub(super) mod single_pass;
pub(super) mod tapping;
pub(super) mod thread;
pub(super) mod thread_cycle;
