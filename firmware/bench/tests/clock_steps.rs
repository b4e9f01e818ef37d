//! Steps on the clock: rate, jitter, and what stops them, measured at the edges.

use gsk_motion::messages::{Command, Response};
use pico_bench::{Bench, CYCLES_PER_TICK, ENABLE, ENABLE_PIN, GROUP, GUARD_PIN, LIMIT, LIMIT_PIN};

/// 50 µs, cycles.
const STOP_CYCLES: u64 = 6250;

/// A board whose axes make steps with these intervals, ticks.
fn moving_bench(intervals: [i64; 2], counts: [i64; 2]) -> Bench {
    let mut bench = Bench::start();
    bench.configure();
    bench.renew();
    let from = i64::from((bench.clock() + 300_000) as u32);
    for axis in 0..2 {
        bench.send(Command::ResetStepClock, &[axis, from]);
        bench.send(Command::SetNextStepDir, &[axis, 1 - axis]);
        bench.send(
            Command::QueueStep,
            &[axis, intervals[axis as usize], counts[axis as usize], 0],
        );
    }
    bench.send(Command::QueueDigitalOut, &[ENABLE, from, 1]);
    bench
}

fn cycles_of(bench: &Bench, axis: usize) -> Vec<u64> {
    let edges = bench.edges.iter().filter(|edge| edge.axis == axis);
    edges.map(|edge| edge.cycle).collect()
}

#[test]
fn both_axes_make_200_000_steps_per_second_without_jitter() {
    // 78 ticks are 4.992 µs.
    let mut bench = moving_bench([78, 78], [10_000, 10_000]);
    bench.run_until(20_000_000, |bench| bench.edges.len() == 20_000);
    bench.run(100_000);
    assert_eq!(bench.shutdown_text(), None);
    assert_eq!((bench.sum(0), bench.sum(1)), (10_000, -10_000));
    for axis in 0..2 {
        let times = cycles_of(&bench, axis);
        let worst = times
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs_diff(78 * CYCLES_PER_TICK));
        let worst = worst.max().unwrap();
        let span = times.last().unwrap() - times[0];
        println!("axis {axis}: greatest deviation of an interval {worst} cycles, span {span}");
        assert!(worst <= 125, "less than 1 µs");
        assert!(span.abs_diff(9_999 * 78 * CYCLES_PER_TICK) <= 125);
    }
}

#[test]
fn an_accelerated_run_is_at_the_times_of_the_host() {
    let mut bench = Bench::start();
    bench.configure();
    bench.renew();
    let from = i64::from((bench.clock() + 300_000) as u32);
    bench.send(Command::ResetStepClock, &[0, from]);
    bench.send(Command::SetNextStepDir, &[0, 1]);
    bench.send(Command::QueueStep, &[0, 2000, 190, -10]);
    bench.send(Command::QueueStep, &[0, 110, 500, 0]);
    bench.send(Command::QueueStep, &[0, 120, 190, 10]);
    bench.run(15_000_000);
    let mut due = Vec::new();
    let mut at = 0_i64;
    for (first, count, add) in [(2000_i64, 190, -10), (110, 500, 0), (120, 190, 10)] {
        for index in 0..count {
            at += first + add * index;
            due.push(at as u64 * CYCLES_PER_TICK);
        }
    }
    let times = cycles_of(&bench, 0);
    assert_eq!(times.len(), due.len());
    let offset = times[0] - due[0];
    let worst = times
        .iter()
        .zip(&due)
        .map(|(time, due)| (time - offset).abs_diff(*due));
    let worst = worst.max().unwrap();
    println!("greatest deviation from the times of the host: {worst} cycles");
    assert!(worst <= 125, "less than 1 µs");
}

#[test]
fn the_greatest_step_rate() {
    // Steps of 1.5 µs with the same pause and as fast as they come.
    let mut fastest = 0;
    for interval in [70, 64, 60, 56, 52] {
        let mut bench = moving_bench([interval, interval], [4000, 4000]);
        bench.run_until(6_000_000, |bench| bench.edges.len() == 8000);
        let times = cycles_of(&bench, 0);
        let span = times.last().unwrap() - times[0];
        if bench.shutdown_text().is_none() && times.len() == 4000 {
            let late = span as i64 - 3999 * interval * CYCLES_PER_TICK as i64;
            println!("interval {interval} ticks: {late} cycles late after 4000 steps");
            if late < 1000 {
                fastest = 15_625_000 / interval;
            }
        } else {
            println!("interval {interval} ticks: {:?}", bench.shutdown_text());
        }
    }
    println!("both axes: {fastest} steps per second each");
    assert!(fastest >= 200_000);
}

#[test]
fn a_guard_stops_within_50_us_and_the_count_is_true() {
    let mut worst = 0;
    for shift in 0..12 {
        let mut bench = moving_bench([100, 150], [60_000, 40_000]);
        bench.run_until(10_000_000, |bench| bench.edges.len() > 400);
        bench.run(shift * 137);
        assert!(bench.level(ENABLE_PIN));
        bench.set_input(GUARD_PIN, true);
        let from = bench.cycle();
        bench.run(500_000);
        assert_eq!(bench.shutdown_text(), Some("Guard input tripped"));
        worst = worst.max(bench.edges.last().unwrap().cycle.saturating_sub(from));
        assert!(!bench.level(ENABLE_PIN), "the output is off");
        for axis in 0..2 {
            assert_eq!(
                bench.query_position(axis),
                bench.sum(axis as usize),
                "{shift}"
            );
        }
    }
    println!(
        "last step {worst} cycles after the guard, {:.1} µs",
        worst as f64 / 125.0
    );
    assert!(worst <= STOP_CYCLES);
}

/// Returns the cycles from the limit switch to the last step, with four samples of the switch at
/// an interval in ticks. The count is true.
fn cycles_to_limit_stop(sample_ticks: i64) -> u64 {
    let mut worst = 0;
    for shift in 0..6 {
        let mut bench = moving_bench([100, 150], [60_000, 40_000]);
        let now = bench.clock() + 40_000;
        let at = i64::from(now as u32);
        bench.send(Command::TrsyncStart, &[GROUP, at, 0, 4]);
        for axis in 0..2 {
            bench.send(Command::StepperStopOnTrigger, &[axis, GROUP]);
        }
        bench.send(
            Command::EndstopHome,
            &[LIMIT, at, sample_ticks, 4, 15_625, 1, GROUP, 1],
        );
        bench.send(
            Command::TrsyncSetTimeout,
            &[GROUP, i64::from((now + 9_000_000) as u32)],
        );
        bench.flush();
        bench.run_until(10_000_000, |bench| bench.edges.len() > 400);
        bench.run(shift * 137);
        bench.set_input(LIMIT_PIN, true);
        let from = bench.cycle();
        bench.run(500_000);
        let state = bench
            .find(Response::TrsyncState)
            .expect("the group reports");
        assert_eq!(state.values[..3], [GROUP as u32, 0, 1]);
        worst = worst.max(bench.edges.last().unwrap().cycle.saturating_sub(from));
        assert_eq!(bench.shutdown_text(), None);
        for axis in 0..2 {
            assert_eq!(bench.query_position(axis), bench.sum(axis as usize));
        }
    }
    worst
}

#[test]
fn a_limit_stops_within_50_us_and_the_count_is_true() {
    // The step-queue link takes four samples 15 µs apart: 45 µs besides the board's own time.
    for (sample_ticks, most) in [(125, STOP_CYCLES), (234, 80 * 125)] {
        let cycles = cycles_to_limit_stop(sample_ticks);
        let interval = sample_ticks as f64 / 15.625;
        println!(
            "samples {interval:.0} µs apart: last step {:.1} µs after the limit",
            cycles as f64 / 125.0
        );
        assert!(cycles <= most);
    }
}

#[test]
fn the_lease_expires_and_the_axes_stop_on_their_path() {
    let mut bench = moving_bench([400, 800], [60_000, 30_000]);
    bench.run_until(10_000_000, |bench| bench.edges.len() > 400);
    bench.renew_at = None;
    let from = bench.cycle();
    bench.run_until(60_000_000, |bench| bench.shutdown_text().is_some());
    assert_eq!(bench.shutdown_text(), Some("Lease expired"));
    let last = bench.edges.last().unwrap().cycle;
    println!(
        "last step {:.1} ms after the host was last received at most 40 ms ago",
        (last - from) as f64 / 125e3
    );
    assert!(last - from <= 168 * 125_000);
    let (mut along, mut across) = (0_i64, 0_i64);
    for edge in &bench.edges {
        if edge.axis == 0 {
            along += 1
        } else {
            across += 1
        }
        assert!((along - 2 * across).abs() <= 3);
    }
    for axis in 0..2 {
        assert_eq!(bench.query_position(axis), bench.sum(axis as usize));
    }
}
