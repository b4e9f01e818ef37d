//! From commands to one position per millisecond.
//!
//! Three laws of speed, all integrated exactly (piecewise in closed form), so that
//! a block takes the same time however it falls on the ticks:
//!
//! Rapid (022/023 rate, 024/025 time to reach it): each axis for itself, at constant
//! acceleration `a = rate / time`; a short way never reaches the rate.
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
//! Cutting (029 time constant T, 030 lowest speed FL, 027 clamp): speed along the
//! path; it jumps to FL, approaches the feed F exponentially, and comes down the
//! same way so that FL is reached exactly at the end point. The braking curve is
//! `v = FL + rest / T`, met at the time `length / F`.
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
//! With 007.3 SMZ = 1 every cut does so. With 007.3 = 0 a cut that follows another
//! begins when the command of the one before has come to its end, while the tool
//! still follows: the corner is rounded, the speed kept (see `lag`).
//!
//! Jog (029, 041 as lowest speed): the cutting law on one axis without an end
//! point. Manual rapid: the rapid law on one axis. Changing between the two, or
//! the direction, goes through standstill (manual PLC «manual rapid selection»).
//!
//! ```text
//!  v │      . ────┐             jog, released: e^(-t/T) down to FL, then 0
//!    │    .        \
//!    │   ╱           ' .
//!  FL├──┘               '┐
//!    └────────────────────► t
//! ```
//!
//! Threads and taps have no speed of their own: they follow the angle of the spindle
//! through an electronic gear (see `gear`, `thread`, `tap`); overrides and feed hold
//! do not act on them.
//!
//! Feed hold, reset and an override of 0 % bring the speed down by the law in
//! force; the distance left is kept, so that going on loses no position.

mod driven;
mod duration;
mod follower;
mod gear;
mod inputs;
mod interpolator;
mod jog;
mod lag;
mod limits;
mod path;
mod ramp;
mod rapid;
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
pub use duration::{Sequel, duration, top_speed};
pub use inputs::{DryRun, MotionInputs, RapidOverride};
pub use interpolator::Interpolator;
pub use jog::JogRate;
pub use limits::MotionLimits;
pub use thread::ThreadMove;
