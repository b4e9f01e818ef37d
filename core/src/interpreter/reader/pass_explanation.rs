//! Finds the cycle that explains a pass.

use crate::interpreter::cycles::box_cycle;
use crate::interpreter::cycles::pattern;
use crate::interpreter::cycles::pecking;
use crate::interpreter::cycles::roughing;
use crate::interpreter::cycles::stepped;
use crate::interpreter::moves::explanation::{Explanation, PassNote};
use crate::interpreter::threads::compound_thread;
use crate::interpreter::threads::counted_thread;
use crate::interpreter::threads::single_pass;
use crate::interpreter::threads::tapping;
use crate::interpreter::threads::thread_cycle;

/// Returns the explanation of a cycle pass; `None` if the move has nothing to explain.
pub(super) fn explain_pass(note: PassNote) -> Option<Explanation> {
    match note {
        PassNote::None => None,
        PassNote::Box { .. } => box_cycle::explain_box(note),
        PassNote::Thread { .. } => thread_cycle::explain_thread_start(note),
        PassNote::Tap { .. } => tapping::explain_tap(note),
        PassNote::ThreadPass { .. } => compound_thread::explain_thread_pass(note),
        PassNote::Level { .. } => roughing::explain_level(note),
        PassNote::Contour { .. } => roughing::explain_contour_pass(note),
        PassNote::Shifted { .. } => pattern::explain_shifted_pass(note),
        PassNote::Column { .. } => pecking::explain_column(note),
        PassNote::Stepped { .. } => stepped::explain_step(note),
        PassNote::SinglePass { .. } => single_pass::explain_single_pass(note),
        PassNote::CountedThread { .. } => counted_thread::explain_counted_pass(note),
    }
}
