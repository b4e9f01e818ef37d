//! States and rules of operation that do not need the control around them: run states, the
//! M/S/T handshake, PLC signals by name, the list of active alarms. `cnc` applies them.

mod active_alarms;
mod automatic;
mod drive_watch;
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
mod speed_arrival;
mod thread;
mod thread_state;
mod zero_return;

pub use crate::mode::OperatingMode;
pub use crate::run_state::RunState;
pub use active_alarms::ActiveAlarms;
pub use automatic::{AutomaticRun, PreparedRestart};
pub(crate) use automatic::{CommandStage, CurrentCommand, RunContinuation, SuspendedRun, is_cut};
pub(crate) use drive_watch::DriveWatch;
pub(crate) use gear_speed::check_gear_speed;
pub use handshake::{Handshake, HandshakePhase, Strobe};
pub(crate) use handwheel::WheelCounter;
pub use input_filter::InputFilter;
pub(crate) use input_filter::X_BYTES;
pub(crate) use limits::travel_alarm;
pub use manual::jog_rate;
pub(crate) use manual::{AxisDirection, JOG_RATE_MAX};
pub(crate) use output_timers::OutputTimers;
pub use sensors::Sensors;
pub use signals::{FromPlc, ToPlc};
pub use soft_switch::SoftSwitch;
pub(crate) use soft_switch::SoftSwitchChange;
pub(crate) use speed_arrival::SpeedArrival;
pub(crate) use thread::{
    AfterThread, STANDSTILL_RPM, check_encoder, check_spindle_turns, check_thread_speed,
};
pub(crate) use thread_state::{HoldProtection, TapStage};
pub(crate) use zero_return::ZeroReturnStage;
