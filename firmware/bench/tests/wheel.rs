//! The handwheel at the built firmware: each edge of its encoder counts, and the board reports
//! the count at its interval.

use gsk_motion::messages::{Command, Response};
use pico_bench::{Bench, CRC};

/// Pin of the signal A of the handwheel; B is at the next.
const WHEEL_PIN: u32 = 26;
/// Object number of the handwheel.
const WHEEL: i64 = 0;
/// Interval of the reports, ticks: 20 ms.
const REPORT_TICKS: i64 = 312_500;
/// Processor cycles from an edge to the next: a wheel with 100 graduations and 400 edges that
/// makes ten turns a second.
const EDGE_CYCLES: u64 = 31_250;

/// Sets the levels of both signals for a count.
fn set_signals(bench: &mut Bench, count: i64) {
    let phase = [0, 1, 3, 2][count.rem_euclid(4) as usize];
    bench.drive_input(WHEEL_PIN, phase & 1 != 0);
    bench.drive_input(WHEEL_PIN + 1, phase & 2 != 0);
}

/// Turns the wheel edge by edge.
fn turn(bench: &mut Bench, at: &mut i64, counts: i64) {
    for _ in 0..counts.abs() {
        *at += counts.signum();
        set_signals(bench, *at);
        bench.run(EDGE_CYCLES);
    }
}

/// The counts that the board has reported, with their clocks.
fn reports(bench: &Bench) -> Vec<(u32, i32)> {
    let wheel = bench.replies.iter();
    let wheel = wheel.filter(|reply| reply.response == Response::WheelState);
    wheel
        .map(|reply| (reply.values[1], reply.values[2] as i32))
        .collect()
}

#[test]
fn the_board_counts_and_reports_the_handwheel() {
    let mut bench = Bench::start();
    let mut at = 0;
    set_signals(&mut bench, at);
    bench.send(Command::AllocateOids, &[1]);
    bench.send(Command::ConfigWheel, &[WHEEL, WHEEL_PIN.into()]);
    bench.send(Command::FinalizeConfig, &[CRC]);
    bench.flush();
    bench.learn_clock();
    let first = (bench.clock() + REPORT_TICKS) as u32;
    bench.send(Command::QueryWheel, &[WHEEL, first.into(), REPORT_TICKS]);
    // A turn forwards, a quarter back, and a wheel that trembles by an edge.
    for (counts, expected) in [(400, 400), (-100, 300), (1, 301), (-1, 300)] {
        turn(&mut bench, &mut at, counts);
        bench.run(6_000_000);
        let last = reports(&bench).last().map(|report| report.1);
        assert_eq!(last, Some(expected), "{counts}");
    }
    let clocks: Vec<u32> = reports(&bench).iter().map(|report| report.0).collect();
    let intervals = clocks.windows(2).map(|pair| pair[1].wrapping_sub(pair[0]));
    let most = intervals.clone().max().unwrap_or(0);
    let ms = f64::from(most) / 15_625.0;
    println!("{} reports, at most {ms:.2} ms apart", clocks.len());
    // A turn of the loop of the board takes a few ticks.
    assert!(
        intervals
            .clone()
            .all(|ticks| ticks.abs_diff(REPORT_TICKS as u32) < 300)
    );
    assert_eq!(bench.edges, [], "the board alone starts no motion");
    assert_eq!(bench.shutdown_text(), None);
}
