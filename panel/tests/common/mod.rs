//! Sets up a lathe with programs in its memory.

use gsk_core::cnc::ControlRequest;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

/// The turned contour of the manual's acceptance program (chapter III-11).
pub const PROGRAM: &str = "O0001;
N0000 G0 X150 Z185;
N0010 M3 S300;
N0040 G0 X136 Z180;
N0060 G0 X16;
N0070 G1 Z153 F1000;
N0080 X40;
N0100 W-63;
N0110 G3 X80 W-20 R20;
N0120 G2 X120 W-20 R20;
N0130 G1 W-20;
N0140 G1 X130 W-5;
N0150 G1 W-25;
N0160 G0 X150 Z185;
N0390 M30;
%
";

/// Contacts of the mode keys and of the cycle start key.
pub const EDIT: BitAddress = key(20, 0);
pub const AUTO: BitAddress = key(20, 1);
pub const HANDWHEEL: BitAddress = key(20, 4);
pub const JOG: BitAddress = key(20, 5);
pub const SINGLE_BLOCK: BitAddress = key(20, 6);
pub const CYCLE_START: BitAddress = key(25, 0);
pub const FEED_HOLD: BitAddress = key(24, 7);

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::X, byte, bit)
}

/// A lathe with a few programs in its memory, O0001 selected.
pub fn lathe() -> Simulation {
    lathe_from(Setup::default())
}

/// The same lathe with a given setup.
pub fn lathe_from(mut setup: Setup) -> Simulation {
    for number in [8, 23, 88, 1000] {
        let text = format!("O{number:04};\nG50 X0 Z0;\nM3 S2;\nM30;\n%\n");
        setup.memory.programs.store(text).unwrap();
    }
    setup.memory.programs.store(PROGRAM).unwrap();
    let mut simulation = Simulation::new(setup);
    ticks(&mut simulation, 200);
    simulation
        .cnc
        .request(ControlRequest::SelectProgram(1))
        .unwrap();
    simulation
}

/// Runs a number of ticks.
pub fn ticks(simulation: &mut Simulation, count: u32) {
    for _ in 0..count {
        simulation.tick();
    }
}

/// Presses a key for 100 ms, then waits 100 ms.
pub fn press(simulation: &mut Simulation, key: BitAddress) {
    for down in [true, false] {
        simulation.cnc.set_panel_key(key, down);
        ticks(simulation, 100);
    }
}
