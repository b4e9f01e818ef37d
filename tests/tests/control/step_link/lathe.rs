//! A machine whose spindle the board drives and measures.

use gsk_core::setup::Setup;
use gsk_link::LinkConfig;
use gsk_twins::klipper::{KlipperHardware, SpindleWiring};

use super::bench::WIRED;
use super::machine::StepMachine;

/// The wires of a machine file, optionally without its index.
fn wires(index: bool) -> LinkConfig {
    let wired = if index { ", index: \"PC3\"" } else { "" };
    let text = WIRED.replace(", index: \"PC3\"", "").replace(
        "spindle_cw: \"PB4\"",
        &format!("spindle_cw: \"PB4\", spindle_ccw: \"PB5\"{wired}"),
    );
    let config: LinkConfig = ron::from_str(&text).unwrap();
    config.check().unwrap();
    config
}

/// Referenced, with gear 1/5: a pulse of Z is 5 µm. Its steps are recorded.
pub fn referenced_lathe(index: bool, parameters: &[(u16, i32)]) -> StepMachine {
    referenced_lathe_with(KlipperHardware::default(), index, parameters)
}

/// The same with another board.
pub fn referenced_lathe_with(
    make: KlipperHardware,
    index: bool,
    parameters: &[(u16, i32)],
) -> StepMachine {
    let mut setup = Setup::delivered();
    setup.memory.parameters.set(37, 2000).unwrap();
    for (number, value) in parameters {
        setup.memory.parameters.set(*number, *value).unwrap();
    }
    let mut machine = StepMachine::one_switch(make, wires(index), setup);
    machine.twin.attach_spindle(SpindleWiring {
        index_pin: "PC3",
        forward_pin: "PB4",
        reverse_pin: "PB5",
        speed_pin: "PH6",
        full_speed_rpm: 2000.0,
        time_constant_s: 0.2,
    });
    machine.return_axes();
    machine.twin.start_recording_steps();
    machine
}
