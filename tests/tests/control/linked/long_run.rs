//! Hours of production on a computer with other load.

use gsk_core::operation::RunState;

use super::{SHORT, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::dice::TestRandom;
use crate::bench::keys::FEED_HOLD;

fn machine_minutes() -> u64 {
    let wanted = std::env::var("MINUTES").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(2)
}

/// Part after part, with pauses of the computer that the lookahead covers. Two minutes of
/// machine time; more with `MINUTES=480` in the environment.
#[test]
fn a_shift_of_parts_loses_no_pulse() {
    for variant in super::LINES {
        make_parts(LinkedMachine::referenced(variant), machine_minutes());
    }
}

/// The same on a board of timed steps.
#[test]
fn a_shift_of_parts_on_a_board_of_timed_steps_loses_no_pulse() {
    make_parts(LinkedMachine::timed_referenced(), machine_minutes());
}

fn make_parts<T: BenchBoard>(mut machine: LinkedMachine<T>, minutes: u64) {
    machine.load(&SHORT.replace("M30", "M99"), None);
    machine.start_program();
    let mut dice = TestRandom(7);
    let begun = machine.ticks;
    while machine.ticks - begun < minutes * 60_000 {
        machine.run_ms(500 + dice.below(3000));
        assert_eq!(
            machine.simulation.cnc.run_state(),
            RunState::Run,
            "{:?} after {} s, line {}",
            machine.simulation.cnc.alarms(),
            (machine.ticks - begun) / 1000,
            machine.simulation.cnc.cursor().line
        );
        machine.pause_host([10, 50, 90][dice.below(3) as usize]);
    }
    machine.press(FEED_HOLD);
    assert!(machine.run_until(5000, |machine| !machine.linked.has_pending_motion()));
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
}
