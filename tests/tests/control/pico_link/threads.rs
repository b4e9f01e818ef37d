//! Threads on the angle of the spindle: all passes in one groove, whatever the speed does.

use gsk_twins::pico::SpindleLoad;

use super::machine::{COUNTS, PicoMachine};

/// A pulse of Z, mm.
const PULSE_MM: f64 = 0.005;

/// A spindle whose speed varies by 20 % within a turn, and drops by 40 % for half a turn when the
/// tool enters.
pub fn disturb(machine: &mut PicoMachine, entry: i64) {
    machine.twin.set_speed_ripple(20.0, 3.0);
    machine.twin.set_load(Some(SpindleLoad {
        stepper: 1,
        interval: [i64::MIN, entry],
        lost_share: 0.4,
        turns: 0.5,
    }));
}

/// The steps of Z in the cuts between two positions, by pass: the distance of each from the helix
/// of the lead through the first, mm.
fn passes(machine: &PicoMachine, lead: f64, between: (f64, f64), direction: f64) -> Vec<Vec<f64>> {
    let (_, offset) = machine.program_offset();
    let mut passes: Vec<Vec<f64>> = Vec::new();
    let (mut is_cutting, mut last) = (false, i64::MAX);
    for step in machine.steps.iter().filter(|step| step.stepper == 1) {
        let place = step.position - machine.origin[1];
        let is_down = place < last;
        last = place;
        // A step down has just passed the half above its position.
        let z = (place as f64 + 0.5) * PULSE_MM + offset;
        let is_inside = is_down && z > between.0 && z < between.1;
        if is_inside && !is_cutting {
            passes.push(Vec::new());
        }
        is_cutting = is_inside;
        if is_inside && let Some(pass) = passes.last_mut() {
            let turns = step.count as f64 / f64::from(COUNTS);
            pass.push(z + lead * turns * direction);
        }
    }
    let first = passes.first().and_then(|pass| pass.first().copied());
    let first = first.unwrap_or_default();
    for pass in &mut passes {
        for place in pass {
            let turns = (*place - first) / lead;
            *place = (turns - turns.round()) * lead;
        }
    }
    passes
}

/// The greatest distance of two steps of all passes from one helix, mm.
fn spread(passes: &[Vec<f64>]) -> f64 {
    let all = || passes.iter().flatten().copied();
    all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
}

fn program_head(spindle: &str) -> String {
    format!("O1\nG50 X40 Z5\nG98 G97 {spindle}\nG00 X30 Z5\n")
}

const FIVE_PASSES: &str = "G92 X29 Z-25 F2\nX28.6\nX28.3\nX28.1\nX28\nG00 X40 Z5\nM30\n";

#[test]
fn five_passes_of_g92_meet_in_one_groove_with_any_speed() {
    for (spindle, direction, sleep) in [
        ("M03 S200", 1.0, 1),
        ("M03 S600", 1.0, 5),
        ("M04 S600", -1.0, 1),
    ] {
        let mut machine = PicoMachine::referenced(&[]);
        machine.sleep = sleep;
        disturb(&mut machine, 0);
        machine.start_program(&(program_head(spindle) + FIVE_PASSES));
        machine.finish(300_000);
        assert_eq!(machine.alarms(), [""; 0], "{spindle}");
        machine.assert_agrees();
        let passes = passes(&machine, 2.0, (-24.0, -5.0), direction);
        assert_eq!(passes.len(), 5, "{spindle}");
        println!("{spindle}: {:.2} um", spread(&passes) * 1000.0);
        assert!(spread(&passes) <= PULSE_MM + 2.0 / f64::from(COUNTS));
    }
}
