//! From machine positions to drive pulses, and the software travel limits.

mod chain;
mod soft_limits;

pub(crate) use chain::motor_reversed;
pub use chain::{AxisChain, gear_speed_limit, least_increment, pulse_weight};
pub use soft_limits::SoftLimits;
