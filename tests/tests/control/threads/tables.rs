//! Measures the lead-in and run-out distances of the manual (I-3.2.4.6, tables 3-10 and
//! 3-11) from the positions that a G32 program executes.
//!
//! ```text
//! lag to         .---------- lag ----------.          `--nocapture` prints the table
//!  the spindle  .'                           '.
//!              '                               '       the ramps are parabolas:
//!             b   c                         c   b      b - c = c - full speed
//! ```

use super::run::ThreadRun;

const RPM: f64 = 500.0;
/// Start and length of the thread, mm.
const START: f64 = 5.0;
const LENGTH: f64 = 40.0;

/// Lead-in and tail are the same ramp, and yet the manual's tails are shorter. In both tables
/// a row is shorter by the same distance: 4 to 8 ms at the speed that the lead-in of the row
/// shows, 5.5 ms on average. That is how long the speed had been falling when the tails were
/// read.
const TAIL_READ_MS: f64 = 5.5;

/// The tables of manual I-3.2.4.6: speed, then lead-in and tail with 029 = 50 ms and with 100
/// ms.
const TABLES: [[f64; 5]; 20] = [
    [500.0, 0.217, 0.150, 0.434, 0.361],
    [600.0, 0.257, 0.213, 0.513, 0.464],
    [800.0, 0.344, 0.266, 0.688, 0.603],
    [1000.0, 0.431, 0.332, 0.862, 0.756],
    [1200.0, 0.519, 0.373, 1.037, 0.883],
    [1400.0, 0.606, 0.504, 1.211, 1.104],
    [1600.0, 0.693, 0.563, 1.386, 1.250],
    [1800.0, 0.780, 0.652, 1.560, 1.427],
    [2000.0, 0.868, 0.703, 1.735, 1.564],
    [2200.0, 0.955, 0.714, 1.909, 1.660],
    [2400.0, 1.042, 0.830, 2.084, 1.864],
    [2600.0, 1.122, 0.866, 2.243, 1.978],
    [2800.0, 1.209, 0.929, 2.417, 2.129],
    [3200.0, 1.383, 1.050, 2.766, 2.423],
    [3600.0, 1.558, 1.310, 3.116, 2.862],
    [4000.0, 1.733, 1.435, 3.465, 3.161],
    [4400.0, 1.907, 1.520, 3.814, 3.418],
    [4800.0, 2.082, 1.563, 4.163, 3.630],
    [5200.0, 2.248, 1.814, 4.496, 4.053],
    [6000.0, 2.597, 1.923, 5.194, 4.502],
];

/// A tick of the thread: distance, and lag to the spindle, mm.
struct ThreadTick {
    way: f64,
    lag: f64,
}

/// The executed positions of a thread relative to the spindle.
fn executed_ticks(lead: f64, time: i32) -> Vec<ThreadTick> {
    let end = START - LENGTH;
    let text =
        format!("O0001\nM03 S{RPM}\nG04 X1.5\nG00 X40 Z{START}\nG32 Z{end} F{lead}\nM00\nM30\n");
    let changes = [(28, 6), (29, time), (175, 0), (22, 15_000), (23, 15_000)];
    let mut run = ThreadRun::started(&text, &changes);
    run.run_until("at the thread", |simulation| {
        simulation.cnc.cursor().line == 5
    });
    let mut ticks = Vec::new();
    let mut turns = 0.0;
    let mut before = run.simulation.lathe.spindle_degrees();
    while run.z() > end {
        run.tick();
        assert_eq!(run.alarm(), None);
        let degrees = run.simulation.lathe.spindle_degrees();
        turns += (degrees - before).rem_euclid(360.0) / 360.0;
        before = degrees;
        let way = START - run.z();
        let lag = turns * lead - way;
        ticks.push(ThreadTick { way, lag });
    }
    ticks.retain(|tick| tick.way > 0.0);
    ticks
}

/// Fraction of a tick at which a value is passed.
fn passing_fraction(from: f64, to: f64, wanted: f64) -> f64 {
    (wanted - from) / (to - from)
}

fn distance_at(ticks: &[ThreadTick], at: f64) -> f64 {
    let index = at.floor();
    let (one, other) = (&ticks[index as usize], &ticks[index as usize + 1]);
    one.way + (other.way - one.way) * (at - index)
}

/// Where the rate of the ramps is three quarters and a half: 1/16 and 1/4 of the lag that a
/// ramp of `lag` from standstill makes. The search starts in the middle of the thread with
/// `step` 1 or -1. Returns the extrapolated end of the ramp, ticks.
fn end_of_ramp(ticks: &[ThreadTick], lag: f64, step: isize) -> f64 {
    let middle = ticks.partition_point(|tick| tick.way < LENGTH / 2.0);
    let in_phase = &ticks[middle - 100..middle + 100];
    let settled = in_phase.iter().map(|tick| tick.lag).sum::<f64>() / 200.0;
    let lag_difference = |index: isize| (ticks[index as usize].lag - settled).abs();
    let [near, far] = [1.0 / 16.0, 1.0 / 4.0].map(|part| {
        let mut index = middle as isize;
        while lag_difference(index + step) < part * lag {
            index += step;
        }
        let normalized_root = |at| libm::sqrt(lag_difference(at) / lag);
        let part = passing_fraction(
            normalized_root(index),
            normalized_root(index + step),
            libm::sqrt(part),
        );
        index as f64 + step as f64 * part
    });
    near - (far - near)
}

#[test]
fn lead_in_and_tail_are_those_of_the_manual() {
    println!("mm/min   T  lead-in ours  manual      tail ours  manual");
    for [speed, in_50, tail_50, in_100, tail_100] in TABLES {
        for (time, lead_in, tail) in [(50, in_50, tail_50), (100, in_100, tail_100)] {
            let ticks = executed_ticks(speed / RPM, time);
            let lag = speed / 60.0 * f64::from(time) / 1000.0 / 2.0;
            let ours_in = distance_at(&ticks, end_of_ramp(&ticks, lag, -1));
            let falls = end_of_ramp(&ticks, lag, 1);
            let ours_tail = LENGTH - distance_at(&ticks, falls + TAIL_READ_MS);
            let off = [ours_in / lead_in - 1.0, ours_tail / tail - 1.0];
            println!(
                "{speed:6} {time:3}  {ours_in:12.3} {lead_in:7.3} {:+5.1}%  {ours_tail:8.3} \
                 {tail:7.3} {:+5.1}%",
                100.0 * off[0],
                100.0 * off[1]
            );
            assert!(off.iter().all(|off| off.abs() < 0.1), "{off:?}");
        }
    }
}
