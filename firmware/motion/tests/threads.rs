//! Thirty threads with a spindle that varies: each step at the count that the oracle worked out
//! in exact fractions, in every pass. `tests/oracles/pulse_board_threads.py` writes the table.

mod support;

use gsk_motion::messages::{Command, Response};
use support::{TestBoard, X, Z};

/// Counts per turn in the table.
const COUNTS: u32 = 4096;
/// Clock rate, ticks per second.
const CLOCK_HZ: f64 = 15_625_000.0;

/// The path of one axis.
struct AxisPath {
    oid: u32,
    denominator: i64,
    entries: Vec<[i64; 3]>,
    steps: usize,
    crc: u32,
}

/// A thread of the table.
struct Thread {
    name: String,
    start: i64,
    is_reverse: bool,
    passes: u32,
    axes: Vec<AxisPath>,
}

fn read_threads() -> Vec<Thread> {
    let mut threads: Vec<Thread> = Vec::new();
    for row in include_str!("threads.tsv").lines().skip(1) {
        let fields: Vec<&str> = row.split('\t').collect();
        let number = |index: usize| fields[index].parse::<i64>().unwrap();
        let entries = fields[6].split(';').map(|entry| {
            let values: Vec<i64> = entry
                .split(',')
                .map(|value| value.parse().unwrap())
                .collect();
            [values[0], values[1], values[2]]
        });
        let path = AxisPath {
            oid: if fields[4] == "Z" { Z } else { X },
            denominator: number(5),
            entries: entries.collect(),
            steps: number(7) as usize,
            crc: u32::from_str_radix(fields[8], 16).unwrap(),
        };
        match threads.last_mut() {
            Some(last) if last.name == fields[0] => last.axes.push(path),
            _ => threads.push(Thread {
                name: fields[0].to_owned(),
                start: number(1),
                is_reverse: number(2) != 0,
                passes: number(3) as u32,
                axes: vec![path],
            }),
        }
    }
    threads
}

/// The checksum of zlib.
fn crc32(bytes: impl Iterator<Item = u8>) -> u32 {
    !bytes.fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & 0_u32.wrapping_sub(crc & 1))
        })
    })
}

/// A spindle at 600 rpm that varies by 20 % twelve times a turn, and loses 40 % for half a turn
/// whenever a tool enters.
struct VaryingSpindle {
    turns: f64,
    entered: f64,
    speed: f64,
}

impl VaryingSpindle {
    fn advance(&mut self, seconds: f64) -> i32 {
        let ripple = 1.0 + 0.2 * (self.turns * 12.0 * core::f64::consts::TAU).sin();
        let after = self.turns - self.entered;
        let dip = if (0.0..0.5).contains(&after) {
            0.6
        } else {
            1.0
        };
        self.turns += self.speed * ripple * dip * seconds;
        (self.turns * f64::from(COUNTS)).floor() as i32
    }
}

/// Cuts a thread in all its passes; returns the counts of the steps of each axis and pass, from
/// the start of the thread on, and the greatest phase error, steps.
fn cut(thread: &Thread) -> (Vec<Vec<Vec<i32>>>, f64) {
    let mut board = TestBoard::default();
    board.configure(COUNTS);
    board.begin();
    let sign = if thread.is_reverse { -1 } else { 1 };
    let mut spindle = VaryingSpindle {
        turns: 0.0,
        entered: f64::MAX,
        speed: 10.0,
    };
    let mut passes = Vec::new();
    let mut worst: f64 = 0.0;
    for pass in 0..thread.passes {
        // Each pass begins at another time and another phase of the spindle's ripple.
        let wait = 3_000_000 + u64::from(pass) * 777_777;
        let mut advance = |board: &mut TestBoard, ticks| {
            board.run_with(ticks, |_| {
                Some(sign * spindle.advance(support::POLL_TICKS as f64 / CLOCK_HZ))
            });
        };
        advance(&mut board, wait);
        board.port.steps.clear();
        for axis in &thread.axes {
            let now = board.port.now as u32 as i64;
            let oid = i64::from(axis.oid);
            let begin = [
                oid,
                now,
                thread.start,
                axis.denominator,
                axis.denominator / 2,
                i64::from(thread.is_reverse),
            ];
            board.send(Command::BeginAngle, &begin);
            for [length, numerator, add] in &axis.entries {
                board.send(Command::QueueAngle, &[oid, *length, *numerator, *add]);
            }
            board.send(Command::EndAngle, &[oid]);
        }
        let turn = f64::from(COUNTS);
        let start = thread.start as f64 / turn;
        let from = (spindle.turns - start).ceil() + start;
        spindle.entered = from + 1.0 / 8.0;
        let lengths = thread
            .axes
            .iter()
            .map(|axis| axis.entries.iter().map(|entry| entry[0]).sum::<i64>());
        let end = from + lengths.max().unwrap() as f64 / turn + 0.01;
        while spindle.turns < end {
            board.run_with(100_000, |_| {
                Some(sign * spindle.advance(support::POLL_TICKS as f64 / CLOCK_HZ))
            });
        }
        assert_eq!(board.shutdown_text(), None, "{}", thread.name);
        let begun = (from * turn).round() as i32;
        let axes = thread.axes.iter().map(|axis| {
            let steps = board
                .port
                .steps
                .iter()
                .filter(|step| step.axis == axis.oid as usize);
            let mut position = 0;
            let counts = steps.map(|step| {
                let count = sign * step.count - begun;
                position += if step.is_up { 1 } else { -1 };
                let (ideal, slope) = ideal_position(axis, count.into());
                worst = worst.max((f64::from(position) - ideal).abs() - slope.abs());
                if step.is_up { count } else { -count }
            });
            counts.collect()
        });
        passes.push(axes.collect());
    }
    (passes, worst)
}

/// The position on the path after a number of counts, and its growth in one count, steps.
fn ideal_position(axis: &AxisPath, count: i64) -> (f64, f64) {
    let (mut rest, mut sum, mut slope) = (i128::from(count), 0_i128, 0_i128);
    for [length, numerator, add] in axis.entries.iter().map(|entry| entry.map(i128::from)) {
        let part = rest.min(length);
        sum += numerator * part + add * part * (part - 1) / 2;
        slope = slope.max((numerator + add * part).abs());
        rest -= part;
    }
    let denominator = axis.denominator as f64;
    (sum as f64 / denominator, slope as f64 / denominator)
}

#[test]
fn every_step_of_thirty_threads_is_at_the_count_of_the_oracle() {
    let threads = read_threads();
    assert_eq!(threads.len(), 30);
    let mut worst: f64 = 0.0;
    for thread in &threads {
        let (passes, error) = cut(thread);
        assert_eq!(passes.len(), thread.passes as usize);
        for axes in &passes {
            for (axis, counts) in thread.axes.iter().zip(axes) {
                assert_eq!(counts.len(), axis.steps, "{}", thread.name);
                let crc = crc32(counts.iter().flat_map(|count| count.to_le_bytes()));
                assert_eq!(crc, axis.crc, "{}", thread.name);
            }
        }
        worst = worst.max(error);
    }
    println!("greatest phase error beyond one count: {worst:.3} steps");
    assert!(worst <= 1.0, "{worst}");
}

/// Follows the spindle with a ratio for 20 000 counts at a speed, counts per second; returns the
/// greatest phase error that the board reports, thousandths of a step.
fn reported_error([steps, counts]: [i64; 2], speed: f64) -> i64 {
    let mut board = TestBoard::default();
    board.configure(16_384);
    board.begin();
    let mut count = 0.0;
    let mut run = |board: &mut TestBoard, ticks| {
        board.run_with(ticks, |_| {
            count += speed * support::POLL_TICKS as f64 / CLOCK_HZ;
            Some(count as i32)
        });
    };
    // The first turn shows the index.
    run(&mut board, 16_400 * 15_625_000 / speed as u64);
    let now = board.port.now as u32 as i64;
    let spindle = i64::from(support::SPINDLE);
    board.send(Command::QueryEncoder, &[spindle, now, 15_625]);
    let begin = [Z.into(), now, 0, counts, counts / 2, 0];
    board.send(Command::BeginAngle, &begin);
    board.send(Command::QueueAngle, &[Z.into(), 20_000, steps, 0]);
    board.send(Command::EndAngle, &[Z.into()]);
    assert!(!board.has(Response::AngleError), "before the thread");
    run(&mut board, 40_000 * 15_625_000 / speed as u64);
    assert_eq!(board.shutdown_text(), None);
    let events = board.events.iter();
    let errors = events.filter(|event| event.response == Response::AngleError);
    let errors: Vec<i64> = errors.map(|event| event.values()[1]).collect();
    let time = 20_000.0 / speed * 1000.0;
    // A report in each millisecond, and the time until its turn comes.
    assert!(errors.len() as f64 >= 0.9 * time - 1.0, "{}", errors.len());
    errors.iter().copied().max().unwrap_or(0)
}

#[test]
fn the_board_reports_the_phase_error() {
    // Half a step and a count; each poll takes at most one count.
    let exact = reported_error([3, 8], 100_000.0);
    assert!((500..=875).contains(&exact), "{exact}");
    // A count at each poll. The output makes a step at every second one: it lags by four steps.
    let lags = reported_error([5002, 10_000], 390_625.0);
    println!("phase error {exact}, at the limit of the output {lags} thousandths of a step");
    assert!((3000..=6000).contains(&lags), "{lags}");
}
