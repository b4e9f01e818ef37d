//! What a seat publishes, and when.

use std::collections::VecDeque;

use super::class_address::{ClassTopics, SeatTopicKind};
use super::lcd_picture::LcdPicture;
use super::part_outline::CoarseOutline;
use super::seat_report::SeatReport;
use super::seat_request::SeatAnswer;
use crate::message::TelemetryMessage;

/// Shortest time between two reports, ms.
const REPORT_INTERVAL_MS: u64 = 250;
/// Shortest time between two outlines, ms.
const PART_INTERVAL_MS: u64 = 2000;
/// Shortest time between two pictures, ms.
const LCD_INTERVAL_MS: u64 = 300;
/// Greatest number of answers and results that wait for the broker.
const MAX_WAITING: usize = 16;
/// Greatest size of a result, bytes.
pub const MAX_RESULT_BYTES: usize = 1_900_000;

/// A seat of a class, and what the broker does not have yet.
#[derive(Debug)]
pub struct SeatPublisher {
    topics: ClassTopics,
    seat: String,
    report: SeatReport,
    part: CoarseOutline,
    lcd: Option<LcdPicture>,
    /// Answers and results, each sent once.
    waiting: VecDeque<TelemetryMessage>,
    has_new_report: bool,
    has_new_part: bool,
    next_report_ms: u64,
    next_part_ms: u64,
    next_lcd_ms: u64,
    /// Until when the instructor watches the LCD, on the caller's clock, ms.
    lcd_until_ms: u64,
}

impl SeatPublisher {
    /// A seat that has published nothing. `seat` is its name in topics.
    pub const fn new(topics: ClassTopics, seat: String, report: SeatReport) -> Self {
        Self {
            topics,
            seat,
            report,
            part: CoarseOutline { lines: Vec::new() },
            lcd: None,
            waiting: VecDeque::new(),
            has_new_report: true,
            has_new_part: true,
            next_report_ms: 0,
            next_part_ms: 0,
            next_lcd_ms: 0,
            lcd_until_ms: 0,
        }
    }

    /// The topic with requests of the instructor.
    pub fn request_topic(&self) -> String {
        self.topic(SeatTopicKind::Request)
    }

    fn topic(&self, kind: SeatTopicKind) -> String {
        self.topics.seat(&self.seat, kind)
    }

    /// The last will: only the name remains.
    pub fn will(&self) -> TelemetryMessage {
        let report = SeatReport {
            name: self.report.name.clone(),
            ..SeatReport::default()
        };
        TelemetryMessage::retained(self.topic(SeatTopicKind::State), report.to_json())
    }

    /// The state of the seat as last set.
    pub const fn report(&self) -> &SeatReport {
        &self.report
    }

    /// Sets the state of the seat.
    pub fn set_report(&mut self, report: SeatReport) {
        let report = SeatReport {
            is_online: true,
            ..report
        };
        self.has_new_report |= self.report != report;
        self.report = report;
    }

    /// Sets the outline of the part.
    pub fn set_part(&mut self, part: CoarseOutline) {
        self.has_new_part |= self.part != part;
        self.part = part;
    }

    /// Sets the LCD, if the instructor watches it.
    pub fn set_lcd(&mut self, picture: LcdPicture) {
        self.lcd = Some(picture);
    }

    /// Publishes the LCD from now on for this time.
    pub fn watch_lcd(&mut self, now_ms: u64, seconds: u16) {
        self.lcd_until_ms = now_ms + u64::from(seconds) * 1000;
        self.next_lcd_ms = 0;
    }

    /// Whether the instructor watches the LCD.
    pub const fn is_lcd_watched(&self, now_ms: u64) -> bool {
        now_ms < self.lcd_until_ms
    }

    /// Answers a request.
    pub fn answer(&mut self, answer: &SeatAnswer) {
        let topic = self.topic(SeatTopicKind::Answer);
        self.enqueue(TelemetryMessage::transient(topic, answer.to_json()));
    }

    /// Hands a sealed result in; returns whether it is small enough.
    pub fn hand_in(&mut self, result: Vec<u8>) -> bool {
        if result.len() > MAX_RESULT_BYTES {
            return false;
        }
        let topic = self.topic(SeatTopicKind::Result);
        self.enqueue(TelemetryMessage::retained(topic, result));
        true
    }

    fn enqueue(&mut self, message: TelemetryMessage) {
        if self.waiting.len() >= MAX_WAITING {
            self.waiting.pop_front();
        }
        self.waiting.push_back(message);
    }

    /// Publishes everything again: a new connection.
    pub const fn forget_published(&mut self) {
        self.has_new_report = true;
        self.has_new_part = true;
        self.next_report_ms = 0;
        self.next_part_ms = 0;
    }

    /// The messages that are due at `now_ms` on a clock that never goes back.
    pub fn take_due(&mut self, now_ms: u64) -> Vec<TelemetryMessage> {
        let mut due: Vec<TelemetryMessage> = Vec::new();
        if self.has_new_report && now_ms >= self.next_report_ms {
            self.has_new_report = false;
            self.next_report_ms = now_ms.saturating_add(REPORT_INTERVAL_MS);
            let topic = self.topic(SeatTopicKind::State);
            due.push(TelemetryMessage::retained(topic, self.report.to_json()));
        }
        if self.has_new_part && now_ms >= self.next_part_ms {
            self.has_new_part = false;
            self.next_part_ms = now_ms.saturating_add(PART_INTERVAL_MS);
            let topic = self.topic(SeatTopicKind::Part);
            due.push(TelemetryMessage::retained(topic, self.part.to_json()));
        }
        if self.is_lcd_watched(now_ms)
            && now_ms >= self.next_lcd_ms
            && let Some(picture) = self.lcd.take()
        {
            self.next_lcd_ms = now_ms + LCD_INTERVAL_MS;
            let topic = self.topic(SeatTopicKind::Lcd);
            due.push(TelemetryMessage::transient(topic, picture.to_bytes()));
        }
        due.extend(self.waiting.drain(..));
        due
    }

    /// The last messages: the broker forgets the seat, but not its result.
    pub fn farewell(&self) -> Vec<TelemetryMessage> {
        [SeatTopicKind::State, SeatTopicKind::Part]
            .map(|kind| TelemetryMessage::retained(self.topic(kind), Vec::new()))
            .into()
    }
}
