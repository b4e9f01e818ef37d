//! Programs on a board end on the pulse, or are refused before anything moves.

use gsk_core::command::MotionCode;
use gsk_core::linked::LinkNote;
use gsk_core::operation::RunState;
use gsk_link::LinkState;
use gsk_twins::grbl::{GrblState, Variant};

use super::{BUSHING, GROOVE, LINES, PIN, SHAFT, SHORT, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{
    CYCLE_START, DRY_RUN, INCREMENT_100, JOG, MACHINE_LOCK, RESET, SINGLE_BLOCK, STEP, Z_MINUS,
};

#[test]
fn the_samples_end_on_the_pulse_of_the_kernel() {
    for variant in LINES {
        for (main, sub) in [(SHAFT, None), (PIN, Some(GROOVE))] {
            let mut machine = LinkedMachine::referenced(variant);
            machine.load(main, sub);
            machine.start_program();
            machine.run_to_end(3_600_000);
            assert_eq!(machine.alarms(), [0_u16; 0]);
            let stood = machine.simulation.cnc.pulses();
            assert_eq!(
                machine.made_pulses(),
                [stood.x.0, stood.z.0],
                "{variant:?} {}",
                main.lines().next().unwrap()
            );
        }
    }
}

#[test]
fn what_the_board_cannot_do_is_refused_before_anything_moves() {
    let thread = "O5 (THREAD)\nM03 S300\nG00 X30 Z5\nG92 X20 Z-20 F2\nM30\n";
    let called = "O6\nM98 P5\nM30\n";
    for (text, sub, line) in [
        (BUSHING, None, 8),
        (thread, None, 4),
        (called, Some(thread), 4),
    ] {
        let mut machine = LinkedMachine::referenced(Variant::Grbl);
        let stood = machine.made_pulses();
        machine.load(text, sub);
        machine.start_program();
        machine.run_ms(2000);
        assert_eq!(machine.alarms(), [604], "{text}");
        let alarm = machine.simulation.cnc.alarms()[0].clone();
        assert_eq!(alarm.source.unwrap().line, line, "{alarm}");
        assert_eq!(machine.made_pulses(), stood, "nothing moves");
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
    }
}

#[test]
fn single_block_stops_between_the_blocks_and_is_checked_there() {
    run_block_by_block(LinkedMachine::referenced(Variant::GrblHal));
    run_block_by_block(LinkedMachine::timed_referenced());
}

fn run_block_by_block<T: BenchBoard>(mut machine: LinkedMachine<T>) {
    machine.load(SHORT, None);
    machine.press(SINGLE_BLOCK);
    machine.notes.clear();
    machine.start_program();
    for _ in 0..30 {
        machine.run_until(20_000, |machine| {
            machine.simulation.cnc.run_state() != RunState::Run
                && !machine.linked.has_pending_motion()
        });
        assert_counts_agree(&machine);
        if machine.simulation.cnc.run_state() == RunState::Reset {
            break;
        }
        machine.press(CYCLE_START);
    }
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
    machine.run_ms(100);
    let agreed = |note: &&LinkNote| matches!(note, LinkNote::CountChecked { agrees: true, .. });
    // N30, N40, N50, N60, N80 move.
    assert!(machine.notes.iter().filter(agreed).count() >= 5);
    let ended = |note: &LinkNote| {
        matches!(
            note,
            LinkNote::CountChecked {
                program: Some(_),
                ..
            }
        )
    };
    assert!(machine.notes.iter().any(ended), "{:?}", machine.notes);
}

#[test]
fn a_dry_run_ends_on_the_same_pulse() {
    run_dry(LinkedMachine::referenced(Variant::Grbl));
    run_dry(LinkedMachine::timed_referenced());
}

fn run_dry<T: BenchBoard>(mut machine: LinkedMachine<T>) {
    machine.load(
        "O5\nG50 X60 Z20\nM03 S300\nG00 X30 Z5\nG92 X20 Z-5 F2\nG00 X60 Z20\nM30\n",
        None,
    );
    machine.press(DRY_RUN);
    machine.start_program();
    machine.run_to_end(300_000);
    assert_eq!(
        machine.alarms(),
        [0_u16; 0],
        "a thread without its spindle is feed"
    );
    assert_counts_agree(&machine);
}

#[test]
fn the_spindle_turns_before_the_cut_and_stops_with_reset() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(SHORT, None);
    machine.start_program();
    machine.watch = Some(|machine| {
        let cuts = machine.simulation.cnc.modal().motion == MotionCode::Line
            && machine.twin.state() == GrblState::Run;
        let (way, speed, coolant) = machine.twin.outputs();
        // 500 of 9999 r/min at 10 V.
        assert!(
            !cuts || (way == 3 && coolant && speed > 0.0),
            "{way} {speed} {coolant}"
        );
    });
    machine.run_until(20_000, |machine| machine.simulation.cnc.cursor().line == 6);
    machine.watch = None;
    assert_eq!(machine.twin.outputs().0, 3);
    machine.press(RESET);
    machine.run_ms(1000);
    assert_eq!(
        (machine.twin.outputs().0, machine.twin.outputs().2),
        (5, false)
    );
}

#[test]
fn a_board_too_slow_for_the_rapids_is_named_before_the_start() {
    let mut machine = LinkedMachine::with_gear(Variant::Grbl, 1);
    machine.load("O3\nG00 X1\nM30\n", None);
    machine.start_program();
    assert_eq!(machine.alarms(), [604]);
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert!(
        detail.starts_with("No.022 = 3800 mm/min makes 126667 pulses/s of X"),
        "{detail}"
    );
}

/// The first block whose cut needs more pulses than the board makes is named before anything
/// moves, whatever the source of its feed.
#[test]
fn a_cut_too_fast_for_the_board_is_named_before_the_start() {
    // 400 pulses/mm of X, 200 of Z, 30 000 pulses/s: 4500 and 9000 mm/min.
    let called = "O5\nG98 G01 Z-5 F7000\nX40\nG04 X1\nM99\n";
    for (text, sub, line, axis) in [
        (
            "O1\nG00 X60\nG98 G01 Z-5 F7000\nX59 Z-9\nX52 F4000\nX54 F6000\nM30\n",
            None,
            6,
            "X",
        ),
        (
            "O1\nG50 X40 Z0\nG98 G02 X50 Z-5 R5 F5000\nM30\n",
            None,
            3,
            "X",
        ),
        ("O6\nG00 X60\nM98 P5\nM30\n", Some(called), 3, "X"),
        (
            "O7\nG65 H01 P#200 Q5000\nG98 G01 X50 F#200\nM30\n",
            None,
            3,
            "X",
        ),
    ] {
        let mut machine = LinkedMachine::referenced(Variant::Grbl);
        let stood = machine.made_pulses();
        machine.load(text, sub);
        machine.start_program();
        machine.run_ms(1000);
        assert_eq!(machine.alarms(), [604], "{text}");
        let alarm = machine.simulation.cnc.alarms()[0].clone();
        assert_eq!(alarm.source.unwrap().line, line, "{alarm}");
        let detail = alarm.detail_en();
        assert!(detail.contains(&format!("{axis} would need")), "{detail}");
        assert_eq!(machine.made_pulses(), stood, "nothing moves");
    }
}

/// A block that is too far ahead for the check at the start is refused when it is reached.
#[test]
fn a_cut_too_fast_far_ahead_is_refused_at_its_block() {
    let mut text = "O1\nG50 X60 Z20\nG98 G01 X59.9 F100\n".to_owned();
    text.push_str(&"G98\n".repeat(105_000));
    text.push_str("X50 F6000\nM30\n");
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(&text, None);
    machine.start_program();
    machine.run_to_end(20_000);
    assert_eq!(machine.alarms(), [604]);
    let alarm = machine.simulation.cnc.alarms()[0].clone();
    assert_eq!(alarm.source.unwrap().line, 105_004, "{alarm}");
    assert_counts_agree(&machine);
}

#[test]
fn under_machine_lock_the_board_stands() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    let stood = machine.made_pulses();
    machine.load(SHORT, None);
    machine.press(MACHINE_LOCK);
    machine.start_program();
    machine.run_ms(2000);
    assert!(machine.simulation.cnc.is_moving());
    machine.pause_host(200);
    machine.run_to_end(60_000);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_eq!(machine.made_pulses(), stood);
    assert_eq!(machine.linked.state(), LinkState::Ready);
}

#[test]
fn steps_and_jogs_end_on_the_pulse() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.press(STEP);
    machine.press(INCREMENT_100);
    let [_, z] = machine.made_pulses();
    for _ in 0..5 {
        machine.press(Z_MINUS);
        machine.run_until(2000, |machine| !machine.linked.has_pending_motion());
    }
    // Five steps of 0.1 mm, 200 pulses a mm.
    assert_eq!(machine.made_pulses()[1], z - 100);
    machine.press(JOG);
    machine.hold_key(Z_MINUS, 1234);
    assert!(machine.run_until(2000, |machine| machine.linked.state() == LinkState::Ready));
    assert!(machine.made_pulses()[1] < z - 200);
    assert_counts_agree(&machine);
    assert_eq!(machine.alarms(), [0_u16; 0]);
}
