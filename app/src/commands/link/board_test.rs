//! Measurements of `link test`: round-trip times, operated switches and, on request, moves
//! of Z with feed holds.

use crate::commands::CommandError;
use std::time::Duration;

use gsk_core::units::{PerAxis, Pulses};
use gsk_host::board::BoardSession;
use gsk_host::platform;
use gsk_link::{FINE as PARTS, Input, LinkEvent, LinkState, MotionRefused, RunTime, Sample, Stop};
use gsk_messages::{Message, say};

use super::super::{EXIT_ALARM, EXIT_OK, output};

/// Duration of the measurement of the idle board.
const IDLE_DURATION: Duration = Duration::from_secs(3);
/// Number of feed holds that are made in the test move.
const HOLD_COUNT: u32 = 10;
/// Time to accelerate to the top speed, or to brake from it, ms.
const RAMP_MS: f64 = 100.0;

/// Returns median and maximum of `times`, ms; `None` if the slice is empty.
fn median_and_max(times: &mut [Duration]) -> Option<(f64, f64)> {
    times.sort_unstable();
    let worst = times.last()?;
    let ms = |time: &Duration| time.as_secs_f64() * 1000.0;
    Some((ms(&times[times.len() / 2]), ms(worst)))
}

/// Measures an idle board for `IDLE_DURATION` and prints its round-trip times. Returns the
/// events of that time.
pub fn measure_idle(board: &mut BoardSession) -> Vec<LinkEvent> {
    let mut events = Vec::new();
    let end = board.now() + IDLE_DURATION;
    let mut round_trips = Vec::new();
    let mut reports = board.link.traffic().reports;
    let is_closed = |state| matches!(state, LinkState::Lost | LinkState::Off);
    while board.now() < end && !is_closed(board.link.state()) {
        events.extend(board.pump());
        let traffic = board.link.traffic();
        if traffic.reports != reports {
            reports = traffic.reports;
            round_trips.extend(traffic.round_trip);
        }
    }
    match median_and_max(&mut round_trips) {
        Some((median, worst)) => {
            output::print_message(&say::link_test_answers(round_trips.len(), median, worst));
        }
        None => output::print_message(&say::link_test_no_answers()),
    }
    events
}

/// The inputs that must not be operated before a move, each with the function that names it.
const SWITCHES: [(Input, fn() -> Message); 4] = [
    (Input::LimitX, say::link_test_limit_x),
    (Input::LimitZ, say::link_test_limit_z),
    (Input::EmergencyStop, say::link_page_emergency_stop),
    (Input::DriveAlarm, say::link_page_drive_alarm),
];

/// Returns the names of those `SWITCHES` that are operated.
pub fn operated_switches(board: &BoardSession) -> Vec<Message> {
    let name_if_operated = |(input, name): (Input, fn() -> Message)| {
        (board.link.input(input) == Some(true)).then(name)
    };
    SWITCHES.into_iter().filter_map(name_if_operated).collect()
}

/// A test move of Z in progress: positions in pulses from its start, speeds in pulses per tick
/// of 1 ms.
struct TestMove<'a> {
    board: &'a mut BoardSession,
    events: Vec<LinkEvent>,
    end_time: RunTime,
    z_pulses: f64,
    pulses_per_tick: f64,
    sent_pulses: i64,
    /// End time of each tick, and the total distance travelled by then, pulses.
    distances: Vec<(RunTime, u64)>,
    refused: Option<MotionRefused>,
}

impl TestMove<'_> {
    /// Moves Z for one tick of 1 ms; its speed approaches `target` with the acceleration that
    /// reaches `top_speed` in `RAMP_MS` (both in pulses per tick). Returns false if the
    /// connection is lost or the board refuses the motion.
    fn move_tick(&mut self, target: f64, top_speed: f64) -> bool {
        let step = top_speed / RAMP_MS;
        self.pulses_per_tick += (target - self.pulses_per_tick).clamp(-step, step);
        self.z_pulses += self.pulses_per_tick;
        self.send_sample()
    }

    /// Sends the end position of the next tick as soon as the lookahead has space. Returns
    /// false if the connection is lost or the board refuses the motion.
    fn send_sample(&mut self) -> bool {
        self.end_time += Duration::from_millis(1);
        let before = self.sent_pulses;
        self.sent_pulses = self.z_pulses.round() as i64;
        let sample = Sample {
            fine: PerAxis::new(0, (self.z_pulses * PARTS as f64).round() as i64),
            ..Sample::new(
                self.end_time,
                PerAxis::new(Pulses(0), Pulses(self.sent_pulses)),
            )
        };
        while self.board.link.free_lookahead() == Duration::ZERO {
            let events = self.board.pump();
            self.events.extend(events);
            if !self.board.link.state().takes_motion() {
                return false;
            }
        }
        let pushed = self.board.link.push(sample);
        match pushed {
            Ok(()) => {
                let distance = self.distances.last().map_or(0, |(_, way)| *way);
                let distance = distance + self.sent_pulses.abs_diff(before);
                self.distances.push((self.end_time, distance));
            }
            Err(refused) => {
                self.sent_pulses = before;
                self.refused = Some(refused);
                // Stop the board before its queue runs dry.
                self.board.link.stop(Stop::Flush);
            }
        }
        pushed.is_ok()
    }

    /// Returns the total distance that the board has certainly executed so far, pulses.
    fn executed_distance(&self) -> u64 {
        let executed = self.board.link.executed();
        let made = self.distances.partition_point(|(end, _)| *end <= executed);
        made.checked_sub(1).map_or(0, |last| self.distances[last].1)
    }

    /// Distance that Z needs if it makes one more tick towards `top_speed` (pulses per tick)
    /// and then brakes, pulses.
    fn braking_distance(&self, top_speed: f64) -> f64 {
        let step = top_speed / RAMP_MS;
        let speed = (self.pulses_per_tick.abs() + step).min(top_speed);
        speed + speed * speed / (2.0 * step)
    }

    /// Brakes from the current speed and waits until the board has executed all motion.
    /// Returns false if the connection is lost, the board refuses the motion, or it is not
    /// ready after 5 s. `top_speed` in pulses per tick.
    fn stop(&mut self, top_speed: f64) -> bool {
        while self.pulses_per_tick != 0.0 {
            if !self.move_tick(0.0, top_speed) {
                return false;
            }
        }
        if self.board.link.finish().is_err() {
            return false;
        }
        let events = self.board.pump_until(Duration::from_secs(5), |link, _| {
            link.state() != LinkState::Moving
        });
        self.events.extend(events);
        self.board.link.state() == LinkState::Ready
    }

    /// Moves Z to pulse `leg` and back and stops at equal distances, as an operator does with
    /// feed hold; appends the duration of each stop to `holds`. `top_speed` in pulses per
    /// tick. Returns false if the connection is lost or the board refuses the motion.
    fn move_with_holds(&mut self, leg: f64, top_speed: f64, holds: &mut Vec<Duration>) -> bool {
        for target in [leg, 0.0] {
            let from = self.z_pulses;
            let direction = (target - from).signum();
            for hold in 1..=HOLD_COUNT / 2 {
                let hold_position =
                    from + (target - from) * f64::from(hold) / f64::from(HOLD_COUNT / 2);
                while (hold_position - self.z_pulses) * direction > self.braking_distance(top_speed)
                {
                    if !self.move_tick(direction * top_speed, top_speed) {
                        return false;
                    }
                }
                // Here the operator presses feed hold.
                let pressed = self.board.now();
                if !self.stop(top_speed) {
                    return false;
                }
                let stopped_at = self.board.link.standing_since();
                holds.extend(stopped_at.map(|at| at.saturating_sub(pressed)));
            }
        }
        true
    }

    /// Moves Z to pulse 0 exactly, from standstill to standstill, at most at `top_speed`
    /// (pulses per tick). Returns false if the connection is lost or the board refuses the
    /// motion.
    fn return_to_start(&mut self, top_speed: f64) -> bool {
        let from = self.z_pulses;
        // Half a cosine wave: its maximum speed is pi/2 times the mean.
        let ticks = (core::f64::consts::FRAC_PI_2 * from.abs() / top_speed)
            .max(RAMP_MS)
            .ceil();
        for tick in 1..=ticks as u32 {
            let fraction = f64::from(tick) / ticks;
            self.z_pulses = from * 0.5 * (1.0 + (core::f64::consts::PI * fraction).cos());
            if !self.send_sample() {
                return false;
            }
        }
        self.z_pulses = 0.0;
        self.send_sample() && self.stop(top_speed)
    }
}

/// Processor time of this process and of the guard process so far, s; `None` if the system
/// does not provide it.
fn processor_time(board: &BoardSession) -> Option<f64> {
    let own = platform::processor_time(std::process::id())?;
    let holder = board.holder_process_id().and_then(platform::processor_time);
    Some(own + holder.unwrap_or(0.0))
}

/// Moves Z by `distance_mm` and back with feed holds, prints the measurements and compares the
/// pulse counts of link and board. Returns the exit code.
pub fn measure_motion(
    board: &mut BoardSession,
    distance_mm: f64,
    feed_mm_per_min: f64,
) -> Result<u8, CommandError> {
    let per_mm = board.link.pulses_per_mm()[1];
    let top_speed = feed_mm_per_min / 60_000.0 * per_mm;
    let (rate, max_rate) = (top_speed * 1000.0, board.link.rates().each[1]);
    if rate > max_rate {
        return Err(say::command_feed_too_high(feed_mm_per_min, rate, max_rate).into());
    }
    // A board with homing starts locked.
    board.pump_until(Duration::from_millis(500), |_, _| false);
    board.link.reset();
    board.pump_until(Duration::from_millis(500), |_, _| false);
    if board
        .link
        .set_position(PerAxis::default(), RunTime::ZERO)
        .is_err()
    {
        return Err(say::command_board_moves().into());
    }
    let (from, before) = (board.now(), board.link.traffic());
    let processor = processor_time(board);
    let mut test_move = TestMove {
        board,
        events: Vec::new(),
        end_time: RunTime::ZERO,
        z_pulses: 0.0,
        pulses_per_tick: 0.0,
        sent_pulses: 0,
        distances: Vec::new(),
        refused: None,
    };
    let mut holds = Vec::new();
    let legs_completed = test_move.move_with_holds(distance_mm * per_mm, top_speed, &mut holds);
    let traffic = test_move.board.link.traffic();
    let seconds = test_move.board.now().saturating_sub(from).as_secs_f64();
    let executed = test_move.executed_distance();
    let load = processor.zip(processor_time(test_move.board));
    let completed = legs_completed && test_move.return_to_start(top_speed);
    if !completed {
        // Some boards report the cause with a later status report only.
        let late = test_move
            .board
            .pump_until(Duration::from_secs(2), |_, _| false);
        test_move.events.extend(late);
    }
    output::print_message(&say::link_test_motion(
        traffic.segments - before.segments,
        (traffic.segments - before.segments) as f64 / seconds,
        executed as f64 / seconds,
        (traffic.sent - before.sent) as f64 / seconds,
    ));
    if let Some((before, after)) = load {
        let percent = (after - before) / seconds * 100.0;
        output::print_message(&say::link_test_host(percent));
    }
    if let Some((median, worst)) = median_and_max(&mut holds) {
        output::print_message(&say::link_test_hold(median, worst, holds.len()));
    }
    let (commanded, refused) = (test_move.sent_pulses, test_move.refused);
    Ok(compare_pulses(
        completed,
        commanded,
        refused,
        &test_move.events,
    ))
}

/// Compares the pulse counts of link and board and prints the result. Returns the exit code.
fn compare_pulses(
    completed: bool,
    commanded: i64,
    refused: Option<MotionRefused>,
    events: &[LinkEvent],
) -> u8 {
    let failed = super::print_alarms(events);
    let position = events.iter().rev().find_map(|event| match event {
        LinkEvent::Position(pulses) => Some(pulses.z.0),
        _ => None,
    });
    match position {
        Some(counted) if completed && !failed => {
            output::print_message(&say::link_test_pulses(commanded, counted));
            if counted == commanded {
                EXIT_OK
            } else {
                EXIT_ALARM
            }
        }
        _ => {
            if let Some(refused) = refused {
                let (number, text) = refused.to_alarm();
                complain!("gsk980td: {number}: {}", output::localize(&text));
            }
            output::print_message(&say::link_test_run_broke_off());
            EXIT_ALARM
        }
    }
}
