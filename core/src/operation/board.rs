//! The real drives behind a pulse board, as the control sees them.

mod checked;
mod rates;
mod spindle;
mod zero;

use crate::units::PerAxis;
pub(crate) use checked::{Checked, board_rates};
use gsk_link::{PulseRates, ThreadRights};
pub(crate) use spindle::{BoardSpindle, SpindleTrouble, why_not};
pub(crate) use zero::ZeroWiring;

/// The drives behind a board, as the control sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoardDrives {
    /// Motion is taken.
    pub takes_motion: bool,
    /// Motion is taken from this tick on, not only after an order under way.
    pub prepared: bool,
    /// The place of the slides is known.
    pub known: bool,
    /// Motion was handed over that has not been made yet.
    pub behind: bool,
    /// Ticks of motion that may not have been made yet.
    pub ahead: u64,
    /// Stops so far behind which the control went on from another place.
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
    pub threads: ThreadRights,
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
    /// The board looks at the switch that the return of the axis waits for.
    pub armed: PerAxis<bool>,
    /// The parameters that it was checked against.
    pub checked: Option<Checked>,
}
