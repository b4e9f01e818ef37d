//! The board's way and time beside the kernel's, and what the pages may show of it.

use core::time::Duration;
use std::collections::VecDeque;

use gsk_core::operation::RunState;
use gsk_twins::grbl::Variant;

use crate::board::{APART, AUTO, Board, CYCLE_START, Machine};
use crate::{GROOVE, PIN, SHAFT, assert_together};

/// At most a pulse and 2 µm beside the commanded way, within 1 % of its time; and no
/// picture shows more than was made.
#[test]
fn the_board_goes_the_kernels_way_in_the_kernels_time() {
    follow(Machine::referenced(Variant::Grbl), SHAFT, None);
    follow(Machine::timed_referenced(), PIN, Some(GROOVE));
}

fn follow<T: Board>(mut machine: Machine<T>, main: &str, sub: Option<&str>) {
    machine.load(main, sub);
    machine.press(AUTO);
    machine.record();
    machine.press(CYCLE_START);
    let mut follower = Follower::default();
    for _ in 0..3_600_000 {
        machine.ms();
        follower.look(&machine);
        match machine.simulation.cnc.run_state() {
            RunState::Reset if !machine.linked.is_behind() => break,
            // M00 waits for the operator.
            RunState::Stop if !machine.linked.is_behind() => machine.press(CYCLE_START),
            _ => {}
        }
    }
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_together(&machine);
    let (made, commanded) = (follower.moving as f64, machine.moving_ticks as f64);
    assert!(
        (made / commanded - 1.0).abs() < 0.01,
        "{made} ms for {commanded} ms"
    );
    // A pulse of Z is 5 µm.
    assert!(follower.off < 0.007, "{} mm off the way", follower.off);
    assert!(
        follower.behind <= Duration::from_millis(400),
        "{:?}",
        follower.behind
    );
}

/// Neither a board faster than the computer runs dry, nor does a slower one fill up.
#[test]
fn clocks_that_differ_are_no_matter() {
    for rate in [0.995, 1.005] {
        let mut machine = Machine::referenced(Variant::Grbl);
        machine.clock_rate = rate;
        machine.load("O1\nG50 X60 Z20\nG98 G01 X50 Z-180 F600\nM30\n", None);
        machine.start();
        let mut least = Duration::MAX;
        machine.wait(5000, |machine| machine.simulation.cnc.feed_actual() > 500.0);
        machine.pass(500);
        while machine.simulation.cnc.feed_actual() > 590.0 {
            machine.ms();
            least = least.min(machine.linked.outstanding());
            assert!(machine.linked.outstanding() <= Duration::from_millis(160));
        }
        assert!(least >= Duration::from_millis(60), "{rate}: {least:?}");
        machine.run_to_end(120_000);
        assert_eq!(machine.alarms(), [0_u16; 0]);
        assert_together(&machine);
    }
}

/// Looks how far the board is beside the recorded way.
#[derive(Default)]
struct Follower {
    at: usize,
    off: f64,
    /// Time between two pulses that belong together, ms.
    moving: u64,
    last_pulse: ([i64; 2], u64),
    /// Pictures that wait: the moment of their motion, their place on the way, and
    /// when they were taken.
    pictures: VecDeque<(Duration, usize, Duration)>,
    /// The longest that a picture has waited.
    behind: Duration,
}

impl Follower {
    fn look<T: Board>(&mut self, machine: &Machine<T>) {
        let [x, z] = machine.made();
        let ms = machine.twin.now() / 1_000_000;
        if self.last_pulse.0 != [x, z] {
            let gap = ms - self.last_pulse.1;
            self.moving += if gap < APART { gap } else { 0 };
            self.last_pulse = ([x, z], ms);
        }
        let mm = |[x, z]: [i64; 2]| [x as f64 / 400.0, z as f64 / 200.0];
        let here = mm([x, z]);
        let way = &machine.path;
        let mut best = (f64::INFINITY, self.at);
        for index in self.at..way.len().saturating_sub(1).min(self.at + 400) {
            let off = distance(here, mm(way[index]), mm(way[index + 1]));
            if off < best.0 {
                best = (off, index);
            }
        }
        if best.0.is_finite() {
            self.at = best.1;
            self.off = self.off.max(best.0);
        }
        let now = Duration::from_nanos(machine.twin.now());
        let place = way.len().saturating_sub(1);
        self.pictures
            .push_back((machine.linked.stamp(), place, now));
        while let Some(&(stamp, place, taken)) = self.pictures.front()
            && machine.linked.has_made(stamp)
        {
            self.pictures.pop_front();
            self.behind = self.behind.max(now - taken);
            // Where the way turns back on itself the nearest place may be the earlier one.
            assert!(place <= self.at + 4, "shown {place}, made {}", self.at);
        }
    }
}

fn distance(at: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let (ax, az) = (to[0] - from[0], to[1] - from[1]);
    let (wx, wz) = (at[0] - from[0], at[1] - from[1]);
    let square = ax * ax + az * az;
    let share = if square > 0.0 {
        ((wx * ax + wz * az) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    libm::hypot(wx - ax * share, wz - az * share)
}
