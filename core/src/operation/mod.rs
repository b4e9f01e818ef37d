//! Operating modes and run states, the M/S/T handshake, reset, emergency stop,
//! manual motion, zero return, travel limits, and the list of active alarms.

mod active_alarms;
mod arrival;
mod automatic;
mod board;
mod drives;
mod execution;
mod gear_speed;
mod handshake;
mod handwheel;
mod input_filter;
mod interlock;
mod intervention;
mod limits;
mod manual;
mod mode;
mod reset;
mod sensors;
mod signals;
mod soft_switch;
mod thread;
mod zero_return;

pub use active_alarms::ActiveAlarms;
pub(crate) use active_alarms::EMERGENCY_STOP;
pub use automatic::{Automatic, RunState};
pub(crate) use board::{BoardDrives, BoardSpindle, SpindleTrouble, ZeroWiring};
pub(crate) use drives::DriveWatch;
pub(crate) use gear_speed::check_gear_speed;
pub use handshake::{Handshake, Phase, Strobe};
pub(crate) use handwheel::WheelCounter;
pub use input_filter::{InputFilter, X_BYTES};
pub(crate) use manual::JOG_RATE_MAX;
pub use manual::jog_rate;
pub use mode::Mode;
pub use sensors::Sensors;
pub use signals::{FromPlc, ToPlc};
pub use soft_switch::SoftSwitch;
pub(crate) use thread::{check_encoder, check_standing, check_thread_speed};
pub(crate) use zero_return::Return;
