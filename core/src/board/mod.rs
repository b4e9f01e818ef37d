//! What passes between the control and a pulse board that makes its motion, tick by
//! tick: the board's part of [`Inputs`](crate::machine::Inputs) and
//! [`Outputs`](crate::machine::Outputs).

mod checked;
mod orders;
mod rates;
mod report;
mod spindle;
mod zero;

use crate::units::PerAxis;
pub(crate) use checked::{Checked, board_rates};
use gsk_link::{AwaitedInput, PulseRates, ThreadCapability};
use gsk_plc::address::BitAddress;
pub(crate) use orders::{BoardOrders, ReturnOrders, RunOrders, SpindleOrders};
pub(crate) use rates::Exceeding;
pub(crate) use report::{BoardReport, Settled};
pub(crate) use spindle::{BoardSpindle, SpindleTrouble, needs_spindle};
pub(crate) use zero::ZeroWiring;

/// What a board says to the control before a tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BoardInputs {
    /// How it stands with the drives behind it.
    pub drives: BoardDrives,
    /// What has happened since the last tick, in its order.
    pub reports: Vec<BoardReport>,
    /// Outputs of the ladder that the board has dropped by itself, and keeps so.
    pub dropped: Vec<BitAddress>,
    /// The part that is made of a pass of a thread.
    pub pass_made: Option<f64>,
    /// The slides stand, and the board has said where; none: not known yet.
    pub settled: Option<Settled>,
}

/// The drives behind a board, as the control sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoardDrives {
    /// Motion is taken.
    pub takes_motion: bool,
    /// Motion is taken from this tick on, not only after an order under way.
    pub prepared: bool,
    /// The board moves by motion that it was given.
    pub moving: bool,
    /// The position of the slides is known.
    pub known: bool,
    /// Motion was handed over that has not been made yet.
    pub behind: bool,
    /// Ticks of motion that may not have been made yet.
    pub ahead: u64,
    /// Stops so far after which the control went on from another position.
    pub stops: u64,
    /// Spindle or coolant have still to be switched before the axes go on.
    pub switching: bool,
    /// Spindle and coolant switch at their place in the motion, without a standstill.
    pub timed: bool,
    /// The spindle speed follows the motion.
    pub surface: bool,
    /// Most pulses a second.
    pub rates: PulseRates,
    /// Pulses per mm of slide travel.
    pub pulses_per_mm: [f64; 2],
    /// Which threads it cuts.
    pub threads: ThreadCapability,
    /// The spindle whose index the board sees; none: it stays the simulated one.
    pub spindle: Option<BoardSpindle>,
    /// A pass that the board cuts begins without a ramp: not faster than this,
    /// mm/min.
    pub pass_speed: f64,
    /// The return of one axis leaves the other where it is.
    pub alone: bool,
    /// What the axes return to when the control drives the return; none: the board
    /// makes it by itself.
    pub zero: Option<PerAxis<ZeroWiring>>,
    /// The switch at which the board is ready to stop the axis.
    pub armed: PerAxis<Option<AwaitedInput>>,
    /// The parameters that it was checked against.
    pub checked: Option<Checked>,
}
