//! The connection of a seat to the broker of its class.

use std::io;
use std::sync::atomic::Ordering;

use gsk_telemetry::class::class_address::ClassAddress;
use gsk_telemetry::class::seat_publisher::SeatPublisher;
use gsk_telemetry::class::seat_report::SeatReport;
use gsk_telemetry::class::seat_request::SeatRequest;
use gsk_telemetry::{SessionOptions, TelemetryMessage};
use tracing::info;

use super::seat_feed::{SeatFeed, SeatParcel, SeatQueueEnds};
use crate::network::mqtt::{BrokerClient, BrokerLine};
use crate::network::service_state::SharedServiceState;

/// What identifies a seat.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeatOptions {
    /// The class.
    pub class: ClassAddress,
    /// Name of the learner.
    pub name: String,
}

/// Connects a seat. Also returns the feed for the kernel.
///
/// # Errors
/// The system starts no thread.
pub fn start_seat(
    options: &SeatOptions,
    state: SharedServiceState,
) -> io::Result<(BrokerLine, SeatFeed)> {
    let report = SeatReport {
        name: options.name.clone(),
        is_online: true,
        ..SeatReport::default()
    };
    let (feed, ends) = SeatFeed::new();
    let client = SeatClient {
        publisher: SeatPublisher::new(options.class.topics(), make_seat_id(), report),
        ends,
    };
    let line = BrokerLine::start(options.class.broker.clone(), client, state)?;
    Ok((line, feed))
}

/// A name that no other seat has; another one at each start.
fn make_seat_id() -> String {
    let mut bytes = [0; 6];
    // Without random numbers two seats share a tile.
    let _ = getrandom::fill(&mut bytes);
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The client of a seat.
struct SeatClient {
    publisher: SeatPublisher,
    ends: SeatQueueEnds,
}

impl BrokerClient for SeatClient {
    fn announce(&self, options: &mut SessionOptions) {
        options.will = Some(self.publisher.will());
        options.subscriptions = vec![self.publisher.request_topic()];
    }

    fn collect(&mut self) {
        let queues = &self.ends.queues;
        if let Some(report) = queues.reports.pop() {
            self.publisher.set_report(report);
        }
        if let Some(part) = queues.parts.pop() {
            self.publisher.set_part(part);
        }
        if let Some(picture) = queues.pictures.pop() {
            self.publisher.set_lcd(picture);
        }
        while let Ok(parcel) = self.ends.parcels.try_recv() {
            match parcel {
                SeatParcel::Answer(answer) => self.publisher.answer(&answer),
                SeatParcel::Result(bytes) => {
                    if !self.publisher.hand_in(bytes) {
                        info!("the result is too large for the broker");
                    }
                }
            }
        }
    }

    fn forget_published(&mut self) {
        self.publisher.forget_published();
    }

    fn take_due(&mut self, now_ms: u64) -> Vec<TelemetryMessage> {
        let is_watched = self.publisher.is_lcd_watched(now_ms);
        let watched = &self.ends.queues.is_lcd_watched;
        watched.store(is_watched, Ordering::Relaxed);
        self.publisher.take_due(now_ms)
    }

    /// A malformed request is ignored: it names nothing to answer.
    fn receive(&mut self, topic: &str, payload: &[u8], now_ms: u64) {
        if topic != self.publisher.request_topic() {
            return;
        }
        match SeatRequest::parse(payload) {
            Ok(SeatRequest::Lcd { seconds }) => self.publisher.watch_lcd(now_ms, seconds),
            Ok(request) => {
                info!("request of the class: {:?}", request.subject());
                // A flood of requests is dropped.
                let _ = self.ends.requests.try_send(request);
            }
            Err(_) => info!("malformed request of the class"),
        }
    }

    fn farewell(&mut self) -> Vec<TelemetryMessage> {
        self.publisher.farewell()
    }
}
