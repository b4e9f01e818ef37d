//! All seats of a class, the one that needs help first.

use std::collections::BTreeMap;

use gsk_messages::{Message, say};

use super::class_address::{ClassTopics, SeatTopicKind};
use super::lcd_picture::LcdPicture;
use super::part_outline::CoarseOutline;
use super::seat_report::{SeatReport, SeatTroubleKind};
use super::seat_request::SeatAnswer;

/// Greatest number of seats.
const MAX_SEATS: usize = 2000;
/// Minutes without a key after which a seat counts as idle.
const IDLE_MIN: u32 = 3;

/// How urgently a seat needs the instructor, the most urgent first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SeatUrgency {
    /// Emergency stop.
    Emergency,
    /// The tool has collided.
    Crash,
    /// The learner asks for help.
    Help,
    /// Another alarm.
    Alarm,
    /// No key for some minutes, and nothing runs.
    Idle,
    /// The learner works.
    Working,
    /// A program runs.
    Running,
    /// The seat is not connected.
    Offline,
}

impl SeatUrgency {
    fn new(report: &SeatReport) -> Self {
        let trouble = report.trouble.as_ref().map(|trouble| trouble.kind);
        match trouble {
            _ if !report.is_online => Self::Offline,
            Some(SeatTroubleKind::Emergency) => Self::Emergency,
            Some(SeatTroubleKind::Crash) => Self::Crash,
            _ if report.asks_help => Self::Help,
            Some(SeatTroubleKind::Alarm) => Self::Alarm,
            None if report.is_running => Self::Running,
            None if report.idle_min >= IDLE_MIN => Self::Idle,
            None => Self::Working,
        }
    }

    /// Whether the instructor is needed.
    pub const fn needs_help(self) -> bool {
        matches!(
            self,
            Self::Emergency | Self::Crash | Self::Help | Self::Alarm
        )
    }
}

/// A seat in the view of the class.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassSeat {
    /// Name of the seat in topics.
    pub id: String,
    /// Its state.
    pub report: SeatReport,
    /// Its part; empty without one.
    pub part: CoarseOutline,
    /// How urgently it needs the instructor.
    pub urgency: SeatUrgency,
    /// Since when, on the caller's clock, ms.
    pub since_ms: u64,
}

impl ClassSeat {
    /// The state in words.
    pub fn state_message(&self) -> Message {
        match self.urgency {
            SeatUrgency::Emergency => say::class_state_emergency(),
            SeatUrgency::Crash => say::class_state_crash(),
            SeatUrgency::Help => say::class_state_help(),
            SeatUrgency::Alarm => say::class_state_alarm(),
            SeatUrgency::Idle => say::class_state_idle(self.report.idle_min),
            SeatUrgency::Working => say::class_state_working(),
            SeatUrgency::Running => say::class_state_running(),
            SeatUrgency::Offline => say::class_state_offline(),
        }
    }
}

/// What a seat has sent besides its state.
#[derive(Clone, Debug, PartialEq)]
pub enum RosterEvent {
    /// The LCD of a seat.
    Lcd {
        /// Name of the seat in topics.
        seat: String,
        /// The picture.
        picture: Box<LcdPicture>,
    },
    /// The answer to a request.
    Answer {
        /// Name of the learner.
        name: String,
        /// The answer.
        answer: SeatAnswer,
    },
    /// A sealed result.
    Result {
        /// Name of the seat in topics.
        seat: String,
        /// Name of the learner.
        name: String,
        /// The file.
        bytes: Vec<u8>,
    },
}

/// The seats of a class.
#[derive(Clone, Debug)]
pub struct ClassRoster {
    topics: ClassTopics,
    seats: BTreeMap<String, ClassSeat>,
    /// Seats that gave way to a connected one with their name.
    replaced: Vec<String>,
}

impl ClassRoster {
    /// A class without seats.
    pub const fn new(topics: ClassTopics) -> Self {
        Self {
            topics,
            seats: BTreeMap::new(),
            replaced: Vec::new(),
        }
    }

    /// The topics of the class.
    pub const fn topics(&self) -> &ClassTopics {
        &self.topics
    }

    /// Forgets all seats: the broker sends those that it knows again.
    pub fn clear(&mut self) {
        self.seats.clear();
    }

    /// Takes a message of the broker at `now_ms`. Malformed ones change nothing.
    pub fn take(&mut self, topic: &str, payload: &[u8], now_ms: u64) -> Option<RosterEvent> {
        let (seat, kind) = self.topics.split(topic)?;
        let name = self.seats.get(seat).map(|it| it.report.name.clone());
        match kind {
            SeatTopicKind::State if payload.is_empty() => {
                self.seats.remove(seat);
                None
            }
            SeatTopicKind::State => {
                self.take_report(seat, SeatReport::parse(payload)?, now_ms);
                None
            }
            SeatTopicKind::Part => {
                let part = match payload.is_empty() {
                    true => CoarseOutline::default(),
                    false => CoarseOutline::parse(payload)?,
                };
                self.seats.get_mut(seat)?.part = part;
                None
            }
            SeatTopicKind::Lcd => Some(RosterEvent::Lcd {
                seat: seat.to_owned(),
                picture: Box::new(LcdPicture::parse(payload)?),
            }),
            SeatTopicKind::Answer => Some(RosterEvent::Answer {
                name: name?,
                answer: SeatAnswer::parse(payload)?,
            }),
            SeatTopicKind::Result if payload.is_empty() => None,
            SeatTopicKind::Result => Some(RosterEvent::Result {
                seat: seat.to_owned(),
                name: name.unwrap_or_else(|| seat.to_owned()),
                bytes: payload.to_vec(),
            }),
            SeatTopicKind::Request => None,
        }
    }

    fn take_report(&mut self, id: &str, report: SeatReport, now_ms: u64) {
        let urgency = SeatUrgency::new(&report);
        if report.is_online {
            // A seat that was cut off and has returned has another name in topics.
            let is_same = |seat: &ClassSeat| {
                seat.id != id && !seat.report.is_online && seat.report.name == report.name
            };
            let same = self.seats.values().filter(|seat| is_same(seat));
            let same: Vec<String> = same.map(|seat| seat.id.clone()).collect();
            for old in same {
                self.seats.remove(&old);
                self.replaced.push(old);
            }
        }
        let has_room = self.seats.len() < MAX_SEATS;
        match self.seats.get_mut(id) {
            Some(seat) => {
                if seat.urgency != urgency {
                    seat.since_ms = now_ms;
                }
                seat.urgency = urgency;
                seat.report = report;
            }
            None if has_room => {
                let seat = ClassSeat {
                    id: id.to_owned(),
                    report,
                    part: CoarseOutline::default(),
                    urgency,
                    since_ms: now_ms,
                };
                self.seats.insert(id.to_owned(), seat);
            }
            None => {}
        }
    }

    /// Seats that gave way since the last call: the broker need not retain them.
    pub fn take_replaced(&mut self) -> Vec<String> {
        core::mem::take(&mut self.replaced)
    }

    /// The seats, the most urgent first; among equals the one that has waited longest.
    pub fn by_urgency(&self) -> Vec<&ClassSeat> {
        let mut seats: Vec<&ClassSeat> = self.seats.values().collect();
        seats.sort_by_key(|seat| {
            // The other seats keep their order by name.
            let waits = match seat.urgency.needs_help() {
                true => seat.since_ms,
                false => 0,
            };
            (
                seat.urgency,
                waits,
                seat.report.name.as_str(),
                seat.id.as_str(),
            )
        });
        seats
    }

    /// A seat by its name in topics; `None` if it has left.
    pub fn seat(&self, id: &str) -> Option<&ClassSeat> {
        self.seats.get(id)
    }

    /// Number of seats that are connected, and of all seats.
    pub fn count(&self) -> (usize, usize) {
        let online = self.seats.values().filter(|seat| seat.report.is_online);
        (online.count(), self.seats.len())
    }
}
