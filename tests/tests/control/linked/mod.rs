//! The whole control with a board in place of its simulated slides, in virtual time: the board
//! makes what the kernel commands, and every stop is a defined one.

mod absence;
mod alarms;
mod checks;
mod faults;
mod limits;
mod lines;
mod long_run;
mod models;
mod motion;
mod parameters;
mod passes;
mod path;
mod programs;
mod reference;
pub mod restart;
mod retrace;
mod states;
mod stop_position;
mod stops;

use super::bench::board::{BenchBoard, LinkedMachine};
use gsk_twins::grbl::Variant;

/// The firmwares that read lines.
const LINES: [Variant; 3] = [Variant::Grbl, Variant::GrblHal, Variant::FluidNc];

const SHAFT: &str = include_str!("../../../../assets/programs/01-stepped-shaft.CNC");
const BUSHING: &str = include_str!("../../../../assets/programs/02-bushing.CNC");
const PIN: &str = include_str!("../../../../assets/programs/03-grooved-pin.CNC");
const GROOVE: &str = include_str!("../../../../assets/programs/O1031.CNC");

/// A short part: rapids, a cut, an arc, spindle and coolant.
const SHORT: &str = "O9\nN10 G50 X60 Z20\nN20 G98 G97 S500 M03\nN30 G00 X40 Z5 M08\n\
    N40 G01 Z-10 F300\nN50 G02 X50 Z-15 R5\nN60 G01 X52\nN70 G04 X0.2\n\
    N80 G00 X60 Z20\nN90 M05\nN95 M09\nN99 M30\n";

#[track_caller]
fn assert_counts_agree<T: BenchBoard>(machine: &LinkedMachine<T>) {
    let stood = machine.simulation.cnc.pulses();
    assert_eq!(machine.made_pulses(), [stood.x.0, stood.z.0]);
}
