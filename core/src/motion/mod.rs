//! Converts commands to one position per millisecond.
//!
//! Three speed laws, all integrated exactly (piecewise in closed form), so that the
//! duration of a block does not depend on its alignment with the ticks:
//!
//! Rapid (022/023 rate, 024/025 time to reach it): each axis separately, at constant
//! acceleration `a = rate / time`; a short distance never reaches the rate.
//!
//! ```text
//!  v │    ┌────────────┐             v │
//!    │   ╱              ╲              │    ╱╲
//!    │  ╱                ╲             │   ╱  ╲
//!    │ ╱                  ╲            │  ╱    ╲
//!    └──────────────────────► t        └───────────► t
//!      a     rate 022/023  -a             short way
//! ```
//!
//! Cutting (029 time constant T, 030 lowest speed FL, 027 limit): speed along the path. It
//! jumps to FL, approaches the feed F exponentially, and decreases in the same way, so that
//! FL is reached exactly at the end point. The braking curve is `v = FL + rest / T`, which
//! begins at the time `length / F`.
//!
//! ```text
//!  v │          . - - ──────┐            F (1 - e^(-t/T)) …
//!    │       .               \
//!    │     .                  '.
//!    │    ╱                     ' .      … e^(-t/T)
//!  FL├───┘                          '──┐
//!    └───┴──────────────────┴──────────┴─► t
//!        0              length/F       end
//! ```
//!
//! With 007.3 SMZ = 1 this applies to all cuts. With 007.3 = 0 a cut that follows another
//! begins when the command of the previous cut has ended, while the tool still follows it:
//! the corner is rounded and the speed is kept (see `lag`).
//!
//! Jog (029, 041 as lowest speed): the cutting law on one axis without an end point. Manual
//! rapid: the rapid law on one axis. A change between the two, or of the direction, passes
//! through a standstill (manual PLC «manual rapid selection»).
//!
//! ```text
//!  v │      . ────┐             jog, released: e^(-t/T) down to FL, then 0
//!    │    .        \
//!    │   ╱           ' .
//!  FL├──┘               '┐
//!    └────────────────────► t
//! ```
//!
//! Threads and taps have no own speed: they follow the spindle angle through an electronic
//! gear (see `gear`, `thread`, `tap`). Overrides and feed hold do not act on them.
//!
//! Feed hold, reset and an override of 0 % reduce the speed by the law in force. The
//! distance to go is kept, so that no position is lost.

mod duration;
mod external_cut;
mod external_tap;
mod gear;
mod inputs;
mod interpolator;
mod lag;
mod limits;
mod manual_axis;
mod path;
mod ramp;
mod rapid;
mod retrace;
mod spindle_follower;
mod straight_rapid;
mod tap;
mod thread;

#[cfg(test)]
mod lag_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod thread_tests;

pub(crate) use duration::path_length;
pub use duration::{CutChain, move_duration, top_speed};
pub use inputs::{DryRun, MotionInputs, RapidOverride};
pub use interpolator::Interpolator;
pub use limits::MotionLimits;
pub use manual_axis::JogRate;
pub(crate) use retrace::{PathBegin, Retrace};
pub use thread::ThreadMove;
