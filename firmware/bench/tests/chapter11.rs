//! The example of the manual's chapter 11: the board's step edges are the pulses that the control
//! commands, whole on the twin, and its first seconds in the emulator.
//!
//! `PICO_CHAPTER_S` is the number of seconds in the emulator, by default two.

mod machine;

use machine::{
    Emulated, Machine, PulseBoard, SpindleProfile, Twin, greatest_difference, other_positions, ups,
};

const PROGRAM: &str = include_str!("../../../assets/programs/04-manual-example.CNC");
/// Seconds in the emulator by default.
const DEFAULT_S: u32 = 2;
/// The spindle, which no output of these boards turns: the speed of the thread.
const SPINDLE: SpindleProfile = SpindleProfile {
    rpm: 100.0,
    ripple: 0.1,
    dip_ms: [0, 0],
    lost: 0.0,
};
/// Greatest difference of the positions of one axis at a step of the other, steps.
const MOST_STEPS_APART: i64 = 2;

/// Checks that the steps are the first pulses that the control has commanded.
fn assert_on_path<B: PulseBoard>(machine: &Machine<B>) {
    for axis in 0..2 {
        let (made, commanded) = (ups(&machine.steps, axis), &machine.commanded[axis]);
        assert!(commanded.starts_with(&made), "axis {axis}");
    }
}

#[test]
fn chapter_11_is_made_edge_by_edge() {
    let seconds = std::env::var("PICO_CHAPTER_S").map_or(DEFAULT_S, |text| text.parse().unwrap());
    let mut twin = Machine::<Twin>::referenced();
    twin.start_program(PROGRAM, SPINDLE);
    let is_over = twin.run_until(1_500_000, Machine::is_over);
    assert!(is_over && twin.alarms().is_empty(), "{:?}", twin.alarms());
    twin.run_ms(50);
    assert_on_path(&twin);
    let whole = [0, 1].map(|axis| ups(&twin.steps, axis).len());
    assert_eq!(whole, [0, 1].map(|axis| twin.commanded[axis].len()));
    println!(
        "twin: {:.1} s, {} edges",
        f64::from(twin.ran_ms) / 1000.0,
        twin.steps.len()
    );

    let mut emulated = Machine::<Emulated>::referenced();
    emulated.start_program(PROGRAM, SPINDLE);
    emulated.run_until(1000 * seconds, Machine::is_over);
    assert_eq!(emulated.alarms(), [""; 0]);
    assert_on_path(&emulated);
    let mut apart = 0;
    for axis in 0..2 {
        let made = ups(&emulated.steps, axis);
        assert!(ups(&twin.steps, axis).starts_with(&made), "axis {axis}");
        let positions = [&emulated.steps, &twin.steps].map(|steps| other_positions(steps, axis));
        apart = apart.max(greatest_difference(&positions[0], &positions[1]));
    }
    println!(
        "emulator: {:.1} s, {} edges, {apart} steps apart",
        f64::from(emulated.ran_ms) / 1000.0,
        emulated.steps.len()
    );
    assert!(apart <= MOST_STEPS_APART, "{apart}");
}
