//! Exchange between the control and the pulse board that makes its motion, tick by tick:
//! the board's part of [`MachineInputs`](crate::machine::MachineInputs) and
//! [`MachineOutputs`](crate::machine::MachineOutputs).

mod checked;
mod orders;
mod rates;
mod report;
mod spindle;
mod zero;

use crate::units::PerAxis;
pub(crate) use checked::{CheckedParameters, board_rates};
use gsk_link::{AwaitedInput, PulseRates, TapCapability, ThreadCapability};
use gsk_plc::address::BitAddress;
pub(crate) use orders::{BoardOrders, ReturnOrders, RunOrders, SpindleOrders};
pub(crate) use rates::ExceededAxes;
pub(crate) use report::{BoardReport, Standstill};
pub(crate) use spindle::{BoardSpindle, SpindleFault, spindle_required_message};
pub(crate) use zero::ZeroWiring;

/// The reports of a pulse board to the control before a tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BoardInputs {
    /// State and abilities of the board and its drives.
    pub drives: BoardDrives,
    /// Reports of the board since the last tick, in order.
    pub reports: Vec<BoardReport>,
    /// Outputs of the ladder that the board has switched off and keeps off.
    pub dropped: Vec<BitAddress>,
    /// Fraction of the thread pass that the board has made, 0–1; `None` without a pass.
    pub pass_fraction: Option<f64>,
    /// Depth of the tap at the angle that the board last reported, mm; `None` without a tap.
    pub tap_depth_mm: Option<f64>,
    /// What the board knows about the position of the slides, while they are at standstill; `None`
    /// otherwise.
    pub standstill: Option<Standstill>,
}

/// The board and its drives as the control sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoardDrives {
    /// Whether the board accepts motion, immediately or after the order that it executes.
    pub takes_motion: bool,
    /// Whether the board accepts motion from this tick on, without waiting for an order to end.
    pub is_prepared: bool,
    /// Whether the board is executing motion from its queue.
    pub is_moving: bool,
    /// Whether the position of the slides is known.
    pub position_known: bool,
    /// Whether the board holds motion that it has not executed.
    pub has_pending_motion: bool,
    /// Ticks of commanded motion that the board may not have executed yet.
    pub ticks_ahead: u64,
    /// Number of stops since the connection after which the control continued from another
    /// position.
    pub resync_count: u64,
    /// Whether the axes must wait because the board is still switching spindle or coolant.
    pub outputs_switching: bool,
    /// Whether the board switches spindle and coolant at their position in the motion,
    /// without a standstill.
    pub has_timed_outputs: bool,
    /// Whether the board changes the spindle speed at its position in the motion, without a
    /// standstill.
    pub speed_follows_motion: bool,
    /// Highest pulse rates of the board, in pulses per second.
    pub rates: PulseRates,
    /// Pulses per mm of slide travel, for X and Z.
    pub pulses_per_mm: [f64; 2],
    /// Which threads the board can cut, or what is missing for threads.
    pub threads: ThreadCapability,
    /// Whether the board can tap, or what is missing.
    pub taps: TapCapability,
    /// The spindle whose index the board measures; `None`: the simulated spindle applies.
    pub spindle: Option<BoardSpindle>,
    /// Highest speed of a thread pass that the board cuts, mm/min: the pass begins without
    /// a ramp.
    pub pass_speed_mm_per_min: f64,
    /// Whether the board's homing moves one axis without the other.
    pub homes_axes_separately: bool,
    /// Switches for a reference return that the control drives; `None`: the board does its
    /// own homing.
    pub zero_wiring: Option<PerAxis<ZeroWiring>>,
    /// Input at which the board is armed to stop each axis; `None`: not armed.
    pub armed_inputs: PerAxis<Option<AwaitedInput>>,
    /// The parameters that the board was configured with; `None` before a board is
    /// connected.
    pub checked_parameters: Option<CheckedParameters>,
}
