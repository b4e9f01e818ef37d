//! Converts machine positions to drive pulses (backlash, pitch errors, electronic gear) and
//! checks the software travel limits.

mod backlash;
mod chain;
mod pitch;
mod soft_limits;

pub(crate) use chain::is_motor_reversed;
pub(crate) use chain::least_increment;
pub use chain::{AxisChain, gear_speed_limit, pulse_weight};
pub use pitch::PitchCurve;
pub use soft_limits::SoftLimits;
