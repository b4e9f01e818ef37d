//! When the board's count is compared with the commanded one: a lost pulse is detected at the
//! next standstill, whatever its cause.

use gsk_core::linked::LinkNote;
use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use super::SHORT;
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{CYCLE_START, FEED_HOLD, RESET, SINGLE_BLOCK, X_PLUS, ZERO};

/// A line of Z, then the words that stop the slides.
fn program_with(words_after: &str) -> String {
    format!("O1\nG50 X60 Z20\nG98 G01 Z10 F600\n{words_after}G01 Z0\nM30\n")
}

/// In the first cut the board counts a pulse of Z too many.
fn machine_in_cut<T: BenchBoard>(ready: &LinkedMachine<T>, text: &str) -> LinkedMachine<T> {
    let mut machine = ready.clone();
    machine.load(text, None);
    machine.start_program();
    assert!(machine.run_until(3000, |machine| machine.simulation.cnc.feed_actual() > 500.0));
    machine.twin.add_position_error([0, 1]);
    machine
}

fn check_detection<T: BenchBoard>(mut machine: LinkedMachine<T>, limit_ms: u32, place: &str) {
    let has_alarm = |machine: &LinkedMachine<T>| machine.alarms().contains(&611);
    assert!(
        machine.run_until(limit_ms, has_alarm),
        "{place}: not found out"
    );
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    let [_, z] = machine.made_pulses();
    for count in [z, z + 1] {
        assert!(detail.contains(&format!("Z {count}")), "{place}: {detail}");
    }
    machine.run_ms(300);
    assert_eq!(machine.linked.state(), LinkState::Locked, "{place}");
    let referenced = machine.simulation.cnc.referenced_axes();
    assert!(!referenced.x && !referenced.z, "{place}");
    assert!(
        machine
            .notes
            .iter()
            .any(|note| matches!(note, LinkNote::CountChecked { agrees: false, .. })),
        "{place}: {:?}",
        machine.notes
    );
    machine.check_nothing_starts();
    machine.press(RESET);
    machine.check_nothing_starts();
    assert_eq!(machine.alarms(), [610], "{place}");
    machine.press(RESET);
    machine.return_to_reference();
    machine.check_program_runs();
}

fn check_every_standstill<T: BenchBoard>(ready: &LinkedMachine<T>) {
    check_detection(
        machine_in_cut(ready, &program_with("M30\n")),
        5000,
        "the end",
    );
    check_detection(machine_in_cut(ready, &program_with("M00\n")), 5000, "M00");
    check_detection(
        machine_in_cut(ready, &program_with("G04 X2\n")),
        3000,
        "a dwell",
    );
    let mut machine = machine_in_cut(ready, &program_with(""));
    machine.press(SINGLE_BLOCK);
    check_detection(machine, 3000, "single block");
    let mut machine = machine_in_cut(ready, &program_with(""));
    machine.press(FEED_HOLD);
    check_detection(machine, 1500, "hold");
    // Before any further motion.
    let mut machine = ready.clone();
    machine.twin.add_position_error([0, 1]);
    check_detection(machine.clone(), 1500, "standing");
    machine.run_ms(1100);
    machine.press(ZERO);
    machine.press(X_PLUS);
    assert_eq!(machine.alarms(), [611], "before a reference return");
}

#[test]
fn a_lost_pulse_is_found_at_every_standstill() {
    check_every_standstill(&LinkedMachine::referenced(Variant::Grbl));
    check_every_standstill(&LinkedMachine::timed_referenced());
}

fn check_on_demand<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let checks = |machine: &LinkedMachine<T>| {
        let agrees = |note: &LinkNote| match note {
            LinkNote::CountChecked {
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
    machine.run_ms(2000);
    machine.notes.clear();
    machine.linked.check_count();
    machine.run_ms(300);
    assert_eq!(checks(&machine), [true]);
    // As when the port is closed.
    machine.linked.check_count_before_close();
    machine.run_ms(5);
    assert_eq!(checks(&machine), [true, true]);
    machine.notes.clear();
    machine.twin.add_position_error([0, 1]);
    machine.run_ms(1500);
    machine.linked.check_count();
    machine.run_ms(300);
    assert!(
        machine
            .notes
            .iter()
            .any(|note| matches!(note, LinkNote::CountChecked { agrees: false, .. }))
    );
    assert!(
        !machine
            .notes
            .iter()
            .any(|note| matches!(note, LinkNote::CountChecked { agrees: true, .. }))
    );
    assert_eq!(machine.alarms(), [611]);
}

#[test]
fn a_count_is_compared_on_demand() {
    check_on_demand(&LinkedMachine::referenced(Variant::Grbl));
    check_on_demand(&LinkedMachine::timed_referenced());
}

/// The log contains every stop of a program and its end.
fn check_log<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    machine.notes.clear();
    machine.load(&SHORT.replace("N70 G04 X0.2", "N70 M00"), None);
    machine.start_program();
    machine.run_until(5000, |machine| machine.simulation.cnc.feed_actual() > 200.0);
    machine.press(FEED_HOLD);
    machine.run_ms(1000);
    let count = |machine: &LinkedMachine<T>| machine.notes.len();
    assert_eq!(count(&machine), 1, "hold: {:?}", machine.notes);
    machine.press(CYCLE_START);
    machine.run_until(20_000, |machine| {
        machine.simulation.cnc.cursor().line == 8 && !machine.linked.has_pending_motion()
    });
    machine.run_ms(500);
    assert_eq!(count(&machine), 2, "M00: {:?}", machine.notes);
    machine.run_ms(5000);
    assert_eq!(count(&machine), 2, "once a stop: {:?}", machine.notes);
    machine.press(CYCLE_START);
    machine.run_to_end(20_000);
    machine.run_ms(500);
    assert_eq!(count(&machine), 3, "the end: {:?}", machine.notes);
    assert!(matches!(
        machine.notes[2],
        LinkNote::CountChecked {
            program: Some(_),
            agrees: true,
            ..
        }
    ));
}

#[test]
fn every_stop_of_a_program_is_in_the_log() {
    check_log(&LinkedMachine::referenced(Variant::Grbl));
    check_log(&LinkedMachine::timed_referenced());
}
