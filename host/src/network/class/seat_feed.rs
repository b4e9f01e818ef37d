//! Passes the state of a seat from the kernel to the thread of the connection. It never waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam::channel::{Receiver, Sender, bounded};
use crossbeam::queue::ArrayQueue;
use gsk_telemetry::class::lcd_picture::LcdPicture;
use gsk_telemetry::class::part_outline::CoarseOutline;
use gsk_telemetry::class::seat_report::SeatReport;
use gsk_telemetry::class::seat_request::{SeatAnswer, SeatRequest};

/// Capacity of the queues for requests, answers and results.
const QUEUE_CAPACITY: usize = 16;

/// What a seat sends once.
#[derive(Debug)]
pub(super) enum SeatParcel {
    /// The answer to a request.
    Answer(SeatAnswer),
    /// A sealed result.
    Result(Vec<u8>),
}

/// The queues between both threads; a new state replaces an older one.
#[derive(Clone, Debug)]
pub(super) struct SeatQueues {
    pub(super) reports: Arc<ArrayQueue<SeatReport>>,
    pub(super) parts: Arc<ArrayQueue<CoarseOutline>>,
    pub(super) pictures: Arc<ArrayQueue<LcdPicture>>,
    pub(super) is_lcd_watched: Arc<AtomicBool>,
}

/// The end of the connection that sends, in its thread.
#[derive(Debug)]
pub(super) struct SeatQueueEnds {
    pub(super) queues: SeatQueues,
    pub(super) parcels: Receiver<SeatParcel>,
    pub(super) requests: Sender<SeatRequest>,
}

/// Passes the state of a seat on. It belongs to the kernel.
#[derive(Debug)]
pub struct SeatFeed {
    queues: SeatQueues,
    parcels: Sender<SeatParcel>,
    requests: Receiver<SeatRequest>,
    last_report: SeatReport,
}

impl SeatFeed {
    /// Creates a feed and the other end of its queues.
    pub(super) fn new() -> (Self, SeatQueueEnds) {
        let queues = SeatQueues {
            reports: Arc::new(ArrayQueue::new(1)),
            parts: Arc::new(ArrayQueue::new(1)),
            pictures: Arc::new(ArrayQueue::new(1)),
            is_lcd_watched: Arc::default(),
        };
        let (parcels, from_kernel) = bounded(QUEUE_CAPACITY);
        let (to_kernel, requests) = bounded(QUEUE_CAPACITY);
        let feed = Self {
            queues: queues.clone(),
            parcels,
            requests,
            last_report: SeatReport::default(),
        };
        let ends = SeatQueueEnds {
            queues,
            parcels: from_kernel,
            requests: to_kernel,
        };
        (feed, ends)
    }

    /// Passes a report on if it differs from the last one.
    pub fn report(&mut self, report: SeatReport) {
        if self.last_report != report {
            self.last_report.clone_from(&report);
            self.queues.reports.force_push(report);
        }
    }

    /// Passes the outline of the part on.
    pub fn show_part(&self, part: CoarseOutline) {
        self.queues.parts.force_push(part);
    }

    /// Whether the instructor watches the LCD.
    pub fn is_lcd_watched(&self) -> bool {
        self.queues.is_lcd_watched.load(Ordering::Relaxed)
    }

    /// Passes the LCD on.
    pub fn show_lcd(&self, picture: LcdPicture) {
        self.queues.pictures.force_push(picture);
    }

    /// Answers a request. A full queue drops the answer.
    pub fn answer(&self, answer: SeatAnswer) {
        let _ = self.parcels.try_send(SeatParcel::Answer(answer));
    }

    /// Hands a sealed result in. A full queue drops it: the learner can still save it.
    pub fn hand_in(&self, result: Vec<u8>) {
        let _ = self.parcels.try_send(SeatParcel::Result(result));
    }

    /// The next request of the instructor; `None` without one.
    pub fn take_request(&self) -> Option<SeatRequest> {
        self.requests.try_recv().ok()
    }
}
