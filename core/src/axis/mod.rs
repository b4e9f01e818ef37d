//! From machine positions to drive pulses: backlash, pitch errors, electronic gear;
//! and the software travel limits.

mod backlash;
mod chain;
mod pitch;
mod soft_limits;

pub(crate) use chain::motor_reversed;
pub use chain::{AxisChain, gear_speed_limit, least_increment, pulse_weight};
pub use soft_limits::SoftLimits;
