//! Compares the board's path and time with those of the kernel, and checks what the pages may
//! show of it.

use core::time::Duration;
use std::collections::VecDeque;

use gsk_core::linked::MotionStamp;
use gsk_core::operation::RunState;
use gsk_twins::grbl::Variant;

use super::{GROOVE, PIN, SHAFT, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine, MAX_PULSE_GAP_MS};
use crate::bench::keys::{AUTO, CYCLE_START};

/// Lengths that differ by less are equal, mm.
const LENGTH_TOLERANCE_MM: f64 = 1e-9;

/// The board is at most a pulse and 2 µm off the commanded path, within 1 % of its time, and
/// no picture shows more than was made.
#[test]
fn the_board_follows_the_kernels_path_in_the_kernels_time() {
    follow_program(LinkedMachine::referenced(Variant::Grbl), SHAFT, None);
    follow_program(LinkedMachine::timed_referenced(), PIN, Some(GROOVE));
}

fn follow_program<T: BenchBoard>(mut machine: LinkedMachine<T>, main: &str, sub: Option<&str>) {
    machine.load(main, sub);
    machine.press(AUTO);
    machine.record_path();
    machine.press(CYCLE_START);
    let mut follower = PathFollower::default();
    for _ in 0..3_600_000 {
        machine.run_one_ms();
        follower.check_position(&machine);
        match machine.simulation.cnc.run_state() {
            RunState::Reset if !machine.linked.has_pending_motion() => break,
            // M00 waits for the operator.
            RunState::Stop if !machine.linked.has_pending_motion() => machine.press(CYCLE_START),
            _ => {}
        }
    }
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
    let (made, commanded) = (follower.moving as f64, machine.moving_ticks as f64);
    assert!(
        (made / commanded - 1.0).abs() < 0.01,
        "{made} ms for {commanded} ms"
    );
    // A pulse of Z is 5 µm.
    assert!(follower.off < 0.007, "{} mm off the way", follower.off);
    assert!(
        follower.max_delay <= Duration::from_millis(400),
        "{:?}",
        follower.max_delay
    );
}

/// A board with a faster clock than the computer does not run dry, and one with a slower clock
/// does not fill up.
#[test]
fn differing_clocks_are_compensated() {
    for rate in [0.995, 1.005] {
        let mut machine = LinkedMachine::referenced(Variant::Grbl);
        machine.clock_rate = rate;
        machine.load("O1\nG50 X60 Z20\nG98 G01 X50 Z-180 F600\nM30\n", None);
        machine.start_program();
        let mut least = Duration::MAX;
        machine.run_until(5000, |machine| machine.simulation.cnc.feed_actual() > 500.0);
        machine.run_ms(500);
        while machine.simulation.cnc.feed_actual() > 590.0 {
            machine.run_one_ms();
            least = least.min(machine.linked.outstanding());
            assert!(machine.linked.outstanding() <= Duration::from_millis(160));
        }
        assert!(least >= Duration::from_millis(60), "{rate}: {least:?}");
        machine.run_to_end(120_000);
        assert_eq!(machine.alarms(), [0_u16; 0]);
        assert_counts_agree(&machine);
    }
}

/// Measures the distance of the board from the recorded path.
#[derive(Default)]
struct PathFollower {
    /// The current segment of the path, and the distance along it, mm.
    at: usize,
    on: f64,
    off: f64,
    /// Greatest time between two pulses of one motion, ms.
    moving: u64,
    last_pulse: ([i64; 2], u64),
    /// Pending pictures: the moment of their motion, their position on the path, and when they
    /// were taken.
    pictures: VecDeque<(MotionStamp, usize, Duration)>,
    /// The longest time a picture was pending.
    max_delay: Duration,
}

impl PathFollower {
    fn check_position<T: BenchBoard>(&mut self, machine: &LinkedMachine<T>) {
        let pulses = machine.made_pulses();
        let way = &machine.path;
        if self.last_pulse.0 != pulses {
            let ms = machine.twin.now() / 1_000_000;
            let before = core::mem::replace(&mut self.last_pulse, (pulses, ms));
            let gap = ms - before.1;
            self.moving += if gap < MAX_PULSE_GAP_MS { gap } else { 0 };
            self.advance_to(way, mm(pulses), distance(mm(before.0), mm(pulses)));
        }
        let now = Duration::from_nanos(machine.twin.now());
        let place = way.len().saturating_sub(1);
        self.pictures
            .push_back((machine.linked.stamp(), place, now));
        while let Some(&(stamp, place, taken)) = self.pictures.front()
            && machine.linked.has_executed(stamp)
        {
            self.pictures.pop_front();
            self.max_delay = self.max_delay.max(now - taken);
            assert!(place <= self.at + 1, "shown {place}, made {}", self.at);
        }
    }

    /// The board has reached a position. Where the path turns back on itself, several
    /// positions are equally near. Then the one counts that is as far along the path as the
    /// board has moved.
    fn advance_to(&mut self, path: &[[i64; 2]], here: [f64; 2], went: f64) {
        let expected = self.on + went;
        let mut best = (f64::INFINITY, f64::INFINITY, self.at, self.on);
        let mut passed = 0.0;
        for index in self.at..path.len().saturating_sub(1).min(self.at + 400) {
            let (from, to) = (mm(path[index]), mm(path[index + 1]));
            let (off, on) = distance_from_segment(here, from, to);
            let astray = (passed + on - expected).abs();
            let nearer = off < best.0 - LENGTH_TOLERANCE_MM;
            if nearer || off < best.0 + LENGTH_TOLERANCE_MM && astray < best.1 - LENGTH_TOLERANCE_MM
            {
                best = (off, astray, index, on);
            }
            passed += distance(from, to);
        }
        if best.0.is_finite() {
            self.at = best.2;
            self.on = best.3;
            self.off = self.off.max(best.0);
        }
    }
}

fn mm([x, z]: [i64; 2]) -> [f64; 2] {
    [x as f64 / 400.0, z as f64 / 200.0]
}

fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::hypot(to[0] - from[0], to[1] - from[1])
}

/// Distance of a position from a segment, and the position along it.
fn distance_from_segment(at: [f64; 2], from: [f64; 2], to: [f64; 2]) -> (f64, f64) {
    let length = distance(from, to);
    let [ax, az] = [0, 1].map(|axis| (to[axis] - from[axis]) / length);
    let along = (at[0] - from[0]) * ax + (at[1] - from[1]) * az;
    let on = along.clamp(0.0, length);
    (distance(at, [from[0] + ax * on, from[1] + az * on]), on)
}
