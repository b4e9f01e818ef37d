//! Real lines and clocks, and a computer that pauses, on a line board: the buffer of the board
//! bridges them, or there is a defined stop.

use gsk_core::operation::RunState;
use gsk_link::LinkState;
use gsk_twins::grbl::{GrblTwin, Variant};
use gsk_twins::wire::{Damage, TwinWire};

use super::{SHORT, assert_counts_agree};
use crate::bench::board::LinkedMachine;
use crate::bench::keys::RESET;

const MS: u64 = 1_000_000;

/// A disturbance of the future traffic.
type LineDisturbance = fn(&mut GrblTwin);

fn repeat_damage(wire: &mut TwinWire, every: u64, damage: Damage) {
    let from = wire.sent_count();
    for count in 1..400 {
        wire.damage(from + count * every, damage);
    }
}

fn damage_once(wire: &mut TwinWire, damage: Damage) {
    let byte = wire.sent_count() + 1500;
    wire.damage(byte, damage);
}

/// Name, the computer's clock relative to the board's, the disturbance, and whether it must
/// remain unnoticed. The link repeats nothing on this wire, so damage leads to a stop.
const LINES: [(&str, f64, LineDisturbance, bool); 11] = [
    ("whole", 1.0, |_| {}, true),
    ("the board's clock is fast", 1.0 - 100e-6, |_| {}, true),
    ("the board's clock is slow", 1.0 + 100e-6, |_| {}, true),
    (
        "it waits, to the board",
        1.0,
        |twin| repeat_damage(&mut twin.to_board, 900, Damage::Stalled(100 * MS)),
        true,
    ),
    (
        "it waits, to the host",
        1.0,
        |twin| repeat_damage(&mut twin.to_host, 900, Damage::Stalled(100 * MS)),
        true,
    ),
    (
        "it becomes slow, to the board",
        1.0,
        |twin| damage_once(&mut twin.to_board, Damage::Delayed(50 * MS)),
        true,
    ),
    (
        "it becomes slow, to the host",
        1.0,
        |twin| damage_once(&mut twin.to_host, Damage::Delayed(100 * MS)),
        true,
    ),
    (
        "it becomes very slow, to the board",
        1.0,
        |twin| damage_once(&mut twin.to_board, Damage::Delayed(100 * MS)),
        true,
    ),
    (
        "bytes are lost",
        1.0,
        |twin| repeat_damage(&mut twin.to_board, 700, Damage::Lost),
        false,
    ),
    (
        "bytes are changed",
        1.0,
        |twin| repeat_damage(&mut twin.to_board, 700, Damage::Changed(0x10)),
        false,
    ),
    (
        "bytes come twice",
        1.0,
        |twin| repeat_damage(&mut twin.to_board, 700, Damage::Doubled),
        false,
    ),
];

#[test]
fn disturbed_lines_are_survived_or_stop_the_board() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    let mut whole_ms = 0;
    for (name, clock_rate, trouble, unnoticed) in LINES {
        let mut machine = ready.clone();
        machine.clock_rate = clock_rate;
        machine.load(SHORT, None);
        trouble(&mut machine.twin);
        let from = machine.twin.now();
        machine.start_program();
        let over = machine.run_until(60_000, |machine| {
            let idle = machine.simulation.cnc.run_state() == RunState::Reset;
            !machine.alarms().is_empty() || (idle && !machine.linked.has_pending_motion())
        });
        assert!(over, "{name}: it hangs");
        let took = (machine.twin.now() - from) / MS;
        machine.run_ms(2000);
        println!("{name}: {took} ms, {:?}", machine.alarms());
        if machine.alarms().is_empty() {
            assert_counts_agree(&machine);
            if whole_ms == 0 {
                whole_ms = took;
            }
            // On a line that stays slow the buffer of the board is the limit.
            assert!(took <= 2 * whole_ms, "{name}: {took} ms");
            continue;
        }
        assert!(!unnoticed, "{name}: {:?}", machine.alarms());
        let stood = machine.twin.pulses();
        machine.press(RESET);
        machine.run_ms(1500);
        assert_eq!(machine.twin.pulses(), stood, "{name}: it moves on");
        if machine.linked.state() == LinkState::Ready {
            assert_counts_agree(&machine);
        }
    }
}

/// Pauses up to 90 ms are unnoticed. A pause longer than the lookahead is 612, and the count
/// is compared.
#[test]
fn a_computer_that_pauses_is_not_noticed_or_stops_the_slides() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    for (pause, noticed) in [
        (10, false),
        (50, false),
        (90, false),
        (250, true),
        (400, true),
    ] {
        let mut machine = ready.clone();
        machine.load("O1\nG50 X60 Z20\nG98 G01 X50 Z-180 F600\nM30\n", None);
        machine.start_program();
        machine.run_until(5000, |machine| machine.simulation.cnc.feed_actual() > 590.0);
        for _ in 0..3 {
            machine.run_ms(400);
            if machine.alarms().is_empty() {
                machine.pause_host(pause);
            }
        }
        machine.run_ms(2000);
        if noticed {
            assert_eq!(machine.alarms(), [612], "{pause}");
            assert_counts_agree(&machine);
        } else {
            assert_eq!(machine.alarms(), [0_u16; 0], "{pause}");
            machine.run_to_end(120_000);
            assert_counts_agree(&machine);
        }
    }
}
