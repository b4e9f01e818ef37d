//! Planner of the board: a short queue of straight moves with acceleration and lookahead.
//!
//! ```text
//!   speed
//!     |      ______________
//!     |     /|            |\______          entry speed of the next block:
//!     |    / |            | |     \         junction, or what can still be
//!     |___/__|____________|_|______\___     braked within the queue
//!        block 1           2       distance
//! ```
//!
//! Motion is prepared for the pulse timer some time in advance, in short segments. Prepared
//! motion has left the queue and does not change: a feed hold decelerates after it.

use std::collections::VecDeque;

/// Duration of the motion in one segment for the pulse timer, s.
const SEGMENT_S: f64 = 1e-4;
/// Least speed that the planner gives a move, mm/s.
const MIN_SPEED: f64 = 0.05;

/// A straight move in the planner queue.
#[derive(Clone, Debug)]
pub(super) struct PlannedBlock {
    /// Number of pulses of X, Y, Z in the whole move, with signs.
    pub(super) steps: [i64; 3],
    /// Direction of the move in X, Y, Z, a vector of length 1.
    pub(super) direction: [f64; 3],
    /// Length of the move, mm.
    pub(super) length: f64,
    /// Speed to reach if acceleration allows, mm/s.
    pub(super) nominal_speed: f64,
    /// Acceleration along the move, mm/s².
    pub(super) acceleration: f64,
    /// Maximum speed at the junction with the move before, mm/s.
    pub(super) junction_speed: f64,
    entry_speed: f64,
}

impl PlannedBlock {
    /// Creates a move whose entry speed is not planned yet.
    pub(super) const fn new(
        steps: [i64; 3],
        direction: [f64; 3],
        length: f64,
        nominal_speed: f64,
        acceleration: f64,
    ) -> Self {
        Self {
            steps,
            direction,
            length,
            nominal_speed,
            acceleration,
            junction_speed: 0.0,
            entry_speed: 0.0,
        }
    }
}

/// A short piece of motion that is prepared for the pulse timer and no longer changes.
#[derive(Clone, Copy, Debug)]
struct PlannerSegment {
    seconds: f64,
    pulses: [i64; 3],
    speed: f64,
}

/// The queue of planned moves, with the motion prepared from its first move.
#[derive(Clone, Debug)]
pub(super) struct Planner {
    blocks: VecDeque<PlannedBlock>,
    capacity: usize,
    /// Duration of the motion to prepare in advance (`prepare_ahead_s`) and of that prepared
    /// now (`prepared_s`), s.
    prepare_ahead_s: f64,
    prepared_s: f64,
    segments: VecDeque<PlannerSegment>,
    /// Distance of the first move that is already prepared as pulses, mm.
    front_distance_mm: f64,
    /// Number of pulses of the first move, X, Y, Z, that are already prepared.
    front_pulses: [i64; 3],
    /// Speed along the path at the end of the prepared motion, mm/s.
    speed: f64,
    last_block: Option<([f64; 3], f64)>,
}

impl Planner {
    pub(super) const fn new(capacity: usize, prepare_ahead_s: f64) -> Self {
        Self {
            blocks: VecDeque::new(),
            capacity,
            prepare_ahead_s,
            prepared_s: 0.0,
            segments: VecDeque::new(),
            front_distance_mm: 0.0,
            front_pulses: [0; 3],
            speed: 0.0,
            last_block: None,
        }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new(self.capacity, self.prepare_ahead_s);
    }

    /// Stops motion at once: drops the prepared motion and keeps the queue.
    pub(super) fn dead_stop(&mut self) {
        self.speed = 0.0;
        self.prepared_s = 0.0;
        self.segments.clear();
    }

    /// Returns whether neither queue nor prepared motion remains.
    pub(super) fn is_empty(&self) -> bool {
        self.blocks.is_empty() && self.segments.is_empty()
    }

    /// Returns whether the axes stand still, at the end of the queue or of a hold.
    pub(super) fn is_stopped(&self) -> bool {
        self.segments.is_empty() && (self.speed <= 0.0 || self.blocks.is_empty())
    }

    pub(super) fn is_full(&self) -> bool {
        self.blocks.len() >= self.capacity
    }

    pub(super) fn free_blocks(&self) -> usize {
        self.capacity.saturating_sub(self.blocks.len())
    }

    /// Returns the pulses of X, Y, Z that the queue and the prepared motion still contain.
    pub(super) fn pending_pulses(&self) -> [i64; 3] {
        let mut ahead = self.front_pulses.map(|made| -made);
        let planned = self.blocks.iter().map(|block| block.steps);
        let segments = self.segments.iter().map(|segment| segment.pulses);
        for steps in planned.chain(segments) {
            for (sum, steps) in ahead.iter_mut().zip(steps) {
                *sum += steps;
            }
        }
        ahead
    }

    /// Returns the current speed along the path, mm/s.
    pub(super) fn speed(&self) -> f64 {
        self.segments.front().map_or(0.0, |segment| segment.speed)
    }

    /// Appends a move to the queue. `deviation` is the junction deviation (setting $11), mm.
    pub(super) fn push(&mut self, mut block: PlannedBlock, deviation: f64) {
        block.junction_speed = match self.last_block {
            Some((before, nominal)) if !self.blocks.is_empty() => {
                junction_speed(before, block.direction, block.acceleration, deviation)
                    .min(nominal)
                    .min(block.nominal_speed)
            }
            _ => 0.0,
        };
        self.last_block = Some((block.direction, block.nominal_speed));
        self.blocks.push_back(block);
        self.replan();
    }

    /// Plans the entry speeds of all moves: backwards from a stop at the end, then forwards
    /// within the acceleration.
    fn replan(&mut self) {
        let mut exit = 0.0_f64;
        for block in self.blocks.iter_mut().skip(1).rev() {
            let braking = (exit * exit + 2.0 * block.acceleration * block.length).sqrt();
            block.entry_speed = block.junction_speed.min(braking);
            exit = block.entry_speed;
        }
        let mut reach = f64::INFINITY;
        for (index, block) in self.blocks.iter_mut().enumerate() {
            let (entry, length) = if index == 0 {
                (self.speed, block.length - self.front_distance_mm)
            } else {
                block.entry_speed = block.entry_speed.min(reach);
                (block.entry_speed, block.length)
            };
            reach = (entry * entry + 2.0 * block.acceleration * length).sqrt();
        }
    }

    /// Advances motion by `seconds` and returns the pulses of X, Y, Z made. `hold` decelerates
    /// to a stop.
    pub(super) fn advance(&mut self, seconds: f64, hold: bool) -> [i64; 3] {
        while self.prepared_s < self.prepare_ahead_s.max(seconds) {
            let (pulses, made) = self.prepare_segment(SEGMENT_S, hold);
            if made <= 0.0 {
                break;
            }
            self.segments.push_back(PlannerSegment {
                seconds: made,
                pulses,
                speed: self.speed,
            });
            self.prepared_s += made;
        }
        self.advance_prepared(seconds)
    }

    /// Advances the prepared motion by `seconds` without preparing more. Returns the pulses of
    /// X, Y, Z made.
    pub(super) fn advance_prepared(&mut self, mut seconds: f64) -> [i64; 3] {
        let mut sum = [0; 3];
        let whole = seconds;
        while seconds > 1e-12 {
            let Some(segment) = self.segments.front_mut() else {
                break;
            };
            let share = (seconds / segment.seconds).min(1.0);
            let due = segment.pulses.map(|pulses| (pulses as f64 * share) as i64);
            for (axis, due) in due.into_iter().enumerate() {
                sum[axis] += due;
                segment.pulses[axis] -= due;
            }
            seconds -= segment.seconds * share;
            segment.seconds *= 1.0 - share;
            if segment.seconds <= 1e-12 {
                for (axis, sum) in sum.iter_mut().enumerate() {
                    *sum += segment.pulses[axis];
                }
                self.segments.pop_front();
            }
        }
        let left = self.prepared_s - (whole - seconds);
        self.prepared_s = if self.segments.is_empty() { 0.0 } else { left };
        sum
    }

    /// Prepares the next `wanted` seconds of motion. Returns the pulses of X, Y, Z and the
    /// duration prepared, s, which is shorter at the end of the queue.
    fn prepare_segment(&mut self, wanted: f64, hold: bool) -> ([i64; 3], f64) {
        let mut seconds = wanted;
        let mut pulses = [0; 3];
        while seconds > 1e-12 {
            let exit = self.blocks.get(1).map_or(0.0, |next| next.entry_speed);
            let Some(block) = self.blocks.front() else {
                self.speed = 0.0;
                break;
            };
            let left = block.length - self.front_distance_mm;
            let braking = (exit * exit + 2.0 * block.acceleration * left).sqrt();
            let change = block.acceleration * seconds;
            let aimed = if hold {
                0.0
            } else {
                block.nominal_speed.min(braking)
            };
            let next = if aimed > self.speed {
                aimed.min(self.speed + change)
            } else if hold {
                (self.speed - change).max(0.0)
            } else {
                aimed
            };
            if hold && next <= 0.0 {
                self.speed = 0.0;
                break;
            }
            let mean = (f64::midpoint(self.speed, next)).max(MIN_SPEED);
            let needed = left / mean;
            self.speed = next;
            if needed > seconds {
                self.front_distance_mm += mean * seconds;
                seconds = 0.0;
            } else {
                self.front_distance_mm = block.length;
                seconds -= needed;
            }
            let finished = self.front_distance_mm >= block.length;
            let share = if block.length > 0.0 {
                self.front_distance_mm / block.length
            } else {
                1.0
            };
            for (axis, sum) in pulses.iter_mut().enumerate() {
                let due = if finished {
                    block.steps[axis]
                } else {
                    (block.steps[axis] as f64 * share) as i64
                };
                *sum += due - self.front_pulses[axis];
                self.front_pulses[axis] = due;
            }
            if finished {
                self.blocks.pop_front();
                self.front_distance_mm = 0.0;
                self.front_pulses = [0; 3];
            }
        }
        (pulses, wanted - seconds)
    }
}

/// Returns the maximum speed, mm/s, at the junction of two directions of length 1, for an
/// acceleration, mm/s², and a junction deviation, mm.
fn junction_speed(before: [f64; 3], after: [f64; 3], acceleration: f64, deviation: f64) -> f64 {
    let cosine: f64 = -(0..3).map(|axis| before[axis] * after[axis]).sum::<f64>();
    if cosine > 0.999_999 {
        return 0.0;
    }
    let half_sine = ((1.0 - cosine.max(-1.0)) / 2.0).sqrt();
    if half_sine > 0.999_999 {
        return f64::INFINITY;
    }
    (acceleration * deviation * half_sine / (1.0 - half_sine)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along_x(steps: i64, nominal_speed: f64, acceleration: f64) -> PlannedBlock {
        PlannedBlock::new(
            [steps, 0, 0],
            [1.0, 0.0, 0.0],
            steps as f64 / 100.0,
            nominal_speed,
            acceleration,
        )
    }

    /// Advances until the queue is empty. Returns the time that takes, s, and the pulses made.
    fn drain(planner: &mut Planner) -> (f64, i64) {
        let (mut ticks, mut x) = (0, 0);
        while !planner.is_empty() {
            x += planner.advance(1e-4, false)[0];
            ticks += 1;
            assert!(ticks < 1_000_000);
        }
        (f64::from(ticks) * 1e-4, x)
    }

    #[test]
    fn a_single_move_is_a_trapezoid() {
        let mut planner = Planner::new(15, 0.05);
        // 10 mm at 20 mm/s and 200 mm/s²: 0.1 s up, 0.1 s down, 8 mm between.
        planner.push(along_x(1000, 20.0, 200.0), 0.02);
        let (seconds, pulses) = drain(&mut planner);
        assert_eq!(pulses, 1000);
        assert!((seconds - 0.6).abs() < 0.005, "{seconds}");
    }

    #[test]
    fn short_moves_in_a_row_run_through() {
        let mut planner = Planner::new(15, 0.05);
        for _ in 0..10 {
            planner.push(along_x(100, 20.0, 4000.0), 0.02);
        }
        assert_eq!(planner.free_blocks(), 5);
        let (seconds, pulses) = drain(&mut planner);
        assert_eq!(pulses, 1000);
        assert!((seconds - 0.505).abs() < 0.01, "{seconds}");
    }

    #[test]
    fn reversal_stops_between_the_moves() {
        assert!(junction_speed([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], 200.0, 0.02) == 0.0);
        assert!(junction_speed([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 200.0, 0.02) > 1e6);
        let square = junction_speed([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 200.0, 0.02);
        assert!((square - 3.108).abs() < 0.01, "{square}");
    }

    #[test]
    fn prepared_motion_has_left_the_queue_but_is_not_made() {
        let mut planner = Planner::new(15, 0.05);
        for _ in 0..10 {
            // 10 ms each.
            planner.push(along_x(20, 20.0, 100_000.0), 0.02);
        }
        let mut x = 0;
        for _ in 0..210 {
            x += planner.advance(1e-4, false)[0];
        }
        // 21 ms are made; the pulse timer holds 50 ms.
        assert!((40..=42).contains(&x), "{x}");
        assert_eq!(planner.free_blocks(), 15 - 3);
        assert_eq!(planner.pending_pulses(), [200 - x, 0, 0]);
    }

    #[test]
    fn hold_and_resume_lose_no_pulse() {
        let mut planner = Planner::new(15, 0.05);
        planner.push(along_x(1000, 20.0, 200.0), 0.02);
        let mut x = 0;
        for _ in 0..2000 {
            x += planner.advance(1e-4, false)[0];
        }
        for _ in 0..2000 {
            x += planner.advance(1e-4, true)[0];
        }
        // 3 mm before the hold, 1 mm prepared, 1 mm of deceleration.
        assert!(planner.is_stopped() && (495..=505).contains(&x), "{x}");
        assert_eq!(x + drain(&mut planner).1, 1000);
    }
}
