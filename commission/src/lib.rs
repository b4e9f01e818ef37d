//! A lathe set up: what is measured at it becomes parameters of its control (manual III-10
//! and III-12).
//!
//! ```text
//!   CSV, REN, RTL ──► Measurement ──► fit: pitch curve, backlash ──► plan: points, interval, origin
//!   readings of a step ────────────────────────────────────────► Proposal: Changes
//!                                      control's own requests ◄──┘   Undo: what was before
//! ```
//!
//! Nothing here moves an axis or writes a parameter: a [`Change`] is asked of the control by
//! whoever shows it, with the control's rights.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod change;
mod correction;
mod csv;
mod fit;
mod gear;
mod import;
mod intervals;
mod line;
mod measurement;
mod plan;
mod ren;
mod rtl;
mod steps;
mod table_file;
mod undo;

pub use change::{Change, Proposal};
pub use correction::{correction, interval_of};
pub use csv::write as write_csv;
pub use fit::{Curve, Fit, fit};
pub use gear::{Drive, Ratio, nearest_ratio};
pub use import::{read, read_of};
pub use line::FileFault;
pub use measurement::{Deviation, Direction, Measurement, Reading, Travel};
pub use plan::{Plan, PlanWish, plan};
pub use ren::{Imported, Table, write as write_ren};
pub use steps::{
    Backlash, DriveKind, GearMeasured, Lag, SpindleSpeed, Step, ZeroMethod, acceleration, backlash,
    direction, gear_from_drive, gear_measured, largest_lag, reference, spindle,
};
pub use table_file::add_table;
pub use undo::{Undo, Undone};
