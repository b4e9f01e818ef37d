//! Commissioning of a lathe: converts measurements to parameters of its control (manual III-10
//! and III-12).
//!
//! ```text
//!   CSV, REN, RTL ──► Measurement ──► fit: pitch curve, backlash ──► plan: points, interval, origin
//!   readings of a step ────────────────────────────────────────► Proposal: ParameterChange
//!                                      control requests ◄───────┘   UndoList: values before
//! ```
//!
//! This crate moves no axis and writes no parameter. The caller sends each [`ParameterChange`] to
//! the control as a request, and the control checks the rights.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod correction;
mod csv;
mod file_line;
mod gear_ratio;
mod import;
mod measurement;
mod parameter_change;
mod pitch_plan;
mod renishaw_ren;
mod renishaw_rtl;
mod screw_fit;
mod steps;
mod table_file;
mod table_interval;
mod undo_list;

pub use correction::{compute_correction, pitch_interval};
pub use csv::write as write_csv;
pub use file_line::FileFault;
pub use gear_ratio::{DriveTrain, GearRatio, find_nearest_ratio};
pub use import::{read_measurement_file, read_measurement_file_with_axes};
pub use measurement::{ApproachDirection, AxisDeviation, AxisReading, Measurement, SlideTravel};
pub use parameter_change::{ParameterChange, Proposal};
pub use pitch_plan::{PitchPlan, PitchPlanOptions, plan_pitch_table};
pub use renishaw_ren::{ImportedFile, PitchTableFile, PitchTableRow, write as write_ren};
pub use screw_fit::{DeviationCurve, ScrewFit, fit_screw};
pub use steps::{
    BacklashReading, CommissioningStep, DriveKind, FollowingErrorReading, MeasuredMove,
    SpindleSpeed, ZeroMethod, propose_acceleration, propose_backlash, propose_direction,
    propose_gear_from_drive, propose_gear_from_move, propose_rapid_rate, propose_reference,
    propose_spindle,
};
pub use table_file::propose_table_values;
pub use undo_list::{UndoEntry, UndoList};
