//! What threads cut: ends, moves, times, agreement with the preview.

use gsk_core::cnc::{ControlRequest, Event};
use gsk_core::command::MoveKind;
use gsk_core::operation::RunState;
use gsk_core::preview::preview;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

use super::run::{DRY_RUN, G32, ThreadRun};

#[test]
fn threads_end_exactly_and_are_reported() {
    let mut run = ThreadRun::started(
        "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG32 Z-20 F2\nX42 Z-30\nJ2 K3 Z-40\nG00 X60\nM30\n",
        &[],
    );
    run.finish();
    assert_eq!(run.alarm(), None);
    let kinds: Vec<_> = run
        .moves
        .iter()
        .filter(|piece| piece.kind != MoveKind::Dwell)
        .map(|piece| (piece.source.line, piece.kind, piece.to.x * 2.0, piece.to.z))
        .collect();
    assert_eq!(
        kinds,
        [
            (4, MoveKind::Rapid, 40.0, 5.0),
            (5, MoveKind::Thread, 40.0, -20.0),
            (6, MoveKind::Thread, 42.0, -30.0),
            (7, MoveKind::Thread, 42.0, -37.0),
            (7, MoveKind::RunOut, 46.0, -40.0),
            (8, MoveKind::Rapid, 60.0, -40.0),
        ]
    );
    // 500 r/min at 2 mm: the second thread is neither late nor slow.
    let second = run.moves.iter().find(|piece| piece.source.line == 6);
    assert!((second.unwrap().duration_s - 10.0 / (1000.0 / 60.0)).abs() < 0.002);
}

#[test]
fn the_preview_computes_the_time_of_threads_and_taps() {
    assert_same_time(
        "O0001\nG00 X40 Z5\nG92 X39 Z-30 F2 J1 K2 L2\nX38.5\nG32 Z-20 F1.5\nG00 X60\nM30\n",
        150.0,
    );
    assert_same_time("O0001\nG00 X0 Z5\nG33 Z-20 F1.5\nM30\n", 49.0);
}

#[track_caller]
fn assert_same_time(text: &str, thread_length: f64) {
    let setup = Setup {
        spindle_rpm: Some(600.0),
        ..Setup::default()
    };
    let mut simulation = Simulation::new(setup.clone());
    let request = ControlRequest::OpenExternal(Program::new(text));
    assert_eq!(simulation.cnc.request(request), Ok(()));
    let estimate = preview(&setup, simulation.cnc.programs(), &mut |_| {});
    assert_eq!(estimate.alarm, None);
    for _ in 0..500 {
        simulation.tick();
    }
    simulation.start_automatic();
    let begun = simulation.cnc.ticks();
    let mut moves = 0;
    while simulation.cnc.run_state() == RunState::Run {
        simulation.tick();
        let moved = |event: &&Event| matches!(event, Event::MoveEnded(_));
        moves += simulation.cnc.events().iter().filter(moved).count();
    }
    assert!(simulation.cnc.alarms().is_empty());
    let took = (simulation.cnc.ticks() - begun) as f64 / 1000.0;
    let off = (took - estimate.time_s).abs();
    assert!(
        off < 0.6 + 0.02 * took,
        "{took} s, {} foreseen",
        estimate.time_s
    );
    assert!(
        moves as u64 + 1 >= estimate.moves,
        "{moves} {}",
        estimate.moves
    );
    assert!(estimate.lengths.thread > thread_length);
}

#[test]
fn face_and_taper_threads_end_exactly() {
    let text = "O0001\nM03 S300\nG04 X1\nG00 X80 Z5\nG32 X20 F3\nG00 Z-5\nG32 X-10 Z-20 F2\n\
                G32 X70 F2\nG34 Z-60 F2 R0.3\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.finish();
    assert_eq!(run.alarm(), None);
    let ends: Vec<_> = run
        .moves
        .iter()
        .filter(|piece| piece.kind == MoveKind::Thread)
        .map(|piece| (piece.to.x * 2.0, piece.to.z))
        .collect();
    assert_eq!(
        ends,
        [(20.0, 5.0), (-10.0, -20.0), (70.0, -20.0), (70.0, -60.0)]
    );
}

#[test]
fn dry_run_cuts_threads_and_taps_without_the_spindle() {
    let text = "O0001\nG00 X40 Z5\nG32 Z-2 F2\nG00 X0\nG33 Z-5 F1\nM30\n";
    let mut run = ThreadRun::new(text, &[]);
    run.press(DRY_RUN);
    run.start();
    run.run_until_z(4.0);
    assert!((run.simulation.cnc.feed_actual() - 126.0).abs() < 1.0);
    run.finish();
    assert_eq!((run.alarm(), run.z()), (None, -2.0));
    let threads = run
        .moves
        .iter()
        .filter(|piece| piece.kind == MoveKind::Thread)
        .map(|piece| piece.to.z);
    assert_eq!(threads.collect::<Vec<_>>(), [-2.0, -5.0, -2.0]);
}

#[test]
fn a_saved_thread_continues_bit_for_bit() {
    let mut one = ThreadRun::started(G32, &[]);
    one.run_until_z(-5.0);
    let mut other = one.simulation.clone();
    for _ in 0..3000 {
        one.simulation.tick();
        other.tick();
    }
    assert_eq!(one.simulation, other);
}
