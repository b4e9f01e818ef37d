//! Random programs of the control on the built firmware in the emulator and on the twin: the same
//! steps, each step of a thread at the same count of the spindle.
//!
//! `PICO_PROGRAMS=0..100` runs the programs with these numbers, by default the first three.

mod machine;

use machine::{
    COUNTS, Emulated, Machine, SpindleProfile, Step, Twin, greatest_difference, paths_apart, ups,
};

/// Programs that run by default.
const DEFAULT_PROGRAMS: std::ops::Range<u64> = 0..3;
/// Greatest difference of the counts of a step of a thread: the tolerance of the segments (twice an
/// eighth of a step), the angle of the index, and the time from the count to the step.
const MOST_COUNTS_APART: i64 = 12;
/// Greatest distance of the paths, steps.
const MOST_STEPS_APART: i64 = 2;
/// Radius below which only threads move Z, pulses of X: the diameter 31.
const THREAD_BELOW_MM: f64 = 31.0;

/// Numbers that are always the same for a seed.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Returns a multiple of `step` from `least` to `most`.
    fn between(&mut self, least: f64, most: f64, step: f64) -> f64 {
        let count = ((most - least) / step).round() as u64 + 1;
        least + (self.next() % count) as f64 * step
    }

    fn below(&mut self, most: u64) -> u64 {
        self.next() % most
    }
}

/// A program, its spindle and what it contains.
struct RandomProgram {
    text: String,
    profile: SpindleProfile,
}

/// Adds a rapid motion or a cut above the threads.
fn push_cut(text: &mut String, dice: &mut Dice, rpm: f64) {
    let (x, z) = (dice.between(31.5, 34.0, 0.02), dice.between(0.0, 5.0, 0.01));
    let feed = dice.between(300.0, 1200.0, 10.0);
    let turn = dice.between(0.2, 0.6, 0.01);
    *text += &match dice.below(5) {
        0 => format!("G00 X{x:.2} Z{z:.2}\n"),
        1 => format!("G01 X{x:.2} Z{z:.2} F{feed:.0}\n"),
        2 => format!("G01 Z{z:.2} F{feed:.0}\nX{x:.2}\n"),
        3 => format!("G99 G01 X{x:.2} Z{z:.2} F{turn:.2}\nG98\n"),
        _ => {
            let surface = dice.between(40.0, 90.0, 1.0);
            format!("G96 S{surface:.0}\nG99 G01 X{x:.2} Z{z:.2} F{turn:.2}\nG98 G97 S{rpm:.0}\n")
        }
    };
}

/// Adds a thread: G32 or G92 with one or two passes, metric or inch, straight or taper.
fn push_thread(text: &mut String, dice: &mut Dice, rpm: f64) {
    let most = (2400.0 / rpm).min(4.0);
    let lead = if dice.below(3) == 0 {
        format!("I{:.0}", dice.between((25.4 / most).ceil(), 32.0, 1.0))
    } else {
        format!("F{:.2}", dice.between(0.4, most, 0.05))
    };
    let (x, z) = (
        dice.between(27.0, 29.0, 0.02),
        dice.between(-7.0, -1.0, 0.01),
    );
    let is_taper = dice.below(3) == 0;
    let rise = dice.between(0.1, 0.6, 0.02);
    *text += "G00 X32\nZ5\n";
    if dice.below(2) == 0 {
        let taper = if is_taper {
            format!(" X{:.2}", x + rise)
        } else {
            String::new()
        };
        *text += &format!("G00 X{x:.2}\nG32{taper} Z{z:.2} {lead}\nG00 X32\nZ5\n");
        return;
    }
    let taper = if is_taper {
        format!(" R-{rise:.2}")
    } else {
        String::new()
    };
    let starts = if dice.below(4) == 0 { " L2" } else { "" };
    *text += &format!("G92 X{x:.2} Z{z:.2}{taper} {lead}{starts}\n");
    if dice.below(2) == 0 && starts.is_empty() {
        *text += &format!("X{:.2}\n", x - 0.2);
    }
    *text += "G00 X32 Z5\n";
}

fn random_program(seed: u64) -> RandomProgram {
    let mut dice = Dice((seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let rpm = dice.between(400.0, 1200.0, 10.0);
    let is_reverse = dice.below(4) == 0;
    let direction = if is_reverse { "M04" } else { "M03" };
    let mut text = format!("O1\nG50 X40 Z5\nG98 G97 {direction} S{rpm:.0}\nG04 X0.2\nG00 X33 Z4\n");
    let is_thread_first = dice.below(2) == 0;
    if is_thread_first {
        push_thread(&mut text, &mut dice, rpm);
    }
    for _ in 0..=dice.below(2) {
        push_cut(&mut text, &mut dice, rpm);
    }
    if !is_thread_first && dice.below(2) == 0 {
        push_thread(&mut text, &mut dice, rpm);
    }
    text += "G00 X40 Z5\nM30\n";
    let stalls = dice.below(8) == 0;
    let profile = SpindleProfile {
        rpm: if is_reverse { -rpm } else { rpm },
        ripple: dice.between(0.0, 0.2, 0.01),
        dip_ms: [300 + dice.below(2000) as u32, 50 + dice.below(300) as u32],
        lost: if stalls {
            1.0
        } else {
            dice.between(0.0, 0.4, 0.01)
        },
    };
    RandomProgram { text, profile }
}

/// The steps of Z in the passes of the threads: counts from the first turn of each pass on.
fn thread_passes(steps: &[Step], from: i64) -> Vec<Vec<i64>> {
    let mut passes: Vec<Vec<i64>> = Vec::new();
    let (mut x, mut is_cutting) = (from, false);
    for step in steps {
        if step.axis == 0 {
            x += if step.is_up { 1 } else { -1 };
        }
        // A diameter of 40 at the start, 2.5 µm of radius a pulse.
        let is_inside = x as f64 * 0.005 + 40.0 < THREAD_BELOW_MM;
        if !is_inside {
            is_cutting = false;
        } else if step.axis == 1 {
            if !is_cutting {
                passes.push(Vec::new());
            }
            is_cutting = true;
            if let Some(pass) = passes.last_mut() {
                pass.push(step.count);
            }
        }
    }
    for pass in &mut passes {
        // The first step is within the first turn after the start.
        let start = pass[0].div_euclid(COUNTS) * COUNTS;
        for count in pass.iter_mut() {
            *count -= start;
        }
    }
    passes
}

/// Differences of two runs of a program.
#[derive(Clone, Copy, Debug, Default)]
struct Differences {
    steps: usize,
    thread_steps: usize,
    /// Greatest difference of the counts of a step of a thread.
    counts_apart: i64,
    /// Greatest distance of the paths, steps.
    steps_apart: i64,
}

/// Compares two runs of a program.
fn compare(name: &str, emulated: &[Step], twin: &[Step]) -> Differences {
    for axis in 0..2 {
        assert!(
            ups(emulated, axis) == ups(twin, axis),
            "{name}: axis {axis}"
        );
    }
    let mut differences = Differences {
        steps: emulated.len(),
        steps_apart: paths_apart(emulated, twin),
        ..Differences::default()
    };
    let passes = [emulated, twin].map(|steps| thread_passes(steps, 0));
    assert_eq!(passes[0].len(), passes[1].len(), "{name}");
    for (one, other) in passes[0].iter().zip(&passes[1]) {
        assert_eq!(one.len(), other.len(), "{name}");
        differences.thread_steps += one.len();
        let apart = greatest_difference(one, other);
        differences.counts_apart = differences.counts_apart.max(apart);
    }
    differences
}

fn chosen_programs() -> std::ops::Range<u64> {
    let Ok(text) = std::env::var("PICO_PROGRAMS") else {
        return DEFAULT_PROGRAMS;
    };
    let (from, to) = text.split_once("..").expect("PICO_PROGRAMS=0..100");
    from.parse().unwrap()..to.parse().unwrap()
}

#[test]
fn random_programs_have_the_same_steps_in_the_emulator_and_on_the_twin() {
    let mut emulated = Machine::<Emulated>::referenced();
    let mut twin = Machine::<Twin>::referenced();
    let opened_ms = emulated.board.bench.cycle() / 125_000;
    println!("referenced after {opened_ms} ms");
    let mut total = Differences::default();
    let mut failed = Vec::new();
    for seed in chosen_programs() {
        let program = random_program(seed);
        let steps = [
            emulated.run_program(&program.text, program.profile),
            twin.run_program(&program.text, program.profile),
        ];
        for axis in 0..2 {
            assert!(
                ups(&steps[0], axis) == emulated.commanded[axis],
                "{}: axis {axis} and the path",
                program.text
            );
        }
        let differences = compare(&program.text, &steps[0], &steps[1]);
        println!("program {seed}: {} ms, {differences:?}", emulated.ran_ms);
        if differences.counts_apart > MOST_COUNTS_APART
            || differences.steps_apart > MOST_STEPS_APART
        {
            println!("{} {:?}", program.text, program.profile);
            failed.push(seed);
        }
        total.steps += differences.steps;
        total.thread_steps += differences.thread_steps;
        total.counts_apart = total.counts_apart.max(differences.counts_apart);
        total.steps_apart = total.steps_apart.max(differences.steps_apart);
    }
    println!("{total:?}");
    assert!(failed.is_empty(), "programs {failed:?}");
}

/// Steps up of the axes, in this order.
fn steps_of(axes: &[usize]) -> Vec<Step> {
    let step = |axis: &usize| Step {
        axis: *axis,
        is_up: true,
        count: 0,
    };
    axes.iter().map(step).collect()
}

#[test]
fn the_distance_of_paths_is_that_of_the_nearer_axis() {
    let straight = steps_of(&[1, 1, 1, 1, 0, 1, 1, 1, 1, 0, 0, 0]);
    // A step of X four steps of Z later is a step of X beside the path.
    let late = steps_of(&[1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
    assert_eq!(paths_apart(&straight, &straight), 0);
    assert_eq!(paths_apart(&straight, &late), 1);
    assert_eq!(paths_apart(&late, &straight), 1);
    // Another corner.
    let around = steps_of(&[0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1]);
    assert_eq!(paths_apart(&late, &around), 4);
}
