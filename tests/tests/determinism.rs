//! The same inputs at the same ticks give the same machine, bit for bit, also after saving and
//! restoring in the middle.

use gsk_tests::determinism::{GOLDEN, SessionTrace};

fn run_session(saves: &[u64]) -> SessionTrace {
    gsk_tests::determinism::trace_session(saves).expect("the session")
}

#[test]
fn the_same_script_twice_is_the_same_machine() {
    assert_eq!(run_session(&[]), run_session(&[]));
}

#[test]
fn saving_and_restoring_changes_nothing() {
    let saves = [1, 2500, 6001, 9137, 12_000, 14_567, 21_003, 33_333];
    assert_eq!(run_session(&[]), run_session(&saves));
}

#[test]
fn positions_are_those_of_every_platform() {
    let trace = run_session(&[]);
    assert_eq!(
        trace.positions, GOLDEN,
        "the positions of the script hash to {:#018x} now",
        trace.positions
    );
}
