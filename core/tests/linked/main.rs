#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]
//! The whole control with a board in place of its simulated slides, in virtual time:
//! what the kernel commands is what the board makes, and every stop is a defined one.

mod alarms;
#[path = "../bench/board.rs"]
mod board;
mod checks;
mod faults;
mod lines;
mod motion;
mod passes;
mod programs;
mod reference;
mod shift;
mod states;
mod stops;
mod way;

use board::{Board, Machine};

const SHAFT: &str = include_str!("../../../assets/programs/01-stepped-shaft.CNC");
const BUSHING: &str = include_str!("../../../assets/programs/02-bushing.CNC");
const PIN: &str = include_str!("../../../assets/programs/03-grooved-pin.CNC");
const GROOVE: &str = include_str!("../../../assets/programs/O1031.CNC");

/// A short part: rapids, a cut, an arc, spindle and coolant.
const SHORT: &str = "O9\nN10 G50 X60 Z20\nN20 G98 G97 S500 M03\nN30 G00 X40 Z5 M08\n\
    N40 G01 Z-10 F300\nN50 G02 X50 Z-15 R5\nN60 G01 X52\nN70 G04 X0.2\n\
    N80 G00 X60 Z20\nN90 M05\nN95 M09\nN99 M30\n";

/// Numbers that look random and are the same each time.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((self.0 >> 33) % u64::from(most)) as u32
    }
}

/// More rounds with `ROUNDS=200` in the environment.
fn rounds(usual: u32) -> u32 {
    let wanted = std::env::var("ROUNDS").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(usual)
}

#[track_caller]
fn assert_together<T: Board>(machine: &Machine<T>) {
    let stood = machine.simulation.cnc.pulses();
    assert_eq!(machine.made(), [stood.x.0, stood.z.0]);
}
