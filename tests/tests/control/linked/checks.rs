//! When the board's count is compared with the commanded one: a lost pulse is detected at the
//! next standstill, whatever its cause.

use gsk_core::linked::Note;
use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use super::SHORT;
use crate::bench::board::{Board, Machine};
use crate::bench::keys::{CYCLE_START, FEED_HOLD, RESET, SINGLE_BLOCK, X_PLUS, ZERO};

/// A line of Z, then the words that stop the slides.
fn program(behind: &str) -> String {
    format!("O1\nG50 X60 Z20\nG98 G01 Z10 F600\n{behind}G01 Z0\nM30\n")
}

/// In the first cut the board counts a pulse of Z too many.
fn cutting<T: Board>(ready: &Machine<T>, text: &str) -> Machine<T> {
    let mut machine = ready.clone();
    machine.load(text, None);
    machine.start();
    assert!(machine.wait(3000, |machine| machine.simulation.cnc.feed_actual() > 500.0));
    machine.twin.add_position_error([0, 1]);
    machine
}

fn is_found_out<T: Board>(mut machine: Machine<T>, limit_ms: u32, place: &str) {
    let told = |machine: &Machine<T>| machine.alarms().contains(&611);
    assert!(machine.wait(limit_ms, told), "{place}: not found out");
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    let [_, z] = machine.made();
    for count in [z, z + 1] {
        assert!(detail.contains(&format!("Z {count}")), "{place}: {detail}");
    }
    machine.pass(300);
    assert_eq!(machine.linked.state(), LinkState::Locked, "{place}");
    let referenced = machine.simulation.cnc.referenced();
    assert!(!referenced.x && !referenced.z, "{place}");
    assert!(
        machine
            .notes
            .iter()
            .any(|note| matches!(note, Note::Checked { agrees: false, .. })),
        "{place}: {:?}",
        machine.notes
    );
    machine.starts_nothing();
    machine.press(RESET);
    machine.starts_nothing();
    assert_eq!(machine.alarms(), [610], "{place}");
    machine.press(RESET);
    machine.reference();
    machine.works();
}

fn every_standstill<T: Board>(ready: &Machine<T>) {
    is_found_out(cutting(ready, &program("M30\n")), 5000, "the end");
    is_found_out(cutting(ready, &program("M00\n")), 5000, "M00");
    is_found_out(cutting(ready, &program("G04 X2\n")), 3000, "a dwell");
    let mut machine = cutting(ready, &program(""));
    machine.press(SINGLE_BLOCK);
    is_found_out(machine, 3000, "single block");
    let mut machine = cutting(ready, &program(""));
    machine.press(FEED_HOLD);
    is_found_out(machine, 1500, "hold");
    // Before any further motion.
    let mut machine = ready.clone();
    machine.twin.add_position_error([0, 1]);
    is_found_out(machine.clone(), 1500, "standing");
    machine.pass(1100);
    machine.press(ZERO);
    machine.press(X_PLUS);
    assert_eq!(machine.alarms(), [611], "before a reference return");
}

#[test]
fn a_lost_pulse_is_found_at_every_standstill() {
    every_standstill(&Machine::referenced(Variant::Grbl));
    every_standstill(&Machine::timed_referenced());
}

fn on_demand<T: Board>(ready: &Machine<T>) {
    let checks = |machine: &Machine<T>| {
        let agrees = |note: &Note| match note {
            Note::Checked {
                commanded,
                counted: Some(counted),
                agrees,
                ..
            } => {
                assert_eq!(commanded == counted, *agrees);
                Some(*agrees)
            }
            _ => None,
        };
        machine.notes.iter().filter_map(agrees).collect::<Vec<_>>()
    };
    let mut machine = ready.clone();
    machine.pass(2000);
    machine.notes.clear();
    machine.linked.check();
    machine.pass(300);
    assert_eq!(checks(&machine), [true]);
    // As when the port is closed.
    machine.linked.check_last();
    machine.pass(5);
    assert_eq!(checks(&machine), [true, true]);
    machine.notes.clear();
    machine.twin.add_position_error([0, 1]);
    machine.pass(1500);
    machine.linked.check();
    machine.pass(300);
    assert!(
        machine
            .notes
            .iter()
            .any(|note| matches!(note, Note::Checked { agrees: false, .. }))
    );
    assert!(
        !machine
            .notes
            .iter()
            .any(|note| matches!(note, Note::Checked { agrees: true, .. }))
    );
    assert_eq!(machine.alarms(), [611]);
}

#[test]
fn a_count_is_compared_on_demand() {
    on_demand(&Machine::referenced(Variant::Grbl));
    on_demand(&Machine::timed_referenced());
}

/// The log contains every stop of a program and its end.
fn is_logged<T: Board>(ready: &Machine<T>) {
    let mut machine = ready.clone();
    machine.notes.clear();
    machine.load(&SHORT.replace("N70 G04 X0.2", "N70 M00"), None);
    machine.start();
    machine.wait(5000, |machine| machine.simulation.cnc.feed_actual() > 200.0);
    machine.press(FEED_HOLD);
    machine.pass(1000);
    let count = |machine: &Machine<T>| machine.notes.len();
    assert_eq!(count(&machine), 1, "hold: {:?}", machine.notes);
    machine.press(CYCLE_START);
    machine.wait(20_000, |machine| {
        machine.simulation.cnc.cursor().line == 8 && !machine.linked.is_behind()
    });
    machine.pass(500);
    assert_eq!(count(&machine), 2, "M00: {:?}", machine.notes);
    machine.pass(5000);
    assert_eq!(count(&machine), 2, "once a stop: {:?}", machine.notes);
    machine.press(CYCLE_START);
    machine.run_to_end(20_000);
    machine.pass(500);
    assert_eq!(count(&machine), 3, "the end: {:?}", machine.notes);
    assert!(matches!(
        machine.notes[2],
        Note::Checked {
            program: Some(_),
            agrees: true,
            ..
        }
    ));
}

#[test]
fn every_stop_of_a_program_is_in_the_log() {
    is_logged(&Machine::referenced(Variant::Grbl));
    is_logged(&Machine::timed_referenced());
}
