//! Threads on the angle of the spindle: all passes in one groove, whatever the speed does.

use gsk_twins::pico::SpindleLoad;

use super::machine::{COUNTS, PicoMachine};
use crate::step_link::lathe::referenced_lathe;

/// A pulse of Z, mm.
pub const PULSE_MM: f64 = 0.005;

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
pub fn passes(
    machine: &PicoMachine,
    lead: f64,
    between: (f64, f64),
    direction: f64,
) -> Vec<Vec<f64>> {
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
pub fn spread(passes: &[Vec<f64>]) -> f64 {
    let all = || passes.iter().flatten().copied();
    all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
}

/// A thread of the table.
struct ThreadCase {
    /// Spindle words.
    spindle: &'static str,
    /// The blocks of the thread.
    text: &'static str,
    /// Lead, mm per turn.
    lead: f64,
    /// Number of passes with positions between Z-16 and Z-6, and of starts.
    passes: usize,
    starts: usize,
}

const fn case(
    spindle: &'static str,
    text: &'static str,
    lead: f64,
    passes: usize,
    starts: usize,
) -> ThreadCase {
    ThreadCase {
        spindle,
        text,
        lead,
        passes,
        starts,
    }
}

const INCH: f64 = 25.4;

/// Metric and inch threads, tapers, several starts, both directions, G32, G76 and G92, with and
/// without run-out.
const THREADS: [ThreadCase; 27] = [
    case("M03 S600", "G92 X29 Z-20 F0.5\nX28.6", 0.5, 2, 1),
    case("M03 S600", "G92 X29 Z-20 F1\nX28.6", 1.0, 2, 1),
    case("M03 S600", "G92 X29 Z-20 F1.25\nX28.6", 1.25, 2, 1),
    case("M03 S600", "G92 X29 Z-20 F1.5\nX28.6", 1.5, 2, 1),
    case("M03 S600", "G92 X29 Z-20 F1.75\nX28.6", 1.75, 2, 1),
    case("M03 S500", "G92 X29 Z-20 F2\nX28.6\nX28.3", 2.0, 3, 1),
    case("M03 S400", "G92 X29 Z-20 F2.5\nX28.6", 2.5, 2, 1),
    case("M03 S300", "G92 X29 Z-20 F3\nX28.6", 3.0, 2, 1),
    case("M03 S200", "G92 X29 Z-20 F4\nX28.6", 4.0, 2, 1),
    case("M03 S60", "G92 X29 Z-20 F2", 2.0, 1, 1),
    case("M04 S600", "G92 X29 Z-20 F1.5\nX28.6", 1.5, 2, 1),
    case("M04 S300", "G92 X29 Z-20 F3\nX28.6", 3.0, 2, 1),
    case("M03 S600", "G92 X29 Z-20 I20\nX28.6", INCH / 20.0, 2, 1),
    case("M03 S600", "G92 X29 Z-20 I14\nX28.6", INCH / 14.0, 2, 1),
    case("M03 S400", "G92 X29 Z-20 I11\nX28.6", INCH / 11.0, 2, 1),
    case("M03 S300", "G92 X29 Z-20 I8\nX28.6", INCH / 8.0, 2, 1),
    case("M03 S600", "G92 X29 Z-20 R-1 F1.5\nX28.6", 1.5, 2, 1),
    case(
        "M03 S400",
        "G92 X29 Z-20 R-0.8 I14\nX28.6",
        INCH / 14.0,
        2,
        1,
    ),
    case("M03 S500", "G92 X29 Z-20 F2 L2\nX28.6", 2.0, 4, 2),
    case("M03 S300", "G92 X29 Z-20 F3 L3\nX28.6", 3.0, 6, 3),
    case("M03 S600", "G92 X29 Z-20 F2 J2 K1\nX28.6", 2.0, 2, 1),
    case(
        "M03 S600",
        "G76 P010000 Q100 R0.1\nG76 X28.6 Z-20 P700 Q300 F1.5",
        1.5,
        0,
        1,
    ),
    case(
        "M03 S400",
        "G76 P020000 Q100 R0.05\nG76 X28.8 Z-20 P600 Q400 F2",
        2.0,
        0,
        1,
    ),
    case(
        "M03 S400",
        "G76 P010000 Q100 R0.1\nG76 X28.8 Z-20 R-0.5 P600 Q400 F2",
        2.0,
        0,
        1,
    ),
    case(
        "M03 S500",
        "G00 X29\nG32 Z-20 F1.5\nG00 X32\nZ5\nX28.8\nG32 Z-20 F1.5\nG00 X32",
        1.5,
        2,
        1,
    ),
    case("M03 S500", "G00 X29\nG32 X30 Z-20 F2\nG00 X32", 2.0, 1, 1),
    case(
        "M03 S500",
        "G00 X29\nG32 Z-8 F2\nG32 X30 Z-20 F2\nG00 X34",
        2.0,
        1,
        1,
    ),
];

fn program(case: &ThreadCase) -> String {
    let ThreadCase { spindle, text, .. } = case;
    format!("O1\nG50 X40 Z5\nG98 G97 {spindle}\nG00 X30 Z5\n{text}\nG00 X40 Z5\nM30\n")
}

#[test]
fn all_passes_meet_in_one_groove_with_a_spindle_that_varies() {
    let mut machine = PicoMachine::referenced(&[]);
    disturb(&mut machine, 0);
    let (mut worst, mut reported_worst): (f64, f64) = (0.0, 0.0);
    for (number, case) in THREADS.iter().enumerate() {
        machine.sleep = 1 + number as u64 % 5;
        machine.start_program(&program(case));
        machine.finish(300_000);
        let text = case.text;
        assert_eq!(machine.alarms(), [""; 0], "{text}");
        machine.assert_agrees();
        let direction = if case.spindle.starts_with("M04") {
            -1.0
        } else {
            1.0
        };
        // The grooves of all starts are one with a lead of a start.
        let pitch = case.lead / case.starts as f64;
        let passes = passes(
            &machine,
            pitch,
            (-16.0, -6.0),
            direction * case.starts as f64,
        );
        assert!(
            passes.len() >= case.passes.max(1),
            "{text}: {}",
            passes.len()
        );
        assert!(
            case.passes == 0 || passes.len() == case.passes,
            "{text}: {}",
            passes.len()
        );
        // Half a pulse, the rest of the segments, and the path of the counts of a poll.
        let reading = machine.linked.encoder().and_then(|it| it.phase_error);
        let reported = reading.expect("the board reports the phase error");
        assert!((0.4..1.5).contains(&reported), "{text}: {reported}");
        reported_worst = reported_worst.max(reported);
        let error = spread(&passes);
        worst = worst.max(error / PULSE_MM);
        // A step, and a count of the encoder.
        let most = PULSE_MM + case.lead / f64::from(COUNTS);
        assert!(error <= most, "{text}: {error}");
    }
    println!(
        "{} threads, worst spread {worst:.3} steps, phase error reported {reported_worst:.3}",
        THREADS.len()
    );
}

/// The lead of G34 grows by R a turn: after n turns the way is F n + R n² / 2.
#[test]
fn growing_leads_have_their_way_at_each_step() {
    let mut machine = PicoMachine::referenced(&[(28, 8000)]);
    disturb(&mut machine, 0);
    for (lead, growth) in [(2.0, 0.1), (1.0, 0.3), (4.0, -0.05)] {
        let text = format!(
            "O1\nG50 X40 Z5\nG98 G97 M03 S300\nG00 X30 Z5\nG34 Z-20 F{lead} R{growth}\nG00 X40\nZ5\nM30\n"
        );
        machine.start_program(&text);
        machine.finish(300_000);
        assert_eq!(machine.alarms(), [""; 0]);
        machine.assert_agrees();
        let (_, offset) = machine.program_offset();
        let z = |place: i64| (place - machine.origin[1]) as f64 * PULSE_MM + offset;
        let steps = machine.steps.iter().filter(|step| step.stepper == 1);
        let down: Vec<_> = steps
            .skip_while(|step| z(step.position) > 4.9)
            .take_while(|step| z(step.position) > -19.5)
            .collect();
        // Turns up to the first step, from 5 = z + F n + R n² / 2.
        let way = 5.0 - z(down[0].position) - PULSE_MM / 2.0;
        let before = way / lead;
        let mut worst: f64 = 0.0;
        for step in &down {
            let counts = (step.count - down[0].count) as f64;
            let turns = before + counts / f64::from(COUNTS);
            let due = lead * turns + growth * turns * turns / 2.0;
            let made = 5.0 - z(step.position) - PULSE_MM / 2.0;
            worst = worst.max((due - made).abs());
        }
        println!(
            "G34 F{lead} R{growth}: {:.2} um over {} steps",
            worst * 1000.0,
            down.len()
        );
        assert!(
            down.len() > 4500 && worst <= PULSE_MM + 4.0 / f64::from(COUNTS),
            "{worst}"
        );
    }
}

/// Klipper's firmware has no encoder: with the same spindle the same program is refused.
#[test]
fn the_same_thread_raises_091_at_klippers_firmware() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.twin.set_speed_ripple(20.0, 3.0);
    lathe.start_program(&program(&THREADS[5]));
    lathe.finish(60_000);
    let alarms = lathe.alarms();
    assert!(alarms[0].contains("091"), "{alarms:?}");
}

/// Feed per revolution and constant surface speed follow the measured speed.
#[test]
fn feed_per_revolution_follows_the_spindle() {
    let mut machine = PicoMachine::referenced(&[]);
    machine.twin.set_speed_ripple(20.0, 3.0);
    machine.start_program(
        "O1\nG50 X40 Z5\nG50 S1500\nG97 M03 S600\nG00 X30\nG99 G01 Z-20 F0.2\nG96 S60\nG01 X20\nG97 S600\nG00 X40 Z5\nM30\n",
    );
    machine.finish(120_000);
    assert_eq!(machine.alarms(), [""; 0]);
    machine.assert_agrees();
    let (_, offset) = machine.program_offset();
    let z = |place: i64| (place - machine.origin[1]) as f64 * PULSE_MM + offset;
    let cut: Vec<_> = machine
        .steps
        .iter()
        .filter(|step| step.stepper == 1 && (-18.0..0.0).contains(&z(step.position)))
        .take(3600)
        .collect();
    let way = z(cut[0].position) - z(cut[3599].position);
    let turns = cut[3599].turns - cut[0].turns;
    println!("{:.4} mm a turn", way / turns);
    assert!((way / turns - 0.2).abs() < 0.004, "{}", way / turns);
}

/// The figures of the link page come from the encoder: 10 turns/s, three swings of 20 % a turn, of
/// which the mean over a report of 10 ms shows most.
#[test]
fn angle_and_ripple_of_the_spindle_are_reported() {
    let mut machine = PicoMachine::referenced(&[]);
    assert_eq!(machine.linked.encoder().and_then(|it| it.ripple), None);
    machine.twin.set_speed_ripple(20.0, 3.0);
    machine.start_program("O1\nG97 M03 S600\nG04 X5\nM05\nM30\n");
    machine.run_ms(4000);
    for _ in 0..50 {
        machine.run_ms(13);
        let reading = machine.linked.encoder().expect("an encoder");
        let angle = reading.angle.expect("an index has passed");
        let late = (machine.twin.spindle_turns() - angle).rem_euclid(1.0);
        assert!(late < 0.25, "{late} turns");
        let ripple = reading.ripple.expect("a turn is complete");
        assert!((0.12..0.25).contains(&ripple), "{ripple}");
    }
    machine.finish(60_000);
    assert_eq!(machine.alarms(), [""; 0]);
}
