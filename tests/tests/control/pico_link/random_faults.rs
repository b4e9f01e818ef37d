//! Random faults on the line and at the pins while a program runs: the program is right, or an
//! alarm is shown; a position that the control calls known is that of the slides.

use std::collections::BTreeMap;
use std::ops::Range;

use gsk_twins::wire::Damage;

use super::machine::PicoMachine;
use super::threads::disturb;

/// Faults in each of the programs, and in each part of the tap.
const ROUNDS: u64 = 125;
const TAP_ROUNDS: u64 = 50;

/// A fault on the line, of the board, at a pin or of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    /// Bytes with an inverted bit: the checksum is wrong.
    DamagedBytes,
    LostBytes,
    /// The host or the line pauses.
    Silence,
    Unplugged,
    Reset,
    LostIndex,
    Limit,
    Guard,
    EncoderJump,
    SpindleStops,
}

const FAULTS: [Fault; 10] = [
    Fault::DamagedBytes,
    Fault::LostBytes,
    Fault::Silence,
    Fault::Unplugged,
    Fault::Reset,
    Fault::LostIndex,
    Fault::Limit,
    Fault::Guard,
    Fault::EncoderJump,
    Fault::SpindleStops,
];

/// Numbers that are always the same.
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % most
    }
}

/// What the faults of a kind did.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    count: u32,
    alarms: u32,
    /// Greatest number of pulses of both axes after the fault until the alarm's standstill.
    run_on: u64,
}

/// Damages some bytes of one direction of the line.
fn damage_line(machine: &mut PicoMachine, dice: &mut Dice, damage: Damage) {
    let wire = if dice.below(2) == 0 {
        &mut machine.twin.to_board
    } else {
        &mut machine.twin.to_host
    };
    let mut byte = wire.sent_count() + dice.below(40);
    for _ in 0..=dice.below(4) {
        wire.damage(byte, damage);
        byte += 1 + dice.below(60);
    }
}

/// Makes a fault happen; returns the counts by which the encoder jumps.
fn apply(machine: &mut PicoMachine, fault: Fault, dice: &mut Dice) -> i64 {
    match fault {
        Fault::DamagedBytes => {
            let bit = 1 << dice.below(8);
            damage_line(machine, dice, Damage::Changed(bit));
        }
        Fault::LostBytes => damage_line(machine, dice, Damage::Lost),
        Fault::Silence => {
            let pause = 5_000_000 + dice.below(250) * 1_000_000;
            damage_line(machine, dice, Damage::Stalled(pause));
        }
        Fault::Unplugged => {
            machine.twin.to_board.set_cut(true);
            machine.twin.to_host.set_cut(true);
        }
        Fault::Reset => machine.twin.press_reset(),
        Fault::LostIndex => machine.twin.set_index_lost(true),
        Fault::Limit => machine.twin.set_pin("gpio22", true),
        Fault::Guard => machine.twin.set_pin("gpio11", true),
        Fault::EncoderJump => {
            let counts = 9 + dice.below(1200) as i64;
            let counts = if dice.below(2) == 0 { counts } else { -counts };
            machine.twin.jump_encoder(counts);
            return counts;
        }
        Fault::SpindleStops => machine.twin.set_stalled(true),
    }
    0
}

/// Pulses of both axes between two positions.
fn pulses_apart(from: [i64; 2], to: [i64; 2]) -> u64 {
    from[0].abs_diff(to[0]) + from[1].abs_diff(to[1])
}

/// Runs the machine from its running program on with a fault; `end` is where the program ends.
fn run_round(
    mut machine: PicoMachine,
    number: u64,
    (end, limit_ms): ([i64; 2], u32),
    tally: &mut Tally,
) {
    let fault = FAULTS[number as usize % FAULTS.len()];
    let mut dice = Dice((number + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    machine.run_ms(dice.below(250) as u32);
    machine.twin.advance(dice.below(1_000_000));
    let was_over = machine.is_over();
    let at = machine.twin.pulses();
    let jumped = apply(&mut machine, fault, &mut dice);
    let name = format!("{number}: {fault:?} {jumped} at {at:?}");
    machine.run_until(limit_ms, |machine| {
        machine.is_over() || !machine.alarms().is_empty()
    });
    // The planned stop after a lease takes 90 + 67 ms.
    machine.run_ms(250);
    let alarms = machine.alarms();
    let stood = machine.twin.pulses();
    machine.run_ms(60);
    assert_eq!(machine.twin.pulses(), stood, "{name}: it moves on");
    if alarms.is_empty() || machine.linked.knows_position() {
        machine.assert_agrees();
    }
    tally.count += 1;
    if alarms.is_empty() {
        // A feed per revolution waits for a spindle that stands.
        let waits = fault == Fault::SpindleStops && !machine.is_over();
        assert!(waits || stood == end, "{name}: no alarm at {stood:?}");
    } else {
        tally.alarms += 1;
        tally.run_on = tally.run_on.max(pulses_apart(at, stood));
    }
    match fault {
        Fault::Unplugged | Fault::Reset | Fault::Guard => {
            assert!(!alarms.is_empty(), "{name}: no alarm");
        }
        Fault::Limit | Fault::EncoderJump if !was_over => {
            assert!(!alarms.is_empty(), "{name}: no alarm");
        }
        _ => {}
    }
}

/// Makes faults with these numbers in a program, which ends within a time after each; `is_begun`
/// holds where the first may happen.
fn run_faults(
    numbers: Range<u64>,
    text: &str,
    limit_ms: u32,
    is_begun: impl Fn(&PicoMachine) -> bool,
) {
    let mut machine = PicoMachine::referenced(&[]);
    disturb(&mut machine, 0);
    machine.start_program(text);
    machine.steps.clear();
    assert!(machine.run_until(20_000, is_begun), "{text}");
    let mut whole = machine.clone();
    whole.finish(20_000);
    assert_eq!(whole.alarms(), [""; 0], "{text}");
    let end = whole.twin.pulses();
    let mut tallies: BTreeMap<Fault, Tally> = BTreeMap::new();
    let rounds = (numbers.end - numbers.start) as u32;
    for number in numbers {
        let fault = FAULTS[number as usize % FAULTS.len()];
        let tally = tallies.entry(fault).or_default();
        run_round(machine.clone(), number, (end, limit_ms), tally);
    }
    for (fault, tally) in &tallies {
        println!("{fault:?}: {tally:?}");
    }
    let alarms: u32 = tallies.values().map(|tally| tally.alarms).sum();
    assert!(alarms >= rounds * 2 / 5, "{alarms}");
}

#[test]
fn faults_in_a_thread() {
    let text = "O1\nG50 X40 Z5\nG98 G97 M03 S1200\nG00 X30 Z5\nG92 X29 Z-20 F1.5\nG00 X40\nM30\n";
    run_faults(0..ROUNDS, text, 3000, |machine| {
        machine.simulation.cnc.position_absolute().z < 0.0
    });
}

#[test]
fn faults_in_a_taper_thread_in_reverse() {
    let text = "O1\nG50 X40 Z5\nG98 G97 M04 S900\nG00 X30 Z5\nG32 X31 Z-15 F2\nG00 X40\nZ5\nM30\n";
    run_faults(1000..1000 + ROUNDS, text, 3000, |machine| {
        machine.simulation.cnc.position_absolute().z < 1.0
    });
}

/// In the hole, at the bottom, at the reversal and on the way back.
#[test]
fn faults_in_a_tap() {
    let text = "O1\nG50 X40 Z5\nG97 M03 S600\nG00 X0 Z2\nG33 Z-4 F1\nG00 Z5\nM30\n";
    let z = |machine: &PicoMachine| machine.simulation.cnc.position_absolute().z;
    run_faults(4000..4000 + TAP_ROUNDS, text, 12_000, |machine| {
        z(machine) < 0.0
    });
    run_faults(5000..5000 + TAP_ROUNDS, text, 12_000, |machine| {
        z(machine) < -4.2
    });
    run_faults(6000..6000 + TAP_ROUNDS, text, 12_000, |machine| {
        machine.twin.spindle_rpm() < -300.0
    });
}

#[test]
fn faults_in_cuts_with_feed_per_revolution() {
    let text = "O1\nG50 X40 Z5\nG99 G97 M03 S1200\nG00 X30 Z5\nG01 Z-2 F0.4\nG02 X40 Z-7 R5\nG00 Z5\nM30\n";
    run_faults(2000..2000 + ROUNDS, text, 3000, |machine| {
        machine.simulation.cnc.position_absolute().z < 4.0
    });
}

#[test]
fn faults_in_rapids_and_cuts() {
    let text =
        "O1\nG50 X40 Z5\nG98 G97 M03 S600\nG00 X30 Z-20\nG01 X34 Z-24 F900\nG00 X40 Z5\nM30\n";
    run_faults(3000..3000 + ROUNDS, text, 3000, |machine| {
        machine.simulation.cnc.position_absolute().z < 4.0
    });
}
