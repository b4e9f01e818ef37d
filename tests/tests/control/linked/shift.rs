//! Hours of production on a computer with other load.

use gsk_core::operation::RunState;

use super::{SHORT, assert_together};
use crate::bench::board::{Board, Machine};
use crate::bench::dice::Dice;
use crate::bench::keys::FEED_HOLD;

fn minutes() -> u64 {
    let wanted = std::env::var("MINUTES").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(2)
}

/// Part after part, with pauses of the computer that the lookahead covers. Two minutes of
/// machine time; more with `MINUTES=480` in the environment.
#[test]
fn a_shift_of_parts_loses_no_pulse() {
    for variant in super::LINES {
        work(Machine::referenced(variant), minutes());
    }
}

/// The same on a board of timed steps.
#[test]
fn a_shift_of_parts_on_a_board_of_timed_steps_loses_no_pulse() {
    work(Machine::timed_referenced(), minutes());
}

fn work<T: Board>(mut machine: Machine<T>, minutes: u64) {
    machine.load(&SHORT.replace("M30", "M99"), None);
    machine.start();
    let mut dice = Dice(7);
    let begun = machine.ticks;
    while machine.ticks - begun < minutes * 60_000 {
        machine.pass(500 + dice.below(3000));
        assert_eq!(
            machine.simulation.cnc.run_state(),
            RunState::Run,
            "{:?} after {} s, line {}",
            machine.simulation.cnc.alarms(),
            (machine.ticks - begun) / 1000,
            machine.simulation.cnc.cursor().line
        );
        machine.pause([10, 50, 90][dice.below(3) as usize]);
    }
    machine.press(FEED_HOLD);
    assert!(machine.wait(5000, |machine| !machine.linked.is_behind()));
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_together(&machine);
}
