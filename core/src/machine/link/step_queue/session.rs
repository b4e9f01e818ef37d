//! The link with a board of timed steps, from the first byte to the last.

mod motion;
mod opening;
mod place;
mod samples;
mod spindle;
mod stops;
mod upkeep;

use core::time::Duration;

use super::super::{
    BoardInfo, Doubt, Event, HostTime, Input, LinkConfig, LinkState, Pins, Stop, Traffic,
};
use super::block::Reader;
use super::clock::{Clock, near};
use super::commands::{Command, Kind, Reply};
use super::delivery::{Delivery, Heard, Mark, Message, Times, Trouble};
use super::describe;
use super::dictionary::Dictionary;
use super::shelf::Shelf;
use super::shutdown;
use super::wiring::Wiring;
use crate::axis::pulse_weight;
use crate::memory::Parameters;
use crate::units::{Axis, PerAxis, Pulses};
use motion::Motion;
use opening::Phase;
use spindle::Spindle;
use stops::{Group, Stopping};
use upkeep::Upkeep;

/// No step is sent that would be made sooner than this.
const LATEST: Duration = Duration::from_millis(20);
/// A slower line is not waited for.
const SLOWEST: Duration = Duration::from_millis(200);
/// A host that looks at its port so late has done something else.
const AWAY: Duration = Duration::from_millis(10);
/// A question is asked again after this, and given up after that.
const ASK_AGAIN: Duration = Duration::from_millis(100);
const GIVE_UP: Duration = Duration::from_millis(600);

/// What the place of the axes is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Purpose {
    /// The dialogue begins.
    Opening,
    /// All motion is made: does the count agree?
    Verify,
    /// Does it still agree? Told when somebody wants to know.
    Look { asked: bool },
    /// The axes were stopped.
    Stopped,
}

/// The place of the axes, asked and not answered.
#[derive(Clone, Copy, Debug)]
struct Reading {
    purpose: Purpose,
    since: HostTime,
    asked: HostTime,
    got: [Option<u32>; 2],
}

/// A link to one board.
#[derive(Clone, Debug)]
pub struct StepLink {
    config: LinkConfig,
    pulses_per_mm: [f64; 2],
    state: LinkState,
    now: HostTime,
    opened: HostTime,
    phase: Phase,
    info: BoardInfo,
    dictionary: Dictionary,
    shelf: Shelf,
    wiring: Option<Wiring>,
    reader: Reader,
    delivery: Delivery,
    clock: Clock,
    motion: Motion,
    group: Group,
    stopping: Option<Stopping>,
    reading: Option<Reading>,
    /// When the place of standing axes is looked at again.
    look_due: HostTime,
    upkeep: Upkeep,
    spindle: Spindle,
    /// The board is shut down: it hears nothing but a reset.
    down: bool,
    /// The slides stand where the kernel believes.
    known: bool,
    /// Why they may not.
    doubt: Doubt,
    /// Motion is taken although the position is not known: by hand.
    released: bool,
    /// The board's count is that of the kernel, since both were put together: no
    /// step was lost, no drive was without power.
    exact: bool,
    /// Levels of the pins whose change is awaited, of X and of Z.
    edges: [Option<i64>; 2],
    events: Vec<Event>,
    traffic: Traffic,
}

/// Pulses per mm of slide travel, X and Z (015–018).
fn pulses_per_mm(parameters: &Parameters) -> [f64; 2] {
    [Axis::X, Axis::Z].map(|axis| 1.0 / pulse_weight(axis, parameters))
}

impl StepLink {
    /// A link whose port has just been opened.
    pub fn open(config: LinkConfig, parameters: &Parameters, now: HostTime) -> Self {
        let mut link = Self {
            config,
            pulses_per_mm: pulses_per_mm(parameters),
            state: LinkState::Opening,
            now,
            opened: now,
            phase: Phase::Sync,
            info: BoardInfo::default(),
            dictionary: Dictionary::default(),
            shelf: Shelf::default(),
            wiring: None,
            reader: Reader::default(),
            delivery: Delivery::new(),
            clock: Clock::new(1.0),
            motion: Motion::new(pulses_per_mm(parameters)),
            group: Group::default(),
            stopping: None,
            reading: None,
            look_due: HostTime::ZERO,
            upkeep: Upkeep::default(),
            spindle: Spindle::new(1.0),
            down: false,
            known: false,
            doubt: Doubt::default(),
            released: false,
            exact: false,
            edges: [None; 2],
            events: Vec::new(),
            traffic: Traffic::default(),
        };
        link.begin();
        link
    }

    /// Dictionaries of boards met before, as told by [`Event::Learned`].
    pub fn know(&mut self, dictionaries: Vec<Vec<u8>>) {
        for packed in dictionaries {
            self.shelf.put(packed);
        }
    }

    /// Where the link stands.
    pub const fn state(&self) -> LinkState {
        self.state
    }

    /// What the board said it is.
    pub const fn board(&self) -> &BoardInfo {
        &self.info
    }

    /// Pulses per mm of slide travel, X and Z.
    pub const fn pulses_per_mm(&self) -> [f64; 2] {
        self.pulses_per_mm
    }

    /// Whether a switch at the board is operated; `None`: not wired, or not told yet.
    pub fn input(&self, input: Input) -> Option<bool> {
        self.upkeep.input(input)
    }

    /// Switches at the board that are operated, as last reported.
    pub fn pins(&self) -> Pins {
        let operated = |input| self.input(input) == Some(true);
        Pins {
            x: operated(Input::LimitX),
            z: operated(Input::LimitZ),
            emergency: operated(Input::EmergencyStop),
            ..Pins::default()
        }
    }

    /// Since when the axes have stood, as far as the board has been told.
    pub fn standing_since(&self) -> Option<HostTime> {
        let last = self.motion.last_step()?;
        let at = self.clock.moment(last);
        (at <= self.now).then_some(at)
    }

    /// Figures of the wire.
    pub const fn traffic(&self) -> Traffic {
        let mut traffic = self.traffic;
        traffic.lines = self.delivery.blocks;
        traffic.resent = self.delivery.resent;
        traffic.garbage = self.reader.garbage;
        traffic
    }

    /// Where the slides stand, as far as that is certain.
    pub fn position(&self) -> Option<PerAxis<Pulses>> {
        (self.known && !self.motion.is_under_way()).then_some(self.motion.commanded)
    }

    /// What happened since the last call.
    pub fn events(&mut self) -> Vec<Event> {
        core::mem::take(&mut self.events)
    }

    /// Bytes to be written to the port.
    pub fn tx(&self) -> &[u8] {
        &self.delivery.outgoing
    }

    /// So many of them were written.
    pub fn consumed(&mut self, count: usize) {
        let count = count.min(self.delivery.outgoing.len());
        self.delivery.outgoing.drain(..count);
        self.traffic.sent += count as u64;
    }

    /// Bytes came from the port.
    pub fn rx(&mut self, bytes: &[u8], now: HostTime) {
        self.pass(now);
        self.traffic.received += bytes.len() as u64;
        if matches!(self.state, LinkState::Off | LinkState::Lost) {
            return;
        }
        self.reader.give(bytes);
        while let Some(block) = self.reader.next() {
            let heard = self
                .delivery
                .hear(block.sequence, block.content.is_empty(), self.now);
            let Some(Heard::Expects(expects)) = heard else {
                if heard.is_some() {
                    self.hear_strange(&block.content);
                }
                continue;
            };
            if block.content.is_empty() {
                continue;
            }
            match self.dictionary.replies(&block.content) {
                Some(replies) => {
                    for reply in replies {
                        self.take(&reply, expects);
                    }
                }
                None => self.reader.garbage += 1,
            }
        }
    }

    fn pass(&mut self, now: HostTime) {
        let gap = now.saturating_sub(self.now);
        self.now += gap;
        if gap >= AWAY {
            self.delivery.was_away(gap);
        }
    }

    /// A board that counts its blocks anew may say why.
    fn hear_strange(&mut self, content: &[u8]) {
        let replies = self.dictionary.replies(content).unwrap_or_default();
        if self.is_running() && replies.iter().any(|reply| reply.kind == Kind::Starting) {
            self.board_restarted();
        }
    }

    /// Time passes; at least every 5 ms.
    pub fn tick(&mut self, now: HostTime) {
        self.pass(now);
        if matches!(self.state, LinkState::Off | LinkState::Lost) {
            return;
        }
        self.open_further();
        if self.is_running() && !self.down {
            self.keep_up();
            self.watch_group();
            self.ask_again();
            self.move_on();
            self.ask_levels_again();
        }
        // A board that restarts is left alone.
        if !matches!(self.phase, Phase::Restarting { .. }) {
            self.send();
        }
    }

    /// The port failed: unplugged, or taken away.
    pub fn lost(&mut self, cause: &str) {
        if matches!(self.state, LinkState::Off | LinkState::Lost) {
            return;
        }
        self.stand_unread(self.delivery.progressed());
        self.give_up_motion();
        self.lose_position(Doubt::Unheard);
        let number = if self.is_running() { 605 } else { 601 };
        self.alarm(number, cause);
        self.enter(LinkState::Lost);
    }

    /// Stops the board at once.
    pub fn stop(&mut self, stop: Stop) {
        if !self.is_running() || self.down || self.state == LinkState::Lost {
            return;
        }
        match stop {
            Stop::Flush => self.flush(),
            // Its own contact: the stop group does it, and a board that is not shut down
            // tells when it is released.
            Stop::Kill if self.input(Input::EmergencyStop) == Some(true) => self.trip(),
            Stop::Kill => {
                self.stand_unread(self.now);
                self.give_up_motion();
                let moves = self.state == LinkState::Moving;
                self.lose_position(Doubt::killed(moves, Doubt::ShutDown));
                self.say_first(Command::EmergencyStop, &[]);
                self.send();
                self.down = true;
                self.enter(LinkState::Fault);
            }
        }
    }

    /// The operator pressed RESET: faults whose cause is gone are cleared; nothing moves
    /// before the kernel has taken over where the axes stand.
    pub fn reset(&mut self) {
        self.motion.limits.look();
        let still = |input| self.input(input) == Some(true);
        match self.state {
            LinkState::Moving => self.flush(),
            LinkState::Fault if self.down || !self.is_running() => self.begin(),
            LinkState::Fault if self.is_running() && self.stopping.is_none() => {
                self.enter(LinkState::Locked);
            }
            LinkState::Tripped
                if self.stopping.is_none()
                    && !still(Input::EmergencyStop)
                    && !still(Input::DriveAlarm) =>
            {
                self.enter(LinkState::Locked);
            }
            _ => {}
        }
    }

    const fn is_running(&self) -> bool {
        matches!(self.phase, Phase::Running)
    }

    fn enter(&mut self, state: LinkState) {
        if self.state != state {
            self.state = state;
            self.events.push(Event::State(state));
        }
    }

    fn alarm(&mut self, number: u16, detail: &str) {
        let detail = detail.to_owned();
        self.events.push(Event::Alarm { number, detail });
    }

    fn say(&mut self, command: Command, arguments: &[i64]) {
        let bytes = self.dictionary.message(command, arguments);
        self.delivery.say(Message::plain(bytes));
    }

    fn say_first(&mut self, command: Command, arguments: &[i64]) {
        let bytes = self.dictionary.message(command, arguments);
        self.delivery.say_first(Message::plain(bytes));
    }

    /// What a block on the wire says, for who watches the traffic.
    pub fn describe(&self, outward: bool, block: &[u8]) -> String {
        describe::block(&self.dictionary, outward, block)
    }

    /// Takes the next block from bytes of the traffic that are collected.
    pub fn next_block(collected: &mut Vec<u8>) -> Option<Vec<u8>> {
        describe::piece(collected)
    }

    /// Something the board must have before a clock; dropped when motion is.
    fn say_timed(&mut self, command: Command, arguments: &[i64], due: u64) {
        self.delivery.say(Message {
            due: Some(due),
            motion: true,
            vital: true,
            ..Message::plain(self.dictionary.message(command, arguments))
        });
    }

    fn say_marked(&mut self, command: Command, arguments: &[i64], mark: Mark) {
        let bytes = self.dictionary.message(command, arguments);
        self.delivery.say_first(Message {
            mark: Some(mark),
            ..Message::plain(bytes)
        });
    }

    fn send(&mut self) {
        let times = self.is_running().then(|| Times {
            now: self.clock.at(self.now),
            earliest: self.earliest(),
            again: self
                .clock
                .at(self.now + self.margin() + self.delivery.slowness_now(self.now)),
        });
        match self.delivery.send(self.now, times) {
            Ok(()) => {}
            Err(Trouble::Silent) => self.lost("the board has not answered for 500 ms"),
            Err(Trouble::Restarted) => self.board_restarted(),
            Err(Trouble::Late) if self.delivery.is_rationed() => self.too_fine(),
            Err(Trouble::Late) => self.late("a step would have come too late"),
        }
    }

    /// Nothing that is sent now is sure to arrive before this clock.
    fn earliest(&self) -> u64 {
        // Of the last trip all but what is known to belong to the way back.
        let there = self.delivery.last_slow_trip();
        let there = there.map_or(Duration::ZERO, |trip| {
            trip.saturating_sub(self.clock.back()) + LATEST / 2
        });
        self.clock.at(self.now + self.margin().max(there))
    }

    fn margin(&self) -> Duration {
        LATEST + (self.clock.round_trip() / 2).min(SLOWEST)
    }

    /// How far ahead the motion is that is handed over now: the lookahead, and on a
    /// line that has become slow what it takes longer, there and to say it again.
    fn ahead(&self) -> Duration {
        self.config.lookahead() + 2 * self.delivery.slowness_now(self.now)
    }

    /// A question is asked again after this.
    fn patience(&self) -> Duration {
        ASK_AGAIN + 2 * self.delivery.slowness_now(self.now)
    }

    /// A clock for things that are to happen soon, and surely not too late.
    fn soon(&self) -> u64 {
        self.clock.at(self.now + self.ahead() + self.margin())
    }

    fn take(&mut self, reply: &Reply, expects: u64) {
        let numbers = reply.numbers;
        match reply.kind {
            Kind::Identify => self.identified(numbers[0], &reply.data),
            Kind::Config if self.delivery.answers(Mark::Config, expects) => {
                self.configured(numbers);
            }
            Kind::Uptime if self.delivery.answers(Mark::Uptime, expects) => self.uptime(numbers),
            Kind::Position if self.delivery.answers(Mark::Position, expects) => {
                self.place_told(i64::from(numbers[0]), numbers[1]);
            }
            Kind::Group if self.delivery.answers(Mark::Group, expects) => self.group_told(numbers),
            Kind::Endstop => {
                let told = self.wiring.as_ref();
                self.upkeep
                    .switch_told(told, i64::from(numbers[0]), numbers[3]);
                if self.delivery.answers(Mark::Switch, expects) {
                    self.level_told(numbers[0].into(), numbers[3].into());
                }
            }
            Kind::Counter => self.turns_told(numbers[2], numbers[3]),
            Kind::Shutdown => {
                let clock = near(numbers[0], self.clock.at(self.now));
                self.shut_down(numbers[1], self.clock.moment(clock));
            }
            Kind::IsShutdown => self.shut_down(numbers[0], self.delivery.progressed()),
            Kind::Starting if self.is_running() => self.board_restarted(),
            _ => {}
        }
    }

    fn shut_down(&mut self, text: u32, at: HostTime) {
        if self.down || self.shut_down_early() {
            return;
        }
        let text = self.dictionary.text(text);
        self.down = true;
        self.stand_unread(at);
        self.lose_position(Doubt::ShutDown);
        self.give_up_motion();
        if let Some((number, help)) = shutdown::alarm(&text) {
            self.alarm(number, &format!("the board has shut down: {text}; {help}"));
        }
        self.enter(LinkState::Fault);
    }

    /// The board started by itself: power or its reset line.
    fn board_restarted(&mut self) {
        if self.is_running() && self.down && !self.known {
            // It was to be reset anyway.
            return;
        }
        self.down = true;
        self.stand_unread(self.delivery.progressed());
        self.lose_position(Doubt::Reset);
        self.give_up_motion();
        self.delivery.begin();
        self.alarm(606, "the board was reset");
        self.enter(LinkState::Fault);
    }
}
