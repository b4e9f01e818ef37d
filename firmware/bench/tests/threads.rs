//! Threads on the angle of an emulated spindle: every step edge at the count that the oracle
//! worked out in exact fractions, within the time that the firmware needs.

use gsk_motion::messages::{Command, Response};
use pico_bench::{Bench, CYCLES_PER_S, GUARD_PIN};

/// The table of the threads.
const TABLE: &str = include_str!("../../motion/tests/threads.tsv");

/// The path of one axis.
struct AxisPath {
    axis: usize,
    denominator: i64,
    entries: Vec<[i64; 3]>,
    steps: usize,
}

/// Returns the start, whether the spindle is reversed, and the paths of a thread.
fn read_thread(name: &str) -> (i64, bool, Vec<AxisPath>) {
    let rows: Vec<Vec<&str>> = TABLE.lines().map(|row| row.split('\t').collect()).collect();
    let rows = rows.iter().filter(|fields| fields[0] == name);
    let mut thread = (0, false, Vec::new());
    for fields in rows {
        let number = |index: usize| fields[index].parse::<i64>().unwrap();
        let entries = fields[6].split(';').map(|entry| {
            let values: Vec<i64> = entry
                .split(',')
                .map(|value| value.parse().unwrap())
                .collect();
            [values[0], values[1], values[2]]
        });
        thread.0 = number(1);
        thread.1 = number(2) != 0;
        thread.2.push(AxisPath {
            axis: usize::from(fields[4] == "X"),
            denominator: number(5),
            entries: entries.collect(),
            steps: number(7) as usize,
        });
    }
    assert!(!thread.2.is_empty(), "{name} is in the table");
    thread
}

/// The position on the path after a number of counts, and its greatest growth in a count, steps.
fn ideal_position(path: &AxisPath, count: i64) -> (f64, f64) {
    let (mut rest, mut sum, mut slope) = (i128::from(count.max(0)), 0_i128, 0_i128);
    for [length, numerator, add] in path.entries.iter().map(|entry| entry.map(i128::from)) {
        let part = rest.min(length);
        sum += numerator * part + add * part * (part - 1) / 2;
        slope = slope.max((numerator + add * part).abs());
        rest -= part;
    }
    let denominator = path.denominator as f64;
    (sum as f64 / denominator, slope as f64 / denominator)
}

/// A spindle that varies by 20 % twelve times a turn and loses 40 % in the first half turn after
/// the tool enters, at `entry` turns.
fn varying_spindle(rpm: f64, entry: f64, sign: i64) -> impl FnMut(u64) -> i64 {
    let (mut turns, mut last) = (0.0_f64, None);
    move |cycle| {
        let elapsed = cycle - last.unwrap_or(cycle);
        last = Some(cycle);
        let ripple = 1.0 + 0.2 * (turns * 12.0 * std::f64::consts::TAU).sin();
        let dip = if (entry..entry + 0.5).contains(&turns) {
            0.6
        } else {
            1.0
        };
        turns += rpm / 60.0 * ripple * dip * elapsed as f64 / CYCLES_PER_S;
        sign * (turns * 4096.0).floor() as i64
    }
}

/// Sends a thread.
fn send_thread(bench: &mut Bench, start: i64, is_reverse: bool, paths: &[AxisPath]) {
    let clock = i64::from(bench.clock() as u32);
    for path in paths {
        let oid = path.axis as i64;
        let begin = [
            oid,
            clock,
            start,
            path.denominator,
            path.denominator / 2,
            is_reverse.into(),
        ];
        bench.send(Command::BeginAngle, &begin);
        for [length, numerator, add] in &path.entries {
            bench.send(Command::QueueAngle, &[oid, *length, *numerator, *add]);
        }
        bench.send(Command::EndAngle, &[oid]);
    }
}

/// Cuts a thread; returns the edges of each axis: count from the start of the thread, position.
fn cut(name: &str, rpm: f64) -> f64 {
    let (start, is_reverse, paths) = read_thread(name);
    let mut bench = Bench::start();
    bench.configure();
    bench.begin();
    let sign = if is_reverse { -1 } else { 1 };
    // The first turn shows the index, the thread begins at the second, the tool enters.
    bench.set_spindle(varying_spindle(rpm, 2.0, sign));
    send_thread(&mut bench, start, is_reverse, &paths);
    let total: usize = paths.iter().map(|path| path.steps).sum();
    bench.run_until(400_000_000, |bench| {
        bench.edges.len() >= total || bench.shutdown_text().is_some()
    });
    bench.run(1_000_000);
    assert_eq!(bench.shutdown_text(), None, "{name}");
    let turn_start = sign * bench.edges[0].count - start;
    let begun = turn_start.div_euclid(4096) * 4096 + start;
    let mut worst: f64 = 0.0;
    for path in &paths {
        let edges: Vec<_> = bench
            .edges
            .iter()
            .filter(|edge| edge.axis == path.axis)
            .collect();
        assert_eq!(edges.len(), path.steps, "{name}");
        let mut position = 0_i64;
        for edge in edges {
            position += if edge.is_up { 1 } else { -1 };
            let (ideal, slope) = ideal_position(path, sign * edge.count - begun);
            worst = worst.max((position as f64 - ideal).abs() - slope);
        }
        assert_eq!(bench.query_position(path.axis as i64), position);
    }
    println!("{name} at {rpm} rpm: {total} edges, phase error {worst:.3} steps beyond a count");
    worst
}

/// Six threads and their speeds; with `PICO_THREADS=all` all 30 of the table at 600 rpm.
fn chosen_threads() -> Vec<(&'static str, f64)> {
    if std::env::var("PICO_THREADS").is_ok_and(|chosen| chosen == "all") {
        let mut names: Vec<_> = TABLE
            .lines()
            .skip(1)
            .filter_map(|row| row.split('\t').next())
            .collect();
        names.dedup();
        return names.into_iter().map(|name| (name, 600.0)).collect();
    }
    vec![
        ("G33-M20", 600.0),
        ("G33-taper-npt", 600.0),
        ("G33-spindle-reverse", 900.0),
        ("G34-taper", 600.0),
        ("G76-M16", 600.0),
        ("G33-inch-27-left", 1500.0),
    ]
}

#[test]
fn threads_with_a_varying_spindle_have_less_than_a_step_of_phase_error() {
    let threads = chosen_threads();
    assert!(threads.len() >= 6);
    for (name, rpm) in threads {
        assert!(cut(name, rpm) <= 1.0, "{name}");
    }
}

#[test]
fn the_encoder_counts_at_3000_rpm() {
    let mut bench = Bench::start();
    bench.set_counts_per_turn(16_384);
    bench.configure();
    bench.begin();
    // 4096 lines: 16 384 counts a turn, 819 200 counts per second.
    let from = bench.cycle();
    bench.set_spindle(move |cycle| ((cycle - from) as f64 * 819_200.0 / CYCLES_PER_S) as i64);
    bench.run(12_500_000);
    let count = bench.count;
    bench.set_spindle(move |_| count);
    bench.run(10_000);
    let clock = i64::from((bench.clock() + 20_000) as u32);
    let reply = bench.query(
        Command::QueryEncoder,
        &[pico_bench::SPINDLE, clock, 0],
        Response::EncoderState,
    );
    assert!(count > 80_000);
    assert_eq!(bench.shutdown_text(), None);
    assert_eq!(i64::from(reply.values[2] as i32), count);
}

/// Starts a thread of one axis with a constant ratio, steps to counts.
fn follow(bench: &mut Bench, axis: i64, steps: i64, counts: i64, length: i64) {
    let clock = i64::from(bench.clock() as u32);
    bench.send(Command::BeginAngle, &[axis, clock, 0, counts, 0, 0]);
    bench.send(Command::QueueAngle, &[axis, length, steps, 0]);
    bench.send(Command::EndAngle, &[axis]);
}

#[test]
fn a_step_follows_its_count_within_a_few_microseconds() {
    let mut bench = Bench::start();
    bench.configure();
    bench.begin();
    follow(&mut bench, 0, 3, 8, 8192);
    follow(&mut bench, 1, 3, 8, 8192);
    bench.flush();
    let from = bench.cycle();
    // 1200 rpm: 81 920 counts and 30 720 steps per second.
    bench.set_spindle(move |cycle| ((cycle - from) as f64 * 81_920.0 / CYCLES_PER_S) as i64);
    bench.run(30_000_000);
    assert_eq!(bench.shutdown_text(), None);
    assert_eq!((bench.sum(0), bench.sum(1)), (3072, 3072));
    // The angle of the index is known to two counts at this speed, and the same ever after.
    let begun = bench.edges[0].count.div_euclid(4096) * 4096;
    let latencies_from = |begun: i64| -> Vec<f64> {
        let axes = (0..2).map(|axis| bench.edges.iter().filter(move |edge| edge.axis == axis));
        let steps = axes.flat_map(|edges| (1..).zip(edges));
        let latency = steps.map(|(step, edge)| {
            // Step n is due at the first count k with 3 k >= 8 n.
            let counts = edge.count - begun - (8 * step + 2) / 3;
            edge.after_count as f64 / 125.0 + counts as f64 * 1e6 / 81_920.0
        });
        latency.collect()
    };
    let offset = (0..3).rfind(|offset| {
        latencies_from(begun + offset)
            .iter()
            .all(|time| *time > 0.0)
    });
    let offset = offset.expect("no step before its count");
    let latencies = latencies_from(begun + offset);
    let mean = latencies.iter().sum::<f64>() / latencies.len() as f64;
    let worst = latencies.iter().copied().fold(0.0, f64::max);
    println!(
        "from the count to the step: {mean:.2} µs, at most {worst:.2} µs; index {offset} counts"
    );
    assert!(worst < 25.0, "less than a step at 30 720 steps per second");
}

#[test]
fn two_axes_follow_819_200_counts_per_second() {
    let mut bench = Bench::start();
    bench.set_counts_per_turn(16_384);
    bench.index_counts = 64;
    bench.configure();
    bench.begin();
    follow(&mut bench, 0, 1, 40, 40_000);
    follow(&mut bench, 1, -1, 80, 40_000);
    bench.flush();
    let from = bench.cycle();
    bench.set_spindle(move |cycle| ((cycle - from) as f64 * 819_200.0 / CYCLES_PER_S) as i64);
    bench.run(15_000_000);
    assert_eq!(bench.shutdown_text(), None);
    assert_eq!((bench.sum(0), bench.sum(1)), (1000, -500));
}

#[test]
fn a_guard_in_a_thread_stops_and_the_count_is_true() {
    let (start, is_reverse, paths) = read_thread("G33-taper-steep");
    let mut bench = Bench::start();
    bench.configure();
    bench.begin();
    bench.set_spindle(varying_spindle(900.0, 0.3, 1));
    send_thread(&mut bench, start, is_reverse, &paths);
    bench.run_until(100_000_000, |bench| bench.edges.len() > 1500);
    bench.set_input(GUARD_PIN, true);
    let from = bench.cycle();
    bench.run(500_000);
    assert_eq!(bench.shutdown_text(), Some("Guard input tripped"));
    assert!(bench.edges.last().unwrap().cycle <= from + 6250);
    for axis in 0..2 {
        assert_eq!(bench.query_position(axis), bench.sum(axis as usize));
    }
}
