//! What `link test` measures at a board: round trips, the switches that are operated, and,
//! when the owner asks for it, moves of Z with holds in them.

use crate::commands::CommandError;
use std::time::Duration;

use gsk_core::units::{PerAxis, Pulses};
use gsk_link::{FINE as PARTS, Input, LinkEvent, LinkState, MotionRefused, RunTime, Sample, Stop};
use gsk_messages::{Message, say};

use super::super::{ALARM, FINE, output};
use crate::board::Board;
use crate::platform;

/// How long the idle board is listened to.
const IDLE: Duration = Duration::from_secs(3);
/// Holds that are measured.
const HOLDS: u32 = 10;
/// Time the drill accelerates and brakes in, ms.
const RAMP_MS: f64 = 100.0;

/// Median and worst of some times, ms.
fn figures(times: &mut [Duration]) -> Option<(f64, f64)> {
    times.sort_unstable();
    let worst = times.last()?;
    let ms = |time: &Duration| time.as_secs_f64() * 1000.0;
    Some((ms(&times[times.len() / 2]), ms(worst)))
}

/// Round trips of an idle board; what happened meanwhile.
pub fn idle(board: &mut Board) -> Vec<LinkEvent> {
    let mut events = Vec::new();
    let end = board.now() + IDLE;
    let mut trips = Vec::new();
    let mut reports = board.link.traffic().reports;
    let over = |state| matches!(state, LinkState::Lost | LinkState::Off);
    while board.now() < end && !over(board.link.state()) {
        events.extend(board.pump());
        let traffic = board.link.traffic();
        if traffic.reports != reports {
            reports = traffic.reports;
            trips.extend(traffic.round_trip);
        }
    }
    match figures(&mut trips) {
        Some((median, worst)) => {
            output::say(&say::link_test_answers(trips.len(), median, worst));
        }
        None => output::say(&say::link_test_no_answers()),
    }
    events
}

/// The switches without which nothing may move, and what they are called.
const SWITCHES: [(Input, fn() -> Message); 4] = [
    (Input::LimitX, say::link_test_limit_x),
    (Input::LimitZ, say::link_test_limit_z),
    (Input::EmergencyStop, say::link_page_emergency_stop),
    (Input::DriveAlarm, say::link_page_drive_alarm),
];

/// Those of them that are operated.
pub fn operated(board: &Board) -> Vec<Message> {
    let operated = |(input, name): (Input, fn() -> Message)| {
        (board.link.input(input) == Some(true)).then(name)
    };
    SWITCHES.into_iter().filter_map(operated).collect()
}

/// A move of Z under way: speed in pulses a tick.
struct Drill<'a> {
    board: &'a mut Board,
    events: Vec<LinkEvent>,
    run: RunTime,
    z: f64,
    speed: f64,
    pulses: i64,
    /// Way handed over, pulses, and when it is made.
    ways: Vec<(RunTime, u64)>,
    refused: Option<MotionRefused>,
}

impl Drill<'_> {
    /// One tick at a speed that goes toward `target`; false when the link broke off.
    fn tick(&mut self, target: f64, top: f64) -> bool {
        let step = top / RAMP_MS;
        self.speed += (target - self.speed).clamp(-step, step);
        self.z += self.speed;
        self.push()
    }

    /// Hands over a tick that ends where Z is, as soon as there is room.
    fn push(&mut self) -> bool {
        self.run += Duration::from_millis(1);
        let before = self.pulses;
        self.pulses = self.z.round() as i64;
        let sample = Sample {
            fine: PerAxis::new(0, (self.z * PARTS as f64).round() as i64),
            ..Sample::new(self.run, PerAxis::new(Pulses(0), Pulses(self.pulses)))
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
                let way = self.ways.last().map_or(0, |(_, way)| *way);
                let way = way + self.pulses.abs_diff(before);
                self.ways.push((self.run, way));
            }
            Err(refused) => {
                self.pulses = before;
                self.refused = Some(refused);
                // What was handed over is not to run dry.
                self.board.link.stop(Stop::Flush);
            }
        }
        pushed.is_ok()
    }

    /// Pulses that the board has certainly made.
    fn made(&self) -> u64 {
        let executed = self.board.link.executed();
        let made = self.ways.partition_point(|(end, _)| *end <= executed);
        made.checked_sub(1).map_or(0, |last| self.ways[last].1)
    }

    /// The way that one more tick towards the top speed takes, and braking after it:
    /// the slide goes no farther than it was sent.
    fn braking(&self, top: f64) -> f64 {
        let step = top / RAMP_MS;
        let speed = (self.speed.abs() + step).min(top);
        speed + speed * speed / (2.0 * step)
    }

    /// Brakes to rest and waits until the board has made it all.
    fn stop(&mut self, top: f64) -> bool {
        while self.speed != 0.0 {
            if !self.tick(0.0, top) {
                return false;
            }
        }
        if self.board.link.finish().is_err() {
            return false;
        }
        let events = self.board.wait(Duration::from_secs(5), |link, _| {
            link.state() != LinkState::Moving
        });
        self.events.extend(events);
        self.board.link.state() == LinkState::Ready
    }

    /// A move from rest to rest that ends on pulse 0 exactly.
    fn return_to_start(&mut self, top: f64) -> bool {
        let from = self.z;
        // Half a wave of the cosine: its greatest speed is pi/2 times the mean.
        let ticks = (core::f64::consts::FRAC_PI_2 * from.abs() / top)
            .max(RAMP_MS)
            .ceil();
        for tick in 1..=ticks as u32 {
            let share = f64::from(tick) / ticks;
            self.z = from * 0.5 * (1.0 + (core::f64::consts::PI * share).cos());
            if !self.push() {
                return false;
            }
        }
        self.z = 0.0;
        self.push() && self.stop(top)
    }
}

/// Processor time of this process and of the one that holds the port so far, where the
/// system tells.
fn processor_time(board: &Board) -> Option<f64> {
    let own = platform::processor_time(std::process::id())?;
    let holder = board.holder().and_then(platform::processor_time);
    Some(own + holder.unwrap_or(0.0))
}

/// Moves Z there and back with holds, and compares the counts.
pub fn motion(board: &mut Board, millimetres: f64, feed: f64) -> Result<u8, CommandError> {
    let per_mm = board.link.pulses_per_mm()[1];
    let top = feed / 60_000.0 * per_mm;
    let (rate, most) = (top * 1000.0, board.link.rates().each[1]);
    if rate > most {
        return Err(CommandError::TooFast { feed, rate, most });
    }
    // A board with homing wakes up locked.
    board.wait(Duration::from_millis(500), |_, _| false);
    board.link.reset();
    board.wait(Duration::from_millis(500), |_, _| false);
    if board
        .link
        .set_position(PerAxis::default(), RunTime::ZERO)
        .is_err()
    {
        return Err(CommandError::NotStill);
    }
    let (from, before) = (board.now(), board.link.traffic());
    let processor = processor_time(board);
    let mut drill = Drill {
        board,
        events: Vec::new(),
        run: RunTime::ZERO,
        z: 0.0,
        speed: 0.0,
        pulses: 0,
        ways: Vec::new(),
        refused: None,
    };
    let leg = millimetres * per_mm;
    let mut holds = Vec::new();
    let mut whole = true;
    'legs: for target in [leg, 0.0] {
        let from = drill.z;
        let way = (target - from).signum();
        for hold in 1..=HOLDS / 2 {
            let place = from + (target - from) * f64::from(hold) / f64::from(HOLDS / 2);
            while (place - drill.z) * way > drill.braking(top) {
                if !drill.tick(way * top, top) {
                    whole = false;
                    break 'legs;
                }
            }
            // The operator presses hold now.
            let pressed = drill.board.now();
            if !drill.stop(top) {
                whole = false;
                break 'legs;
            }
            let stood = drill.board.link.standing_since();
            holds.extend(stood.map(|at| at.saturating_sub(pressed)));
        }
    }
    let traffic = drill.board.link.traffic();
    let seconds = drill.board.now().saturating_sub(from).as_secs_f64();
    let made = drill.made();
    let load = processor.zip(processor_time(drill.board));
    whole = whole && drill.return_to_start(top);
    if !whole {
        // Some boards tell the cause only with their next report.
        let late = drill.board.wait(Duration::from_secs(2), |_, _| false);
        drill.events.extend(late);
    }
    let (commanded, refused, events) = (drill.pulses, drill.refused, drill.events);
    output::say(&say::link_test_motion(
        traffic.segments - before.segments,
        (traffic.segments - before.segments) as f64 / seconds,
        made as f64 / seconds,
        (traffic.sent - before.sent) as f64 / seconds,
    ));
    if let Some((before, after)) = load {
        let percent = (after - before) / seconds * 100.0;
        output::say(&say::link_test_host(percent));
    }
    if let Some((median, worst)) = figures(&mut holds) {
        output::say(&say::link_test_hold(median, worst, holds.len()));
    }
    let failed = super::report(&events);
    let position = events.iter().rev().find_map(|event| match event {
        LinkEvent::Position(pulses) => Some(pulses.z.0),
        _ => None,
    });
    match position {
        Some(counted) if whole && !failed => {
            output::say(&say::link_test_pulses(commanded, counted));
            Ok(if counted == commanded { FINE } else { ALARM })
        }
        _ => {
            if let Some(refused) = refused {
                let (number, text) = refused.to_alarm();
                complain!("gsk980td: {number}: {}", output::worded(&text));
            }
            output::say(&say::link_test_run_broke_off());
            Ok(ALARM)
        }
    }
}
