//! States and rules of operation that do not need the control around them: run states, the
//! M/S/T handshake, PLC signals by name, the list of active alarms. `cnc` applies them.

mod active_alarms;
mod arrival;
mod automatic;
mod drives;
mod gear_speed;
mod handshake;
mod handwheel;
mod input_filter;
mod intervention;
mod limits;
mod manual;
mod output_timers;
mod sensors;
mod signals;
mod soft_switch;
mod thread;
mod thread_state;
mod zero_return;

pub use crate::mode::Mode;
pub use crate::run_state::RunState;
pub use active_alarms::ActiveAlarms;
pub(crate) use arrival::Arrival;
pub use automatic::Automatic;
pub(crate) use automatic::{Aside, Current, Stage, is_cut};
pub(crate) use drives::DriveWatch;
pub(crate) use gear_speed::check_gear_speed;
pub use handshake::{Handshake, Phase, Strobe};
pub(crate) use handwheel::WheelCounter;
pub use input_filter::InputFilter;
pub(crate) use input_filter::X_BYTES;
pub(crate) use limits::travel_alarm;
pub use manual::jog_rate;
pub(crate) use manual::{Direction, JOG_RATE_MAX};
pub(crate) use output_timers::OutputTimers;
pub use sensors::Sensors;
pub use signals::{FromPlc, ToPlc};
pub use soft_switch::SoftSwitch;
pub(crate) use soft_switch::Turning;
pub(crate) use thread::{
    AfterThread, STANDING_RPM, check_encoder, check_standing, check_thread_speed,
};
pub(crate) use thread_state::{Protection, TapStage};
pub(crate) use zero_return::Return;
