//! Tapping: G33.

use gsk_core::command::MoveKind;
use gsk_core::operation::RunState;

use super::run::{CYCLE_START, FEED_HOLD, ThreadRun};

#[test]
fn tapping_follows_the_spindle_through_its_reversal() {
    for (code, starts) in [("M03", 1), ("M04", 1), ("M03", 2)] {
        let text = format!(
            "O0001\n{code} S300\nG04 X1\nG00 X0 Z5\nG33 Z-20 F1.5 L{starts}\nG00 Z50\nM30\n"
        );
        let mut run = ThreadRun::started(&text, &[]);
        let (mut deepest, mut fastest) = (0.0f64, 0.0f64);
        let sign = if code == "M03" { 1.0 } else { -1.0 };
        while run.state() == RunState::Run && run.alarm().is_none() {
            run.tick();
            if run.line() == 5 {
                deepest = deepest.min(run.z());
                fastest = fastest.min(run.simulation.lathe.spindle_rpm() * sign);
            }
        }
        assert_eq!((run.alarm(), run.z()), (None, 50.0));
        // It runs out: deeper than programmed, by less than three turns.
        assert!((-24.5..-20.2).contains(&deepest), "{deepest}");
        assert!(fastest < -250.0, "the spindle was reversed");
        assert!(run.simulation.lathe.spindle_rpm().abs() < 1.0);
        let taps: Vec<_> = run
            .moves
            .iter()
            .filter(|piece| piece.source.line == 5)
            .map(|piece| (piece.kind, piece.to.z == 5.0))
            .collect();
        let both = [(MoveKind::Thread, false), (MoveKind::Thread, true)];
        assert_eq!(taps, both.repeat(starts));
    }
}

#[test]
fn feed_hold_waits_for_the_end_of_a_tap() {
    let text = "O0001\nM03 S300\nG04 X1\nG00 X0 Z5\nG33 Z-20 F1.5\nG00 Z50\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.run_until_z(0.0);
    run.press(FEED_HOLD);
    assert_eq!(run.state(), RunState::Hold);
    run.run_ticks(15_000);
    assert_eq!(run.state(), RunState::Hold, "the hold stands");
    assert!(!run.simulation.cnc.is_moving());
    assert_eq!((run.z(), run.line()), (5.0, 5));
    run.press(CYCLE_START);
    run.finish();
    assert_eq!(run.z(), 50.0);
}
