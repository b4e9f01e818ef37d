//! The link with a board that reads lines, from the first byte to the last.

mod acts;
mod hearing;
mod motion;
mod orders;
mod pass;
mod place;
mod stops;

use core::time::Duration;
use std::collections::VecDeque;

use super::super::limits::Limits;
use super::super::{
    BoardInfo, BoardOutputs, Doubt, Event, HostTime, Input, LinkConfig, LinkState, Pins,
    PulseRates, RunTime, Traffic, contacts,
};
use super::Family;
use super::answers::{Answer, Status};
use super::opening::Opening;
use super::required::Required;
use super::segments::{Segment, Segments};
use crate::memory::Parameters;
use crate::units::{PerAxis, Pulses};
use pass::{Cutting, Turning};

/// Between two reports, standing and moving: the longer, the farther a figure that was
/// damaged on the wire takes the slides.
const STATUS_IDLE: Duration = Duration::from_millis(200);
const STATUS_MOVING: Duration = Duration::from_millis(20);
/// The first pulse of a motion takes this long.
const RUN_UP: Duration = Duration::from_millis(80);
/// A board that was asked and is silent for so long is lost.
const SILENCE: Duration = Duration::from_millis(500);
/// One that answers does so within this.
const HEARD: Duration = Duration::from_millis(100);
/// A line that is not answered by then was lost on the way.
const ANSWER_WAIT: Duration = Duration::from_secs(2);
/// A segment takes no longer than its duration and this.
const LATE: Duration = Duration::from_secs(1);
/// A hold stands within this, or the board is given up.
const HOLD_WAIT: Duration = Duration::from_secs(1);
/// Standing so long before the count is compared.
const SETTLED: Duration = Duration::from_millis(50);
/// Longer between two looks at the link means that the computer was busy.
const AWAY: Duration = Duration::from_millis(100);
/// No line of a board is longer.
const LINE_BYTES: usize = 512;
/// Modal words of all motion.
/// A code of motion wants its F here, way or not.
const MODES: [&str; 2] = ["G21G18G90", "G1G94F60"];
pub(super) const RESET: u8 = 0x18;
/// A reference return ends within this.
const HOMING_WAIT: Duration = Duration::from_secs(120);
/// A board that gave up a reference return has restarted by then.
const EXCUSED: Duration = Duration::from_secs(1);
/// Ctrl-X is sent again after this, while no banner comes.
const RESET_AGAIN: Duration = Duration::from_millis(100);

/// A line that the board has not answered.
#[derive(Clone, Debug)]
struct Unanswered {
    bytes: usize,
    is_segment: bool,
    sent: HostTime,
}

/// Motion in the board that has not been made.
#[derive(Clone, Debug)]
struct Queued {
    duration: RunTime,
    end: RunTime,
    pulses: PerAxis<Pulses>,
    answered: bool,
}

/// How far a flush or an unlock has come.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Halt {
    None,
    /// Waits until the board has read what was sent.
    Draining(HostTime),
    /// `!` was sent; waits for the standstill.
    Braking(HostTime),
    /// Ctrl-X was sent; waits for the banner.
    Restarting(Restart),
}

/// How far a restart of the board has come.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Restart {
    since: HostTime,
    /// When Ctrl-X was sent last; what is sent once may be lost.
    sent: HostTime,
    /// A banner came, and one for each further Ctrl-X may come until then.
    quiet_at: Option<HostTime>,
}

/// A reference return that the board makes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Homing {
    since: HostTime,
    axes: PerAxis<bool>,
    /// The board has named them as being home.
    named: PerAxis<bool>,
}

/// A link to one board.
#[derive(Clone, Debug)]
pub struct LineLink {
    config: LinkConfig,
    required: Required,
    state: LinkState,
    now: HostTime,
    opening: Opening,
    outgoing: Vec<u8>,
    line: Vec<u8>,
    unanswered: VecDeque<Unanswered>,
    backlog: VecDeque<Segment>,
    queued: VecDeque<Queued>,
    /// Motion that has left the board's queue for its pulse timer, and when it is made.
    handed: VecDeque<(HostTime, Queued)>,
    /// Where motion made of late began, and when it was counted as made.
    past: VecDeque<(HostTime, PerAxis<Pulses>)>,
    segments: Segments,
    /// Kernel pulses of the last sample taken.
    commanded: PerAxis<Pulses>,
    /// Board pulses minus kernel pulses.
    offset: PerAxis<Pulses>,
    /// Time of commanded motion the board has certainly made.
    executed: RunTime,
    /// Where that ends.
    made: PerAxis<Pulses>,
    /// When the oldest queued segment became the oldest.
    progressed: HostTime,
    asked: Option<HostTime>,
    last_asked: HostTime,
    status: Option<Status>,
    /// Switches as last reported; a restart says nothing about them.
    pins: Pins,
    still_since: Option<HostTime>,
    halt: Halt,
    position_known: bool,
    /// Why it is not.
    doubt: Doubt,
    /// Where the board was by its last count, since it and the kernel's were put
    /// together, and whether its reports still count from there.
    stood: Option<PerAxis<Pulses>>,
    counts: bool,
    /// Motion is taken although the position is not known: by hand.
    released: bool,
    /// The stop under way was too sudden for the motors to keep their steps.
    slipped: bool,
    /// A limit switch stopped the board on these ways of the axes; which one the next
    /// report tells. None of an axis: its switch was operated before.
    limit_hit: Option<[Option<i64>; 2]>,
    limits: Limits,
    /// When motion of X and Z was last made, that up and that down.
    went: [[Option<HostTime>; 2]; 2],
    homing: Option<Homing>,
    cutting: Option<Cutting>,
    /// The next sample begins where and when the last pass ended.
    resumes: bool,
    turning: Option<Turning>,
    wanted: BoardOutputs,
    switched: BoardOutputs,
    /// A board that gave up restarts; its banner is no surprise until then.
    excused_until: HostTime,
    /// It has restarted by itself: it may be another one, or set otherwise.
    restarted: bool,
    /// It has said that it starts; its banner is no news.
    started: bool,
    /// It is unlocked as soon as it listens: the operator pressed RESET, or it has made the
    /// reference return of one axis and waits for the other.
    unlocks: bool,
    events: Vec<Event>,
    traffic: Traffic,
}

impl LineLink {
    /// A link whose port has just been opened.
    pub fn open(config: LinkConfig, parameters: &Parameters, now: HostTime) -> Self {
        let required = Required::new(parameters, &config);
        let period = Duration::from_millis(config.line.period_ms.into());
        let segments = Segments::new(period, config.line.max_rate, required.pulses_per_mm);
        let limits = Limits::new(required.pulses_per_mm);
        Self {
            config,
            required,
            state: LinkState::Opening,
            now,
            opening: Opening::new(now),
            outgoing: Vec::new(),
            line: Vec::new(),
            unanswered: VecDeque::new(),
            backlog: VecDeque::new(),
            queued: VecDeque::new(),
            handed: VecDeque::new(),
            past: VecDeque::new(),
            segments,
            commanded: PerAxis::default(),
            offset: PerAxis::default(),
            executed: RunTime::ZERO,
            made: PerAxis::default(),
            progressed: now,
            asked: None,
            last_asked: now,
            status: None,
            pins: Pins::default(),
            still_since: None,
            halt: Halt::None,
            position_known: false,
            doubt: Doubt::default(),
            stood: None,
            counts: false,
            released: false,
            slipped: false,
            limit_hit: None,
            limits,
            went: [[None; 2]; 2],
            homing: None,
            cutting: None,
            resumes: false,
            turning: None,
            wanted: BoardOutputs::default(),
            switched: BoardOutputs::default(),
            excused_until: HostTime::ZERO,
            restarted: false,
            started: false,
            unlocks: false,
            events: Vec::new(),
            traffic: Traffic::default(),
        }
    }

    /// Where the link stands.
    pub const fn state(&self) -> LinkState {
        self.state
    }

    /// What the board said it is.
    pub const fn board(&self) -> &BoardInfo {
        &self.opening.board
    }

    /// What the board has to be set to.
    pub const fn required(&self) -> &Required {
        &self.required
    }

    /// The newest report.
    pub const fn status(&self) -> Option<Status> {
        self.status
    }

    /// Switches at the board that are operated, as last reported.
    pub const fn pins(&self) -> Pins {
        self.pins
    }

    /// Whether a switch is operated, a contact closed; `None`: not wired, or nothing
    /// was reported yet.
    pub fn input(&self, input: Input) -> Option<bool> {
        self.status?;
        match input {
            Input::LimitX => Some(self.pins.x),
            Input::LimitZ => Some(self.pins.z),
            Input::EmergencyStop => Some(self.pins.emergency),
            Input::Contact { .. } => {
                let mut wired = contacts::wired(&self.config.inputs);
                let (_, pin) = wired.find(|(contact, _)| *contact == input)?;
                let letter = pin.chars().last()?;
                Some(self.pins.letter(letter) != pin.contains('!'))
            }
            _ => None,
        }
    }

    /// Since when the board has reported itself standing.
    pub const fn standing_since(&self) -> Option<HostTime> {
        self.still_since
    }

    /// Figures of the wire.
    pub const fn traffic(&self) -> Traffic {
        self.traffic
    }

    /// Motion the board has certainly made, as time since the opening.
    pub const fn executed(&self) -> RunTime {
        self.executed
    }

    /// Motion handed over that may not have been made yet.
    pub fn outstanding(&self) -> Duration {
        let handed: Duration = self.handed.iter().map(|(_, one)| one.duration).sum();
        let last = self.handed.back().map_or(self.now, |(made_by, _)| *made_by);
        let queued: Duration = self.queued.iter().map(|segment| segment.duration).sum();
        let waiting: Duration = self.backlog.iter().map(|segment| segment.duration).sum();
        let prepared = handed.min(last.saturating_sub(self.now));
        prepared + queued + waiting + self.segments.pending()
    }

    /// How much more motion may be handed over now.
    pub fn room(&self) -> Duration {
        if !self.is_prepared() || !self.backlog.is_empty() {
            return Duration::ZERO;
        }
        // With a full queue FluidNC looks at `!` and Ctrl-X 20 times a second only, and what
        // waits at a stop is carried out behind the reset.
        let places = usize::from(self.board().blocks);
        if self.opening.family == Family::FluidNc && self.queued.len() + 2 >= places {
            return Duration::ZERO;
        }
        self.config.lookahead().saturating_sub(self.outstanding())
    }

    /// Whether motion is taken, at the latest when the board has answered what it was
    /// told.
    pub fn takes_motion(&self) -> bool {
        (self.state.takes_motion() || self.state == LinkState::Locked && self.released)
            && self.halt == Halt::None
    }

    /// Whether it is known where the slides stand.
    pub const fn knows_position(&self) -> bool {
        self.position_known
    }

    /// Why it is not.
    pub const fn doubt(&self) -> Doubt {
        self.doubt
    }

    /// Where the slides were by the board's last count.
    pub const fn place(&self) -> Option<PerAxis<Pulses>> {
        self.stood
    }

    /// Whether a stop is still under way.
    pub fn is_stopping(&self) -> bool {
        let unread = self.counts && self.status.is_none();
        self.state != LinkState::Lost
            && (self.halt != Halt::None || self.limit_hit.is_some() || unread)
    }

    /// Whether the board answers what it is asked.
    pub fn is_heard(&self) -> bool {
        let waits = |asked| self.now.saturating_sub(asked) < HEARD;
        self.asked.is_none_or(waits)
    }

    /// Whether motion is taken now: the modal words of all motion are confirmed.
    pub fn is_prepared(&self) -> bool {
        self.takes_motion()
            && self.cutting.is_none()
            && self.unanswered.iter().all(|line| line.is_segment)
    }

    /// The most pulses a second that can be given: the faster axis sets the pace of
    /// this board, the other one costs nothing.
    pub fn rates(&self) -> PulseRates {
        let each = f64::from(self.config.line.max_rate);
        PulseRates {
            each: [each; 2],
            both: 2.0 * each,
        }
    }

    /// What happened since the last call.
    pub fn events(&mut self) -> Vec<Event> {
        core::mem::take(&mut self.events)
    }

    /// Bytes to be written to the port.
    pub fn tx(&self) -> &[u8] {
        &self.outgoing
    }

    /// So many of them were written.
    pub fn consumed(&mut self, count: usize) {
        let count = count.min(self.outgoing.len());
        self.outgoing.drain(..count);
        self.traffic.sent += count as u64;
    }

    /// Time passes; at least every 5 ms.
    pub fn tick(&mut self, now: HostTime) {
        self.passes(now);
        if matches!(self.state, LinkState::Off | LinkState::Lost) {
            return;
        }
        if !self.opening.is_done() {
            if self.state == LinkState::Fault {
                return;
            }
            let outcome = self.opening.tick(self.now);
            self.open_further(outcome);
            return;
        }
        self.settle(false);
        self.watch_silence();
        self.watch_pass();
        self.watch_halt();
        self.watch_homing();
        self.ask();
        self.verify();
        self.switch();
    }

    /// Bytes came from the port.
    pub fn rx(&mut self, bytes: &[u8], now: HostTime) {
        self.passes(now);
        self.traffic.received += bytes.len() as u64;
        if !bytes.is_empty() {
            self.opening.hears(self.now);
        }
        for &byte in bytes {
            match byte {
                b'\n' | b'\r' => {
                    let line = core::mem::take(&mut self.line);
                    if !line.is_empty() {
                        let text = String::from_utf8_lossy(&line).into_owned();
                        self.opening.take_text(&text);
                        self.take(&Answer::read(&text));
                    }
                }
                _ if self.line.len() < LINE_BYTES => self.line.push(byte),
                _ => {}
            }
        }
    }

    fn enter(&mut self, state: LinkState) {
        if self.state != state {
            self.state = state;
            if state == LinkState::Moving {
                // What was reported before says nothing about this motion.
                self.still_since = None;
            }
            self.events.push(Event::State(state));
        }
    }

    fn alarm(&mut self, number: u16, detail: &str) {
        let detail = detail.to_owned();
        self.events.push(Event::Alarm { number, detail });
    }

    fn send(&mut self, line: &str, is_segment: bool) {
        self.outgoing.extend_from_slice(line.as_bytes());
        if !line.ends_with('\n') {
            self.outgoing.push(b'\n');
        }
        self.traffic.lines += 1;
        self.traffic.segments += u64::from(is_segment);
        self.unanswered.push_back(Unanswered {
            bytes: line.len() + usize::from(!line.ends_with('\n')),
            is_segment,
            sent: self.now,
        });
    }
}
