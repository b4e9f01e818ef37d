//! The example of the manual's chapter 11: the board's step edges are the pulses that the control
//! commands, whole on the twin; in the emulator the first pass of its thread and its first seconds.
//!
//! `PICO_CHAPTER_S` is the number of these seconds, by default ten.

mod machine;

use machine::{Emulated, Machine, PulseBoard, SpindleProfile, Step, Twin, paths_apart, ups};

const PROGRAM: &str = include_str!("../../../assets/programs/04-manual-example.CNC");
/// The blocks of the first pass of the thread, which the beginning of the program precedes.
const THREAD_BLOCKS: [&str; 7] = ["O", "G50", "N0010", "N0290", "N0300", "N0310", "N0340"];
/// Seconds of the program in the emulator by default.
const DEFAULT_S: u32 = 10;
/// The spindle, which no output of these boards turns: the speed of the thread.
const SPINDLE: SpindleProfile = SpindleProfile {
    rpm: 100.0,
    ripple: 0.1,
    dip_ms: [0, 0],
    lost: 0.0,
};
/// Greatest distance of the paths, steps.
const MOST_STEPS_APART: i64 = 2;

/// The program up to the first pass of its thread, without the blocks that cut before.
fn thread_program() -> String {
    let is_chosen = |line: &&str| THREAD_BLOCKS.iter().any(|start| line.starts_with(start));
    let blocks = PROGRAM.lines().filter(is_chosen).chain(["M30"]);
    blocks.map(|block| format!("{block}\n")).collect()
}

/// Checks that the steps are the first pulses that the control has commanded.
fn assert_on_path<B: PulseBoard>(machine: &Machine<B>, steps: &[Step]) {
    for axis in 0..2 {
        let (made, commanded) = (ups(steps, axis), &machine.commanded[axis]);
        assert!(commanded.starts_with(&made), "axis {axis}");
    }
}

/// Checks that the steps are all pulses that the control has commanded.
fn assert_whole<B: PulseBoard>(machine: &Machine<B>, steps: &[Step]) {
    assert_on_path(machine, steps);
    let commanded = machine.commanded[0].len() + machine.commanded[1].len();
    assert_eq!(steps.len(), commanded);
}

/// Checks that the steps in the emulator are the first ones on the twin.
fn assert_same(name: &str, seconds: f64, emulated: &[Step], twin: &[Step]) {
    for axis in 0..2 {
        let (made, on_twin) = (ups(emulated, axis), ups(twin, axis));
        assert!(on_twin.starts_with(&made), "{name}: axis {axis}");
    }
    let apart = paths_apart(emulated, &twin[..emulated.len()]);
    let edges = emulated.len();
    println!("{name} in the emulator: {seconds:.1} s, {edges} edges, {apart} steps apart");
    assert!(apart <= MOST_STEPS_APART, "{name}: {apart}");
}

fn seconds_of<B>(machine: &Machine<B>) -> f64 {
    f64::from(machine.ran_ms) / 1000.0
}

#[test]
fn chapter_11_is_made_edge_by_edge() {
    let seconds = std::env::var("PICO_CHAPTER_S").map_or(DEFAULT_S, |text| text.parse().unwrap());
    let mut twin = Machine::<Twin>::referenced();
    let thread = twin.run_program(&thread_program(), SPINDLE);
    assert_whole(&twin, &thread);
    let whole = twin.run_program(PROGRAM, SPINDLE);
    assert_whole(&twin, &whole);
    println!("twin: {:.1} s, {} edges", seconds_of(&twin), whole.len());

    let mut emulated = Machine::<Emulated>::referenced();
    let steps = emulated.run_program(&thread_program(), SPINDLE);
    assert_whole(&emulated, &steps);
    assert_same("thread", seconds_of(&emulated), &steps, &thread);
    emulated.start_program(PROGRAM, SPINDLE);
    emulated.run_until(1000 * seconds, Machine::is_over);
    assert_eq!(emulated.alarms(), [""; 0]);
    let steps = std::mem::take(&mut emulated.steps);
    assert!(steps.len() > 1000, "{} edges", steps.len());
    assert_on_path(&emulated, &steps);
    assert_same("program", seconds_of(&emulated), &steps, &whole);
}
